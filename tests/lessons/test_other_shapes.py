"""A program that does its task is right, whatever its shape; a memorized one is not.

The answers of the lessons are those that a teacher expects. These are pupils' own programs, written
from the page alone: correct ones of different shapes, memorized ones, copies from the page or with
the lesson's word as mere decoration, and wrong ones. The messages follow each program that does not
pass.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.support.lesson_findings import findings_of
from tests.support.texts import LANGUAGES
from tiniscript.lessons import catalogue
from tiniscript.lessons.catalogue import NUMBER_GAP
from tiniscript.lessons.lesson import Lesson
from tiniscript.lessons.markdown import blocks, printed_part
from tiniscript.lessons.sentences import sentence

FOLLOW_LINE = (
    "IF(LINE_L); M(5,40); ELSEIF(LINE_R); M(40,5); ELSE; M(35,35); ENDIF; W(0.02) UNTIL(BUTTON)"
)
RIGHT_ANSWERS = [
    (1, 1, "M(80,80)\nW(2.5)"),
    (1, 1, "f(2.5, 80)\nloop(forever); beep(0.5, 440); w(0.5); endloop"),  # the robot stays there
    (1, 1, "LOOP(FOREVER); F(0.5,80); IF(TIME >= 2.5); BREAK; ENDIF; END_LOOP"),
    (2, 1, "P = 80; LOOP(2); M(P, P); W(2.8); S; W(2); P = -P; END_LOOP"),
    (2, 1, "F(2.8,80); BEEP(2,440); R(0.83,60); F(2.8,80)"),
    (3, 1, "F(2.8,80); R(0.42,60); B(2.8,80); R(0.84,60)"),
    (4, 1, "DEF LADO; F(2.2,80); L(0.42,60); END_DEF; LOOP(2); LOOP(2); LADO; END_LOOP; END_LOOP"),
    (5, 1, "DEF PASO; M(-40,40); BEEP(0.3,440); M(40,-40); BEEP(0.3,660); END_DEF; LOOP(3); PASO; END_LOOP; S"),
    (6, 1, "LOOP(3); D = DISTANCE; SHOW(D); F(0.5,50); END_LOOP"),
    (6, 2, "SHOW(DISTANCE); F(1,60); LOOP(FOREVER); SHOW(ROUND(DISTANCE, 0)); W(1); END_LOOP"),
    (7, 1, "LOOP(FOREVER); F(FOREVER, 60) UNTIL(DISTANCE < 15); W(1); END_LOOP"),
    (7, 2, "WHILE(DISTANCE > 16); F(0.2,40) UNTIL(DISTANCE < 16); END_WHILE"),
    (8, 1, "F(2.6,60); L(0.42,60); A = DISTANCE; R(0.83,60); IF(A > DISTANCE); L(0.83,60); ENDIF; F(2.4,60)"),
    (8, 2, "F(2.6,60); L(0.42,60); IF(DISTANCE > 60); ELSE; R(0.833,60); ENDIF; F(2.4,60)"),
    (9, 1, "LOOP(FOREVER); IF(DISTANCE > 30); M(60,60); W(0.05); ELSE; S; L(0.833,60); ENDIF; END_LOOP"),
    (10, 1, "LOOP(FOREVER); GIRO = (LIGHT_L - LIGHT_R) / 10; M(40 - GIRO, 40 + GIRO); W(0.1); END_LOOP"),
    (10, 2, "LOOP(60); IF(LIGHT_L > LIGHT_R); L(0.05,50); ELSE; R(0.05,50); ENDIF; F(0.2,60); END_LOOP"),
    (10, 3, "LOOP(250); IF(LIGHT_L > LIGHT_R + 5); M(20,45); ELSEIF(LIGHT_R > LIGHT_L + 5); M(45,20); ELSE; M(40,40); ENDIF; W(0.05); END_LOOP"),
    (10, 4, "LOOP(40); L(1,30) UNTIL(LIGHT_L <= LIGHT_R); R(1,30) UNTIL(LIGHT_R <= LIGHT_L); F(0.3,50); END_LOOP"),
    (11, 1, "DEF PARADERO; F(0.4,40); F(FOREVER,40) UNTIL(LINE_L); BEEP(1,440); END_DEF; LOOP(3); PARADERO; END_LOOP; LOOP(FOREVER); W(1); END_LOOP"),
    (12, 1, f"DEF SIGUE; {FOLLOW_LINE}; END_DEF; WHILE(NOT BUTTON); SIGUE; END_WHILE; S; T = TIME; BEEP(1,880); SHOW(T)"),
    (12, 2, f"DEF SIGUE; {FOLLOW_LINE}; END_DEF; WHILE(NOT BUTTON); SIGUE; END_WHILE; SHOW(ROUND(TIME,0))"),
]  # fmt: skip
MEMORIZED_ANSWERS = [
    (6, 1, "F(1, 60); LOOP(3); SHOW(80); END_LOOP"),
    (7, 2, "LOOP(3); F(1, 60) UNTIL(DISTANCE < 1); END_LOOP"),
    (8, 2, "F(2.6,60); L(0.42,60); IF(TRUE); F(2.4,60); ENDIF"),
    (9, 1, "LOOP(5); F(3,60); R(0.833,60); END_LOOP"),
    (10, 2, "X = LIGHT_L - LIGHT_R; L(0.1, 60); F(6, 60)"),
    (11, 2, "LOOP(3); F(2.9,40); BEEP(0.2,440); W(1); END_LOOP"),
    (12, 1, f"DEF SIGUE; {FOLLOW_LINE}; END_DEF; WHILE(NOT BUTTON); SIGUE; END_WHILE; S; SHOW(16)"),
]  # fmt: skip
PROGRAMS: dict[int, dict[str, dict[str, str]]] = {
    1: {
        "right": {
            "M(80, 80); W(2.5); S": "",
            "LOOP(5); F(0.5, 80); END_LOOP": "",
            "F(1, 80); W(1); F(1.5, 80)": "",
            "SI|F(2.2, 80)": "",
            "SI|F(2.95, 80)": "",
            "F(2.9, 80); B(0.3, 80)": "",
            "R(0.83, 60); B(2.5, 80)": "",
        },
        "wrong": {
            "SI|B(2.5, 80)": "The robot touched the edge of the floor after 0.6 s",
            "SI|M(80, 80)": "here it ended before the robot could move",
        },
    },
    2: {
        "right": {
            "F(2.78, 80); W(3); R(0.84, 60); F(2.78, 80)": "",
            "M(80, 80); W(2.78); S; W(2); M(-80, -80); W(2.78); S": "",
            "F(2.78, 80); W(1); W(1); B(2.78, 80)": "",
            "DEF WAY; F(2.78, 80); END_DEF; WAY; W(2); B(2.78, 80)": "",
        },
        "wrong": {
            "F(2.78, 80); W(2); B(2.78, 100)": "The robot touched the edge of the floor after 7.5 s",
        },
    },
    3: {
        "right": {
            "M(60, 60); W(3.7); M(-60, 60); W(0.417); M(60, 60); W(3.7); S": "",
            "F(3.7, 60); LOOP(3); R(0.417, 60); END_LOOP; F(3.7, 60)": "",
            "F(2.78, 80); L(0.42, 60); F(2.78, 80); W(1)": "",
            "DEF CORNER; L(0.833, 30); END_DEF; F(3.7, 60); CORNER; F(3.7, 60)": "",
        },
        "rote": {
            "SI|L(0.3, 60)": "The robot only turned on the spot. To go forward, use F: F(2, 80)",
            "F(2.78, 80); W(2); B(2.78, 80)": "At the end the robot was 141 cm from the school",
        },
        "wrong": {
            "F(3.7, 60); L(0.42, 60); F(3.7, 60); L(0.42, 60)": "At the end the robot was facing 91 degrees too far to the left",
            "F(3.7, 60); L(0.42, 60)": "At the end the robot was 100 cm from the school",
        },
    },
    4: {
        "right": {
            "L(0.417, 60); LOOP(4); F(2.96, 60); R(0.417, 60); END_LOOP": "",
            "DEF SIDE; F(2.22, 80); L(0.417, 60); END_DEF; LOOP(4); SIDE; END_LOOP": "",
            "LOOP(4); M(60, 60); W(2.96); M(-60, 60); W(0.417); END_LOOP; S": "",
            "LOOP(4); F(2.96, 60); W(1); L(0.417, 60); W(1); END_LOOP": "",
            "LOOP(4); F(2.96, 60); LOOP(3); R(0.417, 60); END_LOOP; END_LOOP": "",
            "N = 0; LOOP(4); N = N + 1; SHOW(N); F(2.96, 60); L(0.417, 60); END_LOOP": "",
            "R(0.833, 60); LOOP(4); B(2.96, 60); L(0.417, 60); END_LOOP": "",
        },
        "rote": {
            "LOOP(4); BEEP(0.1, 440); END_LOOP; F(2.96, 60); L(0.417, 60); F(2.96, 60); L(0.417, 60); F(2.96, 60); L(0.417, 60); F(2.96, 60)": "The program has 4 moves forward or back, but needs only 1",
        },
        "wrong": {
            "LOOP(4); F(3.6, 60); L(0.417, 60); END_LOOP": "The robot went 17 cm past corner 1 before it stopped or turned",
        },
    },
    5: {
        "right": {
            "DEF HOP; F(0.2, 60); B(0.2, 60); BEEP(0.2, 440); END_DEF; DEF TURN; R(0.2, 60); BEEP(0.2, 880); END_DEF; LOOP(3); HOP; TURN; END_LOOP": "",
            "DEF STEP; BEEP(0.2, 440); L(0.4, 60); BEEP(0.2, 660); END_DEF; STEP; STEP; STEP": "",
            "DEF SPIN; M(50, -50); BEEP(0.3, 700); W(0.5); S; BEEP(0.3, 500); END_DEF; LOOP(4); SPIN; END_LOOP": "",
            "DEF LOW; BEEP(0.1, 300); END_DEF; DEF HIGH; BEEP(0.1, 900); END_DEF; DEF SWING; L(0.2, 50); LOW; R(0.2, 50); HIGH; END_DEF; SWING; SWING; SWING": "",
            "DEF HOP; F(0.4, 60); BEEP(0.1, 440); END_DEF; DEF TURN; R(0.417, 60); BEEP(0.1, 880); END_DEF; LOOP(3); HOP; HOP; HOP; TURN; END_LOOP": "",
            "DEF DIAG; L(0.2, 60); F(1.8, 60); B(1.8, 60); R(0.2, 60); BEEP(0.2, 440); BEEP(0.2, 880); END_DEF; LOOP(3); DIAG; END_LOOP": "",
        },
        "rote": {
            "DEF HOP; W(0.1); END_DEF; HOP; HOP; HOP; LOOP(3); F(0.2, 60); BEEP(0.2, 440); B(0.2, 60); BEEP(0.2, 880); END_LOOP": "The program solves the task just as well without the word HOP",
        },
        "wrong": {
            "DEF HOP; F(0.2, 60); B(0.2, 60); L(0.2, 60); R(0.2, 60); L(0.2, 60); BEEP(0.2, 440); BEEP(0.2, 880); END_DEF; LOOP(4); HOP; END_LOOP": "The program has 5 moves, but needs only 4",
            "DEF HOP; F(0.2, 60); B(0.2, 60); END_DEF; HOP; HOP; HOP; HOP": "The robot did not beep. Add a sound: BEEP(0.2, 440)",
        },
    },
    6: {
        "right": {
            "LOOP(3); SHOW(DISTANCE); F(0.8, 60); END_LOOP; SHOW(DISTANCE)": "",
            "SHOW(DISTANCE); F(0.8, 60); SHOW(DISTANCE); B(0.2, 60); SHOW(DISTANCE)": "",
            "LOOP(4); D = DISTANCE; SHOW(D); F(0.4, 60); END_LOOP; SHOW(DISTANCE)": "",
            "SHOW(DISTANCE); F(FOREVER, 40) UNTIL(DISTANCE < 20); SHOW(DISTANCE); B(0.5, 40); SHOW(DISTANCE)": "",
            "SHOW(DISTANCE); SHOW(DISTANCE); F(1, 60); SHOW(DISTANCE)": "",
        },
        "wrong": {
            "SHOW(DISTANCE); F(6, 60); SHOW(DISTANCE); SHOW(DISTANCE)": "The robot touched the wall after 3.1 s",
            "SHOW(DISTANCE); F(0.3, 60); SHOW(DISTANCE); F(0.3, 60); SHOW(DISTANCE)": "The robot drove 16 cm; the task asks for at least 20 cm",
            "SHOW(DISTANCE); SHOW(DISTANCE); SHOW(DISTANCE); F(1, 60)": "After it stops, the robot should show a value, but does not",
        },
    },
    7: {
        "right": {
            "M(40, 40); W(FOREVER) UNTIL(DISTANCE < 12); S": "",
            "F(FOREVER, 80) UNTIL(DISTANCE < 50); F(FOREVER, 20) UNTIL(DISTANCE < 10)": "",
            "NEAR = 14; F(20, 50) UNTIL(NOT (DISTANCE > NEAR))": "",
            "LOOP(FOREVER); F(0.5, 30) UNTIL(DISTANCE < 15); IF(DISTANCE < 15); BREAK; ENDIF; END_LOOP": "",
            "F(10, 60) UNTIL(DISTANCE <= 17)": "",
            "F(FOREVER, 60) UNTIL(DISTANCE < 18); BEEP(0.2, 440)": "",
        },
        "rote": {
            "SI|L(0.42, 60); F(1.05, 60); W(1) UNTIL(TRUE)": "At the end the robot was not in front of the wall",
        },
    },
    8: {
        "right": {
            "F(2.59, 60); R(0.417, 60); IF(DISTANCE < 60); L(0.833, 60); END_IF; F(2.4, 60)": "",
            "F(1.94, 80); L(0.417, 60); IF(DISTANCE > 60); F(1.8, 80); ELSE; R(0.833, 60); F(1.8, 80); END_IF": "",
            "F(2.59, 60); L(0.417, 60); IF(DISTANCE < 60); B(2.4, 60); ELSE; F(2.4, 60); END_IF": "",
            "F(2.59, 60); R(0.417, 60); SEEN = DISTANCE; L(0.417, 60); IF(SEEN < 60); L(0.417, 60); ELSE; R(0.417, 60); END_IF; F(2.4, 60)": "",
        },
        "rote": {
            "SI|IF(DISTANCE < 30); BEEP(0.3, 220); ELSE; BEEP(0.3, 880); ENDIF": "The robot did not move. Add a move with a time and a power: F(2, 80)",
        },
        "wrong": {
            "F(2.59, 60); R(0.417, 60); IF(DISTANCE < 60); L(0.833, 60); END_IF; F(1, 60)": "At the end the robot was 38 cm from the exit",
        },
    },
    9: {
        "right": {
            "LOOP(FOREVER); F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.83, 60); END_LOOP": "",
            "LOOP(FOREVER); F(FOREVER, 60) UNTIL(DISTANCE < 48); R(0.833, 60); END_LOOP": "",
            "LOOP(3); F(20, 60) UNTIL(DISTANCE < 30); L(0.833, 60); END_LOOP": "",
            "LOOP(FOREVER); M(60, 60); W(FOREVER) UNTIL(DISTANCE < 30); M(-60, 60); W(0.833); END_LOOP": "",
            "LOOP(FOREVER); F(0.1, 60); IF(DISTANCE < 25); R(0.833, 60); ENDIF; END_LOOP": "",
            "DEF PATROL; F(FOREVER, 60) UNTIL(DISTANCE < 20); R(0.42, 60); R(0.42, 60); END_DEF; LOOP(5); PATROL; END_LOOP": "",
        },
        "rote": {
            "F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60); F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60); F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60)": "The program does not use LOOP. Use it here: LOOP(3) ... END_LOOP",
            "LOOP(2); BEEP(0.1, 440); END_LOOP; F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60); F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60); F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60)": "The program solves the task just as well if each LOOP runs only once.",
            "LOOP(1); F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60); F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60); F(FOREVER, 60) UNTIL(DISTANCE < 25); R(0.833, 60); END_LOOP": "The program's LOOP repeats nothing.",
        },
    },
    10: {
        "right": {
            "LOOP(FOREVER); DIFFERENCE = (LIGHT_L - LIGHT_R) / 10; M(35 - DIFFERENCE, 35 + DIFFERENCE); W(0.05); END_LOOP": "",
            "LOOP(FOREVER); IF(LIGHT_L > LIGHT_R + 2); L(0.05, 40); ENDIF; IF(LIGHT_R > LIGHT_L + 2); R(0.05, 40); ENDIF; F(0.2, 60); END_LOOP": "",
            "LOOP(FOREVER); IF(LIGHT_L > LIGHT_R); M(10, 50); ELSE; M(50, 10); ENDIF; W(0.05); END_LOOP": "",
            "LOOP(400); TURN = LIGHT_L - LIGHT_R; M(40 - TURN / 5, 40 + TURN / 5); W(0.05); END_LOOP; S": "",
            "WHILE(LIGHT_L + LIGHT_R < 1800); D = LIGHT_L - LIGHT_R; M(40 - D / 4, 40 + D / 4); W(0.02); END_WHILE; S": "",
        },
        "rote": {
            "SI|LOOP(100); DIFFERENCE = (LIGHT_L - LIGHT_R) / 10; M(35 - DIFFERENCE, 35 + DIFFERENCE); W(0.05); END_LOOP": "The program ended while the lamp was still 53 cm away",
        },
        "wrong": {
            "DIFFERENCE = (LIGHT_L - LIGHT_R) / 10; M(35 - DIFFERENCE, 35 + DIFFERENCE)": "here it ended before the robot could move",
            "LOOP(FOREVER); D = (LIGHT_L - LIGHT_R) / 10; M(8 - D, 8 + D); W(0.05); END_LOOP": "When time ran out after 25.0 s, the robot was still 43 cm from the lamp",
        },
    },
    11: {
        "right": {
            "LOOP(3); F(FOREVER, 40) UNTIL(NOT LINE_L AND NOT LINE_R); F(FOREVER, 40) UNTIL(LINE_L OR LINE_R); BEEP(0.2, 440); W(1); END_LOOP": "",
            "DEF NEXT_STOP; F(FOREVER, 40) UNTIL(LINE_L OR LINE_R); BEEP(0.2, 440); W(1); END_DEF; NEXT_STOP; F(0.3, 40); NEXT_STOP; F(0.3, 40); NEXT_STOP": "",
            "LOOP(3); M(40, 40); W(0.3); W(FOREVER) UNTIL(LINE_L OR LINE_R); S; BEEP(1, 660); W(1); END_LOOP": "",
            "LOOP(3); F(0.3, 30); F(FOREVER, 30) UNTIL(LINE_R); W(1.5); BEEP(0.5, 880); END_LOOP": "",
        },
        "wrong": {
            "LOOP(3); F(FOREVER, 40) UNTIL(LINE_L OR LINE_R); BEEP(0.2, 440); W(1); F(1, 40); END_LOOP": "The robot went 15 cm past the middle of the third stop",
        },
    },
    12: {
        "right": {
            "DEF FINISH; S; SHOW(TIME); END_DEF; WHILE(NOT BUTTON); M(30, 30); IF(LINE_L); M(0, 35); ENDIF; IF(LINE_R); M(35, 0); ENDIF; W(0.02); END_WHILE; FINISH": "",
            "DEF STRAIGHT; M(35, 35); W(FOREVER) UNTIL(LINE_L OR LINE_R OR BUTTON); END_DEF; DEF TO_LEFT; M(5, 40); W(FOREVER) UNTIL(NOT LINE_L OR BUTTON); END_DEF; DEF TO_RIGHT; M(40, 5); W(FOREVER) UNTIL(NOT LINE_R OR BUTTON); END_DEF; WHILE(NOT BUTTON); STRAIGHT; IF(LINE_L); TO_LEFT; ENDIF; IF(LINE_R); TO_RIGHT; ENDIF; END_WHILE; S; SHOW(TIME)": "",
            "DEF STEP; M(30, 30); IF(LINE_L); M(0, 35); ENDIF; IF(LINE_R); M(35, 0); ENDIF; W(0.02) UNTIL(BUTTON); END_DEF; LOOP(FOREVER); STEP; IF(BUTTON); BREAK; ENDIF; END_LOOP; S; SHOW(TIME)": "",
            "DEF STRAIGHT; M(35, 35); W(FOREVER) UNTIL(LINE_L OR LINE_R OR BUTTON); END_DEF; DEF TO_LEFT; M(5, 40); W(FOREVER) UNTIL(NOT LINE_L OR BUTTON); END_DEF; DEF TO_RIGHT; M(40, 5); W(FOREVER) UNTIL(NOT LINE_R OR BUTTON); END_DEF; LOOP(FOREVER); STRAIGHT; TO_LEFT; TO_RIGHT; IF(BUTTON); BREAK; ENDIF; END_LOOP; S; SHOW(TIME)": "",
        },
        "rote": {
            "DEF STRAIGHT; M(35, 35); W(FOREVER) UNTIL(LINE_L OR LINE_R OR BUTTON); END_DEF; STRAIGHT; S": "Is the condition of UNTIL TRUE from the start?",
            "DEF HOP; W(0.1) UNTIL(TRUE); END_DEF; HOP; WHILE(NOT BUTTON); M(30, 30); IF(LINE_L); M(0, 35); ENDIF; IF(LINE_R); M(35, 0); ENDIF; W(0.02); END_WHILE; S; SHOW(TIME)": "The program solves the task just as well without the word HOP",
        },
        "wrong": {
            "DEF STRAIGHT; M(35, 35); W(FOREVER) UNTIL(LINE_L OR LINE_R OR BUTTON); END_DEF; DEF TO_LEFT; M(5, 40); W(FOREVER) UNTIL(NOT LINE_L OR BUTTON); END_DEF; DEF TO_RIGHT; M(40, 5); W(FOREVER) UNTIL(NOT LINE_R OR BUTTON); END_DEF; WHILE(NOT BUTTON); STRAIGHT; IF(LINE_L); TO_LEFT; ENDIF; IF(LINE_R); TO_RIGHT; ENDIF; END_WHILE; S": "The robot showed nothing. Write what it should show: SHOW(TIME)",
            "DEF STRAIGHT; M(35, 35); W(FOREVER) UNTIL(LINE_L OR LINE_R OR BUTTON); END_DEF; DEF TO_LEFT; M(5, 40); W(FOREVER) UNTIL(NOT LINE_L OR BUTTON); END_DEF; DEF TO_RIGHT; M(40, 5); W(FOREVER) UNTIL(NOT LINE_R OR BUTTON); END_DEF; LOOP(FOREVER); STRAIGHT; TO_LEFT; TO_RIGHT; END_LOOP; SHOW(TIME)": "s the robot ran more than 200000 instructions without a pause. Put W(0.05) into the loop.",
            "SHOW(TIME); DEF STRAIGHT; M(35, 35); W(FOREVER) UNTIL(LINE_L OR LINE_R OR BUTTON); END_DEF; DEF TO_LEFT; M(5, 40); W(FOREVER) UNTIL(NOT LINE_L OR BUTTON); END_DEF; DEF TO_RIGHT; M(40, 5); W(FOREVER) UNTIL(NOT LINE_R OR BUTTON); END_DEF; WHILE(NOT BUTTON); STRAIGHT; IF(LINE_L); TO_LEFT; ENDIF; IF(LINE_R); TO_RIGHT; ENDIF; END_WHILE; S": "After it stops, the robot should show a value, but does not",
            "DEF WIG; L(0.05, 20); R(0.05, 20); END_DEF; LOOP(FOREVER); WIG; END_LOOP": "In 60.0 s the robot followed only 10 cm of the black line; the task asks for 240 cm",
        },
    },
    13: {
        "right": {
            "SI|F(FOREVER, 60)\nWHEN(DISTANCE < 30); B(0.3, 60); L(0.4, 60); END_WHEN": "",
            "SI|LOOP(FOREVER); M(50, 40); W(1); M(40, 50); W(1); END_LOOP\nWHEN(DISTANCE < 35); M(-50, 50); W(0.3); END_WHEN": "",
            "SI|LOOP(FOREVER); M(60, 60); W(0.5); END_LOOP\nWHEN(DISTANCE < 35); R(0.2, 60); END_WHEN\nTASK; LOOP(FOREVER); BEEP(0.1, 440); W(2); END_LOOP; END_TASK": "",
        },
        "wrong": {
            "SI|W(1)\nWHEN(DISTANCE < 30); B(0.4, 60); R(0.5, 60); END_WHEN": "The robot did not move. Does the condition of WHEN ever become TRUE? See what the robot reads: SHOW(DISTANCE)",
        },
    },
    14: {
        "right": {
            "SI|F(3, 100); L(0.31, 100); F(2, 100)\nTASK; LOOP(FOREVER); LED(TRUE); W(0.1); LED(FALSE); W(0.1); END_LOOP; END_TASK": "",
            "SI|TASK\nLOOP(20); LED(TRUE); W(0.25); LED(FALSE); W(0.25); END_LOOP\nEND_TASK\nM(60, 60); W(5); L(0.51, 60); M(60, 60); W(3.33); S": "",
            "SI|DEF BLINK; LED(TRUE); W(0.2); LED(FALSE); W(0.2); END_DEF\nTASK; LOOP(22); BLINK; END_LOOP; END_TASK\nF(5, 60); L(0.51, 60); F(3.33, 60)": "",
        },
        "rote": {
            "SI|LOOP(3)\n  LED(TRUE); W(0.3)\n  LED(FALSE); W(0.3)\nEND_LOOP\nF(1, 60)": "The robot stopped 125 cm before the middle of the hospital. Make it drive further.",
            "SI|LOOP(13); LED(TRUE); M(60, 60); W(0.2); LED(FALSE); W(0.19); END_LOOP; S; L(0.51, 60); LOOP(9); LED(TRUE); M(60, 60); W(0.2); LED(FALSE); W(0.17); END_LOOP; S\nTASK; BEEP(0.1, 440); END_TASK": "The program solves the task just as well without the TASK. Use TASK for a part of the task.",
        },
        "wrong": {
            "SI|F(4, 60); L(0.51, 60); F(2, 60)\nTASK; LOOP(12); LED(TRUE); W(0.2); LED(FALSE); W(0.2); END_LOOP; END_TASK": "The robot stopped 40 cm before the middle of the hospital. Make it drive further.",
        },
    },
    15: {
        "right": {
            "SI|L(90°, 80); LOOP(4); F(30CM, 80); R(90°, 80); END_LOOP": "",
            "LADO = 15; LOOP(4); F(LADO + LADO CM, 50); L(90 DEG, 50); END_LOOP": "",
            "DEF SIDE; F(30 cm, 100); L(45 DEG, 60); L(45 DEG, 60); END_DEF; SIDE; SIDE; SIDE; SIDE": "",
        },
        "rote": {
            "SI|F(20 CM, 40)\nW(1)\nF(20 CM, 80)": "The program ended before the robot got to corner 2 of 3",
            "L(90 DEG, 60); R(45 DEG, 60)": "The robot only turned on the spot",
        },
        "wrong": {
            "LOOP(3); F(30 CM, 60); L(90 DEG, 60); END_LOOP": "At the end the robot was 30 cm from its place",
            "LOOP(4); F(30 CM, 60); L(0.42, 60); END_LOOP": "The program does not use DEG",
        },
    },
    16: {
        "right": {
            "SHOW(DISTANCE); WAY = DISTANCE - 20; F(WAY CM, 80); SHOW(DISTANCE)": "",
            "SI|D = DISTANCE; SHOW(D); LOOP(4); F((D - 20) / 4 CM, 60); SHOW(DISTANCE); END_LOOP": "",
            "D = DISTANCE; SHOW(D); F(D - 5 CM, 60) UNTIL(DISTANCE < 20); SHOW(DISTANCE)": "",
        },
        "rote": {
            "SI|SHOW(DISTANCE)": "The robot did not move",
            "X = 10; F(X + 5 CM, 60)": "The robot showed nothing",
        },
        "wrong": {
            "D = DISTANCE; F(D - 20 CM, 60); SHOW(D); SHOW(D)": "The robot showed 81.4, but at that moment DISTANCE was about 20",
        },
    },
    17: {
        "right": {
            "DEF Q(N); LOOP(4); F(N CM, 60); L(90 DEG, 60); END_LOOP; END_DEF; Q(20); Q(30); Q(40)": "",
            "SI|DEF C(N, P); LOOP(4); F(N cm, P); L(90°, 40); END_LOOP; END_DEF; C(20, 40); C(20 * 1.5, 60); C(40, 80)": "",
            "DEF LADO(N); F(N CM, 60); L(90 DEG, 60); END_DEF; DEF C(K); LOOP(4); LADO(K * 10); END_LOOP; END_DEF; D = 2; WHILE(D <= 4); C(D); D = D + 1; END_WHILE": "",
        },
        "rote": {
            "SI|F(20 CM, 60)": "The program ended before the robot got to corner 2 of 11",
        },
        "wrong": {
            "DEF Q(N); LOOP(4); F(N CM, 60); R(90 DEG, 60); END_LOOP; END_DEF; Q(20); Q(30); Q(40)": "The robot touched the wall",
            "DEF Q(N); LOOP(3); F(N CM, 60); L(90 DEG, 60); END_LOOP; END_DEF; Q(20); Q(30); Q(40)": "20 cm past corner 5",
        },
    },
    18: {
        "right": {
            "WHILE(TRUE); M(0, 0); W(0.05); WHILE(KEY_UP); M(80, 80); W(0.02); END_WHILE; WHILE(KEY_DOWN); M(-80, -80); W(0.02); END_WHILE; WHILE(KEY_LEFT); M(-30, 30); W(0.02); END_WHILE; WHILE(KEY_RIGHT); M(30, -30); W(0.02); END_WHILE; IF(KEY_A); BEEP(0.1, 880); END_IF; END_WHILE": "",
            "DEF T(X, Y); M(X, Y); W(0.1); M(0, 0); END_DEF; LOOP(FOREVER); IF(KEY_UP); T(50, 50); END_IF; IF(KEY_DOWN); T(-50, -50); END_IF; IF(KEY_LEFT); T(-50, 50); END_IF; IF(KEY_RIGHT); T(50, -50); END_IF; IF(KEY_A); BEEP(0.2, 440); END_IF; W(0.02); END_LOOP": "",
        },
        "rote": {
            "SI|W(1); F(1.5, 60); W(1); R(1, 40); W(1); F(1, 60); W(1); B(1, 60); W(1); BEEP(0.5, 440); W(1); L(0.5, 40)": "KEY_LEFT was held down, but the robot did not turn to the left",
        },
        "wrong": {
            "W(FOREVER) UNTIL(KEY_UP); F(5, 60)": "no key was held down, but the robot was still moving. Make",
            "W(FOREVER) UNTIL(KEY_UP); F(1, 60); W(FOREVER) UNTIL(KEY_DOWN); B(1, 60)": "KEY_RIGHT was held down, but the robot did not turn to the right",
        },
    },
}  # fmt: skip
ALL_WRONG_ANSWERS = [
    pytest.param(number, program, expected_cause, id=f"{number}-{group}-{k}")
    for number, groups in PROGRAMS.items()
    for group, programs in groups.items()
    for k, (program, expected_cause) in enumerate(programs.items(), 1)
]


def is_right(number: int, seed: int, program: str) -> bool:
    return findings_of(program, lesson_of(number), range(seed, seed + 1)) == []


def lesson_of(number: int) -> Lesson:
    return catalogue.load(catalogue.folders()[number - 1])


def test_every_lesson_has_pupils_programs() -> None:
    assert [*PROGRAMS] == [*range(1, len(catalogue.folders()) + 1)]
    assert all(groups.get("right") for groups in PROGRAMS.values())


@pytest.mark.sampled("number", "program", "expected_cause", keep=len(ALL_WRONG_ANSWERS) // 8)
@pytest.mark.parametrize(("number", "program", "expected_cause"), ALL_WRONG_ANSWERS)
def test_pupils_programs_are_marked_fairly(number: int, program: str, expected_cause: str) -> None:
    """In all worlds of the task: right programs get no finding, and others the right cause."""
    lesson = lesson_of(number)
    findings = findings_of(program.replace("; ", "\n"), lesson, range(1, lesson.world_count + 1))
    assert bool(findings) is bool(expected_cause)
    if expected_cause:
        assert expected_cause in sentence(findings[0], "en")


@pytest.mark.sampled("number", "seed", "program", keep=len(RIGHT_ANSWERS) // 16)
@pytest.mark.parametrize(("number", "seed", "program"), RIGHT_ANSWERS)
def test_a_right_program_of_different_shape_passes(number: int, seed: int, program: str) -> None:
    assert is_right(number, seed, program)


@pytest.mark.parametrize(("number", "seed", "program"), MEMORIZED_ANSWERS)
def test_a_hard_coded_program_fails(number: int, seed: int, program: str) -> None:
    assert not is_right(number, seed, program)


@pytest.mark.parametrize(
    ("folder", "language"),
    [
        pytest.param(folder, language, id=f"{folder.name}-{language}")
        for folder in catalogue.folders()
        for language in LANGUAGES
        if language in ("en", "es") or (folder / f"pupil.{language}.md").is_file()
    ],
)
def test_a_task_states_the_measured_numbers(folder: Path, language: str) -> None:
    """Each has one home, the criterion: a page names it, and has no number of its own."""
    lesson = catalogue.load(folder)
    written_text = printed_part((folder / f"pupil.{language}.md").read_text(encoding="utf-8"))
    task = written_text.split("\n## ")[-2]
    assert "{seconds}" in task
    assert not re.search("[0-9]", re.sub(r"`[^`]*`", "", NUMBER_GAP.sub("", task))), task
    for criterion in lesson.criteria:  # one tolerance for all criteria of a place
        if "within_cm" in criterion.number_by_key and criterion.places and not criterion.area:
            names = {name for name in NUMBER_GAP.findall(task) if name.endswith(".within_cm")}
            tolerances = {criterion.number_by_key["within_cm"] for criterion in lesson.criteria for name in names
                          if name == f"{criterion.kind}.within_cm"}  # fmt: skip
            assert tolerances == {criterion.number_by_key["within_cm"]}, criterion.kind
    page = catalogue.page(folder, catalogue.PUPIL, language)
    assert "{" not in page
    assert f" {lesson.seconds:g} " in page
    assert len(blocks(page)) == len(blocks(written_text))
