"""Images of texts, and of code that no compiler has made."""

from __future__ import annotations

from functools import reduce
from operator import or_

from tiniscript import compile_text, robots
from tiniscript.base.kit import Kit
from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.image import Image, pack, unpack
from tiniscript.bytecode.verify import Refused, verify

TINIBOT = robots.load("tinibot").kit


def image_of(text: str, kit: Kit = TINIBOT) -> Image:
    """Return the image of a text, which must be right."""
    compilation = compile_text(text, kit)
    assert compilation.image, text
    return unpack(compilation.image)


def needs_of(code: bytes) -> int:
    """Return the optional features that the instructions of code need."""
    return reduce(or_, (row.op.needs for row in rows(code) if row.op is not None), 0)


def image_for(code: bytes, kit: Kit, start: str = "SI") -> bytes:
    """Return the image of code for a robot; where its verifier refuses it, any one."""
    needs = needs_of(code)
    try:
        uses = verify(code, len(kit.readings), len(kit.actuators)).uses
    except Refused:
        return pack(start, 0, code, needs=needs)
    return pack(start, kit.hash_of_used(uses), code, needs=needs)
