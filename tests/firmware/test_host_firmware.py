"""The whole robot: its firmware with a computer, a button and a pulled plug.

Behaviour that other files test is not tested here: stops and presses in every state, undo, text,
faults.
"""

from __future__ import annotations

import random

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.robot_on_host import (
    AWAY_PROGRAM,
    KIT,
    LONG_PROGRAM,
    actions_of,
    broken_upload,
    computer,
    live,
    robot_with_saved_program,
    send,
    switched_on,
)
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import BY_NAME, RUN, SAVED_STORED
from tiniscript.link.requests import OK
from tiniscript.link.session import Session


def driving_robot(milliseconds: int) -> tuple[HostFirmware, Session]:
    """Return a robot that has driven for this long, and is still driving."""
    robot, session = switched_on(), computer()
    send(robot, session, AWAY_PROGRAM)
    robot.talk(session, milliseconds)
    return robot, session


def test_a_program_in_one_frame_drives_at_once() -> None:
    robot, session = switched_on(), computer()
    send(robot, session, "SI|F(1, 80)")
    robot.talk(session, 1200)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]
    first_ms, last_ms = (int(line.split()[0]) for line in robot.did[:2])
    assert last_ms - first_ms == 1000
    assert [event.name for event in session.events()] == ["DONE"]
    assert robot.is_latched


@pytest.mark.parametrize("extra_text", ["", "\nTASK\nW(1); S\nEND_TASK"])
def test_code_in_one_frame_is_the_program_that_was_compiled(extra_text: str) -> None:
    """The robot makes its image, which lists its needs."""
    robot, session, image = switched_on(), computer(), image_of(f"SI|F(9, 80){extra_text}")
    assert robot.complete(session, session.live(image.code)).program == image.checksum


def test_after_power_on_nothing_moves_and_the_button_starts_the_stored_program() -> None:
    assert not switched_on().is_lit
    robot, _ = robot_with_saved_program("SI|F(0.5, 80)")
    restarted_robot = switched_on(robot.memory())
    assert restarted_robot.is_lit
    restarted_robot.wait(2000)
    assert restarted_robot.did == []
    restarted_robot.push()
    restarted_robot.wait(600)
    assert actions_of(restarted_robot) == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


def test_without_frames_the_motors_are_turned_off_in_time() -> None:
    robot, session = driving_robot(700)
    silent_ms = robot.now_ms
    robot.wait(2000)
    assert actions_of(robot)[1:] == ["MOTORS 0 0", "FAULTED"]
    off_ms = int(robot.did[1].split()[0])
    assert off_ms - silent_ms <= 1050
    assert robot.complete(session, session.status()).fault == 64


@pytest.mark.parametrize("starts", [1, 256])
def test_a_run_started_by_the_button_is_never_attached(starts: int) -> None:
    """However often it starts: runs are counted in one byte, and one of them was attached."""
    robot, session = driving_robot(100)
    assert not robot.is_lit
    robot.talk(session, 1, flags=1)
    assert actions_of(robot)[-1] == "MOTORS 0 0" and robot.is_lit
    robot.talk(session, 100)
    robot.step(flags=2)
    assert [event.cause for event in session.events() if event.name == "STOPPED"] == [3]
    robot.wait(1500)
    for _ in range(starts - 1):
        robot.push()
        robot.push()
    robot.push()
    robot.wait(1500)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"] * starts + ["MOTORS 80 80"]
    robot.step(flags=8)
    robot.wait(100)
    assert actions_of(robot)[-1] == "MOTORS 80 80"


def test_a_long_press_stops_a_run_begun_meanwhile() -> None:
    """Its first edge came before the start, as after a spike on the wire."""
    robot, session = switched_on(), computer()
    robot.step(flags=1)
    send(robot, session, AWAY_PROGRAM)
    robot.step(flags=32)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]
    robot.step(flags=2)
    robot.wait(100)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]


@pytest.mark.parametrize("seed", range(6))
def test_a_power_cut_leaves_one_program_or_the_other(seed: int) -> None:
    """Whenever it is pulled: while it arrives, while it drives, while it is saved."""
    rng = random.Random(seed)
    memory = robot_with_saved_program()[0].memory()
    for _ in range(6):
        robot, session = switched_on(memory), computer(rng.getrandbits(32))
        session.upload(image_of("SI|B(0.1, 60); " + "SHOW(1); " * rng.randrange(30)))
        robot.talk(session, rng.randrange(1, 1500))
        memory = robot.memory()
        restarted_robot = switched_on(memory)
        assert restarted_robot.is_lit
        restarted_robot.push()
        restarted_robot.wait(400)
        assert actions_of(restarted_robot)[0] in ("MOTORS 80 80", "MOTORS -60 -60")
        assert actions_of(restarted_robot)[-1] == "FINISHED"


