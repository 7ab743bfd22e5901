"""The firmware as it goes onto an Uno reads text: seen from its wire and its pins."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.firmware.test_mega_text import since_the_line_end_ms, typed
from tests.firmware.test_uno_robot import BAUD, FORWARD, NAMES, OFF, computer, image_of, states
from tests.machines.uno import needed
from tests.support.casefile import ROOT, read
from tests.support.platformio import firmware, shared
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

# The same promises are kept by the whole firmware on this computer, on every commit.
pytestmark = pytest.mark.sampled(of="programs, texts and UNDO on a simulated Uno", keep=14)

LINE_MS = 5  # from the end of a line to the pins, at most
PROGRAM_MS = 10  # the same for the last line of the obstacle program
STOP_CYCLES = 192  # from the last byte of a stop to the pins: 12 us
OBSTACLE = (
    "SI|LOOP(FOREVER);", "  F(1, 80);", "  DISTANCE;", "  IF(DISTANCE < 10);", "    STOP;",
    "    R(1, 60);", "  ENDIF;", "END_LOOP;",
)  # fmt: skip
BYTE_MS = 10_000 / BAUD


@pytest.fixture(scope="session")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needed()
    return firmware("uno", tmp_path_factory.mktemp("sketch"), shared(tmp_path_factory))


@pytest.fixture
def uno(sketch: Path, tmp_path: Path) -> Iterator[Uno]:
    memory = tmp_path / "eeprom"
    with Uno(sketch, names=NAMES, eeprom=memory, baud=BAUD, resets_on_open=False) as found:
        found.run_ms(300)
        assert states(found) == OFF
        yield found


def test_a_line_turns_the_motors_and_s_stops_them(uno: Uno) -> None:
    assert typed(uno, "SI|F(2,80)\n", 60) == ["// OK"]
    assert states(uno) == FORWARD
    assert 0 < since_the_line_end_ms(uno) <= LINE_MS
    assert typed(uno, "S\n", 60) == ["// STOPPED"]
    assert states(uno) == OFF
    typed(uno, "SI|F(2,80)\n", 60)
    assert states(uno) == OFF
    uno.run_ms(1100)
    assert typed(uno, "F(2,80)\n", 80) == ["// It was stopped. Begin with SI|"]
    assert typed(uno, "SI|F(0.1,80)\n", 300) == ["// OK", "// DONE"]


def test_the_obstacle_program_in_lines(uno: Uno) -> None:
    uno.sonar("trigger", "echo", 40)
    *lines, last = OBSTACLE
    for line in lines:
        assert typed(uno, f"{line}\r\n", 40) == []
    assert states(uno) == OFF
    assert typed(uno, f"{last}\r", 40) == ["// OK"]
    assert states(uno) == FORWARD
    assert 0 < since_the_line_end_ms(uno) <= PROGRAM_MS
    uno.sonar("trigger", "echo", 5)
    uno.run_ms(1500)
    assert states(uno)["left forward"] == "high" and states(uno)["right backward"] == "high"


@pytest.mark.parametrize("text", ["", "SI|F(2, 80", "LOOP(2); F(1,", "// a comment", "9" * 90])
def test_a_stop_is_as_quick_while_text_is_read(uno: Uno, text: str) -> None:
    typed(uno, "SI|LOOP(FOREVER);M(80,80);END_LOOP\n", 100)
    assert states(uno) == FORWARD
    uno.send(text.encode() + bytes(4))
    uno.run_ms((len(text) + 4) * BYTE_MS + 20)
    stop = uno.received[len(uno.received) - 1]
    assert stop.value == 0
    pins = max(uno.pins[name].cycle for name in ("left", "right"))
    assert states(uno) == OFF
    assert pins - stop.cycle <= STOP_CYCLES


def test_a_program_that_is_lost_and_one_that_comes_back(uno: Uno) -> None:
    wired = computer(uno)
    assert wired.until(wired.session.upload(image_of("SB|B(1, 60)"), runs=False)) == OK
    wired.run(2500)  # it is saved
    assert wired.until(wired.session.upload(image_of("SB|B(2, 60)"), saves=False)) == OK
    uno.run_ms(4000)
    assert typed(uno, "SI|F(0.1,80)\n", 400) == ["// OK. The old program is lost.", "// DONE"]
    assert typed(uno, "SI|F(0.1,80)\n", 400) == ["// OK", "// DONE"]
    uno.press("button")
    uno.run_ms(200)
    assert states(uno)["left backward"] == "high"


def test_its_words_are_those_of_its_level(uno: Uno) -> None:
    words = " ".join(typed(uno, "HELP\n", 600)).replace("// ", "").split()
    assert {"F", "LOOP", "END_LOOP", "ROUND", "UNTIL", "DISTANCE"} <= {*words}
    assert not {"DEF", "END_DEF", "ENDDEF", "TASK"} & {*words}
    assert typed(uno, "DEF A\n", 100) == ["// 1: This robot cannot read it"]
    assert typed(uno, "END_DEF\n", 100) == ["// 1: First open a block"]


def test_the_programs_of_the_paper(uno: Uno) -> None:
    """Each is read to its end, and runs or waits for the button."""
    programs = [case.parts["tiniscript"] for case in read(ROOT / "tests" / "cases" / "paper.md")]
    assert len(programs) > 10
    for program in programs:
        text = program.rstrip("\n") + "\n"
        answers = typed(uno, text, len(text) * BYTE_MS + 1200)
        assert answers[0].startswith("// OK") or ", kit " in answers[0], (text, answers)
        typed(uno, "SI|W(0)\n", 200)  # whatever runs has ended, and nothing is latched


# What waits behind an answer is read where the image of LIVE is made before its frame has ended.
# The bytes of this number are instructions: an `X` in front of them, as S, makes a move of them.
DRIVES = "SI|SHOW(-1337933.387)"


@pytest.mark.parametrize("text", ["X\0", "s\0", "A\n\0"])
def test_text_that_waits_changes_no_line_of_live(uno: Uno, text: str) -> None:
    wired = computer(uno)
    assert wired.until(wired.session.hello()) == OK
    for frame_ms in (22, 23, 24, 25):
        wired.run(50)
        wired.session.events()
        request = wired.session.live(image_of(DRIVES).code)
        begin = uno.cycle + CYCLES_PER_MS
        uno.send(b"SB|\nSB|\n" + text.encode(), at=begin)
        uno.send(wired.session.poll(wired.now_ms), at=begin + frame_ms * CYCLES_PER_MS)
        assert wired.until(request) == OK
        wired.run(80)
        assert states(uno) == OFF
        shown = [event.value for event in wired.session.events() if event.name == "SHOW"]
        assert shown == [-1337933387]
