"""Before which statement a program halts that is to halt at a place of its text."""

from __future__ import annotations

import random

import pytest

from tests.oracle import programs
from tests.support.images import image_of
from tests.support.kits import KITS
from tiniscript.bytecode.statements import statement_of, statement_starts


@pytest.mark.parametrize("seed", range(20))
def test_every_offset_belongs_to_the_last_statement_begun_before_it(seed: int) -> None:
    oracle_kit, kit = KITS[seed % len(KITS)]
    code = image_of(programs.program(random.Random(seed), oracle_kit), kit).code
    starts = statement_starts(code)
    statements = [statement_of(starts, offset) for offset in range(len(code))]
    assert [statements[start] for start in starts] == starts
    assert statements == sorted(statements)
    assert all(start <= offset for offset, start in enumerate(statements))
