"""Motors set individually: a pair is one M with both powers, in any place."""

from __future__ import annotations

from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message

PAIRS = (
    ("motorLeft.run", "motorRight.run"), ("left_motor", "right_motor"), ("motorL", "motorR"),
    ("motorIzquierdo", "motorDerecho"), ("MotorEsquerdo.girar", "MotorDireito.girar"),
    ("motor_izq", "motor_der"), ("LeftMotor.setSpeed", "RightMotor.setSpeed"),
)  # fmt: skip
PLACES = (
    "SI|{}", "{}", "W(3);{}", "{};W(3)", "SI|W(3);{};S", "IF(DISTANCE < 9);{};ENDIF",
    "DEF A1;{};END_DEF;A1", "TASK;{};END_TASK", "LOOP(2)\n{}\nEND_LOOP",
)  # fmt: skip
SEPARATORS = (";", "; ", "\n", ";\n")
POWERS = (("60", "60"), ("-30", "45"))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("pair", PAIRS)
def test_a_pair_of_motor_commands_becomes_one_m(pair: tuple[str, str], place: str) -> None:
    for separator, (left, right), is_turned in product(SEPARATORS, POWERS, (False, True)):
        calls = (f"{pair[0]}({left})", f"{pair[1]}({right})")
        wrong_text = place.format(separator.join(calls[::-1] if is_turned else calls))
        edits = [edit for diagnostic in check(wrong_text) for edit in edits_of(diagnostic) or []]
        assert apply_edits(wrong_text, edits) == place.format(f"M({left}, {right})"), wrong_text
        assert (
            repair_program(wrong_text, check).text == wrong_text
        )  # elsewhere its power is not a percentage


@pytest.mark.parametrize("language", ["en", "es", "pt"])
@pytest.mark.parametrize("place", PLACES)
def test_a_message_about_a_single_motor_explains_that_m_sets_both(
    place: str, language: str
) -> None:
    for pair in PAIRS:
        for name in pair:
            text = place.format(f"{name}(60)")
            (shown_message,) = [
                message(diagnostic, Source(text), language) for diagnostic in check(text)
            ]
            assert "M(50, 80)" in shown_message.fix, text


@pytest.mark.parametrize("separator", SEPARATORS)
def test_a_name_defined_by_the_program_is_not_a_motor(separator: str) -> None:
    defs = (f"DEF MOTOR_{side}(X);M(X, X);END_DEF" for side in "LR")
    text = separator.join((*defs, "MOTOR_L(60)", "MOTOR_R(30)", "F(2 80)"))
    assert [diagnostic.code.number for diagnostic in check(text)] == ["TS017"]


ON = {"forward": "F", "robot.backward": "B", "mBot.turnLeft": "L", "derecha": "R", "F": "F"}
WAITS = {"sleep(2)": "2", "time.sleep(0.5)": "0.5", "delay(1500)": "1.5", "espera(3)": "3"}
OFF = ("stop()", "mBot.stop()", "S", "parar()")


@pytest.mark.sampled("place")
@pytest.mark.parametrize("place", [place for place in PLACES if place != "{}"])
@pytest.mark.parametrize("off", OFF)
def test_motors_on_and_off_after_a_wait_are_a_move(off: str, place: str) -> None:
    for separator, (on, word), (wait, time) in product(SEPARATORS, ON.items(), WAITS.items()):
        wrong_text = place.format(separator.join((f"{on}(50)", wait, off)))
        edits = [edit for diagnostic in check(wrong_text) for edit in edits_of(diagnostic) or []]
        assert apply_edits(wrong_text, edits) == place.format(f"{word}({time}, 50)"), wrong_text
        twice = place.format(separator.join((f"{on}(50)", wait, "left(40)", wait, off)))
        edits = [edit for diagnostic in check(twice) for edit in edits_of(diagnostic) or []]
        assert apply_edits(twice, edits) == place.format(f"{word}({time}, 50);L({time}, 40)"), twice


@pytest.mark.parametrize("text", ["F(2);W(2);S", "F(50);W(2)", "F(2, 50);W(2);S", "F(50);S;W(2)"])
def test_no_move_is_made_without_power_wait_and_end(text: str) -> None:
    assert "F(2, 50)" not in [
        diagnostic.values.get("fix") for diagnostic in check(text) if diagnostic.repair
    ]


def test_a_word_defined_by_the_program_switches_no_motor() -> None:
    wrong_text = "DEF GO(X);F(X, 60);END_DEF;GO(50);W(2);S;F(2 80)"
    assert [diagnostic.values.get("fix") for diagnostic in check(wrong_text)] == ["F(2, 80)"]