def test_an_upload_that_breaks_off_while_a_fault_is_noted_leaves_the_stored_program() -> None:
    """The memory cannot be read while it is written: its content must not count as lost then."""
    robot, session = robot_with_saved_program()
    robot.talk(session, 500)
    request = session.live(image_of("SI|X = 0; SHOW(5 / X)").code)
    assert robot.until(session, request) == OK
    while "FAULTED" not in actions_of(robot):
        robot.talk(session, 1)
    broken_upload(robot, session)
    robot.push()
    robot.wait(400)
    assert actions_of(robot)[-3:] == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


@pytest.mark.parametrize("is_live", [False, True])
def test_an_immediate_fault_names_the_program(is_live: bool) -> None:
    """A program in one frame starts before its checksum is known."""
    robot, session = switched_on(), computer()
    image = image_of("SI|X = 1 / 0")
    values = robot.complete(session, session.live(image.code) if is_live else session.upload(image))
    robot.talk(session, 300)
    faults = [event.program for event in session.events() if event.name == "FAULT"]
    assert faults == [image.checksum]
    assert values.program == image.checksum
    state = robot.complete(session, session.status())
    assert state.fault_program == image.checksum
    assert state.program == (0 if is_live else image.checksum)


@pytest.mark.parametrize("text", ["SB|F(0.1, 50)", LONG_PROGRAM.replace("SI|", "SB|")])
def test_a_robot_reports_its_program_before_it_is_saved(text: str) -> None:
    """In one frame, and in several."""
    robot, session = robot_with_saved_program()
    send(robot, session, text)
    values = robot.complete(session, session.status())
    assert values.program == image_of(text).checksum
    assert values.saved != SAVED_STORED


def test_a_program_of_one_frame_may_use_every_sensor_of_the_kit() -> None:
    robot, session = switched_on(), computer()
    for device in KIT.sensors:
        send(robot, session, f"SI|SHOW({device.name})")
        robot.talk(session, 100)
    assert [event.name for event in session.events()].count("SHOW") == len(KIT.sensors)


@pytest.mark.parametrize("noise", [0, 0xFFFF0000, 0x12345678])
def test_random_numbers_differ_at_different_times(noise: int) -> None:
    """Also where the noise of a board is always the same."""
    values = set()
    for wait_ms in range(300, 320):
        robot, session = HostFirmware(KIT, seed=noise), computer()
        robot.wait(wait_ms)
        robot.complete(session, session.live(image_of("SI|SHOW(RANDOM(1, 10000))").code))
        robot.talk(session, 50)
        values |= {event.value for event in session.events() if event.name == "SHOW"}
    assert len(values) >= 9, "every second millisecond has numbers of its own"


# -- code that arrives during a run: it replaces the program as a whole, or changes nothing ------


RUNS = "SI|X = 3; W(0.02); X = 4; LOOP(FOREVER); F(0.2, 40); SHOW(X); END_LOOP"


@pytest.mark.parametrize("is_line", [False, True])
def test_a_line_that_replaces_a_run_starts_from_its_own_beginning(is_line: bool) -> None:
    robot, session = switched_on(), computer()
    (live if is_line else send)(robot, session, RUNS)
    robot.talk(session, 100)
    session.events()
    robot.did.clear()
    live(robot, session, "SI|F(0.1, 60); Y = TIME; SHOW(Y < 0.2); SHOW(5)")
    robot.talk(session, 300)
    moves = [line for line in actions_of(robot) if line.startswith("MOTORS")]
    assert moves[-2:] == ["MOTORS 60 60", "MOTORS 0 0"] and "MOTORS 40 40" not in moves
    shown_values = [event.value for event in session.events() if event.name == "SHOW"]
    assert shown_values == [1, 5000]


@pytest.mark.parametrize("position", range(-5, 0))
def test_a_damaged_line_does_not_affect_the_running_one(position: int) -> None:
    """Code is made ready while its frame arrives: not where the code lies that runs."""
    robot, session = switched_on(), computer()
    live(robot, session, "SI|F(0.2, 40); F(0.2, 50); SHOW(7)")
    robot.talk(session, 50)
    session.events()
    payload = bytes([RUN]) + image_of("SI|F(0.2, 90); F(0.2, 90); SHOW(9)").code
    frame = Frame(BY_NAME["LIVE"].number, (session._seq + 1) & 0xFF, session._epoch, payload)
    wire = bytearray(encode_frame(frame))
    if position < -1:
        wire[position] ^= 0x11
    for byte in wire if position < -1 else wire[:-1]:  # a sequence cut before its end
        robot.step(bytes([byte]))
    robot.talk(session, 600)
    moves = [line for line in actions_of(robot) if line.startswith("MOTORS")]
    assert "MOTORS 50 50" in moves and "MOTORS 90 90" not in moves
    assert [event.value for event in session.events() if event.name == "SHOW"] == [7000]
