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
        ("R(200, 50)", "TS811"),
        ("L(30, 60)", "TS811"),
        ("L(720, 60)", "TS811"),
        ("F(90, 60)", "TS811"),
        ("B(61, 60)", "TS811"),
        ("F(30, 60)", "TS811"),
        ("W(250)", "TS811"),
        ("BEEP(440, 80)", "TS811"),
        ("F(2, 5)", "TS820"),
        ("F(2, 0) UNTIL(DISTANCE < 9)", "TS820"),
        ("F(1, 80);IF(DISTANCE < 10);S;ENDIF", "TS821"),
        ("F(1, 80);SHOW(DISTANCE);IF(LIGHT_L < 10);BEEP(1, 440);STOP;ENDIF;R(1, 60)", "TS821"),
        ("LOOP(3);F(1, 80);IF(LIGHT_L < 10);S;ENDIF;END_LOOP", "TS821"),
        ("LOOP(FOREVER);IF(DISTANCE < 10);S;ENDIF;F(5, 60);END_LOOP", "TS821"),
        ("IF(DISTANCE < 10);S;ENDIF;F(5, 60)", "TS821"),
        ("D = DISTANCE;F(5, 60) UNTIL(D < 20)", "TS822"),
        ("X = 5;W(FOREVER) UNTIL(X > 5)", "TS822"),
        ("LOOP(3);D = DISTANCE;F(5, 60) UNTIL(D < 20);END_LOOP", "TS822"),
        ("D = DISTANCE;WHILE(D > 10);F(0.2, 60);END_WHILE", "TS823"),
        ("N = 0;WHILE(N < 3);F(0.2, 60);END_WHILE", "TS823"),
        ("N = 0;K = 0;DEF A;K = K + 1;END_DEF;WHILE(N < 3);A;W(1);END_WHILE;SHOW(K)", "TS823"),
        ("F(5, 60) UNTIL(DISTANCE > 20)", "TS824"),
        ("F(FOREVER, 60) UNTIL(20 <= DISTANCE)", "TS824"),
        ("F(5, 60) UNTIL(DISTANCE = 20)", "TS825"),
        ("IF(500 = LIGHT_L);S;ENDIF", "TS825"),
        ("M(80, 80)", "TS826"),
        ("M(80, 80);SHOW(1);S;W(1)", "TS826"),
        ("DEF A;M(80, 80);F(1, 60);END_DEF;A", "TS826"),
        ("M(80, 80);M(-80, -80);W(1)", "TS826"),
        ("WHILE(DISTANCE > 20);F(5, 60);END_WHILE", "TS805"),
        ("F(2, 80)//R(1, 60)", "TS816"),
        ("F(2, 80) // voy; W(2) // compro; B(2, 80) // regreso", "TS816"),
        ("F(2, 80) // voy; STOP", "TS816"),
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
        "LOOP(3);F(1, 80);IF(LIGHT_L < 10);S;BREAK;ENDIF;END_LOOP",
        "LOOP(3);F(1, 80) UNTIL(DISTANCE < 10);IF(DISTANCE < 10);S;ENDIF;END_LOOP",
        "F(0.4, 80);IF(DISTANCE < 10);S;ENDIF",
        "F(1, 80);IF(DISTANCE < 10);S;ELSE;F(1, 80);ENDIF",
        "F(1, 80);IF(DISTANCE < 10);S;R(1, 60);ENDIF",
        "M(50, 50);IF(DISTANCE < 10);S;ENDIF;F(1, 80)",
        "M(50, 50);W(1);IF(LIGHT_L < 10);S;ENDIF;F(1, 80)",
        "IF(DISTANCE < 10);S;ENDIF;L(1, 80)",
        "F(1, 80) UNTIL(LIGHT_L > 5);IF(DISTANCE < 10);S;ENDIF",
        "LOOP(FOREVER);IF(DISTANCE < 10);S;ELSE;F(1, 60);ENDIF;END_LOOP",
        "LOOP(3);D = DISTANCE;F(0.2, 60) UNTIL(D < 20);END_LOOP",
        "D = DISTANCE;F(5, 60) UNTIL(DISTANCE < D)",
        "T = TIME + 2;F(5, 60) UNTIL(TIME > T)",
        "ON = 1;WHILE(ON = 1);W(1);END_WHILE",
        "ON = TRUE;WHILE(ON);W(1);END_WHILE",
        "N = 0;WHILE(N < 3);W(1);BREAK;END_WHILE",
        "N = 0;DEF A;N = N + 1;END_DEF;DEF C;A;END_DEF;WHILE(N < 3);C;END_WHILE",
        "WHILE(DISTANCE > 20);F(0.5, 60);END_WHILE",
        "IF(DISTANCE < 20);F(5, 60) UNTIL(DISTANCE > 20);ENDIF",
        "B(5, 60) UNTIL(DISTANCE > 20)",
        "L(5, 60) UNTIL(DISTANCE > 20)",
        "W(FOREVER) UNTIL(DISTANCE > 20)",
        "F(5, 60) UNTIL(LIGHT_L > 500)",
        "W(5) UNTIL(LIGHT_L = 0)",
        "X = ROUND(DISTANCE, 0);IF(X = 20);S;ENDIF",
        "M(50, 80);W(2)",
        "M(0, 0)",
        "M(50, 50);F(1, 60) UNTIL(DISTANCE < 10)",
        "LOOP(FOREVER);M(50, 50);END_LOOP",
        "DEF A;M(50, 50);END_DEF;A;W(1)",
        "IF(DISTANCE < 9);M(50, 50);ENDIF;W(1)",
        "M(50, 50);BEEP(1, 440);S",
        "F(2, 10)",
        "P = 0;F(2, P)",
        "F(25, 60);L(29, 60);W(90);W(120);F(33, 60)",
        "F(90, 60) UNTIL(DISTANCE < 10)",
        "X = 5;SHOW(X)",
        "N = 3;WHILE(N > 0);N = N - 1;END_WHILE",
        "X = 0;SHOW(X / X)",
        "SHOW(FALSE AND 1 / 0 > 2)",
        "F(2, 80) // turns right: R(1, 60)",
        "// R(1, 60)\nF(2, 80)",
        "F(2, // R(1, 60)\n80)",
        "F(2, 80) // S",
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
    assert advice(wrong.program, KIT, wrong.source)
