"""Replacements for misplaced words: each offer is a correct program."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript import check_text, robots
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, apply_edits
from tiniscript.base.words import lexicon
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.rendering import message

TINIBOT, LINER = robots.load("tinibot").kit, robots.load("liner").kit
SEPARATORS = (";", "\n", "; ")


def fix_of(text: str, lang: str = "en") -> str:
    return message(check(text)[0], Source(text), lang).fix


def mistakes(text: str) -> list[str]:
    return [diagnostic.code.number for diagnostic in check(text) if diagnostic.is_mistake]


# -- a sensor that is set ---------------------------------------------------------------------


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize("word", "FB")
@pytest.mark.parametrize("value", ["30", "7.5"])
@pytest.mark.parametrize("template", ["SI|{}", "SI|W(1);{}", "SI|{};S"])
def test_a_number_for_a_driven_distance_is_centimetres(
    separator: str, word: str, value: str, template: str
) -> None:
    text = template.format(f"DISTANCE = {value}{separator}{word}(DISTANCE, 60){separator}S")
    (diagnostic,) = check(text)
    assert f"Write {word}({value} CM, 60) instead of {word}(DISTANCE, 60)" in fix_of(text)
    assert diagnostic.repair is not None and not diagnostic.repair.is_sure
    right_text = template.format(f"{word}({value} CM, 60){separator}S")
    assert apply_edits(text, diagnostic.repair.edits) == right_text and not mistakes(right_text)


def test_each_use_up_to_the_next_assignment_is_rewritten() -> None:
    text = "SI|DISTANCE = 30;F(DISTANCE, 60);B(DISTANCE, 40);DISTANCE = 9;F(DISTANCE, 60)"
    first = check(text)[0]
    assert first.repair is not None
    text_after = apply_edits(text, first.repair.edits)
    assert text_after == "SI|F(30 CM, 60);B(30 CM, 40);DISTANCE = 9;F(DISTANCE, 60)"


@pytest.mark.parametrize(
    ("unit", "number", "way"),
    [("mm", "300", "30 CM"), ("m", "0.5", "50 CM"), ("cm", "30", "30 CM"), ("°", "90", "90 DEG")],
)
def test_the_unit_of_the_move_follows_the_sensor(unit: str, number: str, way: str) -> None:
    sensors = tuple(
        sensor._replace(unit=unit) if sensor.unit == "cm" else sensor for sensor in TINIBOT.sensors
    )
    word = "R" if way.endswith("DEG") else "F"
    text = f"SI|DISTANCE = {number};{word}(DISTANCE, 60)"
    (diagnostic,) = check_text(text, TINIBOT._replace(sensors=sensors)).diagnostics
    assert diagnostic.values["way"] == f"{word}({way}, 60)"


def test_a_move_in_another_unit_gets_its_own_number() -> None:
    assert "CM, 60" not in fix_of("SI|DISTANCE = 30;R(DISTANCE, 60)")
    assert fix_of("SI|DISTANCE = 30;R(DISTANCE, 60)").startswith("R does not take CM")
    kit = TINIBOT._replace(speed=0, turn=0)
    (diagnostic,) = check_text("SI|DISTANCE = 30;F(DISTANCE, 60)", kit).diagnostics
    full_message = message(diagnostic, Source("SI|DISTANCE = 30;F(DISTANCE, 60)"), "en")
    assert full_message.fix.startswith("F takes a time here, not CM")
    assert fix_of("SI|LIGHT_L = 300;F(LIGHT_L, 60)") == "LIGHT_L_1 = 300"


# -- BREAK outside a loop ---------------------------------------------------------------------

HEADS = ["IF(DISTANCE < 10)", "IF(KEY_A AND LIGHT_L > 3)"]
RESTS = [["BEEP(1, 440)"], ["F(1, 60)", "S"], ["LOOP(2);S;END_LOOP"]]


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("inside", [[], ["S"], ["B(1, 60)", "W(1)"]])
@pytest.mark.parametrize("rest", RESTS)
@pytest.mark.parametrize(
    "template", ["SI|{}", "SI|F(2, 60);{}", "DEF A;{};END_DEF;A", "TASK;{};END_TASK;F(9, 60)"]
)
def test_instructions_after_a_break_move_into_the_other_branch(
    separator: str, head: str, inside: list[str], rest: list[str], template: str
) -> None:
    text = template.format(separator.join([head, *inside, "BREAK", "ENDIF", *rest]))
    diagnostic = next(diagnostic for diagnostic in check(text) if diagnostic.code.number == "TS115")
    right_text = [head, *(inside or ["S"]), "ELSE", *rest, "ENDIF"]
    assert diagnostic.values["fix"] == ";".join(right_text)
    assert diagnostic.repair is not None
    text_after = apply_edits(text, diagnostic.repair.edits)
    joined_text = text_after.replace("\n", ";").replace("; ", ";")
    assert joined_text == template.format(";".join(right_text)).replace("; ", ";")
    assert not mistakes(text_after)


@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("inside", [[], ["S"], ["B(1, 60)", "W(1) // wait"]])
@pytest.mark.parametrize("rest", [["BEEP(1, 440)"], ["F(1, 60)", "S // and stand"]])
@pytest.mark.parametrize("template", ["SI|{}", "SI|F(2, 60)\n{}", "DEF A\n{}\nEND_DEF\nA"])
def test_comments_around_a_break_are_kept(
    head: str, inside: list[str], rest: list[str], template: str
) -> None:
    text = template.format("\n".join([head, *inside, "BREAK // it ends", "ENDIF // if", *rest]))
    diagnostic = next(diagnostic for diagnostic in check(text) if diagnostic.code.number == "TS115")
    assert diagnostic.repair is not None
    text_after = apply_edits(text, diagnostic.repair.edits)
    last_comment = " // it ends" if inside else "S // it ends"
    lines = [head, *inside, last_comment, "ELSE // if", *rest, "ENDIF"]
    assert text_after == template.format("\n".join(lines))
    assert not mistakes(text_after)
    plain = [line.partition(" //")[0] for line in (*(inside or ["S"]), "ELSE", *rest)]
    assert diagnostic.values["fix"] == ";".join([head, *plain, "ENDIF"])


def test_a_break_in_the_else_is_repaired_in_reverse() -> None:
    text = "SI|IF(DISTANCE < 9);B(1, 60);ELSE;S;BREAK;ENDIF;W(2)"
    assert check(text)[0].values["fix"] == "IF(DISTANCE < 9);B(1, 60);W(2);ELSE;S;ENDIF"


@pytest.mark.parametrize(
    "text",
    ["SI|BREAK;F(1, 60)", "SI|IF(DISTANCE < 9);BREAK;ENDIF",
     "SI|IF(DISTANCE < 9);BREAK;S;ENDIF;W(1)",
     "SI|IF(DISTANCE < 9);S;ELSEIF(DISTANCE < 20);BREAK;ENDIF;W(1)",
     "SI|IF(DISTANCE < 9);IF(KEY_A);BREAK;ENDIF;S;ENDIF;W(1)",
     "SI|IF(DISTANCE < 9);BREAK;ENDIF;DEF A;S;END_DEF;A"],
)  # fmt: skip
def test_no_branch_is_offered_if_nothing_or_too_much_is_skipped(text: str) -> None:
    diagnostic = next(diagnostic for diagnostic in check(text) if diagnostic.code.number == "TS115")
    assert not diagnostic.values.get("fix") and diagnostic.repair is None


# -- a lamp -----------------------------------------------------------------------------------

LAMPS = sorted(
    word for word, entries in lexicon().items()
    if any(it.kind == "LED" and not it.value for it in entries) and word != "LED"
)  # fmt: skip
LIGHTS = ["LIGHT", "LUZ"]
SWITCHED = ["ON", "OFF", "HIGH", "LOW", "TRUE", "FALSE", "1", "0"]


def find_diagnostics(text: str, kit: Kit) -> list[Diagnostic]:
    return check_text(text, kit).diagnostics


@pytest.mark.parametrize("template", ["SI|{}", "SI|W(2);{};F(1, 60)", "LOOP(2);{};END_LOOP"])
@pytest.mark.parametrize("state_text", SWITCHED)
@pytest.mark.parametrize("word", [*LAMPS, *LIGHTS])
def test_a_robot_without_a_lamp_is_reported(word: str, state_text: str, template: str) -> None:
    text = template.format(f"{word}({state_text})")
    (shown_message,) = [
        message(diagnostic, Source(text), "en") for diagnostic in find_diagnostics(text, TINIBOT)
    ]
    assert shown_message.code == "TS122"
    assert f"no lamp that a program can switch with {word}" in shown_message.message


@pytest.mark.parametrize("state_text", SWITCHED)
@pytest.mark.parametrize("word", [*LAMPS, *LIGHTS])
def test_a_robots_lamp_is_named(word: str, state_text: str) -> None:
    text = f"SI|{word}({state_text});W(1)"
    (diagnostic,) = find_diagnostics(text, LINER)
    answer = "TRUE" if state_text in ("ON", "HIGH", "TRUE", "1") else "FALSE"
    assert f"LED({answer})" in message(diagnostic, Source(text), "en").fix


def test_lamps_are_reported_once_and_an_unswitched_light_is_not_a_lamp() -> None:
    assert len(find_diagnostics("SI|LIGHT(ON);W(2);LIGHT(OFF)", TINIBOT)) == 1
    assert LAMPS and "L\u00c2MPADA" in str(
        find_diagnostics("SI|L\u00c2MPADA(1)", TINIBOT)[0].values
    )
    for text in ("SI|LIGHT(300)", "SI|LIGHT", "SI|LED(ON)"):
        assert find_diagnostics(text, TINIBOT)[0].code.number != "TS122"
    assert not find_diagnostics("DEF LAMP(N);W(N);END_DEF;LAMP(1)", TINIBOT)


# -- a number in the brackets of a DEF ---------------------------------------------------------


@pytest.mark.parametrize(("lang", "name"), [("en", "SIZE"), ("es", "LARGO"), ("pt", "TAMANHO")])
@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize(
    "inside", ["F({} CM, 60)", "R({}, 60)", "W(1 + {})", "LOOP({});S;END_LOOP"]
)
def test_a_number_in_a_def_is_also_named_in_its_body(
    lang: str, name: str, separator: str, inside: str
) -> None:
    lines = ["SI|DEF SIDE(40)", "B(1, 60)", *inside.format("40").split(";"), "END_DEF", "SIDE(40)"]
    text = separator.join(lines)
    fix = fix_of(text, lang)
    assert inside.format(name).split(";")[0] in fix and f"DEF SIDE({name})" in fix
    assert "SIDE(40)" in fix
    right_text = text.replace("DEF SIDE(40)", f"DEF SIDE({name})")
    assert not mistakes(right_text.replace(inside.format("40"), inside.format(name)))


def test_another_number_of_the_body_is_not_named() -> None:
    for head in ("4", "40, 60"):
        fix = fix_of(f"SI|DEF SIDE({head});F(40 CM, 60);END_DEF;SIDE(40)")
        assert "F(SIZE" not in fix and "SIDE(30)" in fix


# -- initials of another language -------------------------------------------------------------


@pytest.mark.parametrize("place", ["SI|{}", "W(1);{}", "{};S", "IF(DISTANCE < 9);{};ENDIF"])
@pytest.mark.parametrize("other_statement", ["D(1, 50)", "I(1, 50)", "d(2, 30)"])
def test_the_letter_a_beside_another_initial_means_forward(
    place: str, other_statement: str
) -> None:
    for first, second in (("A(2, 70)", other_statement), (other_statement, "a(2, 70)")):
        text = place.format(f"{first};{second}")
        near_by_word = {
            diagnostic.values["found"]: diagnostic.values.get("near") for diagnostic in check(text)
        }
        assert near_by_word["A"] == "F", text


@pytest.mark.parametrize("text", ["A(2, 70)", "A(2, 70);F(1, 50);D(1, 50)", "A(2, 70);L(1, 50)"])
def test_an_initial_alone_or_beside_an_f_is_not_a_word(text: str) -> None:
    assert all(diagnostic.values.get("near") != "F" for diagnostic in check(text))
