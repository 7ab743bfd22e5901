"""Makes the compiler's assembly shorter: `link.py` runs it between compiling and linking.

GCC 5 and 7 write into each function how its registers are kept, reach a far place from a condition
by a jump of its own, and repeat how functions end. Here functions that keep the same registers
share the instructions that do it, a condition that leads far uses a jump that is there already, and
equal ends and parts are there once. What interrupts reach, and what a LIVE waits for, only gets
what makes nothing slower. A sketch that `wants_room` gives more: its main loop calls parts, too,
which makes a LIVE a few microseconds longer.

Knows the text that GCC writes for an AVR whose program counter has 2 bytes. What has another form
than expected is left alone.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping
from typing import NamedTuple

from arguments import share_loads, share_objects
from assembly import (
    BODY,
    LABEL,
    Function,
    Instruction,
    between,
    is_movable,
    leads_on,
    pieces,
    places,
    reached,
    regions,
)
from parts import share_parts
from registers import share_registers

REACH = 3800  # bytes: a call or a jump over less than that takes 2 of them
REGION = 5400  # bytes on each side of what a region shares: some of its calls are long
NEAR = 112  # bytes: how far a condition leads at most, less what an estimate may miss
LONGEST = 16  # instructions of an end
# What runs between a line of a computer and the motors.
QUICK = re.compile(
    r"4Link4hear|4Link5start|FrameCheck|begin_run|7Machine(3act|6powers|4wait|5begin|5sleep|4tick)|"
    r"(robot|board)_motors|5level|^main$|7percent|7limited|8shape_of"
)
MAIN = "main"
TOLD = re.compile(r"\t\.(type|size|section)\t")
OPPOSITE = {"eq": "ne", "lo": "sh", "lt": "ge", "mi": "pl", "cs": "cc", "vs": "vc", "ts": "tc"}
OPPOSITE |= {value: key for key, value in OPPOSITE.items()}


def shorter(assembly: str, addresses: Mapping[str, int], wants_room: bool = False) -> str:
    """Return assembly that does the same. `addresses`: of functions, where they lie about."""
    parts = pieces(assembly)
    functions = {piece.name: piece for piece in parts if isinstance(piece, Function)}
    vectors = [name for name in functions if name.startswith("__vector")]
    interrupting = reached(vectors, functions)
    free = {name: each for name, each in functions.items() if name not in interrupting}
    slow = [
        each
        for name, each in free.items()
        if QUICK.search(name) is None and name in addresses and BODY in each.lines
    ]
    slow.sort(key=lambda function: addresses[function.name])
    near = regions(slow, addresses, REGION)
    others = [piece for piece in parts if isinstance(piece, str) and not TOLD.match(piece)]
    elsewhere = "\n".join(others)
    share_objects(functions, elsewhere)
    common = [share_registers(each, number) for number, each in enumerate(near)]
    share_objects(functions, elsewhere)  # those whose registers are kept otherwise now
    share_loads(list(functions.values()))
    for number, each in enumerate(near):
        each[len(each) // 2].lines += common[number]
    main = [functions[MAIN]] if wants_room and MAIN in functions and MAIN in addresses else []
    share_parts(slow + main, addresses)
    _share_ends(slow, addresses)
    for name, function in functions.items():
        _share_jumps(function, name in interrupting)
    return "".join(f"{line}\n" for piece in parts for line in _lines(piece))


def _lines(piece: str | Function) -> list[str]:
    return [piece] if isinstance(piece, str) else piece.before + piece.lines


# -- conditions that lead far ---------------------------------------------------------------------


def _share_jumps(function: Function, is_hurried: bool) -> None:
    """Let a condition that skips a jump of its own lead there itself, or else use another jump."""
    found = function.instructions()
    at_of = places(function, found)
    jumps = defaultdict(list)  # to a label: the instructions that do nothing else
    for each in found:
        if each.name == "rjmp":
            jumps[each.operands].append(each)
    used: set[int] = set()  # lines of jumps that others lead to
    gone: set[int] = set()  # lines of those that nobody needs
    new = list(function.lines)
    for at in range(1, len(found) - 1):
        before, branch, jump = found[at - 1 : at + 2]
        opposite = OPPOSITE.get(branch.name[2:]) if branch.name.startswith("br") else None
        if opposite is None or branch.operands != ".+2" or jump.name != "rjmp":
            continue
        if leads_on(before) or jump.line in used or jump.line != branch.line + 1:
            continue
        here, label = at_of[branch.line], jump.operands
        if abs(at_of.get(label, 1 << 20) - here) > NEAR:
            if is_hurried:
                continue  # two jumps take longer than one
            others = [each for each in jumps[label] if each != jump and each.line not in gone]
            others.sort(key=lambda each: abs(at_of[each.line] - here))
            if not others or abs(at_of[others[0].line] - here) > NEAR:
                continue
            line = others[0].line
            label = f".Lshared{line}_{function.name}"
            if line not in used:
                new[line] = f"{label}:\n{new[line]}"
                used.add(line)
        gone.add(jump.line)
        new[branch.line] = f"\tbr{opposite} {label}"
    function.lines = "\n".join(line for at, line in enumerate(new) if at not in gone).split("\n")


# -- ends that are equal --------------------------------------------------------------------------


class End(NamedTuple):
    """A place behind which no instruction follows the one before it."""

    function: Function
    number: int
    found: list[Instruction]  # up to the end
    longest: int  # instructions that may be left out here


def _ends(function: Function) -> list[End]:
    found = function.instructions()
    ends: list[End] = []
    for at, last in enumerate(found):
        if last.name not in ("ret", "jmp", "rjmp") or "__" in last.operands or at == 0:
            continue
        if last.name == "rjmp" and last.operands[0] != ".":
            continue
        begin = at
        while begin > 0 and at - begin < LONGEST and is_movable(found[begin - 1]):
            if any(LABEL.match(line) for line in between(function, found, begin)):
                break
            begin -= 1
        if not leads_on(found[at - 1]):
            ends.append(End(function, len(ends), found[: at + 1], at + 1 - begin))
    return ends


def _share_ends(functions: list[Function], addresses: Mapping[str, int]) -> None:
    """Let functions jump to an end that another one has, or that they have before."""
    ends = [end for function in functions for end in _ends(function)]
    gone: dict[tuple[str, int], tuple[int, str]] = {}  # ends: how many instructions, and to where
    labels: dict[tuple[str, int], str] = {}  # lines
    for length in range(LONGEST, 1, -1):
        same = defaultdict(list)
        for end in ends:
            if len(end.found) > length and (end.function.name, end.number) not in gone:
                same[tuple(each[1:] for each in end.found[-length:])].append(end)
        for group in same.values():
            hosts: list[End] = []
            for end in group:
                name = end.function.name
                near = [
                    host
                    for host in hosts
                    if abs(addresses[host.function.name] - addresses[name]) < REACH
                ]
                may_go = end.longest >= length and not leads_on(end.found[-length - 1])
                if near and may_go and not _has_label(end, length, labels):
                    host = near[-1]
                    line = host.found[-length].line
                    key = (host.function.name, line)
                    label = labels.setdefault(key, f".Lend{line}_{host.function.name}")
                    jump = "rjmp" if host.function is end.function else "jmp"
                    gone[name, end.number] = (length, f"\t{jump} {label}")
                else:
                    hosts.append(end)
    for end in reversed(ends):
        name = end.function.name
        if (name, end.number) in gone:
            length, jump = gone[name, end.number]
            lines = end.function.lines
            for each in end.found[-length:]:
                lines[each.line] = ""
            lines[end.found[-1].line] = jump
    for function in functions:
        rows = []
        for number, row in enumerate(function.lines):
            shared = labels.get((function.name, number))
            rows += [f"{shared}:", row] if shared else [row]
        function.lines = rows


def _has_label(end: End, length: int, labels: Mapping[tuple[str, int], str]) -> bool:
    """Return whether somebody leads into what would be left out."""
    return any((end.function.name, each.line) in labels for each in end.found[-length:])
