"""Binds each instruction to its handler in `values`, `actions` or `control`.

Each row of the table in `bytecode` has one handler; importing this fails if one is missing. A
short instruction shares the handler of its long form. Those of tasks come with `tasks`.
"""

from __future__ import annotations

from tiniscript.bytecode.opcodes import NEEDS_TASKS, OPS, Op, op_at, read_operands
from tiniscript.vm import actions, control, values
from tiniscript.vm.handlers import HANDLERS, Step
from tiniscript.vm.state import Execution

_FAMILIES = (values, actions, control)  # importing them fills the table

for _op in OPS:
    if _op.implied is not None:
        HANDLERS[_op.name] = HANDLERS[_op.family]

_missing = [op.name for op in OPS if op.name not in HANDLERS and op.needs != NEEDS_TASKS]
assert not _missing, f"no handler for {_missing}"


def bound(m: Execution, code: bytes) -> list[Step]:
    """Return the step of the instruction at each offset, for this machine. Jumps are offsets.

    Behind the code stands END.
    """
    steps = [HANDLERS["END"](m, 0)] * (len(code) + 1)
    at = 0
    while at < len(code):
        op, after = instruction(code, at)
        operands = read_operands(op, code, at) if op.implied is None else (op.implied.value,)
        kind = op.operands[-1].kind.name if op.operands else ""
        if kind.startswith("fwd"):
            operands = (*operands[:-1], after + operands[-1])
        elif kind.startswith("back"):
            operands = (*operands[:-1], after - operands[-1])
        steps[at] = HANDLERS[op.name](m, after, *operands)
        at = after
    return steps


def instruction(code: bytes, at: int) -> tuple[Op, int]:
    """Return the instruction at an offset, and where the next one begins."""
    op = op_at(code, at)
    assert op is not None, "the code is not verified"
    return op, at + op.size
