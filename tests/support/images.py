"""Images of code that no compiler has made."""

from __future__ import annotations

from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.image import TASKS, pack
from tiniscript.bytecode.opcodes import UNO_OPS
from tiniscript.bytecode.verify import Refused, verify
from tiniscript.kit import Kit


def has_tasks(code: bytes) -> bool:
    """Whether there is an instruction that not every machine has: one of a task."""
    return any(row.op is not None and row.op not in UNO_OPS for row in rows(code))


def image_for(code: bytes, kit: Kit, start: str = "SI") -> bytes:
    """Return the image of code for a robot; where its verifier refuses it, any one."""
    needs = TASKS if has_tasks(code) else 0
    try:
        uses = verify(code, len(kit.sensors), len(kit.actuators)).uses
    except Refused:
        return pack(start, 0, code, needs=needs)
    return pack(start, kit.hash_of_used(uses), code, needs=needs)
