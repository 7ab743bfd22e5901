"""Actions or readings that happen once, or alone, where the author meant more.

A key of the remote control that is read only once, and a TASK that has no other task.
"""

from __future__ import annotations

import re

import pytest

from tests.pupils.corpus import check
from tests.support.casefile import ROOT
from tiniscript import check_text, robots
from tiniscript.base.kit import REMOTE
from tiniscript.base.source import apply_edits
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic

KIT = robots.load("tinibot").kit
QUESTIONS = [
    device.name if device.is_yes_no else f"{device.name} > 20" for device in REMOTE
] + ["NOT KEY_A", "DISTANCE < 9 OR KEY_B"]  # fmt: skip
SURROUNDINGS = [
    "{}", "SI|{}", "SI|F(1, 60);{};S", "SI|W(2)\n{}\nS", "IF(DISTANCE < 9);{};ENDIF",
    "IF(DISTANCE < 9);S;ELSE;W(1);{};ENDIF", "SI|TASK;{};END_TASK;F(9, 60)",
    "W(FOREVER) UNTIL(DISTANCE < 9);{}", "LOOP(3);F(1, 60);END_LOOP;{}",
    "WHEN(KEY_LEFT);L(1, 60);END_WHEN;{}",
]  # fmt: skip
READ = ["IF({q});F(1, 60);ENDIF", "IF(DISTANCE < 5);S;W(1);ELSEIF({q});F(1, 60);ENDIF"]
VALUES = ["F(2, {v})", "M({v}, {v});W(1)", "SHOW({v})", "X = {v};SHOW(X)", "LOOP({v});S;END_LOOP",
          "W({v});S", "DEF A(N);W(N);END_DEF;A({v})"]  # fmt: skip
REPEATED = [
    "LOOP(FOREVER);{};W(0.1);END_LOOP", "WHILE(DISTANCE > 9);{};W(1);END_WHILE",
    "WHEN(DISTANCE < 9);{};END_WHEN", "DEF A;{};END_DEF;LOOP(FOREVER);A;W(1);END_LOOP",
    "TASK;LOOP(FOREVER);{};W(1);END_LOOP;END_TASK;S", "W(FOREVER) UNTIL(KEY_A);{}",
    "WHILE(NOT KEY_B);W(0.1);END_WHILE;{}", "DEF WAIT;W(9) UNTIL(KEY_A);END_DEF;WAIT;{}",
    "LOOP(FOREVER);IF(KEY_A);BREAK;ENDIF;W(0.1);END_LOOP;{}",
]  # fmt: skip


def diagnostics_of(code: codes.Code, text: str) -> list[Diagnostic]:
    compilation = check_text(text, KIT)
    assert compilation.is_right, text
    return [diagnostic for diagnostic in compilation.diagnostics if diagnostic.code is code]


@pytest.mark.sampled("template", keep=3)
@pytest.mark.parametrize("template", SURROUNDINGS)
@pytest.mark.parametrize("read", READ)
@pytest.mark.parametrize("question", QUESTIONS)
def test_a_condition_checked_only_once_is_reported(template: str, read: str, question: str) -> None:
    condition_text = read.format(q=question)
    text = template.format(condition_text)
    (diagnostic,) = diagnostics_of(codes.ASKED_ONCE, text)
    name = re.findall(r"(?:KEY|PAD)_\w+", question)[0]
    assert text[slice(*diagnostic.span)] == name
    assert name in (diagnostic.values.get("early"), diagnostic.values.get("name"))
    is_early = template in ("{}", "SI|{}", *SURROUNDINGS[4:5], SURROUNDINGS[6], SURROUNDINGS[9])
    assert ("early" in diagnostic.values) == is_early or "W(1);ELSEIF" in condition_text
    if diagnostic.repair and "IF(DISTANCE < 9)" not in text and "WHEN" not in text:
        assert not diagnostics_of(codes.ASKED_ONCE, apply_edits(text, diagnostic.repair.edits))


@pytest.mark.parametrize("value", ["PAD_X", "ABS(PAD_Y) + 5"])
@pytest.mark.parametrize("text", VALUES)
def test_a_stick_read_only_once_is_reported_in_any_value(text: str, value: str) -> None:
    assert len(diagnostics_of(codes.ASKED_ONCE, text.format(v=value))) == 1


