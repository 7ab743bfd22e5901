"""A DEF that returns a value is reported once, wherever its RETURN and its calls are."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.diagnostics.rendering import message

RETURNS = ["RETURN", "return", "DEVOLVER", "DEVOLVA", "RETORNA"]
RESULTS = ["N * 2", "(N * 2)", "N", "DISTANCE", "ABS(N - 3)"]
USES = ["X = DOUBLE(4);SHOW(X)", "SHOW(DOUBLE(4))", "F(DOUBLE(4), 60)", "W(1 + DOUBLE(4))",
        "IF(DOUBLE(4) > 3);S;ENDIF", "LOOP(DOUBLE(4));S;END_LOOP", "SHOW(MAX(DOUBLE(4), 9))",
        "SHOW(DOUBLE(4) + DOUBLE(4))", "F(2, 80) UNTIL(DISTANCE < DOUBLE(4))"]  # fmt: skip
SEPARATORS = (";", "\n", ";\n  ")


def codes_of(text: str) -> list[str]:
    return [diagnostic.code.number for diagnostic in check(text)]


@pytest.mark.sampled("use", keep=3)
@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("result", RESULTS)
@pytest.mark.parametrize("word", RETURNS)
@pytest.mark.parametrize("separator", SEPARATORS)
def test_a_return_and_its_uses_are_one_mistake(
    use: str, result: str, word: str, separator: str
) -> None:
    lines = ["SI|DEF DOUBLE(N)", f"{word} {result}", "END_DEF", *use.split(";")]
    text = separator.join(lines)
    (diagnostic,) = check(text)
    assert text[slice(*diagnostic.span)] == word
    full_message = message(diagnostic, Source(text), "en")
    assert full_message.code == "TS051"
    assert f"RESULT = {result} here. Later, write DOUBLE(4) on a line" in full_message.fix


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("separator", SEPARATORS)
def test_following_the_message_gives_a_right_program(use: str, separator: str) -> None:
    call = ["DOUBLE(4)", *use.replace("DOUBLE(4)", "RESULT").split(";")]
    join_after = separator.join(["SI|DEF DOUBLE(N)", "RESULT = N * 2", "END_DEF", *call])
    assert not any(diagnostic.is_mistake for diagnostic in check(join_after))


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("other_statement", ["", ";F(2 80)", ";BLA(3)"])
def test_a_call_used_as_a_value_without_return_is_reported_once(
    use: str, other_statement: str
) -> None:
    text = f"SI|DEF DOUBLE(N);SHOW(N);END_DEF;{use}{other_statement}"
    first, *others = check(text)
    assert (first.code.number, first.values.get("called")) == ("TS051", "DOUBLE")
    assert len(others) == bool(other_statement)


def test_conditions_and_expressions_with_such_calls_are_read_on() -> None:
    text = "SI|DEF NEAR(N);RETURN DISTANCE < N;END_DEF;IF(NEAR(4) AND KEY_A);S;ENDIF"
    assert codes_of(text) == ["TS051"]
    for question_template in (
        "WHILE({});S;END_WHILE",
        "IF({});S;ENDIF",
        "F(2, 80) UNTIL({})",
        "IF(NOT {});S;ENDIF",
    ):
        twice = ";".join(question_template.format(call) for call in ("A(4)", "A(5)"))
        assert codes_of(f"SI|DEF A(N);SHOW(N);END_DEF;{twice}") == ["TS051"]


def test_other_returns_and_right_calls_are_not_reported_as_this_mistake() -> None:
    assert codes_of("SI|DEF A;S;RETURN;END_DEF;A") == ["TS101"]
    assert codes_of("SI|S;RETURN 5") == ["TS101"]
    assert not check("DEF A(N);W(N);END_DEF;A(3);IF(DISTANCE < 9);A(2);ENDIF;A(4)")
