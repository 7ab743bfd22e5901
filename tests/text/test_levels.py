"""The levels of robots that read text: their limits, and programs that fit."""

from __future__ import annotations

import random
import re

import pytest

from tests.oracle import programs
from tests.support.casefile import ROOT
from tests.support.kits import KITS
from tiniscript import compile_text, robots
from tiniscript.base.words import SECONDS, WORDS, Role, Word
from tiniscript.codegen.text.line import plain_code
from tiniscript.codegen.text.memory import Reader
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.library.text_fitting import find_misfits
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.text_levels import CODE_BYTES, LEVELS, UNREAD_WORDS, Level
from tiniscript.syntax.lexer import scan
from tools.generate import text_tables

TINIBOT = robots.load("tinibot").kit
UNO = LEVELS["uno"]


def find_unsupported(text: str, level: Level = UNO) -> list[Diagnostic]:
    compilation = compile_text(text, TINIBOT)
    assert compilation.program is not None and compilation.is_right, compilation.diagnostics
    return find_misfits(compilation.source, compilation.program, TINIBOT, level)


def problems_of(text: str, level: Level = UNO) -> list[tuple[str, str, dict[str, str]]]:
    """Return the code of each diagnostic, the text that it points at, and its values without the
    level."""
    problems = []
    for diagnostic in find_unsupported(text, level):
        values = dict(diagnostic.values)
        assert values.pop("level") == level.name
        problems.append((diagnostic.code.number, text[slice(*diagnostic.span)], values))
    return problems


def test_a_level_has_the_memory_of_its_board() -> None:
    assert {name: level.room for name, level in LEVELS.items()} == {
        "uno": CHIPS["uno"].program_bytes,
        "mega": CHIPS["mega"].program_bytes,
        "esp32": CHIPS["esp32dev"].program_bytes,
    }
    assert CHIPS["nano"].program_bytes == UNO.room  # a Nano is of the level uno


def test_the_room_of_an_uno_is_that_of_its_firmware() -> None:
    """In `layout.h`, this is the size of an image in the EEPROM without its header."""
    layout = (ROOT / "vm_arduino" / "src" / "store" / "layout.h").read_text(encoding="utf-8")
    assert "kStoredCodeBytes = kImageBytes - kHeaderBytes" in layout
    port = (ROOT / "vm_arduino" / "src" / "firmware" / "port.cpp").read_text(encoding="utf-8")
    assert re.search(r"port_room\(\) \{ return kStoredCodeBytes; \}", port)


def test_levels_lack_only_words_of_the_language() -> None:
    for level in LEVELS.values():
        assert level.lacks <= set(WORDS)


def test_a_word_missing_in_a_level_is_reported_at_each_place() -> None:
    small = Level("small", "uno", 2, frozenset(("RANDOM", "DEF", "END_DEF")))
    text = "DEF A; END_DEF; X = random(1, 6); SHOW(X + RANDOM(1, 2)); A // RANDOM"
    assert problems_of(text, LEVELS["mega"]) == []
    assert problems_of(text, small) == [
        ("TS308", "DEF", {"word": "DEF"}),
        ("TS308", "random", {"word": "RANDOM"}),
        ("TS308", "RANDOM", {"word": "RANDOM"}),
    ]


def test_an_uno_lacks_tasks_and_ways() -> None:
    """Therefore such programs are sent compiled."""
    text = "TASK; S; ENDTASK; when(TRUE); F(FOREVER, 60); R(9 DEG, 60); F(9cm, 60); END_WHEN"
    words = ("TASK", "when", "DEG", "cm")  # no ends beside them
    assert problems_of(text) == [("TS308", word, {"word": word.upper()}) for word in words]
    for level in ("mega", "esp32"):
        assert problems_of(text, LEVELS[level]) == []


VALUES = "DEF A(X); SHOW(X); END_DEF; DEF C; A({}); END_DEF; {}"


