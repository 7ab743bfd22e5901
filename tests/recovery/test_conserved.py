"""Conservation: the result of `tsc check --fix` keeps the written values, whichever row made it."""

from __future__ import annotations

import re
from itertools import product

import pytest

from tests.pupils.corpus import check
from tests.support.rows import go_through
from tiniscript import robots
from tiniscript.base.languages import languages, read_language_file
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message
from tiniscript.recovery import rewrites
from tiniscript.recovery.conserved import difference

KIT = robots.load(robots.DEFAULT).kit
# A separate number without a unit.
NUMBER = re.compile(r"(?<![\w.,:'´])(?<!\d )\d+(?:\.\d+)?(?![\w.,:'´%°]| ?[a-z]| \d)")
# The unit of a number by the text before it, and the text after it.
PLACES = (
    (re.compile(r"\b[FBLR]\(-?$"), ""),
    (re.compile(r"\b[FBLR]\([^(),]*,\s*-?$|\bM\([^()]*$"), "%"),
    (re.compile(r"\b(?:W|BEEP)\(-?$|\bTIME\s*[<>=]+\s*-?$"), "s"),
    (re.compile(r"\bBEEP\([^(),]*,\s*-?$"), "Hz"),
    (re.compile(r"\bDISTANCE\s*[<>=]+\s*-?$"), "cm"),
)


def units() -> list[tuple[str, str, float]]:
    """Return one word for each unit of the lexicons, which it is, and how much one is."""
    unit_of = {}
    for language in languages():
        for row in read_language_file(language, "lexicon.txt").split("\n"):
            if row.startswith("unit ") and row.split()[1] in ("s", "cm", "°", "%", "Hz"):
                _, unit, scale = row.partition("|")[0].split()
                unit_of[unit, int(scale) / 1000] = row.partition("|")[2].split()[0].lower()
    return [(word, *its) for its, word in unit_of.items()]


def numbers(text: str) -> list[tuple[float, str]]:
    """Return the numbers of a program with their signs, and the unit of each by its place."""
    pairs = []
    for match in re.finditer(r"(?<![\w.])\d+(?:\.\d+)?", text):
        text_before, text_after = text[: match.start()], text[match.end() :]
        own_unit = next((unit for pattern, unit in PLACES if pattern.search(text_before)), None)
        if own_unit == "":
            way = re.match(r"(?i) ?(CM|DEG)\b", text_after)
            own_unit = {"CM": "cm", "DEG": "°"}[way[1].upper()] if way else "s"
        is_minus = re.search(r"(?:[(,=<>+*/]|^)\s*-$", text_before) is not None
        pairs.append((-float(match[0]) if is_minus else float(match[0]), own_unit or ""))
    return pairs


def is_kept(written_text: str, value: float, unit: str, repaired_text: str) -> bool:
    """Return whether a program has a number with its sign and unit, or still as it was written."""
    return written_text in repaired_text or any(
        abs(number - value) < 0.001 and (not own_unit or not unit or own_unit == unit)
        for number, own_unit in numbers(repaired_text)
    )


ROWS: list[rewrites.SignRow | rewrites.TokenRow] = [*rewrites.sign_rows(), *rewrites.token_rows()]
EXAMPLES = [row.example[0] for row in ROWS]
WRITTEN = [
    *("{}({}, 60)".replace("{}", word, 1) for word in "FBLR"),
    *("W({})", "SHOW({})", "X = {}\nSHOW(X)", "X = {}\nW(X)", "X = {}\nF(X, 60)\nR(X, 60)"),
    *("F(2, {})", "BEEP(1, {})", "F(5, 60) UNTIL(DISTANCE < {})", "W(9) UNTIL(TIME > {})"),
    *("W(1);F({} 60)", "W(1); R 60 {}", "F({}; 60);W(1)"),
]


def variants(text: str) -> list[tuple[str, str, float, str]]:
    """Return a program with another sign or a unit at each of its numbers, and that number."""
    texts = []
    for match in NUMBER.finditer(text):
        value = float(match[0])
        start, end = match.span()
        if text[:start].rstrip()[-1:] not in ("-", "+"):
            texts.append((f"{text[:start]}-{text[start:]}", f"-{match[0]}", -value, ""))
        for written_text, unit, scale in units():
            new_text = f"{text[:end]} {written_text}{text[end:]}"
            texts.append((new_text, f"{match[0]} {written_text}", value * scale, unit))
    return texts


@pytest.mark.sampled("text", keep=15)
@pytest.mark.parametrize("text", [*dict.fromkeys(EXAMPLES)])
def test_no_repair_of_an_example_loses_a_sign_or_a_unit(text: str) -> None:
    for wrong_text, written_text, value, unit in variants(text):
        repaired_text = repair_program(wrong_text, check).text
        assert is_kept(written_text, value, unit, repaired_text), (wrong_text, repaired_text)


