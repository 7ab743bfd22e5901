"""The reader of text on a simulated ATmega328P says what it says on this computer.

There an int has 16 bits, and tables lie in another memory.
"""

from __future__ import annotations

import random
from struct import pack
from zlib import crc32

import pytest

from tests.machines.host import missing as missing_host
from tests.machines.text_reader import NO_DEFS, Answer, TextReader
from tests.oracle import programs
from tests.support.kits import KITS
from tests.text.test_reader_agreement import damaged, soup
from tiniscript.bytecode.image import STARTS
from tiniscript.robots.kit_words import kit_words
from tiniscript.text.problems import NAMES
from tools.bench import avr_bench

REASON = avr_bench.missing() or missing_host()
ROOM = 389
ORACLE_KIT, KIT = KITS[1]


def said(answer: Answer) -> list[int]:
    """Return what the chip says: kind, start or problem, length or column, and a checksum."""
    numbers = {name: number for number, name in NAMES.items()}
    if answer.problem:
        return [4, numbers[answer.problem], answer.column, 0]
    checksum = crc32(answer.code)
    checksum -= (checksum >> 31) << 32
    return [3, STARTS.index(answer.start), len(answer.code), checksum]


def texts() -> list[bytes]:
    found = [soup(seed)[1] for seed in range(400)]
    for seed in range(150):
        rng = random.Random(seed)
        text = programs.program(rng, ORACLE_KIT)
        slip = programs.broken(rng, text).encode("utf-8", "surrogatepass")
        found += [text.encode(), damaged(rng, slip)]
    return [each + b"\n" for each in found if each.strip() and len(each) < 800]


@pytest.mark.skipif(bool(REASON), reason=REASON or "there is a chip")
def test_the_chip_says_the_same() -> None:
    reader = TextReader(KIT, ROOM, NO_DEFS)
    program = avr_bench.built("reader")
    head = pack("<HH", ROOM, len(kit_words(KIT))) + kit_words(KIT)
    request, expected, compared = head, list[list[int]](), 0
    for text in [*texts(), b""]:
        more = pack("<H", len(text)) + text
        if not text or len(request) + len(more) + 2 > avr_bench.REQUEST_BYTES:
            lines = avr_bench.run(program, request + b"\0\0")
            numbers = [int(line.split()[-1]) for line in lines]
            got = [numbers[k : k + 4] for k in range(0, len(numbers), 4)]
            got = [[3 if each[0] == 1 else each[0], *each[1:]] for each in got]  # no program: 1
            assert got == expected
            request, expected, compared = head, [], compared + len(got)
        answer = reader.read(text)
        if answer.is_program or answer.problem:  # else a block is open
            request += more
            expected.append(said(answer))
    reader.close()
    assert compared > 500
