"""Kinds of mistakes, and their messages: on one line and on several, in other words."""

from __future__ import annotations

from itertools import permutations, product

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message

SEPARATORS = (";", "\n", ";\n  ")  # instructions
BLOCKS = (
    ("LOOP(3)", "END_LOOP"),
    ("WHILE(DISTANCE > 10)", "END_WHILE"),
    ("IF(LIGHT_L > 5)", "ENDIF"),
)
TRAVELS = (("F", "CM"), ("B", "CM"), ("L", "DEG"), ("R", "DEG"))
PAIRS = ("F", "B", "L", "R", "M", "BEEP", "RANDOM", "ROUND", "MIN", "MAX")


def codes_and_fixes(text: str) -> list[tuple[str, str]]:
    """Return the code and the fix of each message."""
    messages = (message(diagnostic, Source(text), "en") for diagnostic in check(text))
    return [(message.code, message.fix) for message in messages]


def messages(text: str) -> list[str]:
    return [message(diagnostic, Source(text), "en").message for diagnostic in check(text)]


def apply_fix(text: str, diagnostic: Diagnostic) -> str:
    """Return a program with a diagnostic's offer applied."""
    return apply_edits(text, edits_of(diagnostic) or [])


# -- ends that are crossed ------------------------------------------------------------------------


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize(("outer", "inner"), [*permutations(BLOCKS, 2)])
@pytest.mark.parametrize("rest", ["R(1, 60)", "R(1, 60);W(2)", "LOOP(2);R(1, 60);END_LOOP"])
def test_crossed_ends_are_swapped_and_no_body_leaves_its_block(
    outer: tuple[str, str], inner: tuple[str, str], rest: str, separator: str
) -> None:
    lines = ["SI|S", outer[0], inner[0], "F(1, 60)", "{}", *rest.split(";"), "{}", "BEEP(1, 440)"]
    text = separator.join(lines)
    wrong_text, right_text = text.format(outer[1], inner[1]), text.format(inner[1], outer[1])
    assert not any(diagnostic.is_mistake for diagnostic in check(right_text))
    (diagnostic,) = check(wrong_text)
    assert diagnostic.code.number == "TS026" and diagnostic.values["swapped"] == inner[1]
    assert (
        apply_fix(wrong_text, diagnostic) == right_text
        and repair_program(wrong_text, check).text == wrong_text
    )


def test_crossed_ends_are_reported_beside_other_mistakes() -> None:
    text = "SI|LOOP(3);WHILE(DISTANCE > 10);F(1 60);END_LOOP;R(1, 60);END_WHILE"
    assert [code for code, _ in codes_and_fixes(text)] == ["TS017", "TS026"]
    text = "SI|REPETIR 3\nMIENTRAS(DISTANCE > 10)\nF(1, 60)\nFIN REPETIR\nR(1, 60)\nFIN MIENTRAS"
    assert [(first.code.number, first.values.get("ends")) for first in check(text)[:2]] == [
        ("TS102", "END_LOOP"), ("TS102", "END_WHILE"),
    ]  # fmt: skip
    assert (
        codes_and_fixes(text)[2][1] == "Write END_WHILE here, and END_LOOP where END_WHILE is now"
    )


def test_an_unmatched_end_or_one_across_a_branch_is_not_swapped() -> None:
    for text in ("LOOP(2);IF(DISTANCE < 9);S;END_LOOP;ELSE;W(1);ENDIF",
                 "LOOP(2);IF(DISTANCE < 9);S;END_LOOP;LOOP(2);ENDIF;S;END_LOOP"):  # fmt: skip
        assert not any(diagnostic.values.get("swapped") for diagnostic in check(text)), text


# -- a question with two branches -----------------------------------------------------------------