@pytest.mark.sampled("text", keep=15)
@pytest.mark.parametrize("text", [*dict.fromkeys(EXAMPLES)])
def test_suggestions_keep_a_unit_or_report_its_loss(text: str) -> None:
    """A minus is not checked: without it, a move reverses, and the message says so."""
    for wrong_text, written_text, value, unit in variants(text):
        shown_diagnostics = [
            diagnostic
            for diagnostic in check(wrong_text)
            if diagnostic.repair and not diagnostic.repair.is_sure
        ]
        # Part of a single number: `2. 80`.
        is_part = re.search(rf"\d\. {re.escape(written_text)}", wrong_text)
        for diagnostic in shown_diagnostics if unit and not is_part else ():
            repaired_text = apply_edits(wrong_text, edits_of(diagnostic) or [])
            lost_text = diagnostic.values.get("lost", "")
            assert written_text in lost_text or is_kept(written_text, value, unit, repaired_text), (
                wrong_text,
                repaired_text,
            )


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(3))
def test_no_repair_loses_a_sign_or_a_unit(part: int) -> None:
    go_through(check_nothing_is_lost, WRITTEN[part::3])


def check_nothing_is_lost(text: str) -> None:
    for number, sign, space in product(("2", "0.5"), ("", "-", "- "), ("", " ")):
        for word, unit, scale in units():
            written_text = f"{sign}{number}{space}{word}"
            wrong_text = text.replace("{}", written_text)
            repaired_text = repair_program(wrong_text, check).text
            value = float(number) * scale * (-1 if sign else 1)
            assert is_kept(written_text, value, unit, repaired_text), (wrong_text, repaired_text)


@pytest.mark.parametrize(
    ("text", "repaired_text", "lost", "added"),
    [
        ("F(2 s, 80 %)", "F(2, 80)", [], []),
        ("avanza 2,5 s", "F(2.5, 80)", [], []),
        ("T = 500 ms;W(T)", "T = 0.5;W(T)", [], []),
        ("T = 500 ms;W(T)", "T = 500;W(T)", ["500 ms"], []),
        ("A = 30 CM;F(A, 60)", "A = 30;F(A, 60)", ["30 CM"], []),
        ("A = 30 CM;F(A, 60)", "A = 30;F(A CM, 60)", [], []),
        ("F(-2, 80)", "F(2, 80)", ["-2"], []),
        ("W(1);F(20, 60) CM", "W(1);F(20, 60)", ["CM"], []),
        ("SHOW(DISTANCE) cm", "SHOW(DISTANCE)", [], []),
        ("X = 5;F(2, 80) X", "X = 5;F(2, 80)", ["X"], []),
        ("IF(NOT DISTANCE < 9) S", "IF(DISTANCE < 9);S;ENDIF", ["NOT"], []),
        ("IF(DISTANCE NO ES 9);S;ENDIF", "IF(DISTANCE = 9);S;ENDIF", ["NO"], []),
        ("IF(DISTANCE ¡= 9);S;ENDIF", "IF(DISTANCE = 9);S;ENDIF", ["<>"], []),
        ("unless DISTANCE < 9 S", "IF(DISTANCE >= 9);S;ENDIF", [], []),
        ("IF(DISTANCE < 9) S", "IF(DISTANCE > 9);S;ENDIF", ["<"], []),
        ("IF(DISTANCE < 9, B(1, 60), F(1, 60))", "IF(DISTANCE < 9);B(1, 60);F(1, 60);ENDIF",
         ["ELSE"], []),
        ("S if DISTANCE < 9 else S", "S;IF(DISTANCE < 9);ELSE;S;ENDIF", ["ELSE"], []),
        ("DEF A1;S;END_DEF A1;A1", "DEF A1;S;END_DEF;A1;A1", [], ["A1"]),
        ("F(1, 80)", "F(1, 80);B(1, 80)", [], ["B"]),
        ("1. F(2, 80)\n2. S", "F(2, 80)\nS", [], []),
        ("F(2, 8O)", "F(2, 80)", [], []),
        ("W(1:30)", "W(90)", [], []),
        ("W(1 1/2)", "W(1.5)", [], []),
        ("IF(LIGHT_L > 50%);S;ENDIF", "IF(LIGHT_L > 50);S;ENDIF", ["50%"], []),
        ("IF(LIGHT_L > 50%)\nF(1, 50)", "IF(LIGHT_L > 50)\nF(1, 50)", ["50%"], []),
        ("T = 1;SHOW(ROUND(TIME() - T))", "T = 1;SHOW(ROUND(TIME, - T))", ["-"], []),
        ("X = RANDOM(1-6)", "X = RANDOM(1, 6)", [], []),
        ("4*(F(2, 80))", "LOOP(4);F(2, 80);END_LOOP", [], []),
    ],
)  # fmt: skip
def test_losses_and_additions_of_a_repair_are_found(
    text: str, repaired_text: str, lost: list[str], added: list[str]
) -> None:
    assert difference(text, repaired_text, KIT) == (lost, added)


