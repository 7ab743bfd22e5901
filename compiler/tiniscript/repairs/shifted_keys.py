"""Numbers that were typed with Shift held down: `F(2, 8=)` is 80, as = is on the key of the 0.

Knows the row of digits of a Latin American keyboard. Gives a call only where a number stands in
each place and no other one can be meant; a sign that may just be too much is left to its author.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript.words import WORDS, Argument, Word

_KEYS = dict(zip('=!"#$%&/()', "0123456789", strict=True))
_ROLES = ("move", "wait", "motors", "beep")
_CALL = re.compile(r"\s*([A-Za-z]+)\s*\((.*?)(\)?)\s*", re.DOTALL)
_PLAIN = re.compile(r"[0-9]+(?:\.[0-9]+)?|\.[0-9]+")
_LAST = re.compile(r"([1-9][0-9]?)(={1,2})")  # `8=`, `44=`, `1==`
_FIRST = re.compile(r"([!\"#$%&/(])(0{1,2})")  # `(0`, `&0`
_ALONE = re.compile(r"[!\"#$%&/]")
_POINT = re.compile(r"=(\.[0-9]+)")  # `=.39`
_SEMICOLON = re.compile(r"0;([0-9]{1,2})")  # `0;39`, the comma's key; `0:39` may be a clock
# `F82, 809`, `F82, 80)`: no Shift for the brackets, or for the first one.
_UNSHIFTED = re.compile(r"\s*([FBLRfblr])8([0-9](?:\.[0-9]+)?)\s*,\s*([1-9]0|100)[9)]\s*")
_UNCLOSED = re.compile(r"\s*([FBLRfblr])\s*\(\s*([0-9.]+)\s*,\s*([1-9]0|100)9\s*")  # `F(2, 809`
_LEAST = {"%": 20, "Hz": 100}  # what is lower, pupils do not write
_LONGEST_S = 10


class Shifted(NamedTuple):
    """`call` is "" where more than one number may be meant.

    `sign` is the first one that stands for a `digit`; both are "" for a point.
    """

    word: Word
    call: str
    sign: str
    digit: str


def shifted_call(text: str) -> Shifted | None:
    """Return the call that was meant, None where no sign stands for a digit."""
    if match := _UNSHIFTED.fullmatch(text):
        move = WORDS[match[1].upper()]
        return Shifted(move, f"{move.text}({match[2]}, {match[3]})", "", "")
    if match := _UNCLOSED.fullmatch(text):
        move = WORDS[match[1].upper()]
        return Shifted(move, f"{move.text}({match[2]}, {match[3]})", "", "")
    match = _CALL.fullmatch(text)
    word = WORDS.get(match[1].upper()) if match else None
    if match is None or word is None or word.role not in _ROLES:
        return None
    values = [each.strip() for each in match[2].split(",")]
    if len(values) != len(word.arguments):
        values = [each.strip() for each in re.split("[,;]", match[2])]
    if len(values) != len(word.arguments):
        return None
    meant = []
    sign = digit = ""
    is_sure = True
    for value, argument in zip(values, word.arguments, strict=True):
        if _PLAIN.fullmatch(value):
            meant.append(value)
            continue
        number = _typed(value)
        if number is None:
            return None
        if not sign:
            sign = next(each for each in value if not each.isdigit() and each != ".")
            digit = _KEYS.get(sign, "")
        is_sure = is_sure and _is_sure(value, number, argument)
        meant.append(number)
    if not sign:
        return None
    is_closed = bool(match[3]) or values[-1][-1:].isdigit()
    call = f"{word.text}({', '.join(meant)})" if is_sure and is_closed else ""
    return Shifted(word, call, sign if digit else "", digit)


def _typed(value: str) -> str | None:
    """Return the number with the digits of its keys, None where it has no such sign."""
    if match := _LAST.fullmatch(value):
        return match[1] + "0" * len(match[2])
    if match := _FIRST.fullmatch(value):
        return _KEYS[match[1]] + match[2]
    if match := _POINT.fullmatch(value):
        return "0" + match[1]
    if match := _SEMICOLON.fullmatch(value):
        return "0." + match[1]
    return _KEYS[value] if _ALONE.fullmatch(value) else None


def _is_sure(value: str, number: str, argument: Argument) -> bool:
    if not argument.low <= float(number) * 1000 <= argument.high:
        return False
    if argument.unit == "s" and float(number) > _LONGEST_S:
        return False
    without = _LAST.fullmatch(value)
    if without is None:
        return argument.unit == "s" or float(number) >= _LEAST.get(argument.unit, 0)
    return int(without[1]) < _LEAST.get(argument.unit, 0) <= int(number)
