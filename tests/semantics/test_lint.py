"""The lint: which code gets a warning, and which gets none. `tests/cases/lint.md` has sentences."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from tests.support.advised_programs import ADVISED_PROGRAMS
from tests.support.rows import each_row
from tests.support.texts import catalogue_texts
from tiniscript import check_text, robots
from tiniscript.base.source import apply_edits
from tiniscript.diagnostics import codes
from tiniscript.semantics import lint as lints
from tiniscript.semantics.lint import lint
from tiniscript.syntax.lexer import scan

KIT = robots.load("tinibot").kit


@each_row("text, code", ADVISED_PROGRAMS)
def test_each_warning_is_given_alone(text: str, code: str) -> None:
    compilation = check_text(text, KIT)
    assert compilation.is_right
    assert [diagnostic.code.number for diagnostic in compilation.diagnostics] == [code]


@each_row(
    "text",
    [
        "LOOP(FOREVER);W(1);IF(DISTANCE < 5);BREAK;ENDIF;END_LOOP;S",
        "TASK;W(2);BEEP(0.2, 440);END_TASK;F(9, 60)",
        "TASK;LOOP(3);BEEP(0.2, 440);END_LOOP;W(1);END_TASK;F(9, 60)",
        "DEF A;LOOP(3);W(1);END_LOOP;END_DEF;TASK;A;W(1);END_TASK;F(9, 60)",
        "TASK;W(5) UNTIL(DISTANCE < 9);END_TASK;F(9, 60)",
        "LOOP(FOREVER);F(1, 60);END_LOOP;WHEN(DISTANCE < 10);S;W(1);END_WHEN",
        "LOOP(FOREVER);BEEP(1, 440);END_LOOP;WHEN(DISTANCE < 10);S;END_WHEN",
        "F(9, 60);WHEN(DISTANCE < 10);S;END_WHEN",
        "DEF A;W(1);END_DEF;LOOP(FOREVER);A;END_LOOP",
        "LOOP(3);F(0.4, 80);IF(DISTANCE < 10);S;BREAK;ENDIF;END_LOOP",
        "LOOP(3);F(0.4, 80);IF(DISTANCE < 10);S;W(2);ENDIF;END_LOOP",
        "IF(DISTANCE < 20);W(1);ELSEIF(DISTANCE < 60);S;ENDIF",
        "IF(DISTANCE < 20);W(1);ELSEIF(DISTANCE <= 20);S;ENDIF",
        "IF(DISTANCE > 60);W(1);ELSEIF(DISTANCE > 20);S;ELSEIF(DISTANCE < 5);W(1);ENDIF",
        "LOOP(3);F(1, 80) UNTIL(DISTANCE < 10);IF(DISTANCE < 10);S;ENDIF;END_LOOP",
        "F(1, 80);IF(DISTANCE < 10);S;ELSE;F(1, 80);ENDIF",
        "F(1, 80);IF(DISTANCE < 10);S;R(1, 60);ENDIF",
        "F(0.8, 60);IF(LIGHT_L < 300);S;W(2);ENDIF;F(1, 60)",
        "M(50, 50);IF(DISTANCE < 10);S;ENDIF;F(1, 80)",
        "M(50, 50);W(1);IF(LIGHT_L < 10);S;ENDIF;F(1, 80)",
        "LOOP(3);D = DISTANCE;F(0.2, 60) UNTIL(D < 20);END_LOOP",
        "D = DISTANCE;F(5, 60) UNTIL(DISTANCE < D)",
        "T = TIME + 2;F(5, 60) UNTIL(TIME > T)",
        "ON = 1;WHILE(ON = 1);W(1);END_WHILE",
        "ON = TRUE;WHILE(ON);W(1);END_WHILE",
        "N = 0;WHILE(N < 3);W(1);BREAK;END_WHILE",
        "N = 0;DEF A;N = N + 1;END_DEF;DEF C;A;END_DEF;WHILE(N < 3);C;END_WHILE",
        "WHILE(DISTANCE > 20);F(0.5, 60);END_WHILE",
        "IF(DISTANCE < 20);F(5, 60) UNTIL(DISTANCE > 20);ENDIF",
        "D = DISTANCE;LOOP(4);F(1, 60);IF(D > 100);F(1, 60);ENDIF;L(0.39, 60);END_LOOP",
        "LOOP(FOREVER);SHOW(LIGHT_L);W(600);END_LOOP",
        "W(150);W(900);W(3600)",
        "D = DISTANCE;IF(D < 20);F(1, 60);ENDIF",
        "IF(DISTANCE < 5);M(80, 80);ENDIF;IF(DISTANCE < 9);W(1);ENDIF",
        "WHILE(DISTANCE > 0);F(5, 60);END_WHILE",
        "IF(LIGHT_L >= 1023);S;ENDIF",
        "IF(DISTANCE <= 0);S;ENDIF",
        "W(5) UNTIL(LIGHT_L = 0)",
        "M(50, 80);W(2)",
        "M(0, 0)",
        "LOOP(FOREVER);M(50, 50);END_LOOP",
        "F(2, 10)",
        "F(90, 60) UNTIL(DISTANCE < 10)",
        "N = 3;WHILE(N > 0);N = N - 1;END_WHILE",
        "IF(DISTANCE <= 10 AND DISTANCE >= 10);W(1);ENDIF",
        "IF(DISTANCE < 10 OR DISTANCE > 10);W(1);ENDIF",
        "IF(DISTANCE < 40 AND DISTANCE > 10);W(1);ENDIF",
        "IF(DISTANCE < 10 AND LIGHT_L > 40);W(1);ENDIF",
        "F(FOREVER, 60);TASK;LOOP(FOREVER);L(1, 60) UNTIL(DISTANCE < 9);END_LOOP;END_TASK",
        "F(FOREVER, 60);TASK;LOOP(FOREVER);L(1, 60);LOOP(2);SHOW(1);END_LOOP;END_LOOP;END_TASK",
        "F(FOREVER, 60);TASK;LOOP(FOREVER);L(1, 60);IF(DISTANCE < 9);BREAK;ENDIF;END_LOOP;END_TASK",
        "F(FOREVER, 60);TASK;LOOP(FOREVER);L(1, 60);END_LOOP;END_TASK;WHEN(TRUE);S;END_WHEN",
        "F(FOREVER, 60);TASK;LOOP(FOREVER);W(1);S;END_LOOP;END_TASK;TASK;F(FOREVER, 50);END_TASK",
        "DEF A;W(1);END_DEF;F(FOREVER, 60);TASK;LOOP(FOREVER);L(1, 60);A;END_LOOP;END_TASK",
        "F(FOREVER, 60);TASK;LOOP(FOREVER);L(1, 60);IF(DISTANCE < 9);M(50, 50);ENDIF\n"
        "W(1);END_LOOP;END_TASK",
        "F(FOREVER, 60);TASK;LOOP(FOREVER);F(1, 50);M(50, 50);LOOP(2);W(1);L(1, 60);END_LOOP\n"
        "END_LOOP;END_TASK",
        "F(9, 60);TASK;F(FOREVER, 50);END_TASK",
        "TASK;LOOP(FOREVER);W(1);END_LOOP;END_TASK;F(FOREVER, 60)",
        "// R(1, 60)\nF(2, 80)",
        "F(2, // R(1, 60)\n80)",
        "SPEED = 30;SLOW = 5;F(SPEED, SLOW)",
        "T1 = 30;T2 = 10;F(T1, T2)",
        "X = 30;Y = 10;F(X, Y)",
        "PING|check_connection // F(2,80)",
        "SI|// F(2, 80)\nS",
        "SI|; // F(2, 80)\nS",
        "SI|START // F(2, 80)\nS",
        "LOOP(2); // F(1, 2)\nF(1, 50);END_LOOP",
        "IF(ABS(DISTANCE) <\n 5) // F(1, 2)\nS;ELSE // F(1, 50)\nW(1);ENDIF",
        "IF(DISTANCE < 20);S;ENDIF;B(1, 60)",
        "B(5, 60);IF(DISTANCE < 20);S;ENDIF",
        "LOOP(3);IF(DISTANCE < 20);S;ENDIF;B(1, 60);END_LOOP",
        "LOOP(3);B(1, 60);IF(DISTANCE < 10);R(1, 60);ENDIF;END_LOOP",
        "LOOP(3);F(1, 60);IF(NOT (DISTANCE < 50));R(1, 60);ENDIF;END_LOOP",
        "SHOW(FALSE AND 1 / 0 > 2)",
    ],
)
def test_unwarranted_warnings_are_not_given(text: str) -> None:
    assert check_text(text, KIT).diagnostics == []


# Mistakes listed in the catalogue; `tests/diagnostics/test_rendering.py` tests their texts.
WRONG = [text for key, text in catalogue_texts("en", "messages").items() if key.endswith("/wrong")]


def test_the_table_has_every_warning() -> None:
    warnings = {code for code in codes.CODES.values() if not code.is_mistake}
    warned_codes = {code for row in lints.TABLE for code in row.codes}
    assert warned_codes == warnings - set(lints.FOUND_ELSEWHERE)
    names = {code: name for name, code in vars(codes).items() if isinstance(code, codes.Code)}
    for code, module in lints.FOUND_ELSEWHERE.items():
        source = find_spec(f"tiniscript.{module}")
        assert source is not None and source.origin is not None
        assert f"codes.{names[code]}" in Path(source.origin).read_text(encoding="utf-8")


def test_a_row_reports_only_its_codes(monkeypatch: pytest.MonkeyPatch) -> None:
    """It reports each of its codes, because an unused one would be a false promise."""
    reported: dict[lints.Row, set[codes.Code]] = {row: set() for row in lints.TABLE}

    def watch_row(row: lints.Row) -> lints.Row:
        def find(*arguments: Any) -> None:
            diagnostics = arguments[-1].diagnostics
            count_before = len(diagnostics)
            row.report(*arguments)
            reported[row] |= {diagnostic.code for diagnostic in diagnostics[count_before:]}

        return row._replace(report=find)

    rows = {node_kind: [*map(watch_row, its)] for node_kind, its in lints._ROWS.items()}
    monkeypatch.setattr(lints, "_ROWS", rows)
    for text in [*(text for text, _ in ADVISED_PROGRAMS), *WRONG]:
        check_text(text, KIT)
    assert reported == {row: set(row.codes) for row in lints.TABLE}


def test_a_kit_without_speeds_uses_a_usual_speed() -> None:
    """Centimetres were meant there, too; because it has no CM, the message offers no repair."""
    kit = KIT._replace(speed=0, turn=0)
    (diagnostic,) = check_text("F(20, 60)", kit).diagnostics
    assert diagnostic.code.number == "TS811"
    assert "centimetres" in diagnostic.values
    assert "way" not in diagnostic.values
    assert check_text("F(20, 30);F(19, 60)", kit).diagnostics == []


def test_warnings_are_for_right_programs_only() -> None:
    wrong_compilation = check_text("X = 5;S = 5", KIT)
    assert [diagnostic.is_mistake for diagnostic in wrong_compilation.diagnostics] == [True]
    assert wrong_compilation.program is not None
    assert lint(
        wrong_compilation.program,
        KIT,
        wrong_compilation.source,
        scan(wrong_compilation.source.text),
    )


@each_row(
    "text, expected_text",
    [
        ("TASK;W(1);END_TASK;S", "TASK;LOOP(FOREVER);W(1);END_LOOP;END_TASK;S"),
        ("TASK // beeps\n  W(1) // so\nENDTASK;S",
         "TASK\nLOOP(FOREVER) // beeps\n  W(1) // so\nEND_LOOP\nENDTASK;S"),
    ],
)  # fmt: skip
def test_a_loop_is_suggested_around_a_task_that_runs_once(text: str, expected_text: str) -> None:
    (diagnostic,) = check_text(text, KIT).diagnostics
    assert diagnostic.repair is not None
    assert apply_edits(text, diagnostic.repair.edits) == expected_text
    assert not check_text(expected_text, KIT).diagnostics


def warnings_of(text: str) -> list[str]:
    compilation = check_text(text, KIT)
    assert compilation.is_right, text
    return [diagnostic.code.number for diagnostic in compilation.diagnostics]


@pytest.mark.parametrize("number", ["3", "20", "100", "250", "300", "500", "600", "1000", "10000"])
@pytest.mark.parametrize("sign", ["<", "<=", ">", ">=", "="])
def test_the_clock_includes_waits(number: str, sign: str) -> None:
    is_long = "TS811" in warnings_of(f"W({number})")
    for compared_text in (f"TIME {sign} {number}", f"{number} {sign} TIME"):
        for question in (
            compared_text,
            f"DISTANCE < 9 OR {compared_text}",
            f"NOT ({compared_text})",
        ):
            for text in (
                "WHILE({});F(1, 50);B(1, 50);END_WHILE", "IF({});S;W(1);ENDIF;S", "SHOW({})",
                "F(9, 60) UNTIL({})", "WHEN({});BEEP(1, 440);END_WHEN;F(3, 60)", "X = {};SHOW(X)",
            ):  # fmt: skip
                assert ("TS811" in warnings_of(text.format(question))) is is_long, text


@pytest.mark.parametrize("sign", ["<", "<=", ">", ">="])
@pytest.mark.parametrize("word", ["F", "B", "L", "R", "W"])
def test_a_while_that_its_moves_never_end_is_inverted(word: str, sign: str) -> None:
    move = f"{word}(0.2{', 60' if word != 'W' else ''})"
    is_turned = (word, sign[0]) in (("F", "<"), ("B", ">"))
    for body in (move, f"{move};{move}", f"SHOW(DISTANCE);{move}", f"BEEP(0.1, 440);{move}"):
        text = f"WHILE(DISTANCE {sign} 20);{body};END_WHILE"
        diagnostics = [
            diagnostic
            for diagnostic in check_text(text, KIT).diagnostics
            if diagnostic.code is codes.TURNED_ROUND
        ]
        assert bool(diagnostics) is is_turned, text
        for diagnostic in diagnostics:
            right_text = text.replace(f"WHILE(DISTANCE {sign} 20)", diagnostic.values["fix"])
            assert "TS824" not in warnings_of(right_text), right_text
        for other in (f"{move};R(0.2, 60)", f"IF(LIGHT_L > 9);S;ENDIF;{move}", f"{move};BREAK"):
            assert "TS824" not in warnings_of(f"WHILE(DISTANCE {sign} 20);{other};END_WHILE"), other
        assert "TS824" not in warnings_of(f"IF(DISTANCE < 50);{text};ENDIF")


@pytest.mark.parametrize("seconds", ["0.5", "4.9", "5", "10"])
def test_a_long_move_after_a_finished_check_is_reported(seconds: str) -> None:
    look, move = "IF(DISTANCE < 15);B(1, 70);ENDIF", f"F({seconds}, 50)"
    is_long = float(seconds) >= 5
    for text in (
        f"{look};{move}",
        f"W(1);{look};X = 2;{move};SHOW(X)",
        f"{look};BEEP(1, 440);{move}",
    ):
        assert ("TS805" in warnings_of(text)) is is_long, text
    for text in (
        f"LOOP(3);{look};{move};END_LOOP", f"WHEN(DISTANCE < 9);S;END_WHEN;{look};{move}",
        f"{look};{move} UNTIL(DISTANCE < 9)", f"{look.replace('<', '>')};{move}",
        f"{look.replace('ENDIF', 'ELSE;W(1);ENDIF')};{move}",
    ):  # fmt: skip
        assert "TS805" not in warnings_of(text), text


@pytest.mark.parametrize("low", [1, 20, 80, 100])
@pytest.mark.parametrize("high", [1, 20, 80, 100])
def test_constant_min_max_expressions_are_recognized(low: int, high: int) -> None:
    for outer, inner, is_known in (("MAX", "MIN", high < low), ("MIN", "MAX", high > low)):
        for text in (
            f"{outer}({low}, {inner}({high}, DISTANCE))",
            f"{outer}({inner}(DISTANCE, {high}), {low})",
            f"{outer}({inner}({high}, X), {low})",
        ):  # fmt: skip
            program = f"X = DISTANCE;F(1, {text});SHOW(X)"
            diagnostics = [
                diagnostic
                for diagnostic in check_text(program, KIT).diagnostics
                if diagnostic.code is codes.KNOWN_ANSWER
            ]
            assert bool(diagnostics) is is_known, text
            assert all(diagnostic.values["number"] == str(low) for diagnostic in diagnostics)


@pytest.mark.parametrize("past", ["W(9)", "F(4, 60);B(5, 60)", "WHILE(TIME < 9);W(1);END_WHILE"])
@pytest.mark.parametrize("limit", [5, 9, 10])
def test_a_past_time_is_reported_with_later_instructions(past: str, limit: int) -> None:
    text = f"{past};WHILE(TIME < {limit});BEEP(1, 440);END_WHILE"
    diagnostics = [
        diagnostic
        for diagnostic in check_text(text, KIT).diagnostics
        if diagnostic.code is codes.KNOWN_ANSWER
    ]
    assert bool(diagnostics) is (limit <= 9), text
    assert [diagnostic.values["later"] for diagnostic in diagnostics] == [
        f"WHILE(TIME < {9 + limit})"
    ] * (limit <= 9)
    for other in (
        f"WHEN(DISTANCE < 9);S;END_WHEN;{text}",
        text.replace("W(9)", "W(9) UNTIL(KEY_A)"),
    ):
        if other != text:
            assert "TS827" not in warnings_of(other), other


@pytest.mark.parametrize("value", ["DISTANCE", "D", "DISTANCE - LIGHT_L"])
@pytest.mark.parametrize(("first", "second"), [(50, 50), (50, 40), (50, -50)])
@pytest.mark.parametrize("signs", ["> <", "< >", "> >", "< <", ">= <", "> <=", "<= >", ">= <="])
def test_an_else_between_two_bounds_is_reachable(
    signs: str, value: str, first: int, second: int
) -> None:
    first_sign, second_sign = signs.split()
    arms = (
        f"IF({value} {first_sign} {first});F(1, 60);ELSEIF({value} {second_sign} {second});L(1, 60)"
    )
    text = f"LOOP(3);D = DISTANCE;{arms};ELSE;R(1, 60);ENDIF;END_LOOP;SHOW(D)"
    is_exact = first == second and {first_sign, second_sign} == {"<", ">"}
    assert ("TS825" in warnings_of(text)) is is_exact, text
    assert "TS825" not in warnings_of(text.replace(";ELSE;R(1, 60)", ""))


@pytest.mark.parametrize("throw", ["RANDOM(1, 3)", "RANDOM(0, 10)"])
def test_each_random_call_draws_a_new_number(throw: str) -> None:
    arms = f"IF({throw} = 1);F(1, 60);ELSEIF({throw} = 2);L(1, 60);ENDIF"
    assert "TS843" in warnings_of(arms)
    two_throws = f"SHOW({throw});LOOP({throw});W(1);END_LOOP"
    for place in ("{}", "LOOP(2);{};END_LOOP", "TASK;{};END_TASK;F(3, 60)", "DEF A;{};END_DEF;A"):
        assert "TS843" in warnings_of(place.format(two_throws)), place
    assert "TS843" not in warnings_of(f"N = {throw};SHOW(N);{arms.replace(throw, 'N')}")
    assert "TS843" not in warnings_of(f"SHOW({throw});W(1);LOOP({throw});W(1);END_LOOP")


@pytest.mark.parametrize("call", ["SIDE(30)", "SIDE(15);SIDE(40)", "SIDE(90)"])
def test_the_values_of_a_def_are_times_as_its_own_numbers_are(call: str) -> None:
    for word, unit in (("F", "CM"), ("B", "CM"), ("R", "DEG")):
        text = f"DEF SIDE(SIZE);{word}(SIZE, 60);END_DEF;{call}"
        assert "TS811" in warnings_of(text), text
        assert "TS811" not in warnings_of(text.replace("SIZE, 60", f"SIZE {unit}, 60")), text
        assert "TS811" not in warnings_of(text.replace("SIZE", "SECONDS")), text