@pytest.mark.parametrize("word", ["IF", "SI", "SE", "=SI"])
@pytest.mark.parametrize("sign", ["; ", ";", ", "])
@pytest.mark.parametrize("template", ["SI|{}", "SI|W(1);{}", "SI|LOOP(2)\n{}\nEND_LOOP", "{};W(1)"])
def test_the_second_branch_of_a_question_is_its_else(word: str, sign: str, template: str) -> None:
    question_text = sign.join(["LIGHT_L > 300", "L(1, 60)", "BEEP(1, 440)"])
    wrong_text = template.format(f"{word}({question_text})")
    right_text = template.format("IF(LIGHT_L > 300);L(1, 60);ELSE;BEEP(1, 440);ENDIF")
    assert apply_fix(wrong_text, check(wrong_text)[0]).replace("; ", ";") == right_text


def test_text_after_the_closing_bracket_is_outside_the_branch() -> None:
    text = "SI|W(1);SI(DISTANCE < 10; S);F(1, 60)"
    assert repair_program(text, check).text == "SI|W(1);IF(DISTANCE < 10);S;ENDIF;F(1, 60)"


# -- a DEF that is set ----------------------------------------------------------------------------


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize("value", ["40", "V + 1", "DISTANCE"])
def test_a_def_with_one_value_that_is_assigned_is_called(separator: str, value: str) -> None:
    lines = ["SI|DEF PASSO(N)", "F(N CM, 60)", "END_DEF", "V = 3", f"PASSO = {value}", "S"]
    wrong_text = separator.join(lines)
    assert codes_and_fixes(wrong_text)[0] == ("TS110", f"PASSO({value})")
    assert apply_fix(wrong_text, check(wrong_text)[0]) == wrong_text.replace(
        f"PASSO = {value}", f"PASSO({value})"
    )


def test_a_variable_named_like_a_def_is_renamed() -> None:
    for text in ("DEF A;S;END_DEF;A = 3;A", "DEF A(N);W(N);END_DEF;A = 3;A(2);SHOW(A)"):
        assert codes_and_fixes(text)[0] == ("TS110", "A_2")
    two = "DEF LADO(N, P);F(N, P);END_DEF;LADO = 2, 60"
    assert (
        codes_and_fixes(two) == [("TS015", "LADO(2, 60)")]
        and repair_program(two, check).text == two
    )


# -- a letter that multiplies ---------------------------------------------------------------------


@pytest.mark.parametrize("sign", ["x", "X", "\u00d7", "\u00b7"])
@pytest.mark.parametrize(
    "text",
    ["SI|V = 3;V = 2 {} V;SHOW(V)", "SI|V = 3\nV = V {} V\nSHOW(V)", "SI|SHOW(DISTANCE {} 2)",
     "SI|W(1);F(2 {} 3, 60)", "IF(LIGHT_L {} 2 > 90);S;ENDIF", "V = 4;V = V {} (V + 1);SHOW(V)"],
)  # fmt: skip
def test_a_letter_between_two_values_multiplies(text: str, sign: str) -> None:
    assert repair_program(text.format(sign), check).text == text.format("*")


@pytest.mark.parametrize("text", ["V = 3\nV = 2 x V", "A = 1;B1 = A x A;SHOW(B1)", "V = V x 2"])
@pytest.mark.parametrize("other_statement", ["", ";F(2 80", ";BLA(2)", "\nSHOW(ROUND(TIME, 1)"])
def test_nothing_that_multiplies_becomes_a_note(text: str, other_statement: str) -> None:
    assert not any("//" in fix for _, fix in codes_and_fixes(f"SI|{text}{other_statement}"))


def test_a_variable_x_is_only_shown_as_a_sign() -> None:
    text = "SI|X = 4;Y = 2 x X;SHOW(Y)"
    assert (
        codes_and_fixes(text) == [("TS010", "Y = 2 * X")]
        and repair_program(text, check).text == text
    )
    assert not check("SI|X = 4;SHOW(2 * X)")


