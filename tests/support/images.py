"""Images of code that no compiler has made."""

from __future__ import annotations

from tiniscript.bytecode.image import pack
from tiniscript.bytecode.verify import Refused, verify
from tiniscript.kit import Kit


def image_for(code: bytes, kit: Kit, start: str = "SI") -> bytes:
    """Return the image of code for a robot; where its verifier refuses it, any one."""
    try:
        uses = verify(code, len(kit.sensors), len(kit.actuators)).uses
    except Refused:
        return pack(start, 0, code)
    return pack(start, kit.hash_of_used(uses), code)
