"""What is said of one long row takes a time that grows as the row does."""

from __future__ import annotations

import time

import pytest

from tests.pupils.corpus import check

MOST_S = 4.0  # on a slow machine; where each word reads the whole row, it is far more


@pytest.mark.parametrize(
    "program",
    [
        "SI|" + ";".join(f"foo{k}" for k in range(5000)),
        "SI|" + "F(1, 80) voy " * 3000,
        "idem\n" * 8000,
        "X=Y=5\n" * 4000,
        "X=5;X=TRUE\n" * 4000,
        "F(1,50). " * 16000,
    ],
    ids=["words", "notes", "again", "equal", "kinds", "stops"],
)
def test_a_long_row_is_read_once(program: str) -> None:
    begin = time.process_time()
    assert any(each.is_mistake for each in check(program))
    assert time.process_time() - begin < MOST_S
