"""The rows of suggestions: messages about words after an instruction, and the rest that is read."""

from __future__ import annotations

import re

import pytest

from tests.pupils.corpus import check
from tests.support.rows import each_row
from tiniscript import robots
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import repair_program
from tiniscript.recovery import rows as recovery_rows
from tiniscript.recovery import usage
from tiniscript.recovery.rows import SIGNS, TOKENS
from tiniscript.recovery.suggestion_rows import SUGGESTIONS
from tiniscript.recovery.suggestions import Gaps, SuggestionRow, find_suggestions, rows

KIT = robots.load(robots.DEFAULT).kit


@each_row("row", [pytest.param(row, id=row.example[0]) for row in rows()])
def test_the_example_of_a_row_gets_its_stated_message(row: SuggestionRow) -> None:
    wrong_text, expected = row.example
    name, _, value = expected.partition("=")
    suggested = [suggestion.diagnostic for suggestion in find_suggestions(wrong_text, KIT)]
    assert len(suggested) < 2
    diagnostics = [
        diagnostic
        for diagnostic in suggested or check(wrong_text)
        if row.code in (diagnostic.code, None)
        and expected in (f"{name}={diagnostic.values.get(name)}", diagnostic.code.number)
    ]
    assert diagnostics and value == diagnostics[0].values.get(name, "")
    assert {*row.values} - {"?", "*"} <= {*diagnostics[0].values}


def test_each_example_is_reported_by_its_own_row() -> None:
    """Each example has the message of its own row, and no row is useless."""
    telling: list[SuggestionRow] = []
    original = usage.Usage.diagnostic_of

    def note_row(place: usage.Usage, row: SuggestionRow, gaps: Gaps) -> Diagnostic:
        telling.append(row)
        return original(place, row, gaps)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(usage.Usage, "diagnostic_of", note_row)
        for row in rows():
            check.cache_clear()
            telling.clear()
            check(row.example[0])
            assert row in telling or find_suggestions(row.example[0], KIT), row.example


@pytest.mark.parametrize("table", [SIGNS, TOKENS, SUGGESTIONS])
def test_each_heading_names_the_laws_that_its_rows_keep(table: str) -> None:
    headings_in_doc = {*re.findall("^- `([a-z]+)`:", recovery_rows.__doc__ or "", re.MULTILINE)}
    lines = table.strip().splitlines()
    headings = [line for line in lines if line.startswith("# ")]
    assert lines[0] in headings and len(headings_in_doc) > 5
    for heading in headings:
        laws = heading.rpartition(": ")[2].split(", ")
        assert {*laws} <= headings_in_doc, heading


@pytest.mark.parametrize(
    "wrong_text",
    [
        "F(2, 80) gracias; F(1, 50)",  # no note: TS044
        "F(1, 80) MISPELT",  # rather the name of a DEF
        "F(1, 80) SHWO",  # rather a misspelt word
        "X = 5 + 3",
        "F(2, 80) AND",
        "LOOP(4) ... S ... END_LOOP",
        "F(2, 80) hola~B77E7BD9",
        "F(1, 80) " + "la " * 30,
    ],
)
def test_text_that_is_not_a_comment_is_left_to_other_rules(wrong_text: str) -> None:
    codes = {suggestion.diagnostic.code.number for suggestion in find_suggestions(wrong_text, KIT)}
    assert not codes & {"TS071", "TS085"}


def test_a_block_is_not_a_comment_on_the_text_before_it() -> None:
    codes = {diagnostic.code.number for diagnostic in check("B(1, 60) IF(DISTANCE < 10)\nS\nENDIF")}
    assert not codes & {"TS071", "TS085"}


def test_other_mistakes_beside_the_words_are_also_reported() -> None:
    diagnostics = check("F(2 80) hola\nW(2) espero; AVANZA(1, 80)")
    assert [(diagnostic.code.number, diagnostic.values["fix"]) for diagnostic in diagnostics] == [
        ("TS017", "F(2, 80)"),
        ("TS085", "// hola"),  # its instruction has a repair of its own
        ("TS085", ""),  # more text follows on the line
        ("TS102", "F(1, 80)"),
    ]


@pytest.mark.parametrize(
    ("wrong_text", "expected"),
    [
        ("F(2, 80)\nS\nF(2, 80)\nS\netc", {"all": "LOOP(4);F(2, 80);S;END_LOOP"}),
    ],
)  # fmt: skip
def test_a_reference_to_earlier_text_is_resolved(wrong_text: str, expected: dict[str, str]) -> None:
    assert expected.items() <= check(wrong_text)[-1].values.items()


@pytest.mark.parametrize(
    "wrong_text", ["LOOP(2)\n...\nEND_LOOP", "idem", '"\nF(2, 80)', "F(2, 80)."]
)
def test_a_reference_without_earlier_text_is_not_resolved(wrong_text: str) -> None:
    assert not {diagnostic.code.number for diagnostic in check(wrong_text)} & {"TS130", "TS131"}


def test_text_after_a_verbal_condition_is_reported_with_it() -> None:
    asked_diagnostic, end = check("IF(mucha luz) S ENDIF")
    assert (asked_diagnostic.values["question"], asked_diagnostic.values["another"]) == (
        "LIGHT_L > 500",
        "LIGHT_R > 500",
    )
    assert end.values["fix"] == "IF(LIGHT_L > 500);S;ENDIF"
    assert repair_program("IF(mucha luz) S ENDIF", check).text == "IF(mucha luz);S;ENDIF"


def test_words_are_never_dropped_without_asking() -> None:
    for wrong_text in (
        "F(1, 80) hola",
        "F(2, 80) 3 veces",
        "F(2, 80) y retrocede",
        "F(2, 80) al 50%",
    ):
        assert repair_program(wrong_text, check).text == wrong_text


def test_a_repair_beside_words_does_not_drop_them() -> None:
    assert "hola" in repair_program("F(1, 80) B(1, 80) hola", check).text


def test_a_number_in_another_unit_is_converted() -> None:
    (diagnostic,) = check("S 500 ms")
    assert diagnostic.values["fix"] == "S;W(0.5)"


@pytest.mark.parametrize(
    ("wrong_text", "values"),
    [
        ("F(1, 80); L(1, 60) x4", {"all": "LOOP(4);F(1, 80);L(1, 60);END_LOOP"}),
        ("F(2, 80) luego espera", {"fix": "F(2, 80);W(1)", "example": "1 s"}),
        ("F(5,80) UNTIL(DISTANCE<10) al 50%", {"power": "F(5,50) UNTIL(DISTANCE<10)"}),
        ("se nao tiver parede pra frente 2 segundos",
         # The target of the move, not the wall's place.
         {"fix": "IF(DISTANCE > 10);F(2, 80);ENDIF"}),
        ("L(1,60) (45)", {"extra": "(45)"}),  # rather degrees than how many times
        ("avanza hasta menos de 10", {"fix": "F(FOREVER, 80) UNTIL(DISTANCE < 10)"}),
    ],
)  # fmt: skip
def test_values_of_a_row_are_filled(wrong_text: str, values: dict[str, str]) -> None:
    (diagnostic,) = check(wrong_text)
    assert values.items() <= diagnostic.values.items()
