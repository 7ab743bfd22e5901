"""A text that is twice as long takes twice the work: a hostile one causes no long wait."""

from __future__ import annotations

import pytest

from tests.support.checking_work import ROBOT, calls_of_check
from tiniscript.library.compiling import compile_source

LEAST = 4_000  # pieces


@pytest.mark.sampled("opening", "piece", "end")
@pytest.mark.parametrize(
    ("opening", "piece", "end"),
    [
        ("", "1+", "1"), ("", "1+", ""), ("", "SI|", ""), ("", "SI|\n", ""),
        ("", "SI|", "F(1, 80)"),
        ("SI|SHOW(", "1+", "1)"), ("SI|F(", "1+", "1)"), ("SI|IF(", "1+", "1)"), ("X = ", "1+", ""),
    ],
)  # fmt: skip
def test_a_long_text_takes_no_more_than_in_proportion(opening: str, piece: str, end: str) -> None:
    short, long = (calls_of_check(f"{opening}{piece * count}{end}") for count in (LEAST, 4 * LEAST))
    assert long < 4.8 * short


MISTAKES = 100
MAX_CALLS = 3_000  # most calls per character of a text of this size
REPEATED = [
    *("FOR I = 1 TO 5;F(1, 50);NEXT I", "X{k} = {k} m", "F(5, 60) HASTA(PARED < 10 seg)"),
    *("SIDE = 30 CM;W(SIDE)", "{k}. F(1, 50)", "IF(KEY = UP);S;ENDIF", "F(1, 60, R)", "F(50; 2)"),
    *("avanza {k} segundos", "F(1, 80) voy", "IF(DISTANCE < 10, B(1, 60), F(1, 60))", "F 2 80"),
    *("foo{k}", "DEF P{k};S;ENDDEF P{k}", "\u201cF(2, 80)\u201d", "F(50%, 1000 ms)"),
]


@pytest.mark.sampled("mistake", keep=2)
@pytest.mark.parametrize("separator", ["\n", ";"], ids=["lines", "one-line"])
@pytest.mark.parametrize("mistake", REPEATED)
def test_many_mistakes_take_no_more_than_in_proportion(mistake: str, separator: str) -> None:
    one = mistake.replace("{k}", "1")
    compile_source(one.encode(), ROBOT, "prog.ts", is_strict=False)  # the tables are read
    text = "".join(mistake.replace("{k}", str(k)) + separator for k in range(MISTAKES))
    assert calls_of_check(text) < MAX_CALLS * len(text)
