"""Slips that can mean two things are left to their author; others are repaired, in few steps."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Span
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import CHECKS, fixed, is_better
from tiniscript.library import compiling


@pytest.mark.parametrize(
    "program",
    [
        "W(15.)",  # 1.5, or 15
        "LOOP(1000o);END_LOOP",
        "SHOW(1.5l)",
        "SHOW(5 / 3 - 3))",  # one bracket too many, or one missing
        "X = (5 - 3 / 2",
        "SPEED = 5;:PEED = 6",
        "W(0.?1)",
        "SHOW;",
        "X = 1;X = + 5",
        "F(2,8 0)",
        "F(2,80,60)",
        "WAIT(500)",
        "F(TIEMPO, 80)",  # a variable whose value is missing
        "F 80 %, 2 S F(1, 50)",  # a power, and then a time or not
        "BEEP 80 %, 2",
        "DEF LOOK;S;END_DEF;LOOK:F(2, 80)",  # LOOK is called
    ],
)
def test_a_slip_that_has_two_repairs_is_left_to_its_author(program: str) -> None:
    assert check(program)
    done = fixed(program, check).text
    assert done in (program, program.replace("LOOK:", "LOOK;"))


@pytest.mark.parametrize(
    ("program", "right"),
    [
        ("F(2, 8O)", "F(2, 80)"),
        ("F(2, 80))", "F(2, 80)"),
        ("F(2, 80", "F(2, 80)"),
        ("\u00a1F(2, 80)", "F(2, 80)"),
        ("F(2;80", "F(2, 80)"),
        ("F(\u221e, 80) UNTIL(DISTANCE < 10)", "F(FOREVER, 80) UNTIL(DISTANCE < 10)"),
        ("F(2, 80)\\nR(1, 60)", "F(2, 80);R(1, 60)"),
        ("F(time=2, power=80)", "F(2, 80)"),
        ("x = la distancia", "x = DISTANCE"),
        ("F(dos segundos, 80)", "F(2, 80)"),
        ("TIEMPO 2\nF(TIEMPO, 80)", "TIEMPO = 2\nF(TIEMPO, 80)"),
        ("for i in range(3): F(1, 60); S", "LOOP(3);F(1, 60);S;END_LOOP"),
        ("LOOP(4);(F(1,60);S)", "LOOP(4);F(1, 60);S;END_LOOP"),
        ("F(power=80, time=2)", "F(power=80, time=2)"),  # in another order: its author looks
        ("IF(DISTANCE no es menor que 10);S;ENDIF", "IF(DISTANCE >= 10);S;ENDIF"),
    ],
)
def test_a_slip_that_has_one_repair_gets_it(program: str, right: str) -> None:
    assert fixed(program, check).text == right


@pytest.mark.parametrize("piece", ["(({[|", "F 2 80 R 1 ", "[20:14] x", "F(t=2, vel=80)"])
def test_a_long_hostile_text_takes_few_steps(piece: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = piece * (7000 // len(piece))
    checks: list[str] = []
    checked = compiling.analyzed

    def counted(text: str, kit: Kit, name: str = "") -> compiling.Compiled:
        checks.append(text)
        return checked(text, kit, name)

    monkeypatch.setattr(compiling, "analyzed", counted)
    assert check(text)
    assert 0 < len(checks) <= 40


def test_a_program_is_checked_so_often_and_no_more() -> None:
    """Whatever its repairs uncover."""
    (missing,) = check("F(2 80)")
    texts: list[str] = []

    def endless(text: str) -> list[Diagnostic]:
        texts.append(text)
        return [missing] * (2 * CHECKS - len(texts))

    assert fixed("F(2 80)", endless).repairs == CHECKS - 1 and len(texts) == CHECKS


def test_a_repair_with_a_mistake_in_it_is_none() -> None:
    (missing,) = check("F(2 80)")
    edits = [Edit(Span(3, 3), ",,,"), Edit(Span(5, 6), "")]
    for start, is_repair in ((2, True), (3, False), (5, False), (6, True)):
        other = missing._replace(span=Span(start, 9))
        assert is_better([other], [missing], edits) == is_repair
