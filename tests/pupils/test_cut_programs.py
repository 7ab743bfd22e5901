"""Programs that stop in the middle, without a line end behind their last word."""

from __future__ import annotations

import re

import pytest

from tests.pupils.corpus import check, entries

WORDS = re.compile(r"\w+|[^\w\s]")


@pytest.mark.parametrize(
    "program",
    ["END .", "FIN .", "deja de", "para de", "const int", "F(2, 80) y BEEP", "F(2, 80) + BEEP"],
)
def test_nothing_is_read_behind_the_end(program: str) -> None:
    assert any(each.is_mistake for each in check(program))


def test_all_cut_programs_end() -> None:
    cut = set()
    for each in entries()[::6]:
        last = each.program.splitlines()[-1]
        ends = [found.end() for found in WORDS.finditer(last)]
        cut |= {last[:end] for end in ends[:3] + ends[-3:]}
    assert len(cut) > 200
    for program in cut:
        check(program)
