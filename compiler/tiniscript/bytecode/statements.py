"""The statements of verified code: where each begins. A program halts before these alone."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from tiniscript.bytecode.disassembly import rows


def statement_starts(code: bytes) -> list[int]:
    """Return the offsets where a statement begins: the stack is empty there, and no AND_THEN or
    OR_ELSE is open. The check of an UNTIL or a WHEN begins one, too."""
    starts: list[int] = []
    depth = join_offset = 0
    for row in rows(code):
        if row.op is None:
            break
        next_offset = row.offset + len(row.data)
        if depth == 0 and row.offset >= join_offset:
            starts.append(row.offset)
        depth += row.op.pushes - row.op.pops
        if row.op.control_role == "join":
            join_offset = max(join_offset, next_offset + row.operands[-1])
    return starts


def statement_of(starts: Sequence[int], offset: int) -> int:
    """Return the start of the statement that contains an offset. An instruction of the text may
    begin in the middle of a statement, because the compiler joins it to the previous one.
    """
    return starts[max(0, bisect_right(starts, offset) - 1)]
