"""Random programs of the oracle: together they do all that there is, and end in every way."""

from __future__ import annotations

import random

import pytest

from tests.oracle.ast import Do, Statement
from tests.oracle.interpreter import PAPER_KIT, run
from tests.oracle.programs import WIDE_KIT, program, senses
from tests.oracle.tasks import TaskRobot, Turns
from tests.oracle.words import RANGES


def test_random_programs_are_valid_and_use_every_instruction(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Are valid, and together do every instruction and end in every way."""
    used_words: set[str] = set()

    def watch(name: str) -> None:
        does = getattr(TaskRobot, name)

        def watch_statement(self: TaskRobot, statement: Statement) -> Turns:
            word = statement.word if isinstance(statement, Do) else type(statement).__name__.upper()
            used_words.add(
                f"{word} UNTIL" if isinstance(statement, Do) and statement.until else word
            )
            turns: Turns = does(self, statement)
            return turns

        monkeypatch.setattr(TaskRobot, name, watch_statement)

    for name in ("doing", "choosing", "repeating"):
        watch(name)
    for number in range(200):
        rng = random.Random(number)
        kit = WIDE_KIT if number % 2 else PAPER_KIT
        text = program(rng, kit)
        trace = run(text, kit, senses(rng, kit), 20_000, 20_000, rng.randint(1, 2**32 - 1))
        used_words.add(trace.splitlines()[-1].split(" ", 1)[1])
    words = {*RANGES, "S", "SHOW", "=", "READ", "SET", "CALL", "BREAK"}
    untils = {f"{word} UNTIL" for word in "FBLRW"}
    blocks_and_ends = {"IF", "LOOP", "WHILE", "DONE", "LIMIT", "FAULT OVERFLOW"}
    assert used_words == words | untils | blocks_and_ends | {"FAULT DIVIDE_BY_ZERO"}
