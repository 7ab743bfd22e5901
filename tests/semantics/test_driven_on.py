"""A move with FOREVER and no UNTIL, which a later S was to end."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.words import WORDS
from tiniscript.diagnostics import codes

# Places in a program; in TASKs other instructions interrupt it.
SURROUNDINGS = (
    "{}", "W(1);{}", "{};W(1)", "IF(DISTANCE < 9);{};ENDIF",
    "IF(DISTANCE < 9);W(1);ELSE;{};ENDIF", "LOOP(2);IF(DISTANCE < 9);W(1);ENDIF;{};END_LOOP",
    "DEF SIDE;{};END_DEF;SIDE",
)  # fmt: skip
WAITS = {
    "W(3)": "F(3, 60)",
    "W(ABS(0 - 3))": "F(ABS(0 - 3), 60)",
    "w(forever) UNTIL(DISTANCE < 9)": "F(forever, 60) UNTIL(DISTANCE < 9)",
}


def move_values(text: str) -> dict[str, str]:
    """Return the values of the diagnostic of FOREVER about the move."""
    values = next(
        diagnostic.values
        for diagnostic in check(text)
        if diagnostic.code is codes.FOREVER_NEEDS_UNTIL
    )
    return {key: values[key] for key in ("whole", "running") if key in values}


@pytest.mark.parametrize("template", SURROUNDINGS)
@pytest.mark.parametrize("separator", [";", "\n", "  // on;S\n", "\n\n// it drives\n"])
def test_a_wait_and_s_end_a_move_anywhere(template: str, separator: str) -> None:
    for wait, whole in WAITS.items():
        parts = separator.join(("F(FOREVER, 60)", wait, "STOP"))
        assert move_values(template.format(parts)) == {"whole": whole}, parts


@pytest.mark.parametrize("template", SURROUNDINGS)
@pytest.mark.parametrize(("move", "motors"), [
    ("F", "M(60, 60)"), ("B", "M(-60, -60)"), ("L", "M(-60, 60)"), ("R", "M(60, -60)"),
])  # fmt: skip
def test_a_later_s_ends_the_motors(template: str, move: str, motors: str) -> None:
    text = f"{move}(FOREVER, 60);BEEP(1, 440);LOOP(2);BEEP(1, 880);END_LOOP;S"
    assert move_values(template.format(text)) == {"running": motors}


@pytest.mark.parametrize("template", SURROUNDINGS)
@pytest.mark.parametrize("tail", [
    "", " // on; S", ";W(3)", ";W(3) // S", ";B(1, 50);S", ";IF(DISTANCE < 9);S;ENDIF",
    ";W(1) UNTIL(DISTANCE < 9);W(1);S",
])  # fmt: skip
def test_no_other_instruction_ends_a_move(template: str, tail: str) -> None:
    rest = template.replace("{};", "{}\n")  # a note ends with its line
    assert move_values(rest.format(f"F(FOREVER, 60){tail}")) == {}


@pytest.mark.sampled("template")
@pytest.mark.parametrize("template", SURROUNDINGS)
@pytest.mark.parametrize("word", [*WORDS, "espera"])
def test_no_other_word_with_forever_is_taken_for_a_move(template: str, word: str) -> None:
    """This holds for any number of values: FOREVER alone, first, last or between others."""
    for values in ("FOREVER", "FOREVER, 60", "60, FOREVER", "FOREVER, 60, 60", ""):
        check(template.format(f"{word}({values});W(3);S"))
    check(f"{word} hasta que presione el boton")
