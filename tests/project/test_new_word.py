"""A word that stands for others is a row of `words.py`: every stage takes it from there."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, get_args

import pytest

import tiniscript
from tests.oracle.interpreter import run as run_by_reference
from tests.oracle.words import FIXED_WORDS
from tests.support.casefile import ROOT
from tests.support.new_word import DANCE, HORN, SHAKE, WIGGLE, WORD_TEXTS, with_texts
from tests.support.rows import each_row
from tests.support.text_lines import check_line
from tiniscript import compile_text, robots
from tiniscript.base import languages
from tiniscript.base.source import Source
from tiniscript.base.words import ROLES, WORDS, Role
from tiniscript.bytecode.opcodes import BY_NAME
from tiniscript.codegen import lower
from tiniscript.codegen.sketch import statements
from tiniscript.codegen.sketch.helpers import HELPERS
from tiniscript.codegen.sketch.writing import sketch_of
from tiniscript.codegen.text.line import line_of
from tiniscript.diagnostics import codes
from tiniscript.library.text_fitting import find_misfits
from tiniscript.robots.kit_words import pack_range
from tiniscript.robots.text_levels import LEVELS, Level
from tiniscript.semantics import ir
from tiniscript.semantics.checker import _STATEMENT_MAKERS
from tiniscript.studio.block_printing import format_blocks
from tiniscript.studio.block_reading import read_blocks
from tiniscript.studio.description import description
from tiniscript.syntax.formatter import format_source
from tools.generate import paper, poster, text_tables
from tools.generate.documents import language_document
from tools.generate.paper import Line

ROBOT = robots.load("tinibot")
KIT = ROBOT.kit
PROGRAM = "SI|LOOP(2);\n  HORN;\n  W(1);\nEND_LOOP;\n"
EXPANDED_PROGRAM = PROGRAM.replace(HORN.text, HORN.expansion)


@pytest.fixture(autouse=True)
def _new_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(WORDS, HORN.text, HORN)
    monkeypatch.setitem(FIXED_WORDS, HORN.text, ((), HORN.expansion))
    monkeypatch.setitem(WORDS, WIGGLE.text, WIGGLE)
    monkeypatch.setitem(FIXED_WORDS, WIGGLE.text, (("N",), WIGGLE.expansion))
    monkeypatch.setitem(WORDS, DANCE.text, DANCE)
    monkeypatch.setitem(FIXED_WORDS, DANCE.text, (("SECONDS", "N"), DANCE.expansion))
    monkeypatch.setitem(WORDS, SHAKE.text, SHAKE)
    monkeypatch.setitem(FIXED_WORDS, SHAKE.text, (("BEATS", "POWER"), SHAKE.expansion))


def test_the_new_word_does_the_same_as_its_expansion() -> None:
    compilation = compile_text(PROGRAM, KIT)
    assert not compilation.diagnostics
    assert compilation.image and compilation.image == compile_text(EXPANDED_PROGRAM, KIT).image
    assert str(tiniscript.run(PROGRAM)) == run_by_reference(PROGRAM)


@each_row(
    "program, code",
    [
        ("HORN = 5", codes.RESERVED),
        ("HORN(2)", codes.NO_BRACKETS_HERE),
        ("HORM", codes.UNKNOWN_WORD),
        ("HORN UNTIL(DISTANCE < 10)", codes.UNTIL_NOT_HERE),
        ("SHOW(HORN)", codes.NO_VALUE),
        ("WIGGLE", codes.MISSING_OPEN),
        ("WIGGLE()", codes.ARGUMENT_COUNT),
        ("WIGGLE(2, 3)", codes.ARGUMENT_COUNT),
        ("WIGGLE(0)", codes.OUT_OF_RANGE),
        ("WIGGLE(10)", codes.OUT_OF_RANGE),
        ("WIGGLE(2 CM)", codes.UNIT_PLACE),
        ("WIGGLE(TRUE)", codes.WANTS_NUMBER),
        ("WIGGLE(FOREVER)", codes.FOREVER_NOT_HERE),
        ("WIGGLE(2) UNTIL(DISTANCE < 10)", codes.UNTIL_NOT_HERE),
        ("N = WIGGLE(2)", codes.NO_VALUE),
        ("SHAKE(99, 60)", codes.OUT_OF_RANGE),
        ("SHAKE(3, 101)", codes.OUT_OF_RANGE),
        ("SHAKE(3)", codes.ARGUMENT_COUNT),
        ("SHAKE(3, TRUE)", codes.WANTS_NUMBER),
    ],
)
def test_mistakes_with_the_new_word_are_reported(program: str, code: codes.Code) -> None:
    diagnostics = compile_text(program, KIT).diagnostics
    assert [diagnostic.code for diagnostic in diagnostics] == [code]


@each_row(
    "program, meant_text",
    [
        ("WIGGLE(3)", "LOOP(3);L(0.2, 60);R(0.2, 60);END_LOOP"),
        ("N = 2;WIGGLE(N + 1)", "N = 2;LOOP(N + 1);L(0.2, 60);R(0.2, 60);END_LOOP"),
        ("WIGGLE(MIN(2, (DISTANCE)))", "LOOP(MIN(2, (DISTANCE)));L(0.2, 60);R(0.2, 60);END_LOOP"),
        ("DEF A(N);WIGGLE(N);END_DEF;A(2)",
         "DEF A(N);LOOP(N);L(0.2, 60);R(0.2, 60);END_LOOP;END_DEF;A(2)"),
        ("IF(TRUE);WIGGLE(2);ENDIF;W(1)",
         "IF(TRUE);LOOP(2);L(0.2, 60);R(0.2, 60);END_LOOP;ENDIF;W(1)"),
        ("SHAKE(RANDOM(1, 3), RANDOM(40, 60))",
         "SHAKE_POWER = RANDOM(40, 60);LOOP(RANDOM(1, 3));L(0.2, SHAKE_POWER);R(0.2, SHAKE_POWER)"
         ";END_LOOP"),
        ("N = 2;DANCE(N + 1, N)",
         "N = 2;BEEP(N + 1, 440);BEEP(0.5, 440);LOOP(N);L(0.2, 60);R(0.2, 60);END_LOOP"),
    ],
)  # fmt: skip
def test_a_word_with_a_value_does_what_its_instructions_do(program: str, meant_text: str) -> None:
    """This holds for any value; blocks, text for a robot and the reference use its row."""
    compilation = compile_text(program, KIT)
    assert not compilation.diagnostics
    assert compilation.image and compilation.image == compile_text(meant_text, KIT).image
    assert line_of(compilation.source) == line_of(Source(meant_text))
    assert str(tiniscript.run(program)) == run_by_reference(program)
    assert compilation.program is not None
    for level in LEVELS.values():
        lacking, as_written = (
            [
                (misfit.code, misfit.values)
                for misfit in find_misfits(its.source, its.program, KIT, level)
            ]
            for its in (compilation, compile_text(meant_text, KIT))
            if its.program is not None
        )
        assert lacking == as_written
    sketch = sketch_of(compilation.source, compilation.program, ROBOT, "en")
    assert "turnLeft(" in sketch and WIGGLE.expansion not in sketch


def test_a_wrong_value_is_named() -> None:
    program = "SI|F(1, 80);WIGGLE(2 + UP)"
    (diagnostic,) = compile_text(program, KIT).diagnostics
    assert program[diagnostic.span.start : diagnostic.span.end] == "UP"


def test_a_value_of_such_a_word_is_one_complete_value() -> None:
    """A repeated RANDOM would be two numbers, so a value needed twice goes into a variable.

    In `N * 2` it would need brackets. A name that is a word would mean the word: `F(TIME, 80)` goes
    as long as the program has run.
    """
    for word in WORDS.values():
        for name in (its.name.upper() for its in word.arguments if word.expansion):
            pattern = rf"(?<!\w){name}(?!\w)"
            assert name not in WORDS, word
            assert len(re.findall(pattern, word.expansion)) == 1, word
            is_whole = rf"[(,] *{pattern} *[,)]|= *{pattern} *(?:;|$)"
            assert re.search(is_whole, word.expansion), word


def test_formatter_blocks_and_sketch_keep_the_new_word() -> None:
    assert format_source(Source(PROGRAM.lower())) == PROGRAM
    form = read_blocks(PROGRAM, KIT)
    horn = form.body[0].bodies[0][0]
    assert (horn.kind, horn.word, horn.values) == ("plain", HORN.text, ())
    assert format_blocks(form).text == PROGRAM
    compilation = compile_text(PROGRAM, KIT)
    assert compilation.program is not None
    sketch = sketch_of(compilation.source, compilation.program, ROBOT, "en")
    assert "beep(0.5, 440);" in sketch and "// HORN" in sketch
    assert HORN.text in [word["text"] for word in description()["words"]]


@each_row("level", LEVELS.values())
def test_a_robot_that_reads_text_gets_the_expansion(level: Level) -> None:
    compilation = compile_text(PROGRAM, KIT)
    assert compilation.program is not None
    assert find_misfits(compilation.source, compilation.program, KIT, level) == []
    assert line_of(compilation.source) == line_of(Source(EXPANDED_PROGRAM))
    check_line("SI|HORN", KIT)


# For a process that adds the word before importing the tables of all words.
FRESH_PROCESS_CODE = """
import sys
from pathlib import Path
from tests.support.new_word import HORN, WIGGLE, with_texts
from tiniscript.base import languages
languages.FOLDER = with_texts(Path(sys.argv[1]))
from tiniscript.base.words import WORDS
WORDS[HORN.text] = HORN
WORDS["CHIME"] = HORN._replace(text="CHIME")
WORDS[WIGGLE.text] = WIGGLE
import json
from tiniscript.studio import block_kinds
from tools.builds.page_texts import page_texts
from tools.generate import text_tables
texts = [page_texts(language) for language in ("en", "es")]
labels = [each["block/HORN"] for each in texts] + [block_kinds.BLOCK_TEXTS["CHIME"]]
from tiniscript.studio.block_printing import format_blocks
from tiniscript.studio.block_reading import read_blocks
from tiniscript import robots
form = read_blocks("SI|WIGGLE(X + 2)", robots.load("tinibot").kit)
blocks = [(each.kind, each.word, each.values) for each in form.body], format_blocks(form).text
print(json.dumps([block_kinds.table_data(), labels, text_tables.words_tables("a test"), blocks]))
"""


def in_fresh_process(code: str, tmp_path: Path) -> Any:
    """Return the JSON printed by code in a fresh process, whose tables do not have the new word."""
    command = [sys.executable, "-c", code, str(tmp_path / "said")]
    completed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    return json.loads(completed.stdout)


def test_blocks_and_the_robots_reader_have_it_in_their_tables(tmp_path: Path) -> None:
    blocks, labels, tables, (body, printed) = in_fresh_process(FRESH_PROCESS_CODE, tmp_path)
    assert HORN.text in blocks["kinds"]["plain"]["words"]
    assert WIGGLE.text in blocks["kinds"]["plain_1"]["words"]
    assert blocks["says"]["plain_1"] == "%1 %2"
    value = [["NAME", "X"], ["NUMBER", "2"], ["ADD", ""]]
    assert body == [["plain_1", WIGGLE.text, [value]]]
    assert printed == "SI|WIGGLE(X + 2)\n"
    own_text = "{CHIME} CHIME = BEEP(0.5, 440)"  # the catalogue has no text for it
    assert labels == [*(f"{{{HORN.text}}} {says}" for says in WORD_TEXTS.values()), own_text]
    packed, rows, ranges = tables.split("tini_progmem = {")[1:]
    for word in (HORN.text, WIGGLE.text):
        assert f"// {word}" in packed and f"// {word}" not in rows
    (times,) = WIGGLE.arguments  # no robot reads the word
    assert text_tables.bytes_of_table(pack_range(times.low, times.high)) not in ranges


# The same of a word with a role of its own, of which no stage but the table of words knows.
OWN_ROLE = """
import sys
from pathlib import Path
from tests.support.new_word import LAMP, with_texts
from tiniscript.base import languages
languages.FOLDER = with_texts(Path(sys.argv[1]))
from tiniscript.base.words import WORDS
WORDS[LAMP.text] = LAMP
import json
from tiniscript import robots
from tiniscript.robots.text_levels import LEVELS
from tiniscript.studio import block_kinds
from tiniscript.studio.block_printing import format_blocks
from tiniscript.studio.block_reading import read_blocks
from tools.generate import documents, poster, text_tables
form = read_blocks("SI|LAMP(50)", robots.load("tinibot").kit)
lines = [line.text for line in poster.page("es") if isinstance(line, poster.Line)]
print(json.dumps({
    "lacked": [LAMP.text in level.missing_words for level in LEVELS.values()],
    "tables": text_tables.words_tables("a test"),
    "block": [form.body[0].kind, format_blocks(form).text, block_kinds.BLOCK_TEXTS[LAMP.text]],
    "says": lines[lines.index(LAMP.example) + 1],
    "reference": documents.language_document("docs/es/language.md", "es"),
}))
"""


def test_a_word_with_its_own_role_needs_only_the_table(
    tmp_path: Path,
) -> None:
    """No robot's reader knows it; it has a block, and a place on the poster and in references."""
    output = in_fresh_process(OWN_ROLE, tmp_path)
    assert all(output["lacked"])
    packed, rows, _ = output["tables"].split("tini_progmem = {")[1:]
    assert "// LAMP" in packed and "// LAMP" not in rows
    assert output["block"] == ["plain_1", "SI|LAMP(50)\n", "{LAMP} LAMP"]
    assert output["says"] == WORD_TEXTS["es"]
    others = re.search(r"(?m)^- Otras instrucciones: .*$", output["reference"])
    assert others and f"`LAMP(POWER)` {WORD_TEXTS['es']}" in others[0]


