"""A robot without room for two programs: it reads text where the program is that it holds.

An Uno and a Nano are such robots. Behaviour shared by all robots is tested on this one, too.
"""

from __future__ import annotations

import random

import pytest

from tests.firmware import test_text, test_text_fuzz
from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.robot_on_host import (
    actions_of,
    computer,
    push_button,
    send,
    switched_on,
    wait_until_saved,
)
from tests.support.text_robot import (
    HOLDING_ACTIONS,
    LINE,
    SAVED_MEMORY,
    fetch_image,
    read_back,
    robot_with_program,
    status,
    type_text,
)
from tiniscript.link.messages import SAVED_NOTHING, SAVED_STORED, STATE_STOPPED
from tiniscript.link.requests import OK

LOST = "// The old program is lost."
OTHERWISE = {  # tests of robots that have room for two programs
    "test_typed_lines_leave_the_stored_program",
    "test_a_typed_sb_program_waits_for_the_button_and_is_lost_at_power_off",
}

assert vars(test_text).keys() >= OTHERWISE
for name, test in {**vars(test_text), **vars(test_text_fuzz)}.items():
    if name.startswith("test_") and name not in OTHERWISE:
        globals()[name] = test


@pytest.fixture(autouse=True)
def _without_draft(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(HostFirmware, "has_draft", False)


# -- the program that it holds --------------------------------------------------------------------


def test_a_stored_program_comes_back_with_the_button() -> None:
    robot, session, bytes_before = read_back()
    assert type_text(robot, "SI|F(0.2,50);SHOW(1.5)\r\n", 400) == ["// OK", "// 1.5", "// DONE"]
    assert fetch_image(robot, session) == bytes_before
    assert status(robot, session).saved == SAVED_STORED
    robot.wait(4000)
    assert push_button(robot) == HOLDING_ACTIONS


@pytest.mark.parametrize("has_stored", [True, False])
def test_the_loss_of_an_unsaved_program_is_reported(has_stored: bool) -> None:
    robot, session = robot_with_program() if has_stored else (switched_on(), computer())
    send(robot, session, "SB|L(0.1, 40)", saves=False)
    assert status(robot, session).saved == SAVED_MEMORY
    robot.wait(4000)
    assert type_text(robot, "SI|F(0.2,50)\n", 400) == ["// OK", LOST, "// DONE"]
    assert type_text(robot, "SI|F(0.2,50)\n", 400) == ["// OK", "// DONE"]
    assert push_button(robot) == (HOLDING_ACTIONS if has_stored else [])
    assert robot.is_lit == has_stored


def test_sb_keeps_the_button_until_the_next_line() -> None:
    robot, session, bytes_before = read_back()
    assert type_text(robot, "SB|F(0.2,50)\n", 2000) == ["// OK. The button starts it."]
    assert robot.did == [] and robot.is_lit
    for _ in range(2):
        robot.push()
        robot.wait(400)
    assert actions_of(robot) == LINE * 2
    robot.did.clear()
    assert type_text(robot, "SI|R(0.1,40)\n", 300) == ["// OK", LOST, "// DONE"]
    assert push_button(robot) == HOLDING_ACTIONS
    assert fetch_image(robot, session) == bytes_before


# -- a running program, and a new line -------------------------------------------------------------


def test_a_complete_line_ends_the_running_program() -> None:
    """It also ends it when it needs the running program's memory."""
    robot, session = robot_with_program()
    send(robot, session, "SI|F(30, 60)", saves=False, is_detached=True)
    robot.wait(4000)
    type_text(robot, "SI|R(0.2, 40);W(0.1)")
    assert actions_of(robot)[-1] == "MOTORS 60 60"
    assert type_text(robot, "\n", 600) == ["// OK", LOST, "// DONE"]
    assert actions_of(robot)[-4:] == ["MOTORS 0 0", "MOTORS 40 -40", "MOTORS 0 0", "FINISHED"]
    type_text(robot, "SI|F(30,50)\n", 300)
    type_text(robot, "SI|X = " + "1.2345 + " * 12)
    assert actions_of(robot)[-2:] == ["MOTORS 50 50", "MOTORS 0 0"]
    assert type_text(robot, "0; SHOW(X)\n", 100) == ["// OK", "// 14.82", "// DONE"]


@pytest.mark.parametrize("line", [
    "X" * 50, "SI|" + "F(0.1,50);W(0.2);" * 8 + "hola", "SI|X=" + "1.2345+" * 12 + "hola",
    "SI|" + "F(0.1,50);W(0.2);" * 8 + "\0",
])  # fmt: skip
def test_a_wrong_line_that_needed_the_room_reports_the_lost_program(line: str) -> None:
    robot, session = robot_with_program("SB|B(30, 60)", saves=False)
    first, *other_answers = type_text(robot, line + "\n", 1500)
    assert first.startswith("// ") and other_answers.count(LOST) == 1
    assert status(robot, session).saved == SAVED_NOTHING
    robot.wait(4000)
    assert type_text(robot, "SI|F(0.2,50)\n", 400) == ["// OK", "// DONE"]


# -- interruptions --------------------------------------------------------------------------------


def test_a_request_while_a_block_is_open_finds_the_stored_program() -> None:
    robot, session, bytes_before = read_back()
    type_text(robot, "SI|LOOP(3)\n F(0.1,50)\n", 1500)
    assert fetch_image(robot, session) == bytes_before
    assert robot.until(session, session.start()) == OK
    robot.talk(session, 400)
    assert actions_of(robot) == HOLDING_ACTIONS


@pytest.mark.sampled("at_ms", keep=3)
@pytest.mark.parametrize("at_ms", range(0, 60, 7))
def test_a_power_cut_while_text_is_read_loses_nothing_stored(at_ms: int) -> None:
    robot, _, bytes_before = read_back()
    type_text(robot, "SI|LOOP(3);F(0.01,50);END_LOOP;SHOW(1)\n"[: at_ms + 1], at_ms)
    restarted_robot = switched_on(robot.memory())
    assert push_button(restarted_robot) == HOLDING_ACTIONS
    assert fetch_image(restarted_robot, computer(2)) == bytes_before


@pytest.mark.parametrize("has_draft", [True, False])
def test_a_line_during_a_save_does_not_end_the_run(
    has_draft: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A program is saved when the motors are off: until then it is the one that runs."""
    monkeypatch.setattr(HostFirmware, "has_draft", has_draft)
    robot, session = switched_on(), computer()
    send(robot, session, "SI|F(5, 60)", saves=True, is_detached=True)
    robot.wait(3500)
    assert actions_of(robot) == ["MOTORS 60 60"]
    assert type_text(robot, "SB|F(0.1,50); S\n", 100) == ["// Still saving. Send it again."]
    assert actions_of(robot) == ["MOTORS 60 60"]
    robot.wait(3000)
    wait_until_saved(robot, session)
    image = fetch_image(robot, session)
    assert image.endswith(image_of("SI|F(5, 60)").code)


def test_a_line_during_a_save_is_answered_even_after_a_stop() -> None:
    robot, session = switched_on(write_ms=12.0), computer()
    send(robot, session, "SB|" + "X=RANDOM(1,1000)/7;" * 40, saves=True)
    robot.wait(1900)
    type_text(robot, "S\n", 1200)
    assert type_text(robot, "SI|F(0.1,50)\n", 300) == ["// Still saving. Send it again."]
    assert type_text(robot, "F(0.1,50)\n", 300) == ["// It was stopped. Begin with SI|"]


@pytest.mark.parametrize(
    ("line", "stops"),
    [
        ("S\n", True), ("s;\r\n", True), (" STOP ; \n", True), ("stop\r", True),
        ("ST\n", False), ("STO;P(\n", True), ("SS\n", True), ("STOPP\n", False),
        ("X\n", False), (";\n", False), ("F(1,50)\n", False),
    ],
    ids=lambda value: repr(value)[1:-1],
)  # fmt: skip
def test_s_alone_stops_a_live_line(line: str, stops: bool) -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.live(image_of("SI|F(5, 60)").code)) == OK
    assert actions_of(robot) == ["MOTORS 60 60"]
    type_text(robot, line, 0)
    for _ in range(600):  # a heartbeat after a line is text, and repeated
        robot.talk(session, 1)
    assert actions_of(robot)[:2] == ["MOTORS 60 60"] + ["MOTORS 0 0"] * stops
    assert (status(robot, session).state == STATE_STOPPED) == stops


def test_texts_and_frames_work_in_any_order() -> None:
    """Whatever was typed, the stored program does not change."""
    robot, session = robot_with_program()
    bytes_before = fetch_image(robot, session)
    rng = random.Random(7)
    for _ in range(40):
        robot.wait(3500)
        type_text(robot, rng.choice(["SI|F(0.1,50)\n", "SB|R(0.1,20)\n", "LOOP(2)\n", "S\n"]), 50)
        if rng.random() < 0.5:
            robot.push()
    robot.step(flags=2)
    robot.wait(1500)
    type_text(robot, "SI|W(0)\n")
    robot.wait(3500)
    assert fetch_image(robot, session) == bytes_before