@pytest.mark.parametrize("level", ["mega", "esp32"])
def test_a_reader_accepts_only_supported_values_of_defs(level: str) -> None:
    both = "TASK; C; END_TASK; C; A({})"
    values = {"name": "A"}
    assert problems_of(VALUES.format(1, "C; A(2); TASK; S; END_TASK"), LEVELS[level]) == []
    assert problems_of(VALUES.format(1, "C; A(2)"), UNO) == [
        ("TS308", word, {"word": word}) for word in ("DEF",) * 2
    ]
    several, yes_no = {**values, "count": "2"}, {**values, "yes_no": "X"}
    assert problems_of(VALUES.format(1, both.format(2)), LEVELS[level]) == [
        ("TS318", "DEF", several)
    ]
    assert problems_of(VALUES.format("TRUE", "C"), LEVELS[level]) == [("TS318", "DEF", yes_no)]
    text = VALUES.format("X1 > 2", both.format("TRUE")).replace("DEF", "X1 = 1; DEF", 1)
    assert problems_of(text, LEVELS[level]) == [
        ("TS318", "DEF", yes_no),
        ("TS318", "DEF", several),
    ]


def test_code_may_have_255_bytes() -> None:
    fits = "S;" * CODE_BYTES
    assert problems_of(fits) == []
    over = {"code": str(CODE_BYTES + 2), "limit": str(CODE_BYTES), "over": "2"}
    assert problems_of(fits + "SHOW(1)") == [("TS309", "SHOW(1)", over)]


def test_the_first_instruction_that_does_not_fit_is_the_place() -> None:
    text = "LOOP(2);" + "S;" * 250 + "SHOW(1);SHOW(2);END_LOOP"
    assert problems_of(text) == [
        ("TS309", "SHOW(2)", {"code": "259", "limit": "255", "over": "4"})
    ]  # fmt: skip


def test_only_short_jumps_count() -> None:
    """A far jump of `tsc` is short in a robot: only the excess must be removed."""
    text = "IF(TRUE);" + "S;" * 300 + "ENDIF"
    assert problems_of(text)[0][2] == {"code": "303", "limit": "255", "over": "48"}


def most_bytes(text: str, level: Level = UNO) -> int:
    """Return the bytes that a reader needs for a text."""
    reader = Reader(scan(text).tokens, TINIBOT, level.sensor_bytes)
    reader.program()
    return reader.most_bytes


@pytest.mark.parametrize(
    ("text", "bytes_"),
    [
        ("", 0),
        ("S", 1),  # a letter of a word lies in the code's place
        ("STOP", 4),
        ("S;STOP", 5),
        # a value's own byte, and one byte of code after it
        ("W(5)", 2),
        ("F(5, 5)", 3),  # code, the second value, code
        ("W(((5)))", 4),
        ("W(-(-(5)))", 6),
        ("X=5", 4),  # the letter twice, then the name and its byte
        ("X=5;Y=5", 8),
        ("LONG=5", 9),
        # blocks: 9 bytes each, and the code before and in them
        ("IF(TRUE);ENDIF", 12 + 5),
        ("IF(TRUE);S;ENDIF;IF(TRUE);S;ENDIF", 8 + 9 + 5),
        ("LOOP(2);S;END_LOOP", 4 + 9 + 8),
        ("DEF AB;END_DEF", 2 + 11 + 9 + 7),
        ("DEF AB(XY);END_DEF", 2 + 11 + 9 + 3 + 7),
        ("SHOW(TRUE AND TRUE)", 3 + 3 + 4),
        ("TASK;END_TASK", 3 + 9 + 8),
        ("WHEN(TRUE);END_WHEN", 5 + 9 + 8),
        ("F(1 DEG,5)", 1 + 1 + 3),  # a word lies after the code
        ("F(1°,5)", 4),
    ],
)
def test_the_memory_needed_by_a_reader_is_known(text: str, bytes_: int) -> None:
    assert most_bytes(text) == bytes_


