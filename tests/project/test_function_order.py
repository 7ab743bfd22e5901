"""Tests that the order of functions in flash keeps calls short."""

from __future__ import annotations

import random
from pathlib import Path

from tools.builds.function_order import SCRIPT, Piece, best, calls, far, pieces

MAP = """\
 .text.ignored  0x00000000        0x9 before.o
Linker script and memory map
 .text          0x00000100        0x4 crt.o
 .text._ZN4LinkE.lto_priv.7
                0x00000104     0x1000 a.o
 .text.tiniscript_reader
                0x00001104     0x1000 b.o
 .text.helper   0x00002104       0x10 c.o
 .text.nothing  0x00002114        0x0 c.o
 .text.tiniscript_crc32
                0x00002114        0x8 d.o
 .data          0x00800100       0x20 e.o
"""
CALLS = """
     104:\t0e 94 82 10 \tcall\t0x2104\t; 0x2104 <helper>
     106:\t01 c0       \trjmp\t.+2      \t; 0x10a <inside>
    2106:\t0e 94 8a 08 \tjmp\t0x2114\t; 0x2114 <crc>
"""


def test_what_is_linked_is_read_from_a_map() -> None:
    among, sections = pieces(MAP)
    assert among == [
        Piece(".text._ZN4LinkE*", 0x1000),
        Piece(".text.tiniscript_*", 0x1008),
        Piece(".text.helper*", 0x10),
    ]
    assert [tuple(call) for call in calls(CALLS, sections)] == [(0, 0, 2, 0), (2, 2, 1, 0x1000)]


def test_an_order_with_fewer_far_calls_is_found() -> None:
    among, sections = pieces(MAP)
    all_calls = calls(CALLS, sections)
    found = best(among, all_calls, 200, random.Random(1))
    assert far([0, 1, 2], among, all_calls) == 1
    assert sorted(found) == [0, 1, 2] and far(found, among, all_calls) == 0


def test_the_script_names_each_piece_once() -> None:
    rows = [row for row in SCRIPT.read_text(encoding="utf-8").splitlines() if "*(.text." in row]
    assert len(rows) > 100 and len(set(rows)) == len(rows)


def test_a_build_says_where_the_script_is() -> None:
    script: Path = SCRIPT.with_name("order.py")
    settings = (SCRIPT.parents[3] / "platformio.ini").read_text(encoding="utf-8")
    assert script.is_file() and "extra_scripts = src/boards/avr/order.py" in settings
