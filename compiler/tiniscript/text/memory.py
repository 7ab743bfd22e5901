"""How much memory a robot's reader needs while it reads a program.

Knows what its reader keeps beside the code, and what each of these takes. The C++ reader must
agree: this module is the only place in Python that knows its layout.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.bytecode.opcodes import BLOCKS
from tiniscript.syntax import ast
from tiniscript.text.plain import PlainCode

NAME_BYTES = 1  # of each name of a variable or a DEF, beside its letters
DEF_BYTES = 1  # of each DEF more: where it begins
BLOCK_BYTES = 3  # of each block that is open
OPERATOR_BYTES = 1  # of each operator, bracket and call that waits
WAITING = 16  # operators that may wait at once: room is kept for them
KEPT_FREE = BLOCKS * BLOCK_BYTES + WAITING * OPERATOR_BYTES


def remembered(body: Sequence[ast.Instruction]) -> list[tuple[int, int]]:
    """Return for each name that a program makes its place in the text, and its bytes."""
    seen: dict[str, tuple[int, int]] = {}
    waiting = list(reversed(body))
    while waiting:
        node = waiting.pop()
        if isinstance(node, (ast.Assign, ast.Def)):
            size = len(node.name) + NAME_BYTES + DEF_BYTES * isinstance(node, ast.Def)
            seen.setdefault(node.name, (node.name_span.start, size))
        if isinstance(node, ast.If):
            waiting += reversed(
                (*(each for arm in node.arms for each in arm.body), *node.otherwise)
            )
        elif isinstance(node, (ast.Loop, ast.While, ast.Def)):
            waiting += reversed(node.body)
    return list(seen.values())


def needed(body: Sequence[ast.Instruction], plain: PlainCode) -> int:
    """Return the bytes that a reader needs for a program: its code, its names, what waits."""
    return plain.length + sum(size for _, size in remembered(body)) + KEPT_FREE


def full_at(body: Sequence[ast.Instruction], plain: PlainCode, room: int) -> int:
    """Return where in the text a reader with so much room is full; it needs more for the whole."""
    grows = sorted(remembered(body))
    used, k = KEPT_FREE, 0
    ends = [*(place.offset for place in plain.places[1:]), plain.length]
    for place, end in zip(plain.places, ends, strict=True):
        while k < len(grows) and grows[k][0] <= place.span.start:
            used += grows[k][1]
            k += 1
        if used + end > room:
            return place.span.start
    return grows[-1][0] if grows else 0
