"""Finds an order of functions in which calls are short, for `vm_arduino/extras/near/order.txt`.

Builds the sketch of an Uno, takes which function calls which from the program, and exchanges
functions until no exchange helps: an AVR's short call reaches 4 KB. The same sketch gives the same
order. Run it when functions have come or gone; a sketch with another order is right, only larger.
"""

from __future__ import annotations

import math
import random
import re
import subprocess
import sys
from bisect import bisect_right
from collections import Counter
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.bench import firmware_size
from tools.builds.platformio_offline import CannotStandIn

ORDER = ROOT / "vm_arduino" / "extras" / "near" / "order.txt"
HEAD = (
    "# Where functions lie in the flash of an Uno and a Nano, so that calls are short.\n"
    "# Made by python -m tools.builds.near.\n"
)
REACH = 4030  # bytes of a short call, less what moves when calls get shorter
PART = 256  # bytes: where in a long function a call is
STEPS = 100_000
TRIES = 6
WARMEST, COLDEST = 4.0, 0.02

SECTION = re.compile(r"^ (\.text\S*)\s+0x([0-9a-f]+)\s+0x([0-9a-f]+)\s+(\S+)", re.MULTILINE)
CALL = re.compile(r"\s*([0-9a-f]+):.*\t(?:call|rcall|jmp|rjmp)\t.*; 0x([0-9a-f]+)")
ASSEMBLY = re.compile(r"(\w+_avr)\.S\.o$")


class Section(NamedTuple):
    """A function, or what an assembly file has; `calls` go from a place in it to one in another."""

    start: int
    size: int
    pattern: str  # of the linker; nothing where it stays behind all others


class Call(NamedTuple):
    caller: int
    called: int
    caller_at: int
    called_at: int
    times: int


def sections(map_text: str) -> list[Section]:
    """Return what the linker has put one after the other."""
    _, _, memory = map_text.partition("Linker script and memory map")
    text = memory[memory.index("\n.text ") : memory.index("\n.data ")]
    found = []
    for name, start, size, file in SECTION.findall(text):
        if int(size, 16):
            found.append(Section(int(start, 16), int(size, 16), _pattern(name, file)))
    return sorted(found)


def _pattern(name: str, file: str) -> str:
    if name == ".text":
        assembly = ASSEMBLY.search(file)
        return f"*{assembly[1]}.S.o(.text)" if assembly else ""
    # what whole-program optimization adds to a name changes from build to build
    return f"*({re.sub(r'[.](lto_priv|constprop|isra|part)[.].*$', '.*', name)})"


def calls(disassembly: str, rows: list[Section]) -> list[Call]:
    """Return which section calls which."""
    starts = [row.start for row in rows]

    def find(address: int) -> tuple[int, int] | None:
        at = bisect_right(starts, address) - 1
        if at < 0 or address >= rows[at].start + rows[at].size:
            return None
        within = address - rows[at].start
        is_long = rows[at].size > PART
        return at, within // PART * PART + PART // 2 if is_long else rows[at].size // 2

    counted: Counter[tuple[int, int, int, int]] = Counter()
    for line in disassembly.splitlines():
        if matched := CALL.match(line):
            here, there = (find(int(word, 16)) for word in matched.groups())
            if here and there and here[0] != there[0]:
                counted[here[0], there[0], here[1], there[1]] += 1
    return [Call(*key, count) for key, count in counted.items()]


def far(order: list[int], rows: list[Section], found: list[Call]) -> int:
    """Return how many calls are long in an order of the sections."""
    places, at = [0] * len(rows), 0
    for number in order:
        places[number] = at
        at += rows[number].size
    return sum(
        times
        for caller, called, caller_at, called_at, times in found
        if not -REACH <= places[caller] + caller_at - places[called] - called_at <= REACH
    )


def best_order(
    rows: list[Section], found: list[Call], steps: int = STEPS, tries: int = TRIES
) -> list[int]:
    """Return the best order of several tries: each ends somewhere else."""
    orders = [_tried(rows, found, steps, seed) for seed in range(1, tries + 1)]
    return min(orders, key=lambda order: far(order, rows, found))


def _tried(rows: list[Section], found: list[Call], steps: int, seed: int) -> list[int]:
    """Return an order with few long calls: exchanges that harm are allowed less and less."""
    noise = random.Random(seed)
    order = list(range(len(rows)))
    cost = least = far(order, rows, found)
    best = order
    for step in range(steps):
        warmth = WARMEST * (1 - step / steps) ** 2 + COLDEST
        at, length = noise.randrange(len(rows)), noise.choice((1, 1, 1, 2, 3, 5, 8, 13))
        rest = order[:at] + order[at + length :]
        to = noise.randrange(len(rest) + 1)
        other = rest[:to] + order[at : at + length] + rest[to:]
        other_cost = far(other, rows, found)
        if other_cost <= cost or noise.random() < math.exp((cost - other_cost) / warmth):
            order, cost = other, other_cost
            if cost < least:
                best, least = order, cost
    return best


def main() -> int:
    try:
        elf = firmware_size.measured("uno").firmware
    except (RuntimeError, CannotStandIn) as why:
        print(why, file=sys.stderr)
        return 2
    rows = sections((elf.parent / "near.map").read_text(encoding="utf-8"))
    said = subprocess.run(["avr-objdump", "-d", elf], capture_output=True, text=True, check=True)
    found = calls(said.stdout, rows)
    order = best_order(rows, found)
    patterns = dict.fromkeys(rows[number].pattern for number in order if rows[number].pattern)
    ORDER.write_text(HEAD + "".join(f"{each}\n" for each in patterns), encoding="utf-8")
    print(
        f"Long calls: {far(list(range(len(rows))), rows, found)} in this build,"
        f" {far(order, rows, found)} in the order that was written."
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
