"""Programs that stop in the middle, and long rows: each is read to its end, and once."""

from __future__ import annotations

import re

import pytest

from tests.pupils.corpus import check, entries
from tests.support.checking_work import calls_of_check
from tiniscript.recovery.told import MAX_CHARACTERS

WORDS = re.compile(r"\w+|[^\w\s]")
# Calls for each character: of a row so long that it is read word by word, and of one that is read
# as a whole. If each word reads the whole row, there are far more.
MAX_CALLS, MAX_CALLS_WHOLE = 250, 8_000


@pytest.mark.parametrize(
    "program",
    ["END .", "FIN .", "deja de", "para de", "const int", "F(2, 80) y BEEP", "F(2, 80) + BEEP"],
)
def test_nothing_is_read_after_the_end(program: str) -> None:
    assert any(diagnostic.is_mistake for diagnostic in check(program))


def test_all_cut_programs_end() -> None:
    cut = set()
    for entry in entries()[::12]:
        last_line = entry.program.splitlines()[-1]
        word_ends = [match.end() for match in WORDS.finditer(last_line)]
        cut |= {last_line[:end] for end in word_ends[:3] + word_ends[-3:]}
    assert len(cut) > 100
    for program in cut:
        check(program)


@pytest.mark.sampled("program")
@pytest.mark.parametrize(
    "program",
    [
        "SI|" + ";".join(f"foo{k}" for k in range(5000)),
        "SI|" + "F(1, 80) voy " * 3000,
        "idem\n" * 8000,
        "X=Y=5\n" * 4000,
        "X=5;X=TRUE\n" * 4000,
        "F(1,50). " * 16000,
        "F(1,50). " * 433,
        "F(1,60,R)\n" * 10000,
        "é" * 100_000,
    ],
    ids=["words", "notes", "again", "equal", "kinds", "stops", "steps", "values", "letters"],
)
def test_a_long_line_is_read_once(program: str) -> None:
    assert any(diagnostic.is_mistake for diagnostic in check(program))
    max_calls_per_character = MAX_CALLS if len(program) > MAX_CHARACTERS else MAX_CALLS_WHOLE
    assert calls_of_check(program) < max_calls_per_character * len(program)
