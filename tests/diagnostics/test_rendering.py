"""The texts of diagnostics: each code has its message, and each example its diagnostic."""

from __future__ import annotations

import re
from collections.abc import Mapping

import pytest

from tests.support.rows import each_row
from tests.support.texts import LANGUAGES, gap_names
from tests.support.texts import catalogue_texts as all_said
from tiniscript import check_text, compile_text
from tiniscript.base.kit import NUMBER, YES_NO, Device, Kit
from tiniscript.base.languages import SOURCE_LANGUAGE, languages
from tiniscript.base.source import Source, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import CODES, Diagnostic
from tiniscript.diagnostics.rendering import Message, as_json, as_text, explain, message, titles
from tools.languages import sources

KIT = Kit(
    sensors=(
        Device("LIGHT_R", NUMBER, "", 0, 1_023_000),
        Device("LIGHT_L", NUMBER, "", 0, 1_023_000),
        Device("DISTANCE", NUMBER, "cm", 0, 400_000),
        Device("BUTTON", YES_NO, "", 0, 1),
    ),
    actuators=(
        Device("GRIPPER", NUMBER, "°", 0, 180_000),
        Device("LED", YES_NO, "", 0, 1),
    ),
    speed=45_000,
    turn=360_000,
)
TEXTS = {language: all_said(language, "messages") for language in languages()}
EXAMPLES = [code for code in sorted(CODES) if f"{code}/wrong" in TEXTS[SOURCE_LANGUAGE]]
BOARD = {"robot": "TINIBOT", "limit": "900", "code": "1000", "over": "100"}
LEVEL = {"level": "uno", "limit": "255", "code": "260", "over": "5"}
WITHOUT_EXAMPLE: dict[str, Mapping[str, str]] = {
    "TS001": {},
    "TS002": {},
    "TS003": {},
    "TS119": {**dict.fromkeys(("first", "second", "third"), "LINER"), "own": "A", "found": "B"},
    "TS120": {},
    "TS138": {"found": "X2", "known": "tinibot, liner"},
    "TS306": {"limit": "32767", "over": "100"},
    "TS307": BOARD,
    "TS319": {"robot": "A"},
    "TS308": {"level": "uno", "word": "RANDOM"},
    "TS309": LEVEL,
    "TS310": LEVEL,
    "TS311": LEVEL,
    "TS318": {**LEVEL, "name": "SIDE", "count": "2"},
    "TS313": {"robot": "tinibot"},
    "TS314": {"unit": "CM", "line": "speed = 45"},
    "TS315": {"robot": "tinibot"},
    "TS809": BOARD,
}


def first_message(text: str, lang: str = "en") -> tuple[Message, Source]:
    compilation = compile_text(text, KIT)
    return message(compilation.diagnostics[0], compilation.source, lang), compilation.source


# -- the table ------------------------------------------------------------------------------------


def test_codes_and_texts_correspond() -> None:
    for texts in TEXTS.values():
        assert {key.partition("/")[0] for key in texts} == {"label", "term", *CODES}
    assert set(EXAMPLES) == set(CODES) - set(WITHOUT_EXAMPLE)


@each_row("code", sorted(CODES))
def test_each_code_has_all_texts_in_every_language(code: str) -> None:
    for texts in TEXTS.values():
        for part in ("title", "message", "try", "more"):
            assert texts[f"{code}/{part}"]
            assert part in ("message", "try") or "{" not in texts[f"{code}/{part}"]


def test_a_translator_sees_the_wrong_program_of_a_message() -> None:
    notes = {entry.key: entry.notes for entry in sources()["messages"].entries.values()}
    for code in EXAMPLES:
        rows = [f"wrong: {row}" for row in TEXTS[SOURCE_LANGUAGE][f"{code}/wrong"].splitlines()]
        assert notes[f"{code}/message"] == rows


@each_row("code", EXAMPLES)
def test_the_wrong_example_has_its_diagnostic_first(code: str) -> None:
    for texts in TEXTS.values():
        diagnostics = compile_text(texts[f"{code}/wrong"], KIT).diagnostics
        assert [diagnostic.code.number for diagnostic in diagnostics][:1] == [code]


@each_row("code", EXAMPLES)
def test_the_right_example_has_no_diagnostic(code: str) -> None:
    for texts in TEXTS.values():
        assert compile_text(texts[f"{code}/right"], KIT).diagnostics == []


@each_row("code", EXAMPLES)
def test_the_examples_fill_all_gaps_of_their_messages(code: str) -> None:
    compilation = compile_text(TEXTS[SOURCE_LANGUAGE][f"{code}/wrong"], KIT)
    values = compilation.diagnostics[0].values
    if compilation.diagnostics[0].repair is None:  # otherwise the message shows the result
        assert gap_names(code) <= set(values)
    for lang in LANGUAGES:
        full_message = message(compilation.diagnostics[0], compilation.source, lang)
        assert "{" not in full_message.message + full_message.fix
        assert "@" not in full_message.message + full_message.fix


@pytest.mark.parametrize("code", sorted(WITHOUT_EXAMPLE))
def test_messages_without_an_example_have_gaps_that_are_filled(code: str) -> None:
    assert gap_names(code) <= set(WITHOUT_EXAMPLE[code])
    diagnostic = Diagnostic(CODES[code], Span(0, 0), WITHOUT_EXAMPLE[code])
    for lang in LANGUAGES:
        full_message = message(diagnostic, Source(""), lang)
        assert full_message[2:6] == (1, 1, 1, 1)
        assert as_text(full_message, Source(""), lang).startswith(
            ("Warning: ", "Aviso: ", full_message.message)
        )
        assert "{" not in full_message.message + full_message.fix