# -- units ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("word", "unit"), TRAVELS)
@pytest.mark.parametrize("template", ["SI|{}", "SI|W(1);{};S", "SI|DEF A\n{}\nEND_DEF\nA"])
@pytest.mark.parametrize(("power", "way"), [("70", "30"), ("60", "90"), ("40", "25"), ("99", "20")])
def test_a_unit_stays_with_its_number_and_the_alternative_is_shown(
    word: str, unit: str, template: str, power: str, way: str
) -> None:
    wrong_text = template.format(f"{word}({power}, {way} {unit})")
    own_reading, other_reading = f"{word}({way} {unit}, {power})", f"{word}({power} {unit}, {way})"
    assert codes_and_fixes(wrong_text) == [("TS076", f"{own_reading} or {other_reading}")]
    assert repair_program(wrong_text, check).text == wrong_text


@pytest.mark.parametrize(("word", "unit"), TRAVELS)
@pytest.mark.parametrize("template", ["SI|{}", "SI|W(1);{};S", "SI|DEF A\n{}\nEND_DEF\nA"])
@pytest.mark.parametrize(("little", "power"), [("2", "60"), ("5", "20"), ("0.5", "100")])
def test_a_tiny_value_is_not_the_power_if_another_number_fits(
    word: str, unit: str, template: str, little: str, power: str
) -> None:
    wrong_text = template.format(f"{word}({little}, {power} {unit})")
    first_reading, other_reading = (
        f"{word}({little} {unit}, {power})",
        f"{word}({power} {unit}, {little})",
    )
    assert codes_and_fixes(wrong_text) == [("TS076", f"{first_reading} or {other_reading}")]
    assert repair_program(wrong_text, check).text == wrong_text


def test_each_of_several_moves_has_both_readings() -> None:
    text = "SI|F(60, 20 CM); R(60, 90 DEG);L(50, 45 DEG)"
    assert [fix for _, fix in codes_and_fixes(text)] == [
        "F(20 CM, 60) or F(60 CM, 20)", "R(90 DEG, 60) or R(60 DEG, 90)",
        "L(45 DEG, 50) or L(50 DEG, 45)",
    ]  # fmt: skip


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize(
    ("unit", "word", "way"), [("CM", "F", "CM"), ("cm", "B", "CM"), ("graus", "R", "DEG")]
)
def test_the_unit_of_a_value_of_a_def_goes_into_its_body(
    separator: str, unit: str, word: str, way: str
) -> None:
    lines = [f"SI|DEF LADO(LARGO {unit})", f"{word}(LARGO, 60)", "W(1)", "LADO(30)", "END_DEF"]
    whole = separator.join(lines)
    (diagnostic,) = check(whole)
    assert f"{word}(LARGO {way}, 60)" in apply_fix(whole, diagnostic) and "lost" not in {
        name for name, value in diagnostic.values.items() if value
    }
    body = [line.removeprefix("SI|") for line in lines[:3]]
    late = separator.join(["SI|LADO(30)", *body, lines[4]])
    assert f"{word}(LARGO {way}, 60)" in apply_fix(late, check(late)[0])


def test_a_moved_program_reports_the_lost_unit() -> None:
    text = "SI|ESPERA_X(3)\nDEF ESPERA_X(N graus)\nW(N)\nEND_DEF"
    (diagnostic,) = check(text)
    assert diagnostic.values["lost"] == "graus" and repair_program(text, check).text == text


@pytest.mark.parametrize(("word", "unit"), TRAVELS)
def test_a_misspelled_unit_is_read_as_a_unit(word: str, unit: str) -> None:
    """Two neighbours exchanged, a letter wrong, missing or too much."""
    slips = {unit[1] + unit[0] + unit[2:], "X" + unit[1:], unit[:1] + unit[2:], unit + unit[-1]}
    for slip in {slip for slip in slips if len(slip) > 1} - {"XEG"}:
        for text in (f"SI|{word}(20 {slip}, 60)", f"SI|W(1);BLA(2)\nV = 5;{word}(V {slip}, 60);S"):
            fixes = [fix for _, fix in codes_and_fixes(text)]
            assert not any("Take" in fix for fix in fixes), text
            assert any(f"{unit}, 60)" in fix for fix in fixes), (text, fixes)


