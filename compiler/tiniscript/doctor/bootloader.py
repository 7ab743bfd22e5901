"""Greets the bootloader of a board: whether there is one, and whether there is anything else.

Only the greeting is sent, which changes nothing: neither memory is written, nor is one erased.
"""

from __future__ import annotations

from tiniscript.flash.bootloaders import MEGA, NANO_OLD, UNO, Bootloader
from tiniscript.link.wire import Wire

# For each: what it is greeted with, and how its answer begins.
GREETINGS: tuple[tuple[Bootloader, bytes, bytes], ...] = (
    (UNO, b"\x30\x20", b"\x14\x10"),
    (NANO_OLD, b"\x30\x20", b"\x14\x10"),
    (MEGA, b"\x1b\x01\x00\x01\x0e\x01\x14", b"\x1b\x01\x00"),
)
BLINK_MS = 450  # Optiboot blinks first, and hears no more than two bytes meanwhile
TRIES = 4
ANSWER_MS = 200
OVER_MS = 5000  # a bootloader that has heard nothing for so long has gone on to what is behind it


def answers(wire: Wire) -> tuple[Bootloader, bool] | None:
    """Restart the board and return the bootloader that answers, or None.

    The second value: it answers later on, too; then there is nothing behind it.
    """
    for bootloader, greeting, answer in GREETINGS:
        wire.set_baud(bootloader.baud)
        wire.restart()
        wire.heard(BLINK_MS, BLINK_MS)
        if _greeted(wire, greeting, answer):
            wire.heard(OVER_MS, OVER_MS)
            return bootloader, _greeted(wire, greeting, answer)
    return None


def _greeted(wire: Wire, greeting: bytes, answer: bytes) -> bool:
    for _ in range(TRIES):
        wire.send(greeting)
        if answer in wire.heard(ANSWER_MS):
            return True
    return False
