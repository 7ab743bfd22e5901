"""A DEF with values is read and reported in the same way for each number of values.

The brackets of its header and of its call may be missing, with or without commas, and what is said
of a word of the program's own ends with no gap.
"""

from __future__ import annotations

import re
from itertools import product

import pytest

from tests.pupils.corpus import check
from tests.support.rows import each_row
from tiniscript.base.languages import languages
from tiniscript.base.limits import PARAMETERS
from tiniscript.base.source import Source, apply_edits
from tiniscript.base.words import WORDS
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message

NAMES, NUMBERS = ("SIZE", "V", "ZOOM", "N2"), ("30", "2.5", "7", "0")
ARGUMENT_COUNTS = range(1, PARAMETERS + 1)
JOINTS = (", ", " ", " ,")
PROGRAM = "DEF SIDE{head}\nSHOW({body})\nEND_DEF\nW(1)\nSIDE{call}"


def program(head: str, call: str, count: int) -> str:
    return PROGRAM.format(head=head, call=call, body=" + ".join(NAMES[:count]))


@each_row("count, joint, other", product(ARGUMENT_COUNTS, JOINTS, JOINTS))
def test_brackets_may_be_missing_around_any_count(count: int, joint: str, other: str) -> None:
    names, numbers = NAMES[:count], NUMBERS[:count]
    right_text = {"head": f"({', '.join(names)})", "call": f"({', '.join(numbers)})"}
    bare = {"head": f" {joint.join(names)}", "call": f" {other.join(numbers)}"}
    for lacks in ({"head"}, {"call"}, {"head", "call"}):
        wrong_text = program(count=count, **{**right_text, **{text: bare[text] for text in lacks}})
        assert repair_program(wrong_text, check).text == program(count=count, **right_text), (
            wrong_text
        )


CALL_SLIPS = (
    "{w}(,{a})",
    "{w}({a},)",
    "{w}[{a}]",
    "{w}{{{a}}}",
    "{w}({a}))",
    "{w}(,,{a})",
    "Y = {w}({a})",
)


@pytest.mark.parametrize("language", languages())
def test_no_message_about_a_def_has_a_gap_or_a_wrong_word(language: str) -> None:
    for count, slip in product(ARGUMENT_COUNTS, CALL_SLIPS):
        names, numbers = (", ".join(its[:count]) for its in (NAMES, NUMBERS))
        header = slip.format(w="", a=names) if slip[0] == "{" else ""
        for text in (
            program(f"({names})", f"({numbers})\n{slip.format(w='SIDE', a=numbers)}", count),
            *([program(header, f"({numbers})", count)] if header else []),
        ):
            for diagnostic in check(text):
                full_message = message(diagnostic, Source(text, ""), language)
                assert not re.search(r":\s*(?:DEF)?\s*$", full_message.message), full_message
                assert not re.match(r"Y\b", full_message.message), full_message


# -- the message about each call, in every language ---------------------------------------------

VALUE_LISTS = (
    "3",
    "30 CM",
    "-3",
    "TRUE",
    "DISTANCE",
    "DISTANCE < 10",
    "(1)",
    "MAX(1, 2)",
    "X",
    "1, 2",
)
# no other word
UNTAUGHT_NAMES = ("A", "Q", "AB", "ABC", "LADO", "SIDE", "CUADRADO", "HOLA_2", "ZIGZAG")


@pytest.mark.parametrize("name", UNTAUGHT_NAMES)
def test_an_undefined_word_is_explained_with_def_for_any_values(name: str) -> None:
    for values_text in VALUE_LISTS:
        text = f"{name}({values_text})"
        first = check(text)[0]
        for language in languages():
            full_message = message(first, Source(text, ""), language)
            assert f"DEF {name}(" in full_message.fix, (text, language, full_message)


@pytest.mark.parametrize("count", range(1, PARAMETERS + 1))
def test_a_wrong_number_of_values_is_reported_with_the_call(count: int) -> None:
    usage = f"SIDE({', '.join(NAMES[:count])})"
    for value_count in range(PARAMETERS + 2):
        text = f"DEF {usage}\nS\nEND_DEF\nSIDE({', '.join(['60'] * value_count)})"
        diagnostics = [
            diagnostic for diagnostic in check(text) if diagnostic.code.number == "TS141"
        ]
        assert len(diagnostics) == (value_count != count), text
        for language, diagnostic in product(languages(), diagnostics):
            full_message = message(diagnostic, Source(text, ""), language)
            assert usage in full_message.message + full_message.fix, full_message
            assert re.search(rf"\b{count} val(ue|or)e?s?\b", full_message.message), full_message


KINDS = (
    ("SHOW(N + 1)", "TRUE", "TS201"), ("F(N, 50)", "FALSE", "TS201"),
    ("LOOP(N);S;END_LOOP", "TRUE", "TS201"), ("IF(N);S;ENDIF", "3", "TS202"),
    ("IF(NOT N);S;ENDIF", "3", "TS202"), ("IF(N AND TRUE);S;ENDIF", "3", "TS202"),
    ("W(1) UNTIL(N)", "3", "TS202"),
)  # fmt: skip


