"""How much text a robot takes, in which pieces, and that no part of a program is run alone."""

from __future__ import annotations

import pytest

from tests.firmware.test_host_firmware import KIT, computer, happened, switched_on
from tests.firmware.test_text import LINE, done_after, holding, typed
from tests.machines.host_firmware import EMPTY, HostFirmware
from tests.support.command import OBSTACLE
from tiniscript.base.kit import NUMBER, Device, Kit
from tiniscript.link.requests import OK

LINE_LETTERS = 63  # of an answer, without its end

CODE_BYTES = 255

# -- limits ---------------------------------------------------------------------------------------


def test_a_program_of_255_bytes_and_one_more() -> None:
    robot = switched_on()
    text = "SI|F(0.1,50)" + ";S" * (CODE_BYTES - 4)
    assert typed(robot, text + "\n", 300) == ["// OK", "// DONE"]
    robot.did.clear()
    (answer,) = typed(robot, text + ";S\n", 1100)
    assert answer == "// 255: Too long. Make it shorter"
    assert robot.did == []
    assert done_after(robot, "F(0.2,50)\n") == LINE


def test_many_long_names_until_it_is_full() -> None:
    robot = switched_on()
    names = [f"NAME{chr(65 + k)}" + "X" * 40 for k in range(26)]
    answers = []
    for count in range(1, 12):
        text = "SI|" + "".join(f"{name}=0;" for name in names[:count]) + "SHOW(1)\n"
        answers.append(typed(robot, text, 1100))
    fits = [each == ["// OK", "// 1", "// DONE"] for each in answers]
    assert fits == sorted(fits, reverse=True) and True in fits and False in fits
    assert {len(each) for each in answers if each[0] != "// OK"} == {1}
    assert done_after(robot, "F(0.2,50)\n") == LINE


@pytest.mark.parametrize("what", ["F(1,50);", "A", " ", "(", "9", "\x01", "~", "é", "/", "SI|"])
def test_a_line_of_10000_bytes(what: str) -> None:
    robot = switched_on()
    data = (what * 10_000).encode()[:10_000]
    for at in range(0, len(data), 20):  # as many as there are turns
        robot.step(data[at : at + 20])
    robot.step(b"\n")
    assert robot.did == []
    robot.wait(1100)
    assert typed(robot, "SI|F(0.2,50)\n", 400) == ["// OK", "// DONE"]


@pytest.mark.parametrize("letters", [1, 24, 25, 59, 60, 61, 255, 1000])
def test_help_with_a_device_of_a_long_name(letters: int) -> None:
    """An answer is never longer than a line; a word that is longer is cut."""
    distance = Device("DISTANCE", NUMBER, "cm", 0, 400_000)
    kit = Kit((distance, Device("A" * letters, NUMBER, "", 0, 1)), ())
    robot = HostFirmware(kit, EMPTY)
    robot.wait(200)
    answers = typed(robot, "HELP\n", 2000)
    assert max(map(len, answers)) <= LINE_LETTERS
    words = [word for answer in answers for word in answer.removeprefix("// ").split()]
    assert words[-2:] == ["DISTANCE", "A" * min(letters, LINE_LETTERS - len("// "))]


def test_a_name_cannot_end_its_line() -> None:
    """Else an echo of it would be a program."""
    robot, session = switched_on(), computer()
    robot.until(session, session.hello())
    robot.until(session, session.name(b"\r\nS;\x1b[2J\xc3\xb1\x00\x7f"))
    robot.wait(4000)
    (answer,) = typed(robot, "PING|CHECK_CONNECTION\n")
    assert answer.encode("latin-1").startswith(b"// ??S;?[2J\xc3\xb1??, kit ")


@pytest.mark.parametrize("seed", range(4))
def test_a_robot_without_a_name_says_its_number(seed: int) -> None:
    robot, session = HostFirmware(KIT, EMPTY, seed=0x9F0FFE8D + seed), computer()
    robot.wait(200)
    robot.until(session, session.hello())
    assert session.robot and not session.robot.name
    robot.wait(4000)
    (answer,) = typed(robot, "PING|CHECK_CONNECTION\n")
    assert answer.startswith(f"// {session.robot.id:08x}, kit {KIT.fingerprint:04x}, ")


