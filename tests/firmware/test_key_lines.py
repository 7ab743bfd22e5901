"""Lines of text that are words of a remote control: KEY_A, KEY, PAD 30 -20.

An Uno has no room for them: it reads them as any other line.
"""

from __future__ import annotations

import random

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.button_states import SmallRobot
from tests.support.images import image_of
from tests.support.owners import Keys, OwnedRobot
from tests.support.remote_readings import RELEASED_READINGS, remote_readings
from tests.support.robot_on_host import KIT, computer
from tests.support.text_robot import type_text
from tiniscript.link.messages import HOLD_MS
from tiniscript.link.remote import RemoteState, remote_state_of
from tiniscript.link.requests import OK

UNREAD_KEYS_LINE = "// No program reads keys"
DRIVE_PROGRAM = "SI|F(9,50)"
KEY_UP, KEY_A = remote_state_of(["UP"]), remote_state_of(["A"])


def boot(kind: type[HostFirmware] = HostFirmware) -> HostFirmware:
    robot = kind(KIT)
    robot.wait(300)
    return robot


STATE_BY_LINE = (
    ("KEY_UP", KEY_UP), ("KEY_DOWN", remote_state_of(["DOWN"])),
    ("KEY_LEFT", remote_state_of(["LEFT"])),
    ("KEY_RIGHT", remote_state_of(["RIGHT"])), ("KEY_A", KEY_A), ("KEY_B", remote_state_of(["B"])),
    ("key_a", KEY_A), ("  Key_A ;", KEY_A), ("KEY", RemoteState()),
    ("PAD 30 -20", RemoteState(0, 30, -20)),
    ("pad  -100   100", RemoteState(0, -100, 100)), ("PAD 0 0", RemoteState()),
)  # fmt: skip
LINE_ENDS = ("\n", "\r\n", "\r")
EMPTY_LINES = (*LINE_ENDS, " \n", "\t\r\n")  # lines of nothing


@pytest.mark.parametrize("kind", [HostFirmware, SmallRobot])
@pytest.mark.parametrize(("line", "held_state"), STATE_BY_LINE)
def test_a_key_line_holds_its_keys_for_half_a_second(
    line: str, held_state: RemoteState, kind: type[HostFirmware]
) -> None:
    robot = boot(kind)
    type_text(robot, "KEY_LEFT\n")
    assert type_text(robot, line + "\n") == []
    assert robot.remote() == remote_readings(held_state)
    robot.wait(HOLD_MS - 40)
    assert robot.remote() == remote_readings(held_state)
    robot.wait(40)
    assert robot.remote() == RELEASED_READINGS and robot.did == []


@pytest.mark.parametrize("kind", [HostFirmware, SmallRobot])
def test_blanks_and_line_ends_do_not_change_a_key_line(
    kind: type[HostFirmware],
) -> None:
    rng = random.Random(1)
    robot = boot(kind)
    type_text(robot, "KEY_LEFT\n")  # after this line, keys are not mentioned

    def blanks(min_count: int = 0) -> str:
        return "".join(rng.choices(" \t", k=rng.choice((min_count, 1, 2, 30))))

    for _ in range(20):
        for line, held_state in STATE_BY_LINE:
            words = blanks(1).join(line.strip(" ;").split())
            words = "".join(rng.choice((letter.lower(), letter)) for letter in words)
            end = rng.choice(("", ";", " ;")) + blanks() + rng.choice(LINE_ENDS)
            join_before = "".join(rng.choice(EMPTY_LINES) for _ in range(rng.randint(0, 3)))
            text = join_before + blanks() + words + end
            assert type_text(robot, text, 20) == [], repr(text)
            assert robot.remote() == remote_readings(held_state), repr(text)
            robot.wait(HOLD_MS)


@pytest.mark.parametrize("line", [
    "KEY_C", "KEY_", "KEYS", "KEY_AB", "KEY_A B", "KEY A", "PAD", "PAD 1", "PAD 101 0",
    "PAD 0 -101", "PAD 1 2 3", "PAD 300 0", "PAD - 1", "PAD1 2", "PAD 1000000000 0",
    "PAD 0 0 0 0 0 0 0 0",
    "SI|KEY_A", "KEY = 5", "PADX = 3",
])  # fmt: skip
def test_any_other_line_is_read_as_before(line: str) -> None:
    robot = boot()
    type_text(robot, "KEY_A\n")
    type_text(robot, line + "\n")
    robot.wait(HOLD_MS)
    assert robot.remote() == RELEASED_READINGS