@pytest.mark.sampled("template", keep=3)
@pytest.mark.parametrize("template", REPEATED)
@pytest.mark.parametrize("read", READ)
@pytest.mark.parametrize("question", QUESTIONS)
def test_repeated_and_awaited_conditions_are_not_reported(
    template: str, read: str, question: str
) -> None:
    assert not diagnostics_of(codes.ASKED_ONCE, template.format(read.format(q=question)))


def test_several_conditions_are_reported_once_with_a_loop_around_all() -> None:
    text = "SI|IF(KEY_UP)\nF(0.2, 60)\nENDIF\nIF(KEY_DOWN)\nB(0.2, 60)\nENDIF"
    (diagnostic,) = check(text)
    assert diagnostic.repair is not None and not diagnostic.repair.is_sure
    body = text.removeprefix("SI|")
    assert apply_edits(text, diagnostic.repair.edits) == f"SI|LOOP(FOREVER)\n{body}\nEND_LOOP"
    assert not check(apply_edits(text, diagnostic.repair.edits))


def test_a_variable_with_the_name_of_a_key_is_not_a_key() -> None:
    assert not diagnostics_of(codes.ASKED_ONCE, "KEY_A = 3;LOOP(KEY_A);S;END_LOOP;SHOW(KEY_A)")


def test_no_example_has_a_single_check_or_a_lone_task() -> None:
    places = [*(ROOT / "examples").glob("*.ts")]
    assert places
    for place in places:
        text = place.read_text()
        warnings = [
            diagnostic.code
            for diagnostic in check(text)
            if diagnostic.code in (codes.ASKED_ONCE, codes.LONE_TASK)
        ]
        assert not warnings, place


# -- a TASK alone -----------------------------------------------------------------------------

MOVES = ["F(5, 50)", "R(90 DEG, 60)", "B(2, 50) UNTIL(DISTANCE > 30)"]
BEEP = "BEEP(5, 440)"


@pytest.mark.parametrize("separator", [";", "\n"])
@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("move", MOVES)
def test_one_action_of_a_lone_task_is_moved_outside(move: str, order: int, separator: str) -> None:
    inside = [move, BEEP][:: -1 if order else 1]
    text = f"SI|{separator.join(['TASK', *inside, 'END_TASK'])}"
    (diagnostic,) = diagnostics_of(codes.LONE_TASK, text)
    assert diagnostic.repair is not None
    text_after = apply_edits(text, diagnostic.repair.edits)
    assert text_after == f"SI|{separator.join(['TASK', BEEP, 'END_TASK', move])}"
    assert not diagnostics_of(codes.LONE_TASK, text_after)
    assert diagnostic.values["fix"] == f"TASK;{BEEP};END_TASK;{move}"


@pytest.mark.parametrize("inside", [*MOVES, f"F(1, 50);{BEEP};S", "LOOP(FOREVER);F(1, 50);END_LOOP",
                                    f"{BEEP} // F\nF(1, 50)"])  # fmt: skip
@pytest.mark.parametrize("text_before", ["SI|", "N = 3;", "DEF A;S;END_DEF;"])
def test_each_lone_task_is_reported(inside: str, text_before: str) -> None:
    text = f"{text_before}TASK\n{inside}\nEND_TASK"
    assert "fix" not in diagnostics_of(codes.LONE_TASK, text)[0].values


@pytest.mark.parametrize("other_statement", ["S", "F(1, 50)", "TASK;W(9);END_TASK", "SHOW(1)",
                                             "WHEN(DISTANCE < 9);S;W(1);END_WHEN"])  # fmt: skip
def test_a_task_beside_anything_is_not_reported(other_statement: str) -> None:
    for text in (
        f"TASK;{BEEP};END_TASK;{other_statement}",
        f"{other_statement};TASK;F(5, 50);END_TASK",
    ):
        assert not diagnostics_of(codes.LONE_TASK, text)


def test_a_lone_when_is_not_a_lone_task() -> None:
    assert not diagnostics_of(codes.LONE_TASK, "WHEN(KEY_A);BEEP(1, 440);END_WHEN")
