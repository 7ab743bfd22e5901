"""A block that is written as in another language gets one message, which shows all of it."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, applied
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import edits_of, fixed
from tiniscript.diagnostics.rendering import message


@pytest.mark.parametrize(
    ("program", "shown"),
    [
        ("SI|LOOP(4){\n  F(1, 60);\n}", "SI|LOOP(4); F(1, 60); END_LOOP"),
        (
            "if (DISTANCE < 20) {\n  B(1, 60);\n} else {\n  F(1, 60);\n}",
            "IF(DISTANCE < 20); B(1, 60); ELSE; F(1, 60); ENDIF",
        ),
        ("S\nLOOP(4)\n{\nF(1, 60)\n}\nS", "LOOP(4); F(1, 60); END_LOOP"),  # with its header
        ("for(int i=0;i<4;i++){\n  F(1, 60);\n}", "LOOP(4); F(1, 60); END_LOOP"),
        ("repetir 4\nF(1, 60)\nfin", "LOOP(4); F(1, 60); END_LOOP"),
        ("por siempre\nF(1, 60)", "LOOP(FOREVER); F(1, 60); END_LOOP"),
        ("for i in range(4):\n    F(1, 60)\nS", "LOOP(4); F(1, 60); END_LOOP"),
        (
            "si distancia < 20\nF(1, 50) // va\nsino\nB(1, 50)\nfin",
            "IF(DISTANCE < 20); F(1, 50); ELSE; B(1, 50); ENDIF",
        ),
    ],
)
def test_one_message_shows_the_whole_block(program: str, shown: str) -> None:
    (found,) = check(program)
    assert found.values["whole"] == shown
    assert message(found, Source(program), "es").fix == shown
    edits = edits_of(found)
    assert edits and not any(each.is_mistake for each in check(applied(program, edits)))


def test_a_frame_beside_the_block_is_told_apart() -> None:
    program = "void setup(){\n}\nvoid loop(){\n  F(1, 50);\n}"
    assert check(program)[-1].values["whole"] == "LOOP(FOREVER); F(1, 50); END_LOOP"
    assert not check(fixed(program, check).text)


def test_a_mistake_of_another_kind_keeps_its_message() -> None:
    first, other = check("LOOP(4){\n  F(1; 60);\n}")
    assert first.values["whole"] == "LOOP(4); F(1, 60); END_LOOP"
    assert other.code is codes.SEMICOLON_INSIDE


@pytest.mark.parametrize(
    "program",
    [
        "repetir 4\nF(1, 60)\nR(1, 60)",  # what belongs to it is not said
        "LOOP(4){\nF(1, 60)\nSALTA\n}",  # one line of it stays wrong
        "LOOP(4){\n" + "F(1, 60)\n" * 40 + "}",  # nobody copies so much
    ],
)
def test_what_is_not_sure_or_long_is_not_shown(program: str) -> None:
    assert not any(each.values.get("whole") for each in check(program))
