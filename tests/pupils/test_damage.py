"""Right programs with slips of the finger: no repair loses a number, and all end.

python -m tests.pupils.test_damage 10000    so many damaged programs
"""

from __future__ import annotations

import random
import re
import sys
from functools import partial

import pytest

from tests.pupils.corpus import OTHER_NUMBERS, check, mistake_count
from tests.support.damaged_programs import programs
from tiniscript.base.source import apply_edits
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import edits_of, repair_program

SEEDS_IN_CI = 150
# Inserted or replacing characters: of phones, of other languages, of Spanish.
INSERTED_TEXTS = [
    *";,.:()[]{}|=<>+-*/%!?\"'°~# ", "\n", "\r\n", "//", "==", "&&", "++", ":=", " y ", " o ", "O",
    " si ", " entonces ", " fin ", " SINO ", " ENDIF ", " END_LOOP ", " LOOP(2) ", "l", "ñ", "s",
    "%", " adelante ", " girar ", " derecha ", " 5 ", " cm", "F", " DEF ", " mi vel ",
]  # fmt: skip


def damage_program(seed: int) -> str:
    """Return a right program with one to three slips."""
    rng = random.Random(seed)
    text = rng.choice(programs())
    for _ in range(rng.randint(1, 3)):
        k = rng.randrange(len(text) + 1)
        damage_kind = rng.randrange(5)
        if damage_kind == 0:
            text = text[:k] + text[k + 1 :]
        elif damage_kind == 1:
            text = text[:k] + rng.choice(INSERTED_TEXTS) + text[k:]
        elif damage_kind == 2:
            text = text[:k] + rng.choice(INSERTED_TEXTS) + text[k + 1 :]
        elif damage_kind == 3:
            text = text[:k] + text[k + 1 : k + 2] + text[k : k + 1] + text[k + 2 :]
        else:
            end = text.find("\n", k) + 1 or len(text)
            text = text[:k] + text[end:]
    return text


@pytest.mark.sampled("seed", keep=SEEDS_IN_CI // 3)
@pytest.mark.parametrize("seed", range(SEEDS_IN_CI))
def test_a_damaged_program_is_repaired_or_left(seed: int) -> None:
    text = damage_program(seed)
    diagnostics = check(text)
    for diagnostic in diagnostics[:20]:
        edits = edits_of(diagnostic)
        assert edits is None or apply_edits(text, edits) != text
    repaired_program = repair_program(text, check)
    assert mistake_count(repaired_program.diagnostics_left) <= mistake_count(diagnostics)
    assert repaired_program.diagnostics_left == check(repaired_program.text)
    assert repair_program(repaired_program.text, check).text == repaired_program.text
    for diagnostic in diagnostics[:20]:  # each alone
        edits = edits_of(diagnostic)
        repair_alone = repair_program(text, partial(_only_for_text, text, diagnostic))
        if repair_alone.text != text and diagnostic.code not in OTHER_NUMBERS:
            assert edits and digits(text) == digits(apply_edits(text, edits))


def digits(text: str) -> str:
    return "".join(re.findall("[0-9]", text))


def _only_for_text(text: str, diagnostic: Diagnostic, changed_text: str) -> list[Diagnostic]:
    return [diagnostic] if changed_text == text else []


if __name__ == "__main__":
    for seed in range(int(sys.argv[1])):
        test_a_damaged_program_is_repaired_or_left(seed)
        if seed % 1000 == 999:
            print(seed + 1, flush=True)
