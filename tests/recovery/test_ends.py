"""A block of one line without its end: the message lists possible ends, `--fix` guesses none.

If only one place is possible, the message names it, and the repair changes that block.
"""

from __future__ import annotations

from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message

BLOCKS = (
    ("WHEN(DISTANCE < 15)", "END_WHEN"), ("TASK", "END_TASK"), ("LOOP(3)", "END_LOOP"),
    ("IF(DISTANCE < 15)", "ENDIF"), ("WHILE(DISTANCE > 15)", "END_WHILE"),
)  # fmt: skip
BODIES = (
    ("BEEP(1, 880)", "F(10, 40)"), ("W(1)", "S"), ("F(1, 60)", "F(1, 60)", "S"),
    ("S", "LOOP(2);R(1, 60);END_LOOP", "B(1, 60)"),
)  # fmt: skip
ENCLOSING_BLOCKS = (
    ("LOOP(2)", "END_LOOP"),
    ("DEF PASSO", "END_DEF;PASSO"),
    ("LOOP(FOREVER)", "END_LOOP"),
)
PROGRAM_HEADS = ("SI|", "SI|W(3);", "SB|V = 3;F(V, 60);")


def code_and_fix(text: str) -> tuple[str, str]:
    (diagnostic,) = [diagnostic for diagnostic in check(text) if diagnostic.is_mistake]
    shown_message = message(diagnostic, Source(text), "en")
    assert shown_message.code == "TS024"
    return shown_message.message, shown_message.fix


def places(body: tuple[str, ...]) -> str:
    return ", ".join(line.split(";")[-1] for line in body)


@pytest.mark.parametrize("separator", [";", "; ", " ; "])
@pytest.mark.parametrize(("open_text", "block"), [*product(PROGRAM_HEADS, BLOCKS)])
def test_each_possible_end_is_named_but_none_is_inserted(
    open_text: str, block: tuple[str, str], separator: str
) -> None:
    for body in BODIES:
        text = open_text + separator.join((block[0], *body))
        _, tried_text = code_and_fix(text)
        assert (
            tried_text
            == f"Where does the block end? Write ;{block[1]} after one of these: {places(body)}"
        )
        assert repair_program(text, check).text == text


@pytest.mark.parametrize("enclosing_block", ENCLOSING_BLOCKS)
@pytest.mark.parametrize("block", BLOCKS[2:])
@pytest.mark.parametrize("body", BODIES[:3])
def test_the_inner_block_lacks_its_end_if_the_outer_one_has_its_own(
    body: tuple[str, ...], block: tuple[str, str], enclosing_block: tuple[str, str]
) -> None:
    if (block[1], enclosing_block[1]) == ("END_LOOP", "END_LOOP"):
        return  # the end may be of either
    text = "SI|" + ";".join((enclosing_block[0], block[0], *body, enclosing_block[1]))
    name = block[0].partition("(")[0]
    assert code_and_fix(text) == (
        f"This {name} has no {block[1]}",
        f"Where does the block end? Write ;{block[1]} after one of these: {places(body)}",
    )
    assert repair_program(text, check).text == text


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("tail", ["", ";F(8, 50)"])
def test_an_endless_loop_in_a_task_ends_with_the_task(body: tuple[str, ...], tail: str) -> None:
    text = "SI|" + ";".join(("TASK", "LOOP(FOREVER)", *body, "END_TASK")) + tail
    last_line = body[-1]
    assert code_and_fix(text) == ("This LOOP has no END_LOOP", f"Write ;END_LOOP after {last_line}")
    assert repair_program(text, check).text == text.replace("END_TASK", "END_LOOP;END_TASK")


@pytest.mark.parametrize("block", BLOCKS)
def test_a_single_possible_end_is_stated_directly(block: tuple[str, str]) -> None:
    text = f"SI|{block[0]}; F(1, 60)"
    assert code_and_fix(text)[1] == f"Write ;{block[1]} after F(1, 60)"


def test_a_missing_end_follows_the_last_branch_or_precedes_an_outer_end() -> None:
    text = "SI|IF(DISTANCE < 9);S;W(2);ELSE;W(1);F(1, 60)"
    assert (
        code_and_fix(text)[1]
        == "Where does the block end? Write ;ENDIF after one of these: W(1), F(1, 60)"
    )
    (diagnostic,) = check("SI|LOOP(2);IF(DISTANCE < 9);S;END_LOOP")
    repaired_text = apply_edits(
        "SI|LOOP(2);IF(DISTANCE < 9);S;END_LOOP", edits_of(diagnostic) or []
    )
    assert repaired_text == "SI|LOOP(2);IF(DISTANCE < 9);S;ENDIF;END_LOOP"
