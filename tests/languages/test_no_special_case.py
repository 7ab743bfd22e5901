"""Code chooses no language by its code, and contains no words of one."""

from __future__ import annotations

import ast
import re

import pytest

from tests.support.casefile import ROOT
from tiniscript.base.kit import REMOTE
from tiniscript.base.languages import (
    ABOUT_FILE,
    FOLDER,
    SOURCE_LANGUAGE,
    languages,
    read_language_file,
)
from tiniscript.base.translations import read_language
from tiniscript.base.words import WORDS
from tiniscript.recovery import rows, suggestion_rows
from tiniscript.recovery.rewrites import cells

SPECIAL = re.compile(r"""(?:==|===|!=) ?["'](?:es|en|pt)["']|["'](?:es|en|pt)["'] (?:==|===)""")


def test_no_code_checks_for_a_particular_language() -> None:
    folders = ("compiler/tiniscript", "tools", "vm_arduino")
    counts = {}
    for path in sorted(path for folder in folders for path in (ROOT / folder).rglob("*")):
        parts = path.relative_to(ROOT).parts
        if path.suffix not in (".py", ".js", ".cpp", ".h") or not path.is_file():
            continue
        if {"node_modules", "made", "page", "__pycache__", ".pio"} & set(parts):
            continue
        count = len(SPECIAL.findall(path.read_text(encoding="utf-8")))
        if count:
            counts["/".join(parts)] = count
    assert counts == {}


def _rows(language: str) -> list[tuple[str, list[str]]]:
    """Return the meanings, and the words for each."""
    rows = [
        row
        for row in read_language_file(language, "lexicon.txt").split("\n")
        if not row.startswith("#")
    ]
    return [(meaning, words.split()) for meaning, _, words in (row.partition("|") for row in rows)]


def _words(language: str) -> set[str]:
    return {word for _, words in _rows(language) for word in words}


def test_words_of_a_language_are_in_its_folder() -> None:
    """Patterns of characters have some that are said for signs: `punto y coma`."""
    foreign_words = set().union(*map(_words, languages())) - _words(SOURCE_LANGUAGE) - {*WORDS}
    words_in_code = set()
    for path in sorted((ROOT / "compiler/tiniscript").rglob("*.py")):
        if "page" in path.parts:
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                words_here = foreign_words.intersection(re.findall(r"\b[A-Z_]{4,}\b", node.value))
                if " " not in node.value.strip() or node.value.isupper():
                    words_in_code |= {f"{path.name}: {word}" for word in words_here}
    assert words_in_code == set()


# Texts that are the same in every language: signs, functions of Arduino, a word of Logo, letters,
# two words that are one, and the name of the command.
WRITTEN = {"X", "TONE", "TO", "A", "FL", "LF", "FR", "RF", "UN", "TIL", "TSC"}


def test_rows_contain_no_word_of_a_language() -> None:
    pieces = [*rows.PARTS.values(), *suggestion_rows.PARTS.values()]
    patterns = [
        row[0] for table in (rows.TOKENS, suggestion_rows.SUGGESTIONS) for row in cells(table)
    ]
    words = re.findall(r"(?<![@\w])[A-Z][A-Z_]*\b", " ".join([*pieces, *patterns]))
    assert {*words} - {*WORDS} - {device.name for device in REMOTE} <= WRITTEN


@pytest.mark.parametrize(
    "language",
    [
        language
        for language in languages()[1:]
        if read_language(FOLDER / language / ABOUT_FILE).is_complete
    ],
)
def test_each_language_has_words_for_amounts_and_things(language: str) -> None:
    """A word's meaning in one language, `poco`, is also in the others, `pouco`."""
    kinds = {meaning.split()[0] for meaning, words in _rows(language) if words}
    expected_text = (
        "amount note device stem short power value bye help each every jump colour number unit"
    )
    assert kinds >= {*expected_text.split()}
