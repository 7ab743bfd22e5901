"""Whether a robot may run an image: its header, its code, and the devices that the code uses.

The three in this order, as every machine asks them. Knows no rule of its own.
"""

from __future__ import annotations

from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import EVERYTHING, Image, ImageRefused, unpack
from tiniscript.bytecode.verify import Verdict, verify


def loaded(data: bytes, kit: Kit, has: int = EVERYTHING) -> Image:
    """Return the image in `data`, for a machine that has so much of `needs`.

    Raises ImageRefused, or verify.Refused.
    """
    image = unpack(data, has)
    check(image, kit)
    return image


def check(image: Image, kit: Kit) -> Verdict:
    """Return what the code of an image needs. Raises verify.Refused, or ImageRefused."""
    verdict = verify(image.code, len(kit.sensors), len(kit.actuators), image.needs)
    ours = kit.hash_of_used(verdict.uses)
    if image.devices != ours:
        raise ImageRefused("OTHER_KIT", theirs=f"{image.devices:04x}", ours=f"{ours:04x}")
    return verdict
