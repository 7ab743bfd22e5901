"""The levels of robots that read text: what each lacks, and what fits."""

from __future__ import annotations

import re

import pytest

from tests.support.casefile import ROOT
from tiniscript import compile_text, robots
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.robots.boards import CHIPS
from tiniscript.text.fitting import misfits
from tiniscript.text.levels import CODE_BYTES, LEVELS, Level
from tiniscript.text.memory import KEPT_FREE, NAME_BYTES
from tiniscript.words import WORDS

TINIBOT = robots.load("tinibot").kit
UNO = LEVELS["uno"]


def lacking(text: str, level: Level = UNO) -> list[Diagnostic]:
    found = compile_text(text, TINIBOT)
    assert found.program is not None and found.is_right, found.diagnostics
    return misfits(found.source, found.program, TINIBOT, level)


def told(text: str, level: Level = UNO) -> list[tuple[str, str, dict[str, str]]]:
    """Return the code of each diagnostic, what it points at, and its values without the level."""
    said = []
    for each in lacking(text, level):
        values = dict(each.values)
        assert values.pop("level") == level.name
        said.append((each.code.number, text[slice(*each.span)], values))
    return said


def test_a_level_has_the_memory_of_its_board() -> None:
    assert {name: level.room for name, level in LEVELS.items()} == {
        "uno": CHIPS["uno"].program_bytes,
        "mega": CHIPS["mega"].program_bytes,
        "esp32": CHIPS["esp32dev"].program_bytes,
    }
    assert CHIPS["nano"].program_bytes == UNO.room  # a Nano is of the level uno


def test_the_room_of_an_uno_is_that_of_its_firmware() -> None:
    """`layout.h`: what an image in the EEPROM has beside its header."""
    layout = (ROOT / "vm_arduino" / "src" / "store" / "layout.h").read_text(encoding="utf-8")
    assert "kStoredCodeBytes = kImageBytes - kHeaderBytes" in layout
    port = (ROOT / "vm_arduino" / "src" / "firmware" / "port.cpp").read_text(encoding="utf-8")
    assert re.search(r"port_room\(\) \{ return kStoredCodeBytes; \}", port)


def test_levels_lack_words_of_the_language_alone() -> None:
    for level in LEVELS.values():
        assert level.lacks <= set(WORDS)


def test_a_word_that_a_level_lacks_is_told_at_each_place() -> None:
    small = Level("small", "uno", frozenset(("RANDOM", "DEF", "END_DEF")))
    text = "DEF A; END_DEF; X = random(1, 6); SHOW(X + RANDOM(1, 2)); A // RANDOM"
    assert told(text) == []
    assert told(text, small) == [
        ("TS308", "DEF", {"word": "DEF"}),
        ("TS308", "END_DEF", {"word": "END_DEF"}),
        ("TS308", "random", {"word": "RANDOM"}),
        ("TS308", "RANDOM", {"word": "RANDOM"}),
    ]


def test_code_may_have_255_bytes() -> None:
    fits = "S;" * CODE_BYTES
    assert told(fits) == []
    over = {"code": str(CODE_BYTES + 2), "limit": str(CODE_BYTES), "over": "2"}
    assert told(fits + "SHOW(1)") == [("TS309", "SHOW(1)", over)]


def test_the_first_instruction_that_does_not_fit_is_the_place() -> None:
    text = "LOOP(2);" + "S;" * 250 + "SHOW(1);SHOW(2);END_LOOP"
    assert told(text) == [
        ("TS309", "SHOW(2)", {"code": "259", "limit": "255", "over": "4"})
    ]  # fmt: skip


def test_short_jumps_alone_count() -> None:
    """A jump that is far in `tsc` is not in a robot: what is over is what must go."""
    text = "IF(TRUE);" + "S;" * 300 + "ENDIF"
    assert told(text)[0][2] == {"code": "303", "limit": "255", "over": "48"}


def test_names_take_room_too() -> None:
    long = "".join(f"{chr(65 + k)}{'X' * 39}=0;" for k in range(8))
    used = 8 * (2 + 40 + NAME_BYTES) + KEPT_FREE
    assert used > UNO.room
    values = {"code": str(used), "limit": str(UNO.room), "over": str(used - UNO.room)}
    [(code, place, its)] = told(long)
    assert (code, its) == ("TS310", values)
    assert place == "H"  # where it is full
    assert told(long, LEVELS["mega"]) == []


@pytest.mark.parametrize("text", ["", "PING|CHECK_CONNECTION", "SB|", "SI|F(2, 80)"])
def test_short_programs_fit_each_level(text: str) -> None:
    for level in LEVELS.values():
        assert told(text, level) == []
