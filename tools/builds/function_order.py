"""Finds an order of the sketch's functions in flash in which few calls lead far.

    python -m tools.builds.function_order     writes the order into `boards/avr/order.ld`

On an AVR a call that leads at most 4 KB far takes two bytes less. An order that is old does no harm
but to the size: a function that is not in it lies after the others. So run this again when the
sketch of an Uno approaches its limit.
"""

from __future__ import annotations

import math
import os
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from tools.bench import firmware_size

SCRIPT = firmware_size.PROJECT / "src" / "boards" / "avr" / "order.ld"
BEGIN, END = "/* begin of the order */\n", "    /* end of the order */"
BOARD = "uno"
SHORT_CALL_RANGE = range(-4096, 4096)  # bytes, from just after a short call
TRY_COUNT = 200_000
# The compiler's suffix of a name may change with the next edit.
_APPENDED_SUFFIX = re.compile(r"\.(lto_priv|constprop|part|isra)\.\d+")
# Assembly calls its other files by short calls: they stay together.
_ASSEMBLY = re.compile(r"\.text\.tiniscript_.*")
_SECTION = re.compile(r"^ (\.\S+)\s+0x([0-9a-f]+)\s+0x([0-9a-f]+) ", re.M)
_CALL = re.compile(
    r"^\s+([0-9a-f]+):\t[0-9a-f ]+\t(?:call|jmp|rcall|rjmp)\s.*?; 0x([0-9a-f]+)", re.M
)


class Section(NamedTuple):
    """Code as the linker has placed it: from `begin` to `end` it was in piece `number` at
    `offset`."""

    begin: int
    end: int
    number: int
    offset: int


class Piece(NamedTuple):
    """The functions placed together by a line of the script."""

    pattern: str
    size: int


class Call(NamedTuple):
    """A call from a place in one piece to a place in another."""

    piece: int
    offset: int
    target: int
    target_offset: int


def pieces(linker_map: str) -> tuple[list[Piece], list[Section]]:
    """Return the pieces named in a linker map, in the order of flash."""
    sizes: dict[str, int] = {}
    sections = []
    code = linker_map[linker_map.index("Linker script and memory map") :]
    for name, begin_hex, size_hex in _SECTION.findall(code.replace("\n    ", " ")):
        start, size = int(begin_hex, 16), int(size_hex, 16)
        if not name.startswith(".text.") or size == 0:
            continue
        pattern = _ASSEMBLY.sub(".text.tiniscript_", _APPENDED_SUFFIX.sub("", name)) + "*"
        offset = sizes.setdefault(pattern, 0)
        sections.append(Section(start, start + size, list(sizes).index(pattern), offset))
        sizes[pattern] = offset + size
    return [Piece(*piece) for piece in sizes.items()], sections


def calls(disassembly: str, sections: list[Section]) -> list[Call]:
    """Return the calls between pieces."""

    def find_offset(address: int) -> tuple[int, int] | None:
        for section in sections:
            if section.begin <= address < section.end:
                return section.number, section.offset + address - section.begin
        return None

    calls = []
    for call_text, target_text in _CALL.findall(disassembly):
        caller, callee = find_offset(int(call_text, 16)), find_offset(int(target_text, 16))
        if caller and callee and caller[0] != callee[0]:
            calls.append(Call(*caller, *callee))
    return calls


def count_far_calls(order: list[int], all_pieces: list[Piece], all_calls: list[Call]) -> int:
    """Return the number of far calls in an order."""
    starts = [0] * len(all_pieces)
    address = 0
    for number in order:
        starts[number] = address
        address += all_pieces[number].size
    return sum(
        starts[target] + target_offset - starts[piece] - offset - 2 not in SHORT_CALL_RANGE
        for piece, offset, target, target_offset in all_calls
    )


def rearrange(order: list[int], random_source: random.Random) -> list[int]:
    """Return an order in which some neighbours lie elsewhere, or the other way round."""
    start = random_source.randrange(len(order))
    end = start + random_source.choice((1, 1, 1, 2, 3, 5, 8, 12))
    moved_pieces, other_pieces = order[start:end], order[:start] + order[end:]
    if random_source.random() < 0.8:
        start = random_source.randrange(len(other_pieces) + 1)
    else:
        moved_pieces.reverse()
    return other_pieces[:start] + moved_pieces + other_pieces[start:]


def best_order(
    all_pieces: list[Piece], all_calls: list[Call], try_count: int, random_source: random.Random
) -> list[int]:
    """Search by simulated annealing."""
    order = best = list(range(len(all_pieces)))
    far_count = least_far_count = count_far_calls(order, all_pieces, all_calls)
    for number in range(try_count):
        temperature = 3.0 * (1 - number / try_count) + 0.05
        candidate = rearrange(order, random_source)
        count = count_far_calls(candidate, all_pieces, all_calls)
        if count <= far_count or random_source.random() < math.exp(
            (far_count - count) / temperature
        ):
            order, far_count = candidate, count
            if far_count < least_far_count:
                best, least_far_count = order, far_count
    return best


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        map_path = Path(folder) / "map"
        os.environ["PLATFORMIO_BUILD_FLAGS"] = f"-Wl,-Map={map_path}"
        sketch = firmware_size.measure(BOARD)
        del os.environ["PLATFORMIO_BUILD_FLAGS"]
        all_pieces, sections = pieces(map_path.read_text(encoding="utf-8"))
    command = ["avr-objdump", "-d", str(sketch.firmware)]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    all_calls = calls(result.stdout, sections)
    order = best_order(all_pieces, all_calls, TRY_COUNT, random.Random(1))
    print(f"{sketch.flash:,} bytes before; calls that lead far: "
          f"{count_far_calls(list(range(len(all_pieces))), all_pieces, all_calls)} before, "
          f"{count_far_calls(order, all_pieces, all_calls)} then")  # fmt: skip
    text = SCRIPT.read_text(encoding="utf-8")
    start, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    rows = "".join(f"    *({all_pieces[number].pattern})\n" for number in order)
    SCRIPT.write_text(text[:start] + rows + text[end:], encoding="utf-8")
    print(f"{firmware_size.measure(BOARD).flash:,} bytes with the new order")
    return 0


if __name__ == "__main__":
    sys.exit(main())
