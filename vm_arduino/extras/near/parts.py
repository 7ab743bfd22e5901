"""Lets functions call parts that they have in common: `shorter.py` uses it.

The part that saves most comes first. It lies in the middle of those that call it, so that their
calls are short; who is too far away may have it again.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterator, Mapping
from heapq import heapify, heappop, heappush
from typing import NamedTuple

from assembly import BODY, LABEL, Function, Instruction, between, is_movable, leads_on, places

REACH = 3600  # bytes: a call over less than that takes 2 of them
LONGEST = 16  # instructions
LEAST_SAVED = 2  # bytes

Key = tuple[tuple[str, str], ...]  # instructions: what they do, and with what


class Part(NamedTuple):
    """Instructions of a function that follow each other; nothing leads into their middle."""

    function: Function
    lines: tuple[int, ...]
    address: int  # about


def share_parts(functions: list[Function], addresses: Mapping[str, int]) -> None:
    parts: dict[Key, list[Part]] = defaultdict(list)
    ends = []
    for function in functions:
        found = function.instructions()
        address = addresses[function.name]
        ends.append((address + sum(each.size for each in found), function))
        for part, key in _parts(function, found, address):
            parts[key].append(part)
    ends.sort(key=lambda end: end[0])
    waiting = [(-_saved(key, len(found)), key) for key, found in parts.items() if len(found) > 1]
    heapify(waiting)
    taken: dict[str, set[int]] = defaultdict(set)  # lines of functions
    count = 0
    while waiting and -waiting[0][0] >= LEAST_SAVED:
        _, key = heappop(waiting)
        users = _nearest(_free(parts[key], taken))
        saved = _saved(key, len(users))
        if saved < LEAST_SAVED:
            continue
        if waiting and saved < -waiting[0][0]:
            heappush(waiting, (-saved, key))
            continue
        label = f"tiniscript_part_{count}"
        count += 1
        for part in users:
            taken[part.function.name].update(part.lines)
            for line in part.lines:
                part.function.lines[line] = ""
            part.function.lines[part.lines[0]] = f"\tcall {label}"
        middle = (users[0].address + users[-1].address) // 2
        at = bisect_left(ends, middle, key=lambda end: end[0])
        host = min(ends[max(at - 1, 0) : at + 1], key=lambda end: abs(end[0] - middle))[1]
        host.lines += _called(label, key)
        heappush(waiting, (-saved, key))  # others may be left


def _free(parts: list[Part], taken: Mapping[str, set[int]]) -> list[Part]:
    """Return the parts that are still there, without those that begin inside another one."""
    free: list[Part] = []
    for part in parts:
        others = free[-1].lines if free and free[-1].function is part.function else ()
        is_behind = part.lines[0] > max(others, default=-1)
        if is_behind and taken[part.function.name].isdisjoint(part.lines):
            free.append(part)
    return free


def _nearest(parts: list[Part]) -> list[Part]:
    """Return the most parts that one place reaches, in the order of their addresses."""
    parts = sorted(parts, key=lambda part: part.address)
    best: list[Part] = []
    for first, part in enumerate(parts):
        near = [each for each in parts[first:] if each.address - part.address < 2 * REACH]
        if len(near) > len(best):
            best = near
    return best


def _called(label: str, key: Key) -> list[str]:
    rows = [f"\t{name} {operands}" for name, operands in key]
    if key[-1][0] == "call":
        rows[-1] = f"\tjmp {key[-1][1]}"
        return [f"{label}:", *rows]
    return [f"{label}:", *rows, "\tret"]


def _parts(
    function: Function, found: list[Instruction], address: int
) -> Iterator[tuple[Part, Key]]:
    at_of = places(function, found)
    begin = function.lines.index(BODY)
    for first, start in enumerate(found):
        if start.line < begin or (first > 0 and leads_on(found[first - 1])):
            continue
        key: list[tuple[str, str]] = []
        for at in range(first, min(first + LONGEST, len(found))):
            each = found[at]
            if not is_movable(each) or each.name.startswith("br") or "__SP_" in each.operands:
                break
            if at > first and any(map(LABEL.match, between(function, found, at))):
                break
            if each.name == "icall":
                break
            key.append((each.name, each.operands))
            # a call that may be skipped would not become a jump
            is_end = not leads_on(each) and not ("call" in each.name and leads_on(found[at - 1]))
            if at > first and is_end:
                lines = tuple(one.line for one in found[first : at + 1])
                yield Part(function, lines, address + at_of[start.line]), tuple(key)
            if "call" in each.name:
                break  # nothing more of the stack is used where a call comes last


def _saved(key: Key, count: int) -> int:
    """Return the bytes that are saved where so many parts become one; calls are short."""
    size = sum(4 if name in ("lds", "sts") else 2 for name, _ in key)
    return count * (size - 2) - size - (0 if key[-1][0] == "call" else 2)