@each_row("body, values_text, code", KINDS)
def test_a_body_that_needs_another_kind_names_the_first_call(
    body: str, values_text: str, code: str
) -> None:
    """Also below a call through another DEF; variables of the program are reported as before."""
    for text, called_text in (
        (f"DEF SIDE(N);{body};END_DEF;SIDE({values_text})", "SIDE"),
        (f"DEF SIDE(n);{body};END_DEF;DEF TWO(K);SIDE(K);END_DEF;TWO({values_text})", "SIDE"),
        (f"N = {values_text};{body}", ""),
    ):
        (diagnostic,) = (diagnostic for diagnostic in check(text) if diagnostic.code.number == code)
        for language in languages():
            fix = message(diagnostic, Source(text, ""), language).fix
            assert ("SIDE" in fix) == bool(called_text), (text, fix)


EXTRAS = (" = 5", "=5", " + 1", "=-5", " = (5)", " = MAX(1, 2)", " < 3")


@each_row("count, extra", product(ARGUMENT_COUNTS, EXTRAS))
def test_wrong_text_after_a_defs_name_is_reported_with_the_right_header(
    count: int, extra: str
) -> None:
    """Default values of Python for calls without any. All names are known below."""
    names = NAMES[:count]
    right_text = program(f"({', '.join(names)})", f"({', '.join(NUMBERS[:count])})", count)
    for place in range(count):
        wrong_text = right_text.replace(names[place], names[place] + extra, 1)
        (diagnostic,) = check(wrong_text)
        assert diagnostic.code.number == "TS091", wrong_text
        assert diagnostic.values["fix"] == right_text.split("\n")[0], wrong_text


@pytest.mark.parametrize("count", range(2, PARAMETERS + 1))
def test_a_missing_comma_in_a_def_is_shown_in_its_header(count: int) -> None:
    names = NAMES[:count]
    right_text = program(f"({', '.join(names)})", f"({', '.join(NUMBERS[:count])})", count)
    for bits in range(1, 1 << (count - 1)):
        joints = [" " if bits >> k & 1 else ", " for k in range(count - 1)]
        head = "".join(map("".join, zip(names, [*joints, ""], strict=True)))
        wrong_text = right_text.replace(", ".join(names), head, 1)
        (diagnostic,) = check(wrong_text)
        assert (diagnostic.code.number, diagnostic.values["fix"]) == (
            "TS017",
            right_text.split("\n")[0],
        ), wrong_text


@pytest.mark.parametrize("word", sorted(word for word in WORDS if WORDS[word].is_call))
@pytest.mark.parametrize("count", [0, *ARGUMENT_COUNTS])
def test_a_def_by_a_word_of_the_language_is_renamed_with_its_calls(word: str, count: int) -> None:
    argument_count = len(WORDS[word].arguments)
    if count == argument_count:
        return  # the callee is ambiguous
    head = f"({', '.join(NAMES[:count])})" if count else ""
    call = f"({', '.join(NUMBERS[:count])})" if count else ""
    inside = f"F({NAMES[0]} CM, 60)" if count else "F(30 CM, 60)"
    program = f"DEF {{0}}{head}\n{inside}\nEND_DEF\nW(1)\n{{0}}{call}\n{{0}}{call}"
    wrong_text = program.format(word)
    (diagnostic,) = check(wrong_text)
    assert diagnostic.code.number == "TS105"
    repaired_text = apply_edits(wrong_text, edits_of(diagnostic) or [])
    assert repaired_text == program.format(f"{word}_1")
    assert not [diagnostic for diagnostic in check(repaired_text) if diagnostic.is_mistake]


UNKNOWN_WORDS = ("I", "FOO", "HACER", "XX")


@pytest.mark.parametrize(
    "place", ["{}", "SI|{}", "SI|W(1);{}", "{};S", "IF(DISTANCE < 9);{};ENDIF"]
)
def test_calls_in_a_row_are_instructions_also_of_unknown_words(place: str) -> None:
    known_calls = ("F(2, 80)", "W(1)", "BEEP(1, 440)")
    for one, word, gap in product(known_calls, UNKNOWN_WORDS, (" ", "  ", "")):
        calls = (one, f"{word}(1, 60)", known_calls[0])
        wrong_text = place.format(gap.join(calls))
        first, *others = check(wrong_text)
        assert first.code.number == "TS013", wrong_text
        assert apply_edits(wrong_text, edits_of(first) or []) == place.format(";".join(calls)), (
            wrong_text
        )
        assert [diagnostic.values.get("found") for diagnostic in others] == [word], wrong_text


@pytest.mark.parametrize("point", [". ", " . ", ".  "])
@pytest.mark.parametrize(
    "right_text", ["F(2, 80)", "B(1, 60)", "L(0.5, 60)", "BEEP(1, 440)", "M(50, -30)"]
)
def test_a_point_before_a_space_is_read_as_a_comma(right_text: str, point: str) -> None:
    for place in ("{}", "SI|{}", "W(1);{};S", "S\n{}\nS"):
        wrong_text = place.format(right_text.replace(", ", point))
        assert repair_program(wrong_text, check).text == place.format(right_text), wrong_text