@each_row(
    "role", [role for role in ROLES.values() if role.is_instruction and not role.has_duration]
)
def test_each_role_that_is_not_a_statement_of_its_own_has_an_instruction_and_a_helper(
    role: Role,
) -> None:
    if role.name in _STATEMENT_MAKERS or role.name == "fixed":
        return
    assert role.name.upper() in BY_NAME, "bytecode/opcodes.py"
    assert role.name in HELPERS, "codegen/sketch/helpers.py"


@each_row("stage", [lower, statements])
def test_each_statement_of_the_ir_has_a_row_in_code_generation(stage: Any) -> None:
    """Otherwise only a user would notice a new word with a role of its own that is not
    generated."""
    assert set(stage._STATEMENTS) == {*get_args(ir.Statement)}


@pytest.mark.parametrize(("language", "says"), WORD_TEXTS.items())
def test_the_new_word_is_on_the_poster(
    language: str, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(languages, "FOLDER", with_texts(tmp_path / "said"))
    languages.forget_languages()
    monkeypatch.setitem(WORDS, "CHIME", HORN._replace(text="CHIME"))
    lines = [line for line in poster.page(language) if isinstance(line, Line)]
    languages.forget_languages()
    texts = [line.text for line in lines]
    assert texts[texts.index(HORN.text) + 1] == says
    assert texts[texts.index("CHIME") + 1] == "= BEEP(0.5, 440)"
    assert max(line.y for line in lines[:-1]) <= paper.HEIGHT - 26


def test_a_full_page_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    for number in range(20):
        monkeypatch.setitem(WORDS, f"HORN{number}", HORN._replace(text=f"HORN{number}"))
    with pytest.raises(AssertionError, match="the page has room for 45 rows"):
        poster.page("en")


@each_row(
    "document, language, says",
    [
        ("docs/en/language.md", "en", "With fixed values"),
        ("docs/es/language.md", "es", "Con valores fijos"),
    ],
)
def test_the_new_word_is_in_the_references(document: str, language: str, says: str) -> None:
    row = rf"(?m)^- {says}: .*`HORN` = `BEEP\(0\.5, 440\)` (.*)$"
    match = re.search(row, language_document(document, language))
    with_values = {
        "WIGGLE(N)": WIGGLE, "DANCE(SECONDS, N)": DANCE, "SHAKE(BEATS, POWER)": SHAKE,
    }  # fmt: skip
    assert match
    assert match[1] == " ".join(
        f"`{usage}` = `{word.expansion}`" for usage, word in with_values.items()
    )
