"""The findings of wrong programs, and their consequences."""

from __future__ import annotations

import re
from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Edit, Source, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.diagnostics.fixing import repair_program
from tiniscript.recovery.setup import setup_diagnostic
from tiniscript.recovery.told import to_original


def test_si_in_place_of_brackets_is_repaired_with_its_end() -> None:
    diagnostic = setup_diagnostic("SI(F(2, 80)); S")
    edits = (Edit(Span(0, 3), "SI|"), Edit(Span(11, 12), ""))
    assert diagnostic is not None and diagnostic.repair == Repair(edits, True)


@pytest.mark.parametrize("text", ["SI| F(2, 80)", "SI DISTANCE < 10", "si hay una pared para", ""])
def test_other_beginnings_are_not_repaired(text: str) -> None:
    assert setup_diagnostic(text) is None


def test_a_following_mistake_is_reported_at_its_place() -> None:
    text = "SIF(2, 80); R(1, 60) S; FAST"
    diagnostics = check(text)
    assert [(one.code.number, text[slice(*one.span)]) for one in diagnostics] == [
        ("TS036", "SI"), ("TS013", ""), ("TS101", "FAST"),
    ]  # fmt: skip
    assert repair_program(text, check).text == "SI|F(2, 80); R(1, 60); S; FAST"


def test_a_line_with_a_checksum_is_left_alone() -> None:
    assert "TS058" in [diagnostic.code.number for diagnostic in check("SI:F(2, 80)~B77E7BD9")]


@pytest.mark.parametrize(
    ("span", "span_before"),
    [((0, 3), (0, 3)), ((1, 2), (0, 3)), ((3, 5), (3, 5)), ((6, 6), (7, 7)), ((2, 8), (0, 9))],
)
def test_a_place_after_edits_maps_back_to_the_original(
    span: tuple[int, int], span_before: object
) -> None:
    diagnostic = Diagnostic(codes.ODD_CHARACTER, Span(*span), {"also": "LIGHT_R < 300"})
    edits = [Edit(Span(5, 6), ""), Edit(Span(0, 3), "SI|")]
    moved_diagnostic = to_original(diagnostic, edits, Source("SI|F(2, 80)"))
    assert (moved_diagnostic.span, moved_diagnostic.values) == (span_before, diagnostic.values)


def test_an_unreadable_condition_is_shown_as_written() -> None:
    values_by_code = {
        diagnostic.code.number: diagnostic.values
        for diagnostic in check("IF(esta listo) F(2, 80) ENDIF")
    }
    assert values_by_code["TS014"]["fix"] == "IF(esta listo);F(2, 80);ENDIF"


def codes_and_places(text: str) -> list[tuple[str, str]]:
    return [(diagnostic.code.number, text[slice(*diagnostic.span)]) for diagnostic in check(text)]


def test_a_finding_does_not_reach_into_the_words_after_it() -> None:
    text = "F(2, 80 %) de potencia"
    assert codes_and_places(text) == [("TS049", "80 %"), ("TS085", "de potencia")]
    assert repair_program(text, check).text == "F(2, 80) de potencia"


def test_each_line_is_reported_with_its_repair() -> None:
    text = "F(2 s, 80%)\r\nLOOP(3 veces)\r\n  R(1, 60)\r\nFIN\r\n"
    assert [code for code, _ in codes_and_places(text)] == ["TS049", "TS049", "TS023"]
    assert repair_program(text, check).text == "F(2, 80)\r\nLOOP(3)\r\n  R(1, 60)\r\nEND_LOOP\r\n"


@pytest.mark.parametrize(
    "wrong_text",
    [
        "SHOW(5 / 3 - 3))",  # SHOW(5 / (3 - 3))
        "SPEED = 5;:PEED = 6",
        "F(2 s, 80)~B77E7BD9",
    ],
)
def test_lossy_repairs_are_never_applied_without_asking(wrong_text: str) -> None:
    assert repair_program(wrong_text, check).text == wrong_text


FORMS = ("{}{}", "{} {}", "{}: {}", "{}({}", "{}[{}]", "{}( {} )", "{} {})", "{} {}]")
SEPARATORS = (", ", " ", ";", "; ", " y ", ".")


