"""The words of a kit as a robot that reads text keeps them.

Knows the table of `vm_arduino/src/text/kit_words.h`.
"""

from __future__ import annotations

from tiniscript.base.kit import REMOTE, Kit

LAST_LETTER = 0x80  # marks the last letter of a word
_YES_NO, _SENSOR, _ACTUATOR, _GIVES_WAY = 1, 2, 4, 8
_HAS_SPEED, _HAS_TURN = 1, 2


def kit_words(kit: Kit) -> bytes:
    """Return the table: the devices of the kit, a 0, and whether it goes and turns."""
    return own_words(kit) + remote_words(kit) + end_of_words(kit)


def own_words(kit: Kit) -> bytes:
    """Return the words of the profile: its sensors and actuators."""
    table = bytearray()
    for device in kit.sensors:
        table += pack_word(device.name) + bytes((_SENSOR | _YES_NO * device.is_yes_no,))
    for device in kit.actuators:
        table += pack_word(device.name) + bytes((_ACTUATOR | _YES_NO * device.is_yes_no,))
        if not device.is_yes_no:
            table += pack_range(device.low, device.high)
    return bytes(table)


def remote_words(kit: Kit) -> bytes:
    """Return the words of the remote control."""
    table = bytearray()
    for device in REMOTE if kit.has_remote else ():
        table += pack_word(device.name) + bytes(
            (_GIVES_WAY | _SENSOR | _YES_NO * device.is_yes_no,)
        )
    return bytes(table)


def end_of_words(kit: Kit) -> bytes:
    """Return a 0, and whether the kit says how fast it goes and turns."""
    return bytes((0, _HAS_SPEED * bool(kit.speed) | _HAS_TURN * bool(kit.turn)))


def pack_word(word: str) -> bytes:
    """Return the letters of a word, the last one marked."""
    return word[:-1].encode() + bytes((ord(word[-1]) | LAST_LETTER,))


def pack_range(low: int, high: int) -> bytes:
    """Return the least and the largest plain number that an argument may be."""
    return b"".join(value.to_bytes(4, "little", signed=True) for value in (low, high))
