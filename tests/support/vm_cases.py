"""The cases of the machine, sorted by their contents."""

from __future__ import annotations

import pytest

from tests.support.casefile import all_cases

CASES = all_cases()


def having(*parts: str) -> list[pytest.ParameterSet]:
    return [pytest.param(case, id=case.id) for case in CASES if all(p in case.parts for p in parts)]


def disassemblies_alone() -> list[pytest.ParameterSet]:
    """Return the disassemblies of no program."""
    cases = [case for case in CASES if "tiniscript" not in case.parts and "bytecode" in case.parts]
    return [pytest.param(case, id=case.id) for case in cases]
