"""A word with fixed values is a row of `words.py`: every stage takes it from there."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import tiniscript
from tests.oracle.interpreter import run as run_by_reference
from tests.oracle.words import FIXED
from tests.support.casefile import ROOT
from tests.support.new_word import HORN, SAID, with_texts
from tests.support.rows import each_row
from tests.text.test_line import check_line
from tiniscript import compile_text, robots
from tiniscript.base import languages
from tiniscript.base.source import Source
from tiniscript.base.words import WORDS
from tiniscript.codegen.sketch.writing import sketch_of
from tiniscript.codegen.text.line import line_of
from tiniscript.diagnostics import codes
from tiniscript.library.text_fitting import misfits
from tiniscript.robots.text_levels import LEVELS, Level
from tiniscript.studio.block_printing import print_blocks
from tiniscript.studio.block_reading import read
from tiniscript.studio.description import description
from tiniscript.syntax.formatter import formatted
from tools.generate import paper, poster
from tools.generate.documents import language_document
from tools.generate.paper import Line

ROBOT = robots.load("tinibot")
KIT = ROBOT.kit
PROGRAM = "SI|LOOP(2);\n  HORN;\n  W(1);\nEND_LOOP;\n"
MEANT = PROGRAM.replace(HORN.text, HORN.stands_for)


@pytest.fixture(autouse=True)
def _has_horn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(WORDS, HORN.text, HORN)
    monkeypatch.setitem(FIXED, HORN.text, HORN.stands_for)


def test_it_does_what_it_stands_for() -> None:
    compiled = compile_text(PROGRAM, KIT)
    assert not compiled.diagnostics
    assert compiled.image and compiled.image == compile_text(MEANT, KIT).image
    assert str(tiniscript.run(PROGRAM)) == run_by_reference(PROGRAM)


@each_row(
    "program, code",
    [
        ("HORN = 5", codes.RESERVED),
        ("HORN(2)", codes.NO_BRACKETS_HERE),
        ("HORM", codes.UNKNOWN_WORD),
        ("HORN UNTIL(DISTANCE < 10)", codes.UNTIL_NOT_HERE),
        ("SHOW(HORN)", codes.NO_VALUE),
    ],
)
def test_what_is_wrong_with_it_is_said(program: str, code: codes.Code) -> None:
    diagnostics = compile_text(program, KIT).diagnostics
    assert [diagnostic.code for diagnostic in diagnostics] == [code]


def test_it_is_kept_by_formatter_blocks_and_sketch() -> None:
    assert formatted(Source(PROGRAM.lower())) == PROGRAM
    form = read(PROGRAM, KIT)
    horn = form.body[0].bodies[0][0]
    assert (horn.kind, horn.word, horn.values) == ("fixed", HORN.text, ())
    assert print_blocks(form).text == PROGRAM
    compiled = compile_text(PROGRAM, KIT)
    assert compiled.program is not None
    sketch = sketch_of(compiled.source, compiled.program, ROBOT, "en")
    assert "beep(0.5, 440);" in sketch and "// HORN" in sketch
    assert HORN.text in [each["text"] for each in description()["words"]]


@each_row("level", LEVELS.values())
def test_a_robot_that_reads_text_gets_what_it_stands_for(level: Level) -> None:
    compiled = compile_text(PROGRAM, KIT)
    assert compiled.program is not None
    assert misfits(compiled.source, compiled.program, KIT, level) == []
    assert line_of(compiled.source) == line_of(Source(MEANT))
    check_line("SI|HORN", KIT)


# Of a process that knows the word before it imports what makes tables of all words.
FRESH = """
import sys
from pathlib import Path
from tests.support.new_word import HORN, with_texts
from tiniscript.base import languages
languages.FOLDER = with_texts(Path(sys.argv[1]))
from tiniscript.base.words import WORDS
WORDS[HORN.text] = HORN
WORDS["CHIME"] = HORN._replace(text="CHIME")
import json
from tiniscript.studio import block_kinds
from tools.builds.page_texts import page_texts
from tools.generate import text_tables
texts = [page_texts(language) for language in ("en", "es")]
labels = [each["block/HORN"] for each in texts] + [block_kinds.SAYS["CHIME"]]
print(json.dumps([block_kinds.data(), labels, text_tables.words_tables("a test")]))
"""


def test_blocks_and_the_robots_reader_have_it_in_their_tables(tmp_path: Path) -> None:
    ran = subprocess.run(
        [sys.executable, "-c", FRESH, str(tmp_path / "said")],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    blocks, labels, tables = json.loads(ran.stdout)
    assert HORN.text in blocks["kinds"]["fixed"]["words"]
    own = "{CHIME} CHIME = BEEP(0.5, 440)"  # the catalogue has nothing to say of it
    assert labels == [*(f"{{{HORN.text}}} {says}" for says in SAID.values()), own]
    packed, rows, _ = tables.split("tini_progmem = {")[1:]
    assert "// HORN" in packed and "// HORN" not in rows


@pytest.mark.parametrize(("language", "says"), SAID.items())
def test_it_is_on_the_poster(
    language: str, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(languages, "FOLDER", with_texts(tmp_path / "said"))
    languages.forget()
    monkeypatch.setitem(WORDS, "CHIME", HORN._replace(text="CHIME"))
    lines = [line for line in poster.page(language) if isinstance(line, Line)]
    languages.forget()
    texts = [line.text for line in lines]
    assert texts[texts.index(HORN.text) + 1] == says
    assert texts[texts.index("CHIME") + 1] == "= BEEP(0.5, 440)"
    assert max(line.y for line in lines[:-1]) <= paper.HEIGHT - 26


def test_a_page_that_is_full_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
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
def test_it_is_in_the_references(document: str, language: str, says: str) -> None:
    row = rf"(?m)^- {says}: .*`HORN` = `BEEP\(0\.5, 440\)`$"
    assert re.search(row, language_document(document, language))