def test_unread_keys_are_reported_once() -> None:
    robot = boot()
    assert type_text(robot, "KEY_UP\n", 1500) == [UNREAD_KEYS_LINE]
    assert type_text(robot, "KEY_UP\n" * 3, 1500) == []
    type_text(robot, DRIVE_PROGRAM + "\n", 1500)
    assert type_text(robot, "KEY_UP\n", 1500) == []
    robot.remote()  # simulates a program that reads keys
    assert type_text(robot, "KEY_UP\n", 1500) == []
    type_text(robot, "S\n", 2500)
    assert type_text(robot, "KEY_UP\n", 1500) == [UNREAD_KEYS_LINE]


def test_a_key_repeated_every_300_ms_at_9600_baud_stays_held() -> None:
    robot = boot()
    line = b"KEY_UP\r\n"
    robot.latched_while(20, line, is_spread=True)
    for _ in range(40):
        for _ in range(28):
            robot.wait(10)
            assert robot.remote() == remote_readings(KEY_UP)
        robot.latched_while(20, line, is_spread=True)


def test_key_lines_end_and_start_nothing_and_work_beside_live() -> None:
    for kind in (HostFirmware, SmallRobot):
        robot, session = kind(KIT), computer()
        robot.wait(100)
        assert robot.until(session, session.live(image_of("F(2, 80)").code)) == OK
        robot.talk(session, 100)
        robot.did.clear()
        for _ in range(4):
            session.receive(robot.wait(20, b"KEY_A\n"), robot.now_ms)
            assert robot.remote() == remote_readings(KEY_A), kind
            robot.talk(session, 250)
        assert robot.did == [] and session.is_running


def test_in_an_open_block_a_key_line_belongs_to_the_program() -> None:
    robot = boot()
    assert type_text(robot, "SI|LOOP(2)\nKEY_A\n", 100) != [] or robot.remote() == RELEASED_READINGS
    assert robot.remote() == RELEASED_READINGS


@pytest.mark.parametrize("stop_kind", ["text", "zeros", "button"])
def test_after_a_stop_key_lines_count_as_silence(stop_kind: str) -> None:
    """A person who keeps holding a key can type a program a second later."""
    robot = boot()
    type_text(robot, DRIVE_PROGRAM + "\n", 100)
    assert "MOTORS 50 50" in robot.did[-1]
    if stop_kind == "text":
        type_text(robot, "S\n", 20)
    elif stop_kind == "zeros":
        robot.wait(20, bytes(4))
        robot.wait(1500)  # from here on the robot reads text again
        type_text(robot, "KEY_UP\n", 20)
    else:
        robot.push()
    for _ in range(5):
        type_text(robot, "KEY_UP\n", 290)
    assert robot.is_latched
    robot.did.clear()
    type_text(robot, "SI|F(1,30)\n", 100)
    assert any("MOTORS 30 30" in line for line in robot.did)


def test_a_wrong_line_has_the_same_effect_while_a_key_is_held() -> None:
    """The rest of the program is ignored until a second of silence, and keys count as silence."""
    robot = boot()
    type_text(robot, "SI|FOO\n", 10)
    for _ in range(5):
        type_text(robot, "KEY_UP\n", 290)
    type_text(robot, "F(1,30)\n", 100)
    assert any("MOTORS 30 30" in line for line in robot.did)


def test_text_without_permission_to_drive_presses_no_keys() -> None:
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    table.robot.wait(3000)
    type_text(table.robot, "KEY_A\n", 1500)
    assert table.robot.remote() == RELEASED_READINGS


def test_a_burst_of_a_thousand_key_lines_is_handled() -> None:
    robot = boot()
    robot.wait(10, b"KEY_B\n" * 1000)
    robot.wait(1000)
    type_text(robot, "KEY_A\n", 20)
    assert robot.remote() == remote_readings(KEY_A)
    assert robot.did == []
