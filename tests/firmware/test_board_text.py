"""The firmware as it goes onto an Uno and a Mega reads text: seen from its wire and its pins.

The effects of a line are tested with the whole firmware on this computer: `test_text` and
`test_text_small`.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.machines.uno import skip_unless_available
from tests.support.board_builds import each_board
from tests.support.platformio import copy_sketch, pio
from tests.support.robot_on_uno import (
    BAUD,
    FORWARD,
    NAMES,
    OBSTACLE_LINES,
    OFF,
    computer,
    states,
    switched_on,
)
from tiniscript import robots
from tiniscript.flash import building
from tiniscript.link.messages import TEXT_LEVEL, TEXT_LEVELS
from tools.generate.packed_texts import pack_texts
from tools.generate.remark_tables import rows
from tools.uno import CYCLES_PER_MS, Uno

LINE_MS = 5  # longest time from the end of a line to the pins
STOP_MS = 2  # the same for S
PROGRAM_MS = 10  # the same for the last line of the obstacle program
STOP_CYCLES = 192  # longest time from the last byte of a stop to the pins: 12 us
BYTE_MS = 10_000 / BAUD


def type_and_listen(uno: Uno, text: str, milliseconds: float) -> list[str]:
    """Type a text; return the robot's answer after this many milliseconds."""
    count_before = len(uno.sent_bytes)
    uno.send(text.encode())
    uno.run_ms(milliseconds)
    return bytes(byte.value for byte in uno.sent_bytes[count_before:]).decode().splitlines()


def time_since_line_end_ms(uno: Uno) -> float:
    """Return the time from the end of the last line that came to the last change of a motor."""
    pins = [uno.pins[name].cycle for name in ("left", "right")]
    return (max(pins) - uno.received_bytes[-1].cycle) / CYCLES_PER_MS


@pytest.mark.sampled("sketch_name")
@pytest.mark.parametrize("sketch_name", ["uno", "nano"])
def test_a_program_whose_line_never_ends_runs(
    sketch_name: str, sketches: Callable[[str], Path], memory: Path
) -> None:
    """Also on a Nano; a second time, and only complete ones."""
    with switched_on(sketches(sketch_name), memory) as robot:
        for _ in range(2):
            answers = type_and_listen(robot, "SI|F(1, 60)", 2800)
            assert (states(robot), answers[:-1]) == (OFF, [])
            assert type_and_listen(robot, "", 400)[-1:] == ["// OK"]
            assert states(robot) == FORWARD
            robot.run_ms(1500)
        assert type_and_listen(robot, "SI|F(1", 3500) == ["// End the line with Enter (\\n)"]
        assert states(robot) == OFF


@pytest.mark.sampled("sketch_name")
@pytest.mark.parametrize("sketch_name", ["uno", "nano"])
def test_a_start_discards_a_partial_line(
    sketch_name: str, sketches: Callable[[str], Path], memory: Path
) -> None:
    """It does so only after a module's message, and after a program that never ended."""
    with switched_on(sketches(sketch_name), memory) as robot:
        for message in ("OK+CONN", "OK+CONN", "+CONNECTED:12 ", "OK+LOST\r\nOK+CONN"):
            assert type_and_listen(robot, message + "SI|F(0.5, 60)\r\n", 80) == ["// OK"]
            assert states(robot) == FORWARD
            robot.run_ms(600)
            assert states(robot) == OFF
        assert type_and_listen(robot, "OK+CONN", 1500) == []  # a message alone, and a pause
        assert type_and_listen(robot, "SI|F(0.5, 60)\n", 80) == ["// OK"]
        assert type_and_listen(robot, "SI|LOOP(2)\nSI|F(0.5, 60)\n", 120) == [
            "// Started again",
            "// OK",
        ]
        assert states(robot) == FORWARD
        robot.run_ms(600)
        assert ", kit " in type_and_listen(robot, "OK+CONNPING|CHECK_CONNECTION\n", 120)[0]
        assert type_and_listen(robot, "HELLO SI|F(0.5, 60)\n", 80)[0].startswith("// 1: ")
        assert type_and_listen(robot, "OK+CONN F(0.5, 60)\n", 80) == []
        assert states(robot) == OFF


@each_board
def test_a_line_starts_the_motors_and_s_stops_them(robot: Uno) -> None:
    assert type_and_listen(robot, "SI|F(2,80)\n", 60) == ["// OK"]
    assert states(robot) == FORWARD
    assert 0 < time_since_line_end_ms(robot) <= LINE_MS
    assert type_and_listen(robot, "S\n", 60) == ["// STOPPED"]
    assert states(robot) == OFF
    assert 0 < time_since_line_end_ms(robot) <= STOP_MS
    type_and_listen(robot, "SI|F(2,80)\n", 60)
    assert states(robot) == OFF
    robot.run_ms(1100)
    assert type_and_listen(robot, "F(2,80)\n", 80) == ["// It was stopped. Begin with SI|"]