# -- a ; between two values -----------------------------------------------------------------------


@pytest.mark.parametrize("word", PAIRS)
@pytest.mark.parametrize("other_statement", ["", "BLA(2);", "F(2 80;", "W(1)\n"])
def test_a_semicolon_between_two_values_is_named(word: str, other_statement: str) -> None:
    call = f"{word}(40; 60)" if word in PAIRS[:6] else f"SHOW({word}(1; 2))"
    comma = call.replace(";", ",")
    text = f"SI|{other_statement}{call}"
    offers = [(code, fix) for code, fix in codes_and_fixes(text) if comma in fix]
    assert offers and offers[0][0] in ("TS017", "TS019"), codes_and_fixes(text)
    assert not {"TS042", "TS088"} & {code for code, _ in codes_and_fixes(text)}


@pytest.mark.parametrize(("word", "unit"), TRAVELS)
def test_a_right_unit_before_a_semicolon_is_not_reported(word: str, unit: str) -> None:
    for number in ("20", "N_2", "2 * 3"):
        codes = {code for code, _ in codes_and_fixes(f"SI|W(1);{word}({number} {unit}; 60)")}
        assert "TS019" in codes and "TS088" not in codes


# -- consequences of one mistake ------------------------------------------------------------------


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize(
    ("head", "end", "slip"),
    [("DEF GIRO", "END_DEF", "END_DFE"), ("LOOP(2)", "END_LOOP", "END_LOPO"),
     ("IF(DISTANCE < 9)", "ENDIF", "ENIDF"), ("WHILE(TRUE)", "END_WHILE", "END_WIHLE")],
)  # fmt: skip
@pytest.mark.parametrize("other_statement", ["", "BLA(2)"])
def test_a_misspelt_end_is_that_end(
    separator: str, head: str, end: str, slip: str, other_statement: str
) -> None:
    lines = [f"SI|{head}", "L(1, 60)", slip, "GIRO" if "DEF" in head else "S", other_statement]
    diagnostics = check(separator.join(filter(None, lines)))
    assert [diagnostic.code.number for diagnostic in diagnostics] == ["TS101"] * (
        1 + bool(other_statement)
    )
    assert diagnostics[0].values["near"] == end


@pytest.mark.parametrize("head", ["DEF PASO", "DEF PASO(N)", "LOOP(4)"])
@pytest.mark.parametrize("dots", ["...", "\u2026", ". . ."])
def test_an_end_after_dots_is_not_missing(head: str, dots: str) -> None:
    end = "END_LOOP" if head == "LOOP(4)" else "END_DEF"
    call = {"DEF PASO": "PASO", "DEF PASO(N)": "PASO(3)"}.get(head, "S")
    text = f"SI|{head} {dots} {end}\nF(1, 60)\nLOOP(2)\n{call}\nEND_LOOP"
    ((code, fix),) = codes_and_fixes(text)
    assert code == "TS082" and ("DEF" in head) == (f"{head}; F(1, 60); {end}" in fix)


@pytest.mark.parametrize("separator", SEPARATORS)
def test_a_wrong_head_of_a_def_makes_no_name_of_its_body_unknown(separator: str) -> None:
    lines = ["SI|DEF LADO(30)", "F(LARGO CM, 60)", "W(LARGO)", "END_DEF", "LADO(30)", "W(ZZZ)"]
    assert [code for code, _ in codes_and_fixes(separator.join(lines))] == ["TS091", "TS103"]


