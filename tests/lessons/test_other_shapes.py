"""A program that does its task is right, whatever its shape; one by heart is not.

The answers of the lessons are what a teacher expects. These are what pupils write instead.
"""

from __future__ import annotations

import pytest

from tests.lessons.test_lessons import findings_of
from tests.machines.wasm import missing
from tiniscript.lessons import catalogue

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is wasmtime")

FOLLOW = (
    "IF(LINE_L); M(5,40); ELSEIF(LINE_R); M(40,5); ELSE; M(35,35); ENDIF; W(0.02) UNTIL(BUTTON)"
)
RIGHT = [
    (1, 1, "M(80,80)\nW(2.5)"),
    (1, 1, "f(2.5, 80)\nloop(forever); beep(0.5, 440); w(0.5); endloop"),  # there it stays
    (1, 1, "LOOP(FOREVER); F(0.5,80); IF(TIME >= 2.5); BREAK; ENDIF; END_LOOP"),
    (2, 1, "P = 80; LOOP(2); M(P, P); W(2.8); S; W(2); P = -P; END_LOOP"),
    (2, 1, "F(2.8,80); BEEP(2,440); R(0.78,60); F(2.8,80)"),
    (3, 1, "F(2.8,80); R(0.39,60); B(2.8,80); R(0.79,60)"),
    (4, 1, "DEF LADO; F(2.2,80); L(0.39,60); END_DEF; LOOP(2); LOOP(2); LADO; END_LOOP; END_LOOP"),
    (5, 1, "DEF PASO; M(-40,40); BEEP(0.3,440); M(40,-40); BEEP(0.3,660); END_DEF; LOOP(3); PASO; END_LOOP; S"),
    (6, 1, "LOOP(3); D = DISTANCE; SHOW(D); F(0.5,50); END_LOOP"),
    (6, 2, "SHOW(DISTANCE); F(1,60); LOOP(FOREVER); SHOW(ROUND(DISTANCE, 0)); W(1); END_LOOP"),
    (7, 1, "LOOP(FOREVER); F(FOREVER, 60) UNTIL(DISTANCE < 15); W(1); END_LOOP"),
    (7, 2, "WHILE(DISTANCE > 16); F(0.2,40) UNTIL(DISTANCE < 16); END_WHILE"),
    (8, 1, "F(2.6,60); L(0.39,60); A = DISTANCE; R(0.78,60); IF(A > DISTANCE); L(0.78,60); ENDIF; F(2.4,60)"),
    (8, 2, "F(2.6,60); L(0.39,60); IF(DISTANCE > 60); ELSE; R(0.785,60); ENDIF; F(2.4,60)"),
    (9, 1, "LOOP(FOREVER); IF(DISTANCE > 30); M(60,60); W(0.05); ELSE; S; L(0.785,60); ENDIF; END_LOOP"),
    (10, 1, "LOOP(FOREVER); GIRO = (LIGHT_L - LIGHT_R) / 10; M(40 - GIRO, 40 + GIRO); W(0.1); END_LOOP"),
    (10, 2, "LOOP(60); IF(LIGHT_L > LIGHT_R); L(0.05,50); ELSE; R(0.05,50); ENDIF; F(0.2,60); END_LOOP"),
    (10, 3, "LOOP(250); IF(LIGHT_L > LIGHT_R + 5); M(20,45); ELSEIF(LIGHT_R > LIGHT_L + 5); M(45,20); ELSE; M(40,40); ENDIF; W(0.05); END_LOOP"),
    (10, 4, "LOOP(40); L(1,30) UNTIL(LIGHT_L <= LIGHT_R); R(1,30) UNTIL(LIGHT_R <= LIGHT_L); F(0.3,50); END_LOOP"),
    (11, 1, "DEF PARADERO; F(0.4,40); F(FOREVER,40) UNTIL(LINE_L); BEEP(1,440); END_DEF; LOOP(3); PARADERO; END_LOOP; LOOP(FOREVER); W(1); END_LOOP"),
    (12, 1, f"DEF SIGUE; {FOLLOW}; END_DEF; WHILE(NOT BUTTON); SIGUE; END_WHILE; S; T = TIME; BEEP(1,880); SHOW(T)"),
    (12, 2, f"DEF SIGUE; {FOLLOW}; END_DEF; WHILE(NOT BUTTON); SIGUE; END_WHILE; SHOW(ROUND(TIME,0))"),
]  # fmt: skip
BY_HEART = [
    (6, 1, "F(1, 60); LOOP(3); SHOW(80); END_LOOP"),
    (7, 2, "LOOP(3); F(1, 60) UNTIL(DISTANCE < 1); END_LOOP"),
    (8, 2, "F(2.6,60); L(0.39,60); IF(TRUE); F(2.4,60); ENDIF"),
    (9, 1, "LOOP(5); F(3,60); R(0.785,60); END_LOOP"),
    (10, 2, "X = LIGHT_L - LIGHT_R; L(0.1, 60); F(6, 60)"),
    (11, 2, "LOOP(3); F(2.9,40); BEEP(0.2,440); W(1); END_LOOP"),
    (12, 1, f"DEF SIGUE; {FOLLOW}; END_DEF; WHILE(NOT BUTTON); SIGUE; END_WHILE; S; SHOW(16)"),
]  # fmt: skip


def is_right(number: int, seed: int, program: str) -> bool:
    lesson = catalogue.load(catalogue.folders()[number - 1])
    return findings_of(program, lesson, range(seed, seed + 1)) == []


@pytest.mark.parametrize(("number", "seed", "program"), RIGHT)
def test_a_right_program_of_another_shape_passes(number: int, seed: int, program: str) -> None:
    assert is_right(number, seed, program)


@pytest.mark.parametrize(("number", "seed", "program"), BY_HEART)
def test_a_program_by_heart_does_not(number: int, seed: int, program: str) -> None:
    assert not is_right(number, seed, program)