@each_board
def test_the_obstacle_program_runs_line_by_line(robot: Uno) -> None:
    robot.set_sonar_distance("trigger", "echo", 40)
    *lines, last_line = OBSTACLE_LINES
    for line in lines:
        assert type_and_listen(robot, f"{line}\r\n", 40) == []
    assert states(robot) == OFF
    assert type_and_listen(robot, f"{last_line}\r", 40) == ["// OK"]
    assert states(robot) == FORWARD
    assert 0 < time_since_line_end_ms(robot) <= PROGRAM_MS
    robot.set_sonar_distance("trigger", "echo", 5)
    robot.run_ms(1500)
    assert states(robot)["left forward"] == "high" and states(robot)["right backward"] == "high"


@pytest.mark.sampled("text", keep=2)
@pytest.mark.parametrize("text", ["", "SI|F(2, 80", "LOOP(2); F(1,", "// a comment", "9" * 90])
def test_a_stop_is_as_quick_while_text_is_read(uno: Uno, text: str) -> None:
    type_and_listen(uno, "SI|LOOP(FOREVER);M(80,80);END_LOOP\n", 100)
    assert states(uno) == FORWARD
    uno.send(text.encode() + bytes(4))
    uno.run_ms((len(text) + 4) * BYTE_MS + 20)
    stop = uno.received_bytes[len(uno.received_bytes) - 1]
    assert stop.value == 0
    pins = max(uno.pins[name].cycle for name in ("left", "right"))
    assert states(uno) == OFF
    assert pins - stop.cycle <= STOP_CYCLES


@each_board
def test_a_board_accepts_the_words_of_its_level(board: str, robot: Uno) -> None:
    wired_uno = computer(robot)
    features = wired_uno.complete(wired_uno.session.hello()).features
    assert TEXT_LEVELS[features & TEXT_LEVEL][0] == board.upper()
    robot.run_ms(4000)
    words = " ".join(type_and_listen(robot, "HELP\n", 600)).replace("// ", "").split()
    assert {"F", "LOOP", "END_LOOP", "ROUND", "UNTIL", "DISTANCE"} <= {*words}
    assert bool({"DEF", "END_DEF", "ENDDEF", "TASK"} & {*words}) == (board == "mega")
    answers = type_and_listen(robot, "SI|SHOW(12.5);F(0.1,50)\n", 300)
    assert answers == ["// OK", "// 12.5", "// DONE"]


@pytest.mark.parametrize("board", ["mega"])
def test_a_wrong_line_does_not_end_a_program_on_boards_with_room_for_both(robot: Uno) -> None:
    assert type_and_listen(
        robot, "SI|LOOP(FOREVER)\r\nM(50,50)\r\nW(0.1)\r\nEND_LOOP\r\n", 200
    ) == ["// OK"]
    assert type_and_listen(robot, "SI|R(1,500)\r\n", 100) == ["// 500: 0 to 100"]
    assert states(robot) == FORWARD


def test_an_uno_contains_only_the_texts_that_it_can_print(sketch: Path) -> None:
    """The reasons of a DEF, other levels and discs take no flash."""
    firmware = sketch.read_bytes()
    assert pack_texts(rows("en", is_small=True)).texts in firmware
    assert pack_texts(rows("en")).texts not in firmware


@pytest.mark.sampled(of="long ways of a chip")
def test_a_profile_in_spanish_makes_a_robot_that_answers_in_spanish(tmp_path: Path) -> None:
    """Built by `tsc firmware`. The other language takes no flash."""
    skip_unless_available()
    project = copy_sketch(tmp_path)
    for language, answer, other_language in (
        ("es", "500: 0 a 100", "en"),
        ("en", "500: 0 to 100", "es"),
    ):
        robot = robots.load("tinibot", "mega").with_language(language)
        (project / building.HEADER_FILE).write_text(building.header(robot), encoding="utf-8")
        pio(project, "run", "-e", "mega").gives(0)
        elf = project / ".pio" / "build" / "mega" / "firmware.elf"
        for language_code in (language, other_language):
            assert (pack_texts(rows(language_code)).texts in elf.read_bytes()) == (
                language_code == language
            )
        with Uno(elf, names=NAMES, board="mega", baud=BAUD, resets_on_open=False) as mega:
            mega.run_ms(300)
            assert type_and_listen(mega, "SI|R(1, 500)\n", 100) == [f"// {answer}"]