# -- the content of a message ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "right_text"),
    [("LADO(pot=60, lar=20)", "LADO(20, 60)"), ("LADO(20, pot = 60)", "LADO(20, 60)"),
     ("LADO(pot=60, 20)", "LADO(20, 60)"), ("LADO(LAR=V + 1, POT=60)", "LADO(V + 1, 60)")],
)  # fmt: skip
@pytest.mark.parametrize("separator", SEPARATORS)
def test_named_values_of_a_def_are_put_in_its_order(
    call: str, right_text: str, separator: str
) -> None:
    lines = ["SI|DEF LADO(LAR, POT)", "F(LAR CM, POT)", "END_DEF", "V = 4", call]
    assert codes_and_fixes(separator.join(lines)) == [("TS052", right_text)]
    assert not check("DEF A(Q);IF(Q);S;ENDIF;END_DEF;X = 3;A(X = 3)")


@pytest.mark.parametrize("end", ["FIM", "FIN", "END"])
@pytest.mark.parametrize("text", ["SEMPRE; F(1, 60); {}", "W(1)\nSIEMPRE\nF(1, 60)\n{}\n"])
def test_an_end_that_closes_a_block_is_not_superfluous(text: str, end: str) -> None:
    assert not any("not needed" in message for message in messages(f"SI|{text.format(end)}"))
    assert "THEN is not needed here." in messages("IF(DISTANCE < 9) THEN;S;ENDIF")


@pytest.mark.parametrize("sign", ["**", "^", " ** ", " ^"])
def test_a_power_is_named_with_all_of_its_sign(sign: str) -> None:
    text = f"SI|V = 3;W(V{sign}2)"
    (diagnostic,) = check(text)
    assert diagnostic.values["right"] == "* V" and diagnostic.values["found"].startswith(
        sign.strip()
    )
    assert text[slice(*diagnostic.span)] == diagnostic.values["found"]


def test_two_offers_explain_how_their_brackets_differ() -> None:
    (offer,) = codes_and_fixes("SI|D = MAX(LIGHT_L, 4 + LIGHT_R")
    first, second = "(in the brackets: LIGHT_L, 4 + LIGHT_R)", "(in the brackets: LIGHT_L, 4)"
    assert offer[1].index(first) < offer[1].index(second)


@pytest.mark.parametrize("word", ["PARA", "for", "para"])
def test_a_message_names_the_word_that_was_written(word: str) -> None:
    (diagnostic, *_) = check(f"SI|{word} N DE 1 A 3\nF(N, 60)\nFIN")
    assert (diagnostic.code.number, diagnostic.values["found"]) == ("TS102", word)


@pytest.mark.parametrize(
    ("condition_text", "next_move"), [*product(["DISTANCE<25", "LIGHT_L > 300"], "FB")]
)
def test_the_question_after_until_is_shown(condition_text: str, next_move: str) -> None:
    text = f"SI|F(5, 60) UNTIL {condition_text}. {next_move}(1, 50)"
    assert (
        repair_program(text, check).text
        == f"SI|F(5, 60) UNTIL({condition_text}); {next_move}(1, 50)"
    )


@pytest.mark.parametrize("number", ["15", "32.5"])
@pytest.mark.parametrize(
    "other_statement", ["W(9) UNTIL(DISTANCE < {})", "IF(DISTANCE < {});S;ENDIF"]
)
def test_an_example_uses_the_number_of_the_program(number: str, other_statement: str) -> None:
    other_line = other_statement.format(number)
    for text in (f"SI|F(FOREVER, 50);{other_line}", f"SI|{other_line}\nB(FOREVER, 50)"):
        assert codes_and_fixes(text)[0][1].endswith(f"UNTIL(DISTANCE < {number})")
    assert codes_and_fixes("SI|F(FOREVER, 50)")[0][1].startswith(
        "F(FOREVER, 50) UNTIL(DISTANCE < 10)"
    )


# -- questions --------------------------------------------------------------------------------