@pytest.mark.sampled("word", keep=2)
@pytest.mark.parametrize("word", ["R", "derecha", "M", "motores"])
def test_no_repair_loses_a_sign_or_a_point(word: str) -> None:
    """`R .5 60` is not `R(5, 60)`, nor `M: -50 50` `M(50, 50)`."""
    pairs = (["0.5", "60"], [".5", "60"], ["1.25", "70"], ["-50", "50"], ["50", "-50"])
    losses = []
    for values, form, separator in product(pairs, FORMS, SEPARATORS):
        wrong_text = form.format(word, separator.join(values))
        repaired_text = repair_program(wrong_text, check).text
        numbers = [float(number) for number in re.findall(r"-?[0-9]*\.?[0-9]+", repaired_text)]
        if repaired_text != wrong_text and numbers != [float(value) for value in values]:
            losses.append((wrong_text, repaired_text))
    assert all(
        re.match(r"[RM]\.[0-9]+\.", wrong_text) for wrong_text, _ in losses
    )  # `F.2.80` is F(2, 80)


@pytest.mark.parametrize(
    ("wrong_text", "slips"),
    [
        ("LOOP 2\nS\nFIN", [("TS015", "LOOP(2); S; END_LOOP", "END_LOOP")]),
        ("while DISTANCE > 9:\n  if DISTANCE > 20:\n    S",
         [("TS015", "WHILE(DISTANCE > 9); IF(DISTANCE > 20); S; ENDIF; END_WHILE", "END_WHILE"),
          ("TS015", "IF(DISTANCE > 20); S; ENDIF", "ENDIF")]),
        ("F(2 80)\nLOOP(2)\nS\nFIN", [("TS017", "", ""), ("TS023", "", "")]),
        ("LOOP 2\n" + "F(1, 80)\n" * 20 + "FIN", [("TS015", "", ""), ("TS023", "", "")]),
    ],
)  # fmt: skip
def test_a_block_is_reported_with_its_end(
    wrong_text: str, slips: list[tuple[str, str, str]]
) -> None:
    codes_and_places = [
        (diagnostic.code.number, diagnostic.values) for diagnostic in check(wrong_text)
    ]
    assert [
        (code, values["whole"], values.get("ends", "")) for code, values in codes_and_places
    ] == slips


def test_an_unclosed_block_is_reported_with_its_last_line() -> None:
    (diagnostic,) = check("F(1, 80)\nLOOP(2)\n  R(1, 50)\nS")
    assert diagnostic.code is codes.NEVER_ENDS


def test_a_name_is_reported_once_with_all_its_lines() -> None:
    (diagnostic,) = check("año = 3\nF(año, 50)\nF(2, año)")
    assert (diagnostic.values["line"], diagnostic.values["lines"]) == ("2", "2, 3")
    assert repair_program("año = 3\nF(año, 50)", check).text == "ANIO = 3\nF(ANIO, 50)"


def test_a_long_text_is_not_read_as_a_whole() -> None:
    wrong_text = "W(2 s)\n"
    assert all(diagnostic.repair is not None for diagnostic in check(wrong_text))
    assert all(diagnostic.repair is None for diagnostic in check(wrong_text * 3000)[:3])


@pytest.mark.sampled("blank")
@pytest.mark.parametrize("blank", [" ", "( ", "5 ", "(5) "])
def test_many_blanks_take_no_time(blank: str) -> None:
    """The blanks are before or after a value; a minute for each would be noticed."""
    assert check(f"SI|F({blank * 20_000}((5)+1), 60) hola amigo\n")
    assert check(f"SI|F(5{blank * 20_000}hola amigo\n")


@pytest.mark.sampled("wrong_text", keep=2)
@pytest.mark.parametrize(
    "wrong_text",
    ["F(2. 80)", "F(2,5, 80)", "F (2, 80)cm", "F(2 80)", "FOO(1)", "avanza 2", "LOOP(3)"],
)
def test_only_the_first_of_many_mistakes_are_reported(wrong_text: str) -> None:
    """There are so many that a check for each would be noticed."""
    diagnostics = check(f"{wrong_text}\n" * 8000)
    assert len(diagnostics) <= codes.MAX_DIAGNOSTICS + 1
    assert diagnostics == codes.in_order(diagnostics)
    assert diagnostics[0].span.start <= len(wrong_text)


@pytest.mark.parametrize("line_ends", [*product(("\n", "\r", "\r\n", "\n\r", "\r\r\n"), repeat=3)])
def test_different_line_ends_may_be_mixed(line_ends: tuple[str, ...]) -> None:
    rows = ("F(2 80)", "R(1 60)", "LOOP(2)", "S")
    text = "".join(row + end for row, end in zip(rows, (*line_ends, ""), strict=True))
    places = [text[: diagnostic.span.start].count(")") for diagnostic in check(text)]
    assert [diagnostic.code.number for diagnostic in check(text)] == ["TS017", "TS017", "TS024"]
    assert places[:2] == [0, 1]
    assert (
        "F(2, 80)" in repair_program(text, check).text
        and "R(1, 60)" in repair_program(text, check).text
    )
