"""Position: a row means the same in any place of its instruction.

The example of each row is read alone, and then first, last and in the middle of one line, and in an
IF, a DEF and a TASK. A row of a whole line says so with `^^`, `$$`, `\\A` or `\\Z`.
"""

from __future__ import annotations

import re
from functools import lru_cache, partial
from itertools import chain

import pytest

from tests.support.rows import go_through
from tiniscript import robots
from tiniscript.base.kit import Kit
from tiniscript.diagnostics.codes import Code
from tiniscript.library.compiling import analyze
from tiniscript.recovery import rewrites, rows
from tiniscript.recovery.meanings import lexemes, texts
from tiniscript.recovery.search import Candidate, Recovery
from tiniscript.syntax.blocks import WORD_OF_END

KITS = [robots.load(name).kit for name in ("tinibot", "grabber", "liner")]
PLACES_ON_A_LINE = ("W(3);{}", "{};W(3)", "W(3);{};W(3)")
PLACES_IN_A_BLOCK = ("IF(DISTANCE < 9);{};ENDIF", "DEF A1;{};END_DEF;A1", "TASK;{};END_TASK")
TOP_LEVEL_WORD = re.compile(r"\b(?:DEF|TASK|WHEN|BREAK)\b")  # these are in no block, or in a loop
LINE_ANCHORS = ("^^", "$$", r"\A", r"\Z")


def examples() -> list[str]:
    """Return the examples of all rows that speak of an instruction, each on one line."""
    texts = []
    for pattern, *_, example in chain(rewrites.cells(rows.SIGNS), rewrites.cells(rows.TOKENS)):
        wrong_text = example.rpartition(" => ")[0].strip()
        if not any(sign in pattern for sign in LINE_ANCHORS) and "//" not in example:
            texts.append(re.sub(r"\s*⏎\s*", ";", re.sub(r"^SI\s*\|", "", wrong_text)))
    return [*dict.fromkeys(texts)]


@lru_cache(None)
def mistakes(kit: Kit, text: str) -> tuple[Code, ...]:
    return tuple(
        diagnostic.code for diagnostic in analyze(text, kit).diagnostics if diagnostic.is_mistake
    )


def find_meant_program(text: str) -> Candidate | None:
    """Return the meant program, for the first robot on which it is right."""
    candidates = [Recovery(text, kit, partial(mistakes, kit)).best_candidate() for kit in KITS]
    return next(
        (candidate for candidate in candidates if candidate and candidate.is_whole), candidates[-1]
    )


def words_of(text: str) -> tuple[str, ...]:
    """Return the words of a program; between two instructions is one separator."""
    parts = (texts(lexemes(part)) for part in re.split("[;\n]", text))
    return tuple(chain(*((*part, ";") for part in parts if part)))


def ends(text: str) -> int:
    return sum(text in WORD_OF_END for text in texts(lexemes(text)))


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(3))
def test_a_row_means_the_same_wherever_its_instruction_stands(part: int) -> None:
    go_through(check_same_meaning_everywhere, examples()[part::3])


def check_same_meaning_everywhere(wrong_text: str) -> None:
    meant_alone = find_meant_program(wrong_text)
    if meant_alone is None:
        return  # the program depends on its lines in the table
    is_open = ends(meant_alone.text) > ends(
        wrong_text
    )  # later lines may belong to the block that it begins
    may_stand_in_a_block = not TOP_LEVEL_WORD.search(meant_alone.text.upper())
    for place in (*PLACES_ON_A_LINE, *(PLACES_IN_A_BLOCK if may_stand_in_a_block else ())):
        candidate = find_meant_program(place.format(wrong_text))
        same = place.format(meant_alone.text)
        if is_open and not place.endswith("{}"):
            assert (
                candidate is None
                or not candidate.is_applied
                or words_of(candidate.text) == words_of(same)
            ), place
        else:
            assert candidate, place
            assert (words_of(candidate.text), candidate.is_applied) == (
                words_of(same),
                meant_alone.is_applied,
            ), place