ORDERS = ("F(5, 60)", "S", "BEEP(1, 440)", "SHOW(DISTANCE)", "P")
COMPARISON = "DISTANCE > 3"
CONDITION_TEMPLATES = [
    *("F(5, 60) IF({})", "F(5, 60) IF {}", "S IF({});F(1, 50)", "S IF({})\nF(1, 50)"),
    *("F(5, 60) WHEN {} BEEP(1, 440)", "IF {} S ENDIF", "IF({}) S ENDIF", "F(5, 60) UNTIL {}"),
    *("WHILE {};F(1, 50);END_WHILE", "WHEN({}) BEEP(1, 440) END", "STOP({})"),
    *("F(5, 60) UNTIL {} AND LIGHT_L > 5", "IF {} OR LIGHT_L > 5 S ENDIF"),
]


@pytest.mark.sampled("text", keep=4)
@pytest.mark.parametrize("place", ["SI|{}", "SI|W(1);{}", "SI|W(1)\n{}"])
@pytest.mark.parametrize("text", CONDITION_TEMPLATES)
def test_a_yes_no_may_replace_any_comparison(text: str, place: str) -> None:
    wrong_text = place.format(text)
    compared = [fix for _, fix in codes_and_fixes(wrong_text.format(COMPARISON))]
    assert compared and COMPARISON in compared[0]
    for question in ("KEY_A", "NOT KEY_LEFT", "KEY_UP AND KEY_B"):
        as_compared = [fix.replace(COMPARISON, question) for fix in compared]
        assert [fix for _, fix in codes_and_fixes(wrong_text.format(question))] == as_compared


@pytest.mark.sampled("order", keep=2)
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(
    ("word", "end"), [("IF", "ENDIF"), ("WHILE", "END_WHILE"), ("WHEN", "END_WHEN")]
)
@pytest.mark.parametrize("template", ["{}", "W(1);{}", "W(1)\n{}", "{};W(2)"])
def test_text_after_a_trailing_condition_does_not_become_its_block(
    order: str, word: str, end: str, template: str
) -> None:
    for question in ("KEY_A", COMPARISON):
        line = f"{order} {word}({question});B(1, 50)"
        text = f"SI|DEF P;S;END_DEF\n{template.format(line)}"
        assert any(diagnostic.is_mistake for diagnostic in check(text))
        assert repair_program(text, check).text == text
        ended_text = f"SI|DEF P;S;END_DEF\n{template.format(f'{line};{end}')}"
        assert (
            f"{order};{word}({question});B(1, 50);{end}" in repair_program(ended_text, check).text
        )


# -- what is named, and what is reported once -------------------------------------------------


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize("template", ["SI|{}", "SI|F(2, 80);{}", "{};S"])
@pytest.mark.parametrize(
    ("head", "named_text"),
    [
        ("PARA I DE 1 A 4", "PARA"), ("para i de 1 até 4 faça", "para"),
        ("FOR I FROM 1 TO 4", "FOR"),
        ("para cada i de 1 a 4", "para cada"),
    ],
)  # fmt: skip
def test_only_the_counting_word_is_named(
    head: str, named_text: str, template: str, separator: str
) -> None:
    text = template.format(separator.join((head, "L(1, 60)", "END_LOOP")))
    diagnostic = next(diagnostic for diagnostic in check(text) if diagnostic.code.number == "TS102")
    assert (diagnostic.values["found"], text[slice(*diagnostic.span)]) == (named_text, named_text)


@pytest.mark.parametrize("use", ["F(1, {})", "LOOP({});S;END_LOOP", "BEEP(1, {});BEEP(2, {})"])
@pytest.mark.parametrize("name", ["notes", "N"])
def test_a_name_that_holds_a_list_is_not_compared_as_a_number(name: str, use: str) -> None:
    text = f"SI|{name} = [440, 494]\n{use.replace('{}', name)}"
    assert [code for code, _ in codes_and_fixes(text)] == ["TS067"]
    assert "TS103" in [code for code, _ in codes_and_fixes(text + ";W(OTHER)")]
