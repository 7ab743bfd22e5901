"""Labels: anything that numbers an instruction is removed, in each place and language."""

from __future__ import annotations

from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.diagnostics.fixing import repair_program

NUMBER_LABELS = (
    "{n})",
    "{n}.",
    "{n} -",
    "{n}.-",
    "({n})",
    "{n}º",
    "{n}:",
    "{a})",
    "{a}.",
    "{A})",
    "{a}:",
)
WORDS = (
    "Questão", "Questao", "Passo", "Paso", "Step", "Linha", "Ejercicio", "Exercício", "Pregunta",
    "Item", "Parte", "Mission",
)  # fmt: skip
WORD_LABELS = (
    "{w} {n}:",
    "{w} {n} -",
    "{w} {n})",
    "{w} {n}.",
    "{w} {a}:",
    "{w} nº {n}:",
    "{w}{n}:",
)
LABELS = [*NUMBER_LABELS, *(label.replace("{w}", w) for w, label in product(WORDS, WORD_LABELS))]
PROGRAMS = (
    ("F(2, 60)", "L(90 DEG, 60)", "BEEP(1, 500)", "S"),
    ("LOOP(2)", "F(25 CM, 60)", "END_LOOP", "S"),
    ("IF(DISTANCE < 9)", "S", "ELSE", "F(1, 60)", "ENDIF"),
    ("V = 3", "DEF LADO", "W(V)", "END_DEF", "LADO"),
)
PLACES = (("", "\n"), ("", ";"), ("", "; "), ("SI|", "\n"), ("SI|", ";"), ("SB|", "\n  "))


def add_labels(label: str, program: tuple[str, ...]) -> list[str]:
    letters = "abcde"
    names = (label.format(n=k + 1, a=letters[k], A=letters[k].upper()) for k in range(len(program)))
    return [f"{name} {order}" for name, order in zip(names, program, strict=True)]


@pytest.mark.sampled("label", keep=32)
@pytest.mark.parametrize("label", LABELS)
def test_a_label_is_removed_anywhere(label: str) -> None:
    for program, (text_before, separator) in product(PROGRAMS, PLACES):
        wrong_text = text_before + separator.join(add_labels(label, program))
        assert {diagnostic.code.number for diagnostic in check(wrong_text)} == {"TS054"}, wrong_text
        assert repair_program(wrong_text, check).text == text_before + separator.join(program), (
            wrong_text
        )


@pytest.mark.parametrize("label", LABELS)
def test_a_label_is_reported_near_setup_titles_and_other_mistakes(label: str) -> None:
    rows = add_labels(label, ("SI|F(2, 60)", "R(2 60)"))
    codes = [diagnostic.code.number for diagnostic in check("\n".join(["My square", *rows]))]
    assert codes == ["TS073", "TS054", "TS054", "TS017"]


@pytest.mark.parametrize(
    "text",
    ["F(2; 80) S", "F(2,\n80) S", "DEF B;S;END_DEF;B. F(2, 80)", "4) 80", "F(2;80) R(1;50)",
     "Ejercicio 3. El cuadrado", "REPEAT 4: F(2, 80)", "espera 2. F(1, 60)", "F: F(2, 80)",
     "avanza 2) F(1, 60)", "S. F(2, 80)", "IF 3: F(2, 80)", "PASO 1 = 3", "4 vueltas: F(2, 80)",
     "TASK 1: F(2, 80)", "X = |5 - DISTANCE|"],
)  # fmt: skip
def test_possible_instructions_are_not_removed_as_labels(text: str) -> None:
    assert "TS054" not in {diagnostic.code.number for diagnostic in check(f"SI|{text}")}
