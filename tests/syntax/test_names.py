"""Words that are no words of the language are names: of variables, DEFs, sensors, actuators.

Beginners' typing mistakes are sought only where they are mistakes: a DEF may be called END, a
variable Y, a sensor RIGHT.
"""

from __future__ import annotations

import pytest

from tiniscript import compile_text
from tiniscript.base.kit import NUMBER, YES_NO, Device, Kit
from tiniscript.base.words import WORDS, lexicon, lexicon_concept

FOREIGN_WORDS = sorted(  # an arrow is no name
    word for word in lexicon() if lexicon_concept(word) in WORDS and word.isidentifier()
)
MISTAKEN_WORDS = ["END", "Y", "O", "THEN", "DO", "BEGIN", "NO", "YES", "IS", "LET", "VAR", "INT",
                  "CALL", "F2", "B50", "L90", "R1", "W1", "S1", "M2", "CM", "SEC", "FIN", "REM",
                  "ON", "OFF", "X", "SI_", "IF_", "ELSE_IF", "SQRT", "TINI", "N", "E5"]  # fmt: skip
NAMES = sorted({*FOREIGN_WORDS, *MISTAKEN_WORDS} - set(WORDS))

NO_KIT = Kit((), ())


def is_right(text: str, kit: Kit = NO_KIT) -> bool:
    compilation = compile_text(text, kit)
    return not [
        diagnostic.code.number for diagnostic in compilation.diagnostics if diagnostic.is_mistake
    ]


def test_a_variable_may_have_an_accented_name() -> None:
    for name in NAMES:
        count = f"{name} = 2;IF({name} > 1 AND {name} < 5);{name} = {name} + 1;ENDIF"
        assert is_right(count), name
        assert is_right(f"{name} = TRUE\nWHILE({name});{name} = NOT {name};END_WHILE"), name
        used = f"{name} = 50;F({name} / 100, {name});SHOW({name}) ; M({name}, -{name})"
        assert is_right(used), name
        assert is_right(f"Q=3\n{name}=4;LOOP({name});Q={name};END_LOOP;SHOW(Q)"), name


def test_a_def_may_have_an_accented_name() -> None:
    for name in NAMES:
        assert is_right(f"DEF {name};S;END_DEF;{name};LOOP(2);{name};END_LOOP"), name
        assert is_right(f"DEF {name}\nS\nEND_DEF\n{name}\nIF(TRUE)\n{name}\nENDIF"), name


@pytest.mark.parametrize("kind", [NUMBER, YES_NO])
def test_a_sensor_may_have_an_accented_name(kind: str) -> None:
    for name in NAMES:
        kit = Kit((Device(name, kind, "", 0, 1 if kind == YES_NO else 1000),), ())
        condition = name if kind == YES_NO else f"{name} > 0"
        text = f"{name};IF({condition});W(1) UNTIL({condition});ENDIF;SHOW({name})"
        assert is_right(text, kit), name


@pytest.mark.parametrize("kind", [NUMBER, YES_NO])
def test_an_actuator_may_have_an_accented_name(kind: str) -> None:
    value = "TRUE" if kind == YES_NO else "90"
    for name in NAMES:
        kit = Kit((), (Device(name, kind, "", 0, 1 if kind == YES_NO else 180_000),))
        text = f"{name}({value});IF(TRUE);{name}({value});ENDIF;W(1)\n{name}({value})"
        assert is_right(text, kit), name


def test_a_word_means_one_word_of_the_language() -> None:
    assert len(FOREIGN_WORDS) > 300
    for word in FOREIGN_WORDS:
        assert len({entry.kind for entry in lexicon()[word]} & {*WORDS}) == 1, word
