"""A repair is offered only where copying it does what was written."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.rendering import message
from tiniscript.kit import Kit
from tiniscript.library import compiling
from tiniscript.repairs import fixing, vouching, whole_calls
from tiniscript.repairs.accounting import lost, makes_up, makes_up_names
from tiniscript.repairs.fixing import fixed
from tiniscript.repairs.placing import edits_of
from tiniscript.repairs.vouching import vouched
from tiniscript.source import Edit, Source, Span
from tiniscript.syntax.parser import parse


@pytest.mark.parametrize(
    ("before", "after", "gone"),
    [
        ("adelante 2 segundos", "F(2, 80)", []),
        ("F 2 80", "F(3, 80)", ["2"]),
        ("delay(500)", "W(0.5)", []),
        ("delay(500)", "W(5)", ["500"]),
        ("W 2 min", "W(120)", []),
        ("F(1,5, 80)", "F(1.5, 80)", []),
        ("si no hay pared avanza", "F(2, 80)", ["NO", "PARED", "SI"]),
        ("si ve una pared gira", "IF(DISTANCE < 10)", ["GIRA"]),
        ("mientras DISTANCE > 10", "WHILE(DISTANCE > 10)", []),
        ("F(2, 80) mientras DISTANCE > 10", "F(2, 80) UNTIL(DISTANCE <= 10)", []),
        ("F(2, 80) mientras DISTANCE > 10", "F(2, 80) UNTIL(DISTANCE > 10)", ["MIENTRAS"]),
        ("avanza hasta DISTANCE < 10", "F(2, 80)", ["10", "DISTANCE", "HASTA"]),
        ("F(1, 50);F(1, 50)", "F(1, 50)", ["1", "50", "F"]),
        ("mi vel = 5", "MI_VEL = 5", []),
        ("else if (X > 1)", "ELSEIF(X > 1)", []),
        ("R(1, 50) // gira", "// R(1, 50) gira", ["//", "R"]),
        ("F(-2, 80)", "B(2, 80)", []),
        ("F(2, 80)", "B(2, 80)", ["F"]),
        ("tres veces", "LOOP(3)", []),
        ("NOT X", "X", ["NOT"]),
        (
            "avanza hasta la pared y gira a la derecha",
            "F(2, 80)",
            ["DERECHA", "GIRA", "HASTA", "PARED"],
        ),
        ("motor izquierda 50", "M(50, 0)", []),
        ("si hay pared adelante para", "IF(DISTANCE < 10);S;ENDIF", []),
        ("adelante y para", "S", ["ADELANTE"]),
        ("F(2, 80); S", "F(2, 80)", ["S"]),
        ("M 50 50", "F(50, 50)", ["M"]),
        ("F 2 s 80", "F(2, 80)", []),
    ],
)
def test_what_a_change_loses_is_named(before: str, after: str, gone: list[str]) -> None:
    assert lost(before, after) == gone


def test_a_rule_that_writes_a_number_in_another_way_may_do_so() -> None:
    assert lost("1/2 min", "30") == ["1", "2"]
    assert lost("1/2 min", "30", codes.UNIT) == []


@pytest.mark.parametrize(
    ("before", "after", "is_made_up"),
    [
        ("adelante", "F(2, 80)", True),
        ("adelante 2", "F(2, 80)", False),  # a power is always made up
        ("si X < 15", "IF(X < 15)", False),
        ("si hay pared", "IF(DISTANCE < 10)", True),
    ],
)
def test_numbers_of_examples_are_made_up(before: str, after: str, is_made_up: bool) -> None:
    assert makes_up(before, after) == is_made_up


def tried(program: str) -> list[str]:
    """Return what to try, in English, for each mistake."""
    source = Source(program)
    return [message(each, source, "en").fix for each in check(program) if each.is_mistake]


@pytest.mark.parametrize(
    ("program", "wrong"),
    [
        ("WAIT(500)", "W(500)"),  # rather milliseconds
        ("drive forward until you see a wall then turn left", "F(2, 80)"),
        ("cuando distancia menor a 15 frenar y girar izquierda", "IF(DISTANCE < 10)"),
        ("si ve una pared gira", "IF(DISTANCE < 10)"),
        ("turn left for 1 second at 50 percent", "L(1, 80)"),
        ("while (DISTANCE > 15) F(0.2,50); S;", "WHILE(DISTANCE > 15);F(0.2, 50);S;END_WHILE"),
        (
            "while (true) { if (DISTANCE < 10) break; F(0.2,50); }",
            "WHILE(TRUE);IF(DISTANCE < 10);BREAK;F(0.2, 50);ENDIF;END_WHILE",
        ),
        ("IF(DISTANCE<10,S)", "S_1"),
        ("IF(DISTANCE < 10);S\nF(1,50)", "Write ENDIF after line 2: F(1,50)"),
        ("para cada vuelta\nF(1,50)\nfin", "LOOP(3)"),
        (
            "si DISTANCE < 10 S si DISTANCE > 10 F(1,50)",  # the second is not in the first
            "IF(DISTANCE < 10);S;IF(DISTANCE > 10);F(1, 50);ENDIF;ENDIF",
        ),
        (
            "IF(DISTANCE < 10)\nS\nIF(DISTANCE > 10)\nF(1,50)\nENDIF",
            "Write ENDIF after line 5: ENDIF",
        ),
        ("repeat F(1,50) until DISTANCE < 10", "LOOP(3)"),
        ("4 LOOP(F(1,50))", "Take out 4"),
    ],
)
def test_what_does_something_else_is_not_offered(program: str, wrong: str) -> None:
    found = tried(program)
    assert found
    assert wrong not in found
    assert all(found), "each mistake still says what to try"


def test_a_step_that_keeps_all_that_was_said_is_offered() -> None:
    assert tried("LEFT(1,50) AND FORWARD(2,80)")[0] == "L(1, 50);F(2, 80)"
    assert tried("repetir 4 veces avanza 1 segundo y luego pita")[0] == "LOOP(4)"


@pytest.mark.parametrize(
    ("before", "after", "is_made_up"),
    [
        ("SHOW", "SHOW(DISTANCE)", True),
        ("mostrar distancia", "SHOW(DISTANCE)", False),
        ("mientras no haya pared", "WHILE(DISTANCE > 10)", False),
        ("mi vel = 5", "MI_VEL = 5", False),
    ],
)
def test_names_of_examples_are_made_up(before: str, after: str, is_made_up: bool) -> None:
    assert makes_up_names(before, after) == is_made_up


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


@pytest.mark.parametrize("piece", ["(({[|", "F 2 80 R 1 "])
def test_a_long_hostile_text_takes_few_steps(piece: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = piece * (7000 // len(piece))
    looked_at = []
    checks = []

    def counted(other: str) -> list[Diagnostic]:
        checks.append(other)
        return _read(other)

    def placed(diagnostic: Diagnostic, source: Source) -> list[Edit] | None:
        looked_at.append(diagnostic)
        return edits_of(diagnostic, source)

    monkeypatch.setattr(fixing, "edits_of", placed)
    fixed(text, counted)
    assert len(checks) <= 20 + fixing.CHECKED_CHARACTERS // len(text) + fixing.MANY
    assert len(looked_at) <= fixing.MANY * len(checks)


def test_repairs_that_touch_are_tried_in_few_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    checks = []
    checked = compiling.analyzed

    def counted(text: str, kit: Kit, name: str = "") -> compiling.Compiled:
        checks.append(text)
        return checked(text, kit, name)

    monkeypatch.setattr(compiling, "analyzed", counted)
    assert check("F(t=2, vel=80)" * 60)[0].values["fix"] == "F(2, 80)"
    assert len(checks) <= 4


def test_of_repairs_that_all_touch_those_that_nobody_tries_are_not_offered() -> None:
    text = "LOOP 4" + " " * 20_000
    values = {"word": "LOOP", "fix": "LOOP(4)", "usage": "LOOP(times)"}
    found = [Diagnostic(codes.MISSING_OPEN, Span(0, 6), values, Span(0, 6))] * 50
    checks: list[str] = []

    def none(other: str) -> list[Diagnostic]:
        checks.append(other)
        return []

    kept = vouched(found, Source(text), none)
    tried = 1 + vouching.CHECKED_CHARACTERS // len(text)
    assert len(checks) == tried
    assert [bool(each.values["fix"]) for each in kept] == [True] * tried + [False] * (50 - tried)


def test_of_a_text_with_many_mistakes_the_first_are_looked_at_as_a_whole(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    places = []
    around = whole_calls._around

    def counted(text: str, place: int) -> Span:
        places.append(place)
        return around(text, place)

    monkeypatch.setattr(whole_calls, "_around", counted)
    assert len(check("[20:14] x" * 400)) > whole_calls.MANY
    assert len(places) <= 2 * whole_calls.MANY


def _read(text: str) -> list[Diagnostic]:
    """Return what the parser says alone, which takes a tenth of the time."""
    return parse(Source(text), None).diagnostics