def test_sensor_sets_are_wider_on_boards_with_more_sensors() -> None:
    assert most_bytes("LOOP(2);END_LOOP", LEVELS["mega"]) == most_bytes("LOOP(2);END_LOOP") + 3 * 2
    assert most_bytes("DEF A;END_DEF", LEVELS["mega"]) == most_bytes("DEF A;END_DEF") + 4 * 2


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, 2000, 500))
def test_the_reader_and_the_compiler_count_the_same_code(first: int) -> None:
    for seed in range(first, first + 500):
        oracle_kit, kit = KITS[seed % len(KITS)]
        compilation = compile_text(programs.program(random.Random(seed), oracle_kit), kit)
        tokens = scan(compilation.source.text).tokens
        if UNREAD_WORDS & {token.text for token in tokens}:
            continue
        reader = Reader(tokens, kit, 2)
        reader.program()
        assert compilation.program is not None
        assert reader.code_bytes == plain_code(compilation.program).short_length, (
            compilation.source.text
        )
        value_names = (
            name for procedure in compilation.program.procedures for name in procedure.values
        )
        names = [*reader.variables, *(name + 8 * "?" for name in reader.defs)]
        names += (compilation.program.variables[k] for k in value_names)
        assert reader.used_bytes == sum(1 + len(name) for name in names), compilation.source.text


@pytest.mark.parametrize("end", ["ENDIF", "ELSE;DISTANCE;ENDIF"])
def test_sensors_read_on_every_branch_are_not_read_again(end: str) -> None:
    compilation = compile_text(f"IF(TRUE);DISTANCE;{end};SHOW(DISTANCE)", TINIBOT)
    assert compilation.program is not None
    reader = Reader(scan(compilation.source.text).tokens, TINIBOT, 2)
    reader.program()
    assert reader.code_bytes == plain_code(compilation.program).short_length


def test_names_also_take_room() -> None:
    long = "".join(f"{chr(65 + k)}{'X' * 49}=0;" for k in range(7))
    bytes_before = 6 * (2 + 51)
    needed = bytes_before + 2 * 50 + 1
    values = {"code": str(needed), "limit": str(UNO.room), "over": str(needed - UNO.room)}
    # At the place where the memory is full.
    assert problems_of(long) == [("TS310", "G" + "X" * 49, values)]
    assert problems_of(long, LEVELS["mega"]) == []
    assert problems_of(long[: -len("X=0;") - (needed - UNO.room) // 2 - 1] + "=0;") == []


def test_a_word_has_at_most_255_letters() -> None:
    fits, over = "X" * 255 + "=0", "X" * 256 + "=0"
    for level in (LEVELS["mega"], LEVELS["esp32"]):
        assert problems_of(fits, level) == []
        assert problems_of(over, level) == [("TS308", "X" * 256, {"word": "X" * 256})]


def test_at_most_254_brackets_are_open_at_once() -> None:
    fits = f"X=0;SHOW({'(' * 253}X{')' * 253})"
    assert problems_of(fits) == []
    over = f"X=0;SHOW({'(' * 254}X{')' * 254})"
    assert problems_of(over) == [("TS311", "(", {"limit": "254"})]


@pytest.mark.parametrize("text", ["", "PING|CHECK_CONNECTION", "SB|", "SI|F(2, 80)"])
def test_short_programs_fit_each_level(text: str) -> None:
    for level in LEVELS.values():
        assert problems_of(text, level) == []


def test_a_word_unknown_to_all_levels_is_reserved_only_for_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is not a command of the reader, but a word of later versions."""
    monkeypatch.setattr(text_tables, "UNREAD_WORDS", UNREAD_WORDS | {"BEEP"})
    words = text_tables.words_in_order()
    assert words.index(WORDS["BEEP"]) > words.index(WORDS["SI"])
    packed_text, rows, _ = text_tables.words_tables("a test").split("tini_progmem = {")[1:]
    assert "// BEEP" in packed_text and "// BEEP" not in rows and "// SHOW" in rows
    letters_before = sum(len(word.text) for word in words[: words.index(WORDS["BEEP"])])
    assert text_tables.bytes_before("later") == letters_before


def test_missing_reader_entries_for_a_new_word_are_reported() -> None:
    with pytest.raises(
        LookupError,
        match=r"READ_ROLES in robots/text_levels\.py.*ROLES of tools/generate/text_tables\.py",
    ):
        text_tables.role_of(Word("HONK", Role("honk"), (SECONDS,)))
    with pytest.raises(LookupError, match=r"OPCODES in tools/generate/text_tables\.py"):
        text_tables.opcode_of(Word("HONK", Role("beep"), (SECONDS,)))
