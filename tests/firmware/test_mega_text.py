"""The firmware as it goes onto a Mega, which reads text: seen from its wire and its pins."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.firmware.test_uno_robot import BAUD, FORWARD, NAMES, OFF, states
from tests.machines.uno import needed
from tests.support.platformio import firmware, shared
from tools.uno import CYCLES_PER_MS, Uno

LINE_MS = 5  # from the end of a line to the pins, at most
STOP_MS = 2  # the same for S


@pytest.fixture(scope="session")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needed()
    return firmware("mega", tmp_path_factory.mktemp("sketch"), shared(tmp_path_factory))


@pytest.fixture
def mega(sketch: Path, tmp_path: Path) -> Iterator[Uno]:
    memory = tmp_path / "eeprom"
    with Uno(
        sketch, names=NAMES, board="mega", eeprom=memory, baud=BAUD, resets_on_open=False
    ) as found:
        found.run_ms(300)
        assert states(found) == OFF
        yield found


def typed(mega: Uno, text: str, milliseconds: float) -> list[str]:
    """Type a text; return what the robot has answered after so many milliseconds."""
    before = len(mega.sent)
    mega.send(text.encode())
    mega.run_ms(milliseconds)
    return bytes(byte.value for byte in mega.sent[before:]).decode().splitlines()


def since_the_line_end_ms(mega: Uno) -> float:
    """Return the time from the end of the last line that came to the last change of a motor."""
    pins = [mega.pins[name].cycle for name in ("left", "right")]
    return (max(pins) - mega.received[-1].cycle) / CYCLES_PER_MS


def test_a_line_turns_the_motors_and_s_stops_them(mega: Uno) -> None:
    assert typed(mega, "SI|F(2,80)\n", 60) == ["// OK"]
    assert states(mega) == FORWARD
    assert 0 < since_the_line_end_ms(mega) <= LINE_MS
    assert typed(mega, "S\n", 60) == ["// STOPPED"]
    assert states(mega) == OFF
    assert 0 < since_the_line_end_ms(mega) <= STOP_MS
    typed(mega, "SI|F(2,80)\n", 60)
    assert states(mega) == OFF


def test_a_wrong_line_leaves_what_runs(mega: Uno) -> None:
    assert typed(mega, "SI|LOOP(FOREVER)\r\nM(50,50)\r\nW(0.1)\r\nEND_LOOP\r\n", 200) == ["// OK"]
    assert typed(mega, "SI|R(1,500)\r\n", 100) == ["// 8: Too small or too large"]
    assert states(mega) == FORWARD


def test_its_words_and_its_end(mega: Uno) -> None:
    assert typed(mega, "SI|SHOW(12.5);F(0.1,50)\n", 300) == ["// OK", "// 12.5", "// DONE"]
    words = " ".join(typed(mega, "HELP\n", 600)).replace("// ", "").split()
    assert {"F", "LOOP", "END_LOOP", "DISTANCE"} <= {*words}
