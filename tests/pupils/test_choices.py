"""Repairs take few steps, and none contains a mistake."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Span
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import MAX_CHECKS, is_better, repair_program
from tiniscript.library import compiling


@pytest.mark.parametrize("piece", ["(({[|", "F 2 80 R 1 ", "[20:14] x", "F(t=2, vel=80)"])
def test_a_long_hostile_text_takes_few_steps(piece: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = piece * (7000 // len(piece))
    checks: list[str] = []
    checked = compiling.analyze

    def count_check(text: str, kit: Kit, name: str = "") -> compiling.Compilation:
        checks.append(text)
        return checked(text, kit, name)

    monkeypatch.setattr(compiling, "analyze", count_check)
    assert check(text)
    assert 0 < len(checks) <= 40


def test_a_program_is_checked_a_limited_number_of_times() -> None:
    """This limit holds whatever its repairs uncover."""
    (missing,) = check("F(2 80)")
    texts: list[str] = []

    def endless(text: str) -> list[Diagnostic]:
        texts.append(text)
        return [missing] * (2 * MAX_CHECKS - len(texts))

    assert (
        repair_program("F(2 80)", endless).repair_count == MAX_CHECKS - 1
        and len(texts) == MAX_CHECKS
    )


def test_a_repair_that_contains_a_mistake_is_not_offered() -> None:
    (missing,) = check("F(2 80)")
    edits = [Edit(Span(3, 3), ",,,"), Edit(Span(5, 6), "")]
    for start, is_repair in ((2, True), (3, False), (5, False), (6, True)):
        other_diagnostic = missing._replace(span=Span(start, 9))
        assert is_better([other_diagnostic], [missing], edits) == is_repair