def test_a_program_too_long_for_any_robot_is_reported_with_its_excess() -> None:
    message, source = first_message("SHOW(DISTANCE * 1.125 + 2.25)\n" * 5000)
    assert message.code == "TS306"
    assert re.search(r"\d+ bytes too long: a robot holds at most 32767$", message.message)
    assert (message.line, message.column) == (5000, 29)
    assert "{" not in as_text(message, source, "en")


# -- gaps -----------------------------------------------------------------------------------------


def test_a_text_with_an_empty_gap_is_replaced_by_the_next() -> None:
    known_diagnostic = Diagnostic(codes.UNKNOWN_NAME, Span(0, 1), {"found": "Y", "near": "YY"})
    unknown = known_diagnostic._replace(values={"found": "Y", "near": ""})
    source = Source("Y")
    assert message(known_diagnostic, source, "en").message.endswith("Did you mean YY?")
    assert message(unknown, source, "en").message == "There is no variable or sensor Y"
    assert message(unknown, source, "en").fix.startswith("Which number is Y?")


def test_braces_ats_and_line_ends_in_a_program_have_no_effect() -> None:
    for text in ("{fix}", "{0.__class__}", "{", "}", "%s", "@", "@number?", "a\nb\tc", "\x07"):
        values = {"by": "W", "found": text}
        full_message = message(
            Diagnostic(codes.WANTS_NUMBER, Span(0, 0), values), Source("W"), "en"
        )
        plain_text = text.replace("\n", " ").replace("\t", " ").replace("\x07", "␇")
        assert full_message.fix == f"Write a number instead of {plain_text}"


def test_terms_and_units_are_translated() -> None:
    assert first_message("X = 1;X = TRUE;SHOW(X)", "es")[0].message == (
        "X empezó como un número y no puede volverse un sí o no"
    )
    assert "F(tiempo, potencia)" in first_message("F(1)", "es")[0].message
    assert first_message("GRIPPER(181)", "es")[0].message.endswith("de 0 a 180 grados")
    assert first_message("M(101, 0)", "es")[0].message.endswith("de -100 a 100 %")
    assert first_message("SHOW(1000000 * 1000000)", "es")[0].message.endswith("es demasiado grande")


def test_long_pieces_of_a_program_are_shortened() -> None:
    message, _ = first_message("SHOW(" + "DISTANCE < 1 AND " * 5000 + "TRUE + 1)")
    assert len(message.message) < 200
    assert len(message.fix) < 200
    message, _ = first_message("A" * 100_000)
    assert len(message.message) < 200


# -- whole messages: `tests/cases` has them as text -----------------------------------------------


def test_colors_change_nothing_but_colors() -> None:
    for text in ("F(2 80)", "W(0.12345)"):
        message, source = first_message(text)
        colored_text = as_text(message, source, "en", color=True)
        assert colored_text != as_text(message, source, "en")
        assert re.sub(r"\033\[[0-9;]*m", "", colored_text) == as_text(message, source, "en")


def test_messages_are_available_as_json() -> None:
    compilation = check_text("F()\nX = 0.0001\nSHOW(X)", KIT)
    messages = [
        message(diagnostic, compilation.source, "en") for diagnostic in compilation.diagnostics
    ]
    assert as_json(messages) == [
        {
            "code": "TS020",
            "severity": "mistake",
            "line": 1,
            "column": 1,
            "end_line": 1,
            "end_column": 4,
            "message": "F needs 2 values in its brackets, F(time, power), but has 0",
            "fix": messages[0].fix,
        },
        {
            "code": "TS801",
            "severity": "warning",
            "line": 2,
            "column": 5,
            "end_line": 2,
            "end_column": 11,
            "message": "Numbers have at most three decimals, so 0.0001 becomes 0",
            "fix": "0",
        },
    ]


# -- explanations and languages -------------------------------------------------------------------


@pytest.mark.parametrize("lang", LANGUAGES)
@each_row("code", sorted(CODES))
def test_each_code_is_explained(code: str, lang: str) -> None:
    text = explain(code, lang)
    assert text is not None
    assert TEXTS[lang][f"{code}/title"] in text
    assert TEXTS[lang][f"{code}/more"] in text
    for example in ("wrong", "right"):
        for row in TEXTS[lang].get(f"{code}/{example}", "").split("\n"):
            assert row in text


def test_an_explanation_is_complete() -> None:
    assert explain("012", "es") == (
        "TS012 (error): Un decimal con coma\n"
        "\n"
        "En TiniScript la coma separa los valores; por eso F(1,5, 80) tiene tres: 1, 5 y 80. "
        "Uno y medio se escribe con punto: 1.5.\n"
        "\n"
        "Mal:\n"
        "\n"
        "    SI|F(1,5, 80)\n"
        "\n"
        "Bien:\n"
        "\n"
        "    SI|F(1.5, 80)"
    )


def test_a_code_is_found_however_it_is_written() -> None:
    full_text = explain("TS017", "en")
    assert full_text is not None
    assert explain("ts017", "en") == explain(" 017 ", "en") == full_text
    for code in ("TS999", "", "TS", "terms", "labels", "TSTS017", "٢٠٥", "hello"):
        assert explain(code, "en") is None


@pytest.mark.parametrize("lang", ["en", "es"])
def test_titles_list_every_code(lang: str) -> None:
    assert [code for code, _ in titles(lang)] == sorted(CODES)
    assert all(title for _, title in titles(lang))