@pytest.mark.parametrize("end", ["\n", "\r", "\r\n"])
def test_the_obstacle_program_in_lines(end: str) -> None:
    robot = switched_on()
    lines = ["SI|LOOP(FOREVER);", "  F(1, 80);", "  DISTANCE;", "  IF(DISTANCE < 10);",
             "    STOP;", "    R(1, 60);", "  ENDIF;", "END_LOOP"]  # fmt: skip
    robot.sense(0, 0, 50_000)
    assert typed(robot, end.join(lines) + end) == ["// OK"]
    robot.wait(2500)
    robot.sense(0, 0, 9_000)
    robot.wait(1000)
    assert happened(robot)[-1] == "MOTORS 60 -60"
    assert typed(robot, OBSTACLE.rstrip("\n").replace("\n", end) + end)[-1] == "// OK"


def test_text_at_once_after_power_on() -> None:
    robot = HostFirmware(KIT, holding()[0].memory())
    robot.step(b"SI|F(0.2,50)\n", flags=16, ticks=0)
    assert robot.step(ticks=3) == b"// Still saving. Send it again.\r\n"
    robot.wait(300)
    assert done_after(robot, "SI|F(0.2,50)\n") == LINE
    (hello,) = typed(HostFirmware(KIT, EMPTY), "PING|CHECK_CONNECTION\n")
    assert hello.endswith(", text uno")


# -- what must not be run in parts ----------------------------------------------------------------


@pytest.mark.parametrize("between", ["zero", "frame", "button", "two tabs"])
def test_the_rest_of_a_program_that_was_lost_is_not_run(between: str) -> None:
    """Its lines are whole ones, and mean something else alone."""
    robot, session = switched_on(), computer()
    typed(robot, "SI|LOOP(2)\n")
    if between == "zero":
        typed(robot, b"R(0.1,\0")
    elif between == "frame":
        assert robot.until(session, session.clear()) == OK
    elif between == "button":
        robot.step(flags=2)
        robot.push()
    else:
        typed(robot, "BAD\n")
    typed(robot, "F(0.2,50)\nF(0.2,50)\n", 400)
    typed(robot, "END_LOOP\n", 400)
    assert robot.did == []
    robot.wait(1100)
    assert done_after(robot, "SI|F(0.2,50)\n") == LINE


@pytest.mark.parametrize("blanks", ["\t\t", "\t", "  ", "\t \t"])
def test_a_line_of_a_program_may_come_late_and_indented(blanks: str) -> None:
    robot = switched_on()
    typed(robot, "SI|LOOP(2)\n", 1500)
    typed(robot, f"{blanks}F(0.2,50)\n", 1500)
    assert typed(robot, "END_LOOP\n", 700) == ["// OK", "// DONE"]
    assert happened(robot) == LINE[:2] * 2 + LINE[2:]


@pytest.mark.parametrize(
    ("text", "awaited"),
    [
        ("LOOP(2)\n", "END_LOOP"), ("LOOP(FOREVER)\n", "END_LOOP"), ("IF(TRUE)\n", "ENDIF"),
        ("IF(TRUE);ELSE\n", "ENDIF"), ("WHILE(TRUE)\n", "END_WHILE"), ("DEF A\n", "END_DEF"),
        ("X=(1\n", ")"), ("LOOP(2)\nX=1+", "END_LOOP"), ("LOOP(2)\nX=-", "END_LOOP"),
        ("IF(TRUE)\nX=TRUE AND NOT ", "ENDIF"), ("IF(TRUE)\nX=MIN(1,", "ENDIF"),
        ("DEF A\nF(1,", "END_DEF"),
    ],
)  # fmt: skip
def test_what_an_open_block_waits_for_is_told(text: str, awaited: str) -> None:
    """Also in the middle of a line: what the reader keeps of that is no block."""
    assert typed(switched_on(), text, 1100) == [f"// Waiting for {awaited}"]
