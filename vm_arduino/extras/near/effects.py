"""Which registers an instruction of an AVR reads and writes: `arguments.py` asks it.

Knows nothing of flags and memory. What is not listed here has unknown effects.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from assembly import Instruction

LOADS = ("ldi", "mov", "movw")  # these write a register and do nothing else
BOTH = ("add", "adc", "sub", "sbc", "and", "or", "eor")  # read and write their first operand
FIRST = ("subi", "sbci", "andi", "ori", "inc", "dec", "neg", "com", "lsl", "lsr", "asr", "ror")
FIRST += ("rol", "swap", "bld")
PAIRS = ("adiw", "sbiw", "movw")  # their operands stand for two registers
WRITES = (*LOADS, "lds", "ldd", "ld", "lpm", "in", "pop")  # write their first operand
READS = (
    "cp",
    "cpc",
    "cpi",
    "cpse",
    "tst",
    "sbrc",
    "sbrs",
    "bst",
    "sts",
    "std",
    "st",
    "out",
    "push",
)
NEITHER = ("sbi", "cbi", "sbic", "sbis", "nop", "set", "clt", "sec", "clc", "rjmp")
POINTERS = {"X": 26, "Y": 28, "Z": 30}
REGISTER = re.compile(r"r(\d+)|(-?)([XYZ])(?:(\+)[\w(].*|(\+)?)")


class Effects(NamedTuple):
    written: frozenset[int]
    read: frozenset[int]


def effects(each: Instruction) -> Effects | None:
    """Return the effects of an instruction, or None where they are unknown."""
    name = each.name
    if name in NEITHER or name.startswith("br"):
        return Effects(frozenset(), frozenset())
    if name not in (*BOTH, *FIRST, *PAIRS, *WRITES, *READS) or not each.operands:
        return None
    first, _, second = (word.strip() for word in each.operands.partition(","))
    written: set[int] = set()
    read: set[int] = set()
    for is_first, word in ((True, first), (False, second)):
        named, moved = _registers(word, name in PAIRS)
        is_written = is_first and name in (*BOTH, *FIRST, *PAIRS, *WRITES)
        is_read = not is_first or name not in WRITES
        written |= named if is_written else moved
        read |= named if is_read else set()
    if name == "eor" and first == second:
        read = set()
    return Effects(frozenset(written), frozenset(read))


def _registers(operand: str, is_pair: bool) -> tuple[set[int], set[int]]:
    """Return which registers an operand names, and which of them it moves on, as `Z+` does."""
    word = {"__zero_reg__": "r1", "__tmp_reg__": "r0"}.get(operand, operand)
    matched = REGISTER.fullmatch(word)
    if matched is None:
        return set(), set()
    number, before, pointer, _, behind = matched.groups()
    if number:
        return {int(number), int(number) + is_pair}, set()
    pair = {POINTERS[pointer], POINTERS[pointer] + 1}
    return pair, pair if before or behind else set()
