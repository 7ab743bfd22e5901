"""What callers hand over to functions: `shorter.py` uses it.

A method that only methods of the same object call finds the object in Y, where they have it. What
many callers of a function load before they call it is there once, in front of the function. Nothing
gets slower by either. What has another form than expected is left alone.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from itertools import combinations, count
from typing import NamedTuple

from assembly import (
    BODY,
    ENDING,
    LABEL,
    SKIPS,
    WORD,
    Function,
    Instruction,
    between,
    leads_on,
)
from effects import LOADS, effects

CALLS = ("call", "rcall", "jmp")
FARTHEST = 14  # instructions before a call that are looked at
OBJECT, HAND_OVER = ("movw", "r28,r24"), ("movw", "r24,r28")
GIVEN, Y = frozenset((24, 25)), frozenset((28, 29))  # registers of the object
SAVED = ["\tpush r28", "\tpush r29"]
RESTORED = ["\tpop r29", "\tpop r28", "\tret"]

Load = tuple[str, str]  # its name and its operands


class Site(NamedTuple):
    """A call, and the loads before it that may as well come right before it."""

    caller: Function
    call: Instruction
    loads: dict[Load, int]  # and their lines


def _sites(functions: list[Function]) -> dict[str, list[Site]]:
    """Return the calls of each function that is called by its name."""
    found = defaultdict(list)
    for function in functions:
        instructions = function.instructions()
        for at, each in enumerate(instructions):
            if each.name in CALLS:
                loads = _loads(function, instructions, at)
                found[each.operands].append(Site(function, each, loads))
    return found


def _loads(function: Function, found: list[Instruction], call: int) -> dict[Load, int]:
    touched: set[int] = set()
    loads: dict[Load, int] = {}
    if leads_on(found[call - 1]):
        return loads
    for at in range(call - 1, max(call - FARTHEST, -1), -1):
        each = found[at]
        done = effects(each)
        if any(LABEL.match(line) for line in between(function, found, at + 1)):
            break
        if done is None or each.name.startswith(("br", "rjmp")):
            break
        if at > 0 and leads_on(found[at - 1]):
            break
        if each.name in LOADS and touched.isdisjoint(done.written | done.read):
            loads[each.name, each.operands] = each.line
        touched |= done.written | done.read
    return loads


# -- loads that many callers have -----------------------------------------------------------------


def share_loads(functions: list[Function]) -> None:
    """Put what many callers of a function load in front of it, and let them call that."""
    calls = _sites(functions)
    for function in functions:
        name = function.name
        for number in count():
            loads = _common(calls[name])
            if not loads:
                break
            entry = f"tiniscript_to{number}_{function.name}"
            rows = [f"\t{each} {operands}" for each, operands in loads]
            function.before = [f"{entry}:", *rows, *function.before]
            for site in calls[name]:
                if all(each in site.loads for each in loads):
                    for each in loads:
                        site.caller.lines[site.loads.pop(each)] = ""
                    site.caller.lines[site.call.line] = f"\t{site.call.name} {entry}"
                    calls[entry].append(site)
            name = entry


def _common(calls: list[Site]) -> list[Load]:
    """Return the loads that save most, if any do."""
    best: tuple[int, list[Load]] = (0, [])
    for one, other in combinations(calls, 2):
        loads = sorted(one.loads.keys() & other.loads.keys())
        users = sum(all(each in site.loads for each in loads) for site in calls)
        best = max(best, (len(loads) * (users - 1), loads))
    return best[1]


# -- objects whose methods call each other --------------------------------------------------------


def share_objects(functions: Mapping[str, Function], elsewhere: str) -> None:
    """Let a method that only methods of its object call take it from Y; `elsewhere`: other text."""
    calls = _sites(list(functions.values()))
    counted: dict[str, int] = defaultdict(int)
    for each in functions.values():
        for line in each.lines:
            for word in WORD.findall(line):
                counted[word] += 1
    others = set(WORD.findall(elsewhere))
    for name, function in functions.items():
        own = calls[name]
        # all that name it are calls, and its label
        if name in others or not own or counted[name] != len(own) + 1:
            continue
        if all(HAND_OVER in site.loads and site.call.name != "jmp" for site in own):
            if _takes_object(function):
                for site in own:
                    site.caller.lines[site.loads.pop(HAND_OVER)] = ""


def _takes_object(function: Function) -> bool:
    """Let a function that moves its object into Y expect it there. Return whether it is one."""
    if function.lines.count(BODY) != 1 or function.lines.count(ENDING) != 1:
        return False
    body = function.lines.index(BODY)
    if any("__prologue_saves__" in line for line in function.lines[:body]):
        return False  # changes Y
    found = function.instructions()
    at = next((at for at, each in enumerate(found) if each[1:] == OBJECT), 0)
    if found[at].line < body or any(map(LABEL.match, function.lines[body : found[at].line])):
        return False
    for each in found[:at]:
        done = effects(each)
        touched = GIVEN | Y if done is None else done.written | done.read
        if each.line > body and (each.name not in LOADS or not touched.isdisjoint(GIVEN | Y)):
            return False
    is_kept = any(_is_read(function, found, at + 1, each) for each in GIVEN)
    function.lines[found[at].line] = "\tmovw r24,r28" if is_kept else ""
    _leave_y(function, found[at + 1 :])
    return True


def _leave_y(function: Function, rest: list[Instruction]) -> None:
    """Do not save Y where nothing else comes into it."""
    lines = function.lines
    body, ending = lines.index(BODY), lines.index(ENDING)
    if lines[1:body] != SAVED or lines[ending + 1 : ending + 4] != RESTORED:
        return
    for each in rest:
        done = effects(each)
        is_known = done is not None or each.name in (*CALLS, "ret")
        is_end = ending < each.line <= ending + 3
        if not is_end and not (is_known and (done is None or Y.isdisjoint(done.written))):
            return
    for number in (1, 2, ending + 1, ending + 2):
        lines[number] = ""


def _is_read(function: Function, found: list[Instruction], first: int, register: int) -> bool:
    """Return whether a register may be read before it is written, from an instruction on."""
    labels = {}
    for at, each in enumerate(found):
        rows = function.lines[: each.line] if at == 0 else between(function, found, at)
        labels.update({matched[1]: at for row in rows if (matched := LABEL.match(row))})
    seen: set[int] = set()
    nexts = [first]
    while nexts:
        at = nexts.pop()
        if at in seen:
            continue
        seen.add(at)
        done = effects(found[at]) if at < len(found) else None
        if done is None or register in done.read:
            return True
        if register in done.written:
            continue
        each = found[at]
        is_branch = each.name.startswith("br") or each.name == "rjmp"
        if is_branch and each.operands not in labels and each.operands != ".+2":
            return True
        if is_branch and each.operands in labels:
            nexts.append(labels[each.operands])
        if each.name in SKIPS or each.operands == ".+2":
            nexts.append(at + 2)
        if each.name != "rjmp":
            nexts.append(at + 1)
    return False
