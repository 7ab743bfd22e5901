"""The firmware as it goes onto a Mega, which reads text: seen from its wire and its pins."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.firmware.test_uno_robot import BAUD, FORWARD, NAMES, OFF, states
from tests.machines.uno import needed
from tests.machines.wired import Wired
from tests.support.platformio import copied, firmware, pio, shared
from tiniscript import robots
from tiniscript.flash import building
from tiniscript.link.messages import TEXT_LEVEL, TEXT_LEVELS
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tools.generate.packed_texts import packed
from tools.generate.remark_tables import rows
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
    assert typed(mega, "SI|R(1,500)\r\n", 100) == ["// 500: 0 to 100"]
    assert states(mega) == FORWARD


def test_its_hello_tells_its_level(mega: Uno) -> None:
    wired = Wired(mega, Session(1, BAUD))
    request = wired.session.hello()
    assert wired.until(request) == OK
    assert wired.session.robot is not None
    features = wired.session.robot.values.features
    assert TEXT_LEVELS[features & TEXT_LEVEL][0] == "MEGA"


def in_flash(elf: Path, language: str) -> bool:
    """Whether a firmware has the answers of a language."""
    return packed(rows(language)).texts in elf.read_bytes()


@pytest.mark.sampled(of="long ways of a chip")
def test_a_profile_in_spanish_makes_a_robot_that_answers_in_spanish(tmp_path: Path) -> None:
    """As `tsc firmware` makes it. The other language takes no flash."""
    needed()
    project = copied(tmp_path)
    for language, answer, other in (
        ("es", "500: 0 a 100", "en"),
        ("en", "500: 0 to 100", "es"),
    ):
        robot = robots.load("tinibot", "mega").speaking(language)
        (project / building.HEADER).write_text(building.header(robot), encoding="utf-8")
        code, log = pio(project, "run", "-e", "mega")
        assert code == 0, log
        elf = project / ".pio" / "build" / "mega" / "firmware.elf"
        assert in_flash(elf, language) and not in_flash(elf, other)
        with Uno(elf, names=NAMES, board="mega", baud=BAUD, resets_on_open=False) as mega:
            mega.run_ms(300)
            assert typed(mega, "SI|R(1, 500)\n", 100) == [f"// {answer}"]


def test_its_words_and_its_end(mega: Uno) -> None:
    assert typed(mega, "SI|SHOW(12.5);F(0.1,50)\n", 300) == ["// OK", "// 12.5", "// DONE"]
    words = " ".join(typed(mega, "HELP\n", 600)).replace("// ", "").split()
    assert {"F", "LOOP", "END_LOOP", "DISTANCE"} <= {*words}
