"""How functions keep registers, and what keeps them for several: `shorter.py` uses it.

GCC writes pushes and pops into a function or, for many registers, jumps to what libgcc has for it;
a function may begin one way and end the other. Knows nothing of where functions lie.
"""

from __future__ import annotations

import re
from itertools import combinations
from typing import NamedTuple

from assembly import BODY, ENDING, Function

KEPT = (*range(2, 18), 28, 29)  # the registers that a function keeps, as GCC counts them
MOST_MORE = 3  # registers that a function may keep without need: each is a byte of the stack
CALLS = 4  # bytes of what a function calls and jumps to instead

FRAMELESS = "/* frame size = 0 */"
SAVES = re.compile(r"\tjmp __prologue_saves__\+\(\(18 - (\d+)\) \* 2\)$")
RESTORES = re.compile(r"\tjmp __epilogue_restores__ \+ \(\(18 - (\d+)\) \* 2\)$")


class Frame(NamedTuple):
    """How a function without local variables in memory keeps registers: lines of its text."""

    count: int  # of the last registers of KEPT
    begin: tuple[int, int]  # the first line and the one behind the last one
    end: tuple[int, int]
    saved: int  # bytes, if others do it


class Side(NamedTuple):
    """The begin or the end of a function, as far as it is about registers."""

    registers: tuple[int, ...]
    lines: int
    size: int  # in bytes; a jump takes 2 or 4


def share_registers(functions: list[Function], number: int) -> list[str]:
    """Let functions call what keeps their registers, and return that."""
    uses = [(each, frame) for each in functions if (frame := frame_of(each)) is not None]
    counts = sorted({frame.count for _, frame in uses})
    tried = (some for size in range(len(counts) + 1) for some in combinations(counts, size))
    shared = min(tried, key=lambda some: _cost([frame for _, frame in uses], some))
    for function, frame in uses:
        count = _used(frame, shared)
        if count:
            # the end first: it lies behind the begin
            lowest = KEPT[-count]
            function.lines[slice(*frame.end)] = [f"\tjmp tiniscript_restore_{number}_r{lowest}"]
            function.lines[slice(*frame.begin)] = [f"\tcall tiniscript_keep_{number}_r{lowest}"]
    return _shared(shared, number) if shared else []


def frame_of(function: Function) -> Frame | None:
    """Return how a function keeps registers, or None if that cannot be shared."""
    lines = function.lines
    if FRAMELESS not in lines or lines.count(BODY) != 1 or lines.count(ENDING) != 1:
        return None
    body, ending = lines.index(BODY), lines.index(ENDING)
    begin, end = _begin(lines[1:body]), _end(lines[ending + 1 :])
    if begin is None or end is None or begin.registers != end.registers:
        return None
    return Frame(
        len(KEPT) - KEPT.index(begin.registers[0]),
        (1, body),
        (ending + 1, ending + 1 + end.lines),
        begin.size + end.size,
    )


def _begin(lines: list[str]) -> Side | None:
    pushed = [line.removeprefix("\tpush r") for line in lines]
    if pushed and all(each.isdigit() for each in pushed):
        return _side([int(each) for each in pushed], len(lines), 2 * len(lines))
    begun = SAVES.match(lines[4]) if len(lines) == 6 else None
    if begun is None or lines[:2] != ["\tldi r26,0", "\tldi r27,0"] or lines[5] != "1:":
        return None
    return Side(KEPT[-int(begun[1]) :], 6, 10)


def _end(lines: list[str]) -> Side | None:
    """Return what is left of a function behind the mark of its end."""
    ended = RESTORES.match(lines[3]) if len(lines) > 3 else None
    if ended is not None:
        sized = [f"\tldi r30, lo8({ended[1]})", "\tin r28,__SP_L__", "\tin r29,__SP_H__"]
        if sorted(lines[:3]) != sorted(sized):
            return None
        return Side(KEPT[-int(ended[1]) :], 4, 8)
    if "\tret" not in lines:
        return None
    popped = [line.removeprefix("\tpop r") for line in lines[: lines.index("\tret")]]
    if not popped or not all(each.isdigit() for each in popped):
        return None
    return _side([int(each) for each in reversed(popped)], len(popped) + 1, 2 * len(popped) + 2)


def _side(registers: list[int], lines: int, size: int) -> Side | None:
    complete = registers if registers != [28] else [28, 29]
    if complete != sorted(complete) or not set(complete) <= set(KEPT) or complete[-1] != 29:
        return None
    return Side(tuple(complete), lines, size)


def _used(frame: Frame, shared: tuple[int, ...]) -> int:
    """Return how many registers a function keeps where so many can be kept; 0 for itself."""
    enough = [count for count in shared if frame.count <= count <= frame.count + MOST_MORE]
    return min(enough, default=0)


def _cost(frames: list[Frame], shared: tuple[int, ...]) -> int:
    """Return the bytes of all that keeps registers."""
    called = sum(2 * count + 6 for count in shared) + (2 * shared[-1] + 2 if shared else 0)
    return called + sum(CALLS if _used(frame, shared) else frame.saved for frame in frames)


def _shared(counts: tuple[int, ...], number: int) -> list[str]:
    """Return what keeps numbers of registers, the last one first, and what restores them."""
    lines = []
    for count in counts:
        lines.append(f"tiniscript_keep_{number}_r{KEPT[-count]}:")
        lines += ["\tpop r31", "\tpop r30"]  # where the function goes on
        lines += [f"\tpush r{each}" for each in reversed(KEPT[-count:])]
        lines.append("\tijmp")
    for each in KEPT[-counts[-1] :]:
        if len(KEPT) - KEPT.index(each) in counts:
            lines.append(f"tiniscript_restore_{number}_r{each}:")
        lines.append(f"\tpop r{each}")
    return [*lines, "\tret"]
