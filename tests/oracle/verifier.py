"""The verifier in `bytecode_spec.md`, run exactly as it is in the page.

It shares nothing with the package: the instructions come from the tables of the page. If it
disagrees with the others about a rule or an offset, the page is wrong, or one of them is.
"""

from __future__ import annotations

import re
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from tests.oracle.spec_tables import SPEC, Instruction, instructions, rule_numbers

Verdict = tuple[int, int]  # the number of the rule that is broken, or 0, and the offset
OF_TASKS = ("TASK", "WHEN", "LOOK", "END_TASK", "END_WHEN")


class RuleBroken(Exception):
    """Raised with the name of the rule."""


def _row_of(instruction: Instruction) -> SimpleNamespace:
    def operands(code: bytes, offset: int) -> list[tuple[str, int, int, int]]:
        operand_rows = [
            (operand.kind, operand.low, operand.high, value)
            for operand, value in instruction.read(code, offset)
        ]
        return operand_rows + [(kind, value, value, value) for kind, value in instruction.implied]

    parts = {
        "takes": instruction.takes,
        "leaves": instruction.leaves,
        "role": instruction.role,
        "name": instruction.name,
    }
    return SimpleNamespace(size=instruction.size, operands=operands, **parts)


def _require(holds: object, rule: str) -> None:
    if not holds:
        raise RuleBroken(rule)


@lru_cache(maxsize=1)
def text() -> str:
    """Return the page's program."""
    match = re.search(r"^```verifier\n(.*?)^```$", SPEC.read_text("utf-8"), re.M | re.S)
    assert match
    return match[1]


@lru_cache(maxsize=2)
def program(text: str) -> dict[str, Any]:
    """Return the names of such a program."""
    names: dict[str, Any] = {rule: rule for rule in rule_numbers()}
    names |= {"IF": "IF", "REPEAT": "REPEAT", "COUNT": "COUNT", "UNKNOWN": None}
    names |= {"m": SimpleNamespace(), "must": _require, "record": SimpleNamespace}
    names["rows"] = {code: _row_of(row) for code, row in instructions().items()}
    exec(text, names)
    return names


def verdict(
    code: bytes, sensors: int, actuators: int, needs: int = 0xFF, changed_text: str = ""
) -> Verdict:
    """Return the first rule that is broken, and where; (0, 0) if none is."""
    names = program(changed_text or text())
    try:
        names["verify"](code, sensors, actuators, needs)
    except RuleBroken as error:
        return rule_numbers()[str(error)], names["m"].at
    return 0, 0
