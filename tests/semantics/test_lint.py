"""The lint: what it warns of, and what it leaves alone. `tests/cases/lint.md` has sentences."""

from __future__ import annotations

import pytest

from tiniscript import check_text, robots
from tiniscript.semantics.lint import advice

KIT = robots.load("tinibot").kit


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("LOOP(FOREVER);W(1);END_LOOP;S", "TS802"),
        ("LOOP(2);BREAK;S;END_LOOP", "TS802"),
        ("IF(DISTANCE < 5);LOOP(FOREVER);W(1);END_LOOP;ELSE;LOOP(FOREVER);W(1);END_LOOP;ENDIF;S",
         "TS802"),
        ("F(0, 80)", "TS803"),
        ("L(2 - 2, 80)", "TS803"),
        ("LOOP(FOREVER);X = DISTANCE;SHOW(X);END_LOOP", "TS804"),
        ("WHILE(TRUE);DISTANCE;END_WHILE", "TS804"),
        ("DEF A;SHOW(1);END_DEF;LOOP(FOREVER);A;END_LOOP", "TS804"),
        ("LOOP(3);F(1, 80);IF(DISTANCE < 10);S;ENDIF;END_LOOP", "TS805"),
        ("LOOP(3);B(0.5, 80);DISTANCE;IF(5 > DISTANCE);S;ENDIF;END_LOOP", "TS805"),
        ("X = 5", "TS806"),
        ("DEF A;S;END_DEF", "TS807"),
        ("SHOW(5 % (3 - 3))", "TS808"),
        ("IF(2147483 * 2 > DISTANCE);S;ENDIF", "TS808"),
        ("F(500, 50)", "TS811"),
        ("SPEED = 80;TIME_S = 2;F(SPEED, TIME_S)", "TS810"),
        ("VEL1 = 80;X = 2;F(VEL1, X)", "TS810"),
        ("X = 80;SEGUNDOS = 2;R(X, SEGUNDOS)", "TS810"),
        ("F(2, 80)//R(1, 60)", "TS816"),
        ("F(2, 80); // r(1,60); S", "TS816"),
        ("SI|F(2, 80);S // W(1) R(1, 60)", "TS816"),
        ("LOOP(2);F(2, 80);END_LOOP // R(1, 60)", "TS816"),
        ("X = MAX(1,\n2);SHOW(X) // R(1, 60)", "TS816"),
    ],
)  # fmt: skip
def test_advice(text: str, code: str) -> None:
    found = check_text(text, KIT)
    assert found.is_right
    assert [diagnostic.code.number for diagnostic in found.diagnostics] == [code]


@pytest.mark.parametrize(
    "text",
    [
        "LOOP(FOREVER);W(1);IF(DISTANCE < 5);BREAK;ENDIF;END_LOOP;S",
        "F(0, 80) UNTIL(DISTANCE < 5)",
        "LOOP(FOREVER);M(LIGHT_L / 10, LIGHT_R / 10);END_LOOP",
        "DEF A;W(1);END_DEF;LOOP(FOREVER);A;END_LOOP",
        "LOOP(3);F(0.4, 80);IF(DISTANCE < 10);S;ENDIF;END_LOOP",
        "LOOP(3);F(1, 80);IF(LIGHT_L < 10);S;ENDIF;END_LOOP",
        "LOOP(3);F(1, 80) UNTIL(DISTANCE < 10);IF(DISTANCE < 10);S;ENDIF;END_LOOP",
        "F(1, 80);IF(DISTANCE < 10);S;ENDIF",
        "X = 5;SHOW(X)",
        "N = 3;WHILE(N > 0);N = N - 1;END_WHILE",
        "X = 0;SHOW(X / X)",
        "SHOW(FALSE AND 1 / 0 > 2)",
        "F(2, 80) // turns right: R(1, 60)",
        "// R(1, 60)\nF(2, 80)",
        "F(2, // R(1, 60)\n80)",
        "F(2, 80) // S",
        "F(150, 50);F(180, 80)",
        "R(200, 50);F(499, 50)",
        "TIEMPO = 30;POTENCIA = 10;F(TIEMPO, POTENCIA)",
        "T = 30;P = 10;F(T, P)",
        "SECONDS = 20;SLOW = 10;F(SECONDS, SLOW)",
        "VELOCIDAD = 5;TIEMPO = 30;F(TIEMPO, VELOCIDAD)",
        "SPEED = 30;SLOW = 5;F(SPEED, SLOW)",
        "T1 = 30;T2 = 10;F(T1, T2)",
        "X = 30;Y = 10;F(X, Y)",
        "PING|check_connection // F(2,80)",
        "SI|// F(2, 80)\nS",
        "SI|; // F(2, 80)\nS",
        "SI|START // F(2, 80)\nS",
        "DEF A //F(1, 2)\nS;END_DEF;A",
        "LOOP(2); // F(1, 2)\nF(1, 50);END_LOOP",
        "IF(ABS(DISTANCE) <\n 5) // F(1, 2)\nS;ELSE // F(1, 50)\nW(1);ENDIF",
        "F(2, 80) // W(1), S",
        "F(2, 80) // R(1, 60)/S",
    ],
)
def test_no_advice(text: str) -> None:
    assert check_text(text, KIT).diagnostics == []


def test_advice_is_for_right_programs_alone() -> None:
    wrong = check_text("X = 5;S = 5", KIT)
    assert [diagnostic.is_mistake for diagnostic in wrong.diagnostics] == [True]
    assert wrong.program is not None
    assert advice(wrong.program, KIT)
