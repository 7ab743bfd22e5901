"""The assembly of GCC for an AVR as functions, and what may be moved in it: `shorter.py` uses it.

Knows the text that GCC writes, not what becomes of it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

LONG = ("call", "jmp", "lds", "sts", "asm")  # take 4 bytes, or may
SKIPS = ("cpse", "sbrc", "sbrs", "sbic", "sbis")
BODY, ENDING = "/* prologue: function */", "/* epilogue start */"
FIXED = ("asm", "push", "pop", "ret", "jmp", "rjmp", "ijmp")

INSTRUCTION = re.compile(r"\t([a-z]+)(?:[ \t]+(.*?))?[ \t]*$")
LABEL = re.compile(r"([\w.$]+):")
SIZE = re.compile(r"\t\.size\t([\w.$]+), \.-")
WORD = re.compile(r"[A-Za-z_.$][\w.$]*")
PLACE = re.compile(r"(^|\W)(\d+[bf]$|\.[-+ ])")  # that is told by its distance


class Instruction(NamedTuple):
    line: int
    name: str
    operands: str

    @property
    def size(self) -> int:
        return 4 if self.name in LONG else 2


class Function:
    """A function of the assembly: the lines from its label to its size."""

    def __init__(self, name: str, lines: list[str]) -> None:
        self.name = name
        self.lines = lines
        self.before: list[str] = []  # lines in front of the label

    def instructions(self) -> list[Instruction]:
        """Return them; those that must stay as they are have the name asm."""
        found = []
        is_own = True
        is_locked = False  # no interrupts: that must not take longer
        for number, line in enumerate(self.lines):
            if line.startswith(("/* #APP", "/* #NOAPP")):
                is_own = line.startswith("/* #NOAPP")
            matched = INSTRUCTION.match(line)
            if matched:
                is_locked = is_locked or matched[1] == "cli"
                name = matched[1] if is_own and not is_locked else "asm"
                found.append(Instruction(number, name, matched[2] or ""))
                is_locked = is_locked and "__SREG__" not in line
        return found

    def words(self) -> set[str]:
        return {word for line in self.lines for word in WORD.findall(line)}


def pieces(assembly: str) -> list[str | Function]:
    """Return functions, and the lines between them."""
    lines = assembly.splitlines()
    sizes = [(number, SIZE.match(line)) for number, line in enumerate(lines)]
    ends = {matched[1]: number for number, matched in sizes if matched}
    pieces: list[str | Function] = []
    number = 0
    while number < len(lines):
        matched = LABEL.match(lines[number])
        end = ends.get(matched[1], -1) if matched else -1
        body = lines[number:end]
        # Switches between sections in the middle: a table of jumps, whose labels count.
        if matched and end > number and any("prologue: " in line for line in body):
            pieces.append(Function(matched[1], body))
            number = end
        else:
            pieces.append(lines[number])
            number += 1
    return pieces


def reached(roots: list[str], functions: Mapping[str, Function]) -> set[str]:
    """Return the functions that some functions name, that those name, and so on."""
    found = set()
    while roots:
        name = roots.pop()
        if name not in found:
            found.add(name)
            roots += [word for word in functions[name].words() if word in functions]
    return found


def places(function: Function, found: list[Instruction]) -> dict[int | str, int]:
    """Return where lines and labels lie behind the begin of the function, at most."""
    sizes = {each.line: each.size for each in found}
    places: dict[int | str, int] = {}
    at = 0
    for number, line in enumerate(function.lines):
        matched = LABEL.match(line)
        if matched:
            places[matched[1]] = at
        places[number] = at
        at += sizes.get(number, 0)
    return places


def between(function: Function, found: list[Instruction], at: int) -> list[str]:
    """Return the lines between an instruction and the one before it."""
    return function.lines[found[at - 1].line + 1 : found[at].line]


def is_movable(each: Instruction) -> bool:
    return each.name not in FIXED and PLACE.search(each.operands) is None


def leads_on(each: Instruction) -> bool:
    """Return whether the instruction may skip the next one."""
    return each.name in SKIPS or each.operands.startswith(".+")


def regions(
    functions: list[Function], addresses: Mapping[str, int], reach: int
) -> list[list[Function]]:
    """Return functions in groups: none lies further from the middle than `reach` bytes."""
    if not functions:
        return []
    first, last = (addresses[functions[at].name] for at in (0, -1))
    count = -(-(last + 1 - first) // (2 * reach))
    groups: list[list[Function]] = [[] for _ in range(count)]
    for function in functions:
        groups[(addresses[function.name] - first) * count // (last + 1 - first)].append(function)
    return [group for group in groups if group]