@pytest.mark.parametrize(
    ("wrong_text", "repaired_text"),
    [
        ("T = 500 ms;W(T)", "T = 0.5;W(T)"),
        ("F(5, 60) UNTIL(TIME > 500 ms)", "F(5, 60) UNTIL(TIME > 0.5)"),
        ("D = 300 mm\nF(5, 60) UNTIL(DISTANCE < D)", "D = 30\nF(5, 60) UNTIL(DISTANCE < D)"),
        ("ANGULO = 90 graus; R(ANGULO, 60)", "ANGULO = 90; R(ANGULO DEG, 60)"),
        ("SIDE = 30 CM\nF(SIDE, 60)", "SIDE = 30\nF(SIDE CM, 60)"),
        ("SIDE = 30 CM\nW(SIDE)", "SIDE = 30 CM\nW(SIDE)"),
        ("IF(TIME > 2 min);S;ENDIF", "IF(TIME > 120);S;ENDIF"),
        ("D = 1 m\nSHOW(D)", "D = 100\nSHOW(D)"),
        ("W(1);F(20, 60) CM", "W(1);F(20, 60) CM"),
        ("DEF PASO;S\nENDDEF PASO\nPASO;PASO", "DEF PASO;S\nEND_DEF\nPASO;PASO"),
    ],
)
def test_repairs_keep_units_and_names_or_are_not_applied(
    wrong_text: str, repaired_text: str
) -> None:
    assert repair_program(wrong_text, check).text == repaired_text


@pytest.mark.parametrize(
    ("wrong_text", "tried_text"),
    [
        ("SIDE = 30 CM\nF(SIDE, 60)", "SIDE = 30 and F(SIDE CM, 60)"),
        ("SIDE = 30 CM\nW(SIDE)", "SIDE = 30"),
        ("F(25, 60 CM)", "F(60 CM, 25) or F(25 CM, 60)"),
        ("F(-0.5 M, 60)", "B(50 CM, 60)"),
        ("F(5, 60) HASTA(PARED < 10 seg)", "F(5, 60) UNTIL(DISTANCE < 10)"),
        ("R(-90 grados, 60)", "L(90 DEG, 60)"),
        ("F(- 2 sec, 60)", "B(2, 60)"),
    ],
)
def test_suggestions_name_losses_and_other_readings(wrong_text: str, tried_text: str) -> None:
    (diagnostic,) = check(wrong_text)
    shown_message = message(diagnostic, Source(wrong_text), "en")
    assert shown_message.fix == tried_text
    assert (lost_text := diagnostic.values.get("lost", "")) in shown_message.message
    assert bool(lost_text) is ("leaves out" in shown_message.message)
    assert repair_program(wrong_text, check).text == wrong_text or diagnostic.values.get("carried")


@pytest.mark.parametrize("digits", ["15", "25", "05", "251"])
@pytest.mark.parametrize(
    "wrong_text", ["F({0},{1}, {2})", "avanza {0},{1} segundos a {2}", "W({2});F({0},{1}, 80)"]
)
def test_digits_after_a_decimal_comma_are_not_a_second_number(wrong_text: str, digits: str) -> None:
    """`F(1,5, 15)` is F(1.5, 15): its 15 is there."""
    text = wrong_text.format(digits[0], digits[1:], digits)
    for diagnostic in check(text):
        assert "lost" not in diagnostic.values, (text, diagnostic.values)


def test_no_repair_removes_a_sign_as_a_command() -> None:
    """A stop sign is S, in any place; a sign without meaning may be removed."""
    rows = (read_language_file(language, "lexicon.txt").split("\n") for language in languages())
    command_rows = [row.partition("|") for its in rows for row in its if re.match("[FBLRS] ", row)]
    signs = [
        (cells[0].strip(), s) for cells in command_rows for s in cells[2].split() if not s.isascii()
    ]
    signs = [(word, sign) for word, sign in signs if len(sign) == 1 and not sign.isalpha()]
    assert ("S", "\U0001f6d1") in signs
    for word, sign in signs:
        for text in ("F(2, 80) {}", "F(2, 80){}", "F(2, 80); {}", "S\n{}", "SI|F(2, 80)\n  {} "):
            repaired_text = repair_program(text.format(sign), check).text
            assert sign in repaired_text or repaired_text.rstrip().endswith(word), (
                sign,
                text,
                repaired_text,
            )


def test_a_loss_in_one_line_does_not_block_repairs_of_others() -> None:
    """A number of another line is not that of this one, and BLA is unknown."""
    wrong_text = "IF(LUZ_ESQ > 50%)\nF(2 80)\nENDIF\nBLA(3);F(1, 50)"
    right_text = wrong_text.replace("F(2 80)", "F(2, 80)").replace("LUZ_ESQ", "LIGHT_L")
    assert repair_program(wrong_text, check).text == right_text


def test_a_unit_is_reported_at_its_place() -> None:
    wrong_text = "F(25 CM, 60) UNTIL(DISTANCE < 10 CM)"
    (diagnostic,) = check(wrong_text)
    assert (diagnostic.values["found"], wrong_text[slice(*diagnostic.span)]) == ("10 CM", "10 CM")
