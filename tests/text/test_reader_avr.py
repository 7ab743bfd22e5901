"""The reader of text on a simulated ATmega328P agrees with the one on this computer.

On this chip, an int has 16 bits, and tables are in another memory.
"""

from __future__ import annotations

from struct import pack
from zlib import crc32

import pytest

from tests.machines.text_reader import NO_DEFS, Answer, TextReader
from tests.support.kits import KITS
from tests.support.reader_agreement import some_texts
from tiniscript.bytecode.image import STARTS
from tiniscript.codegen.text.problems import PROBLEM_NAMES
from tiniscript.robots.kit_words import kit_words
from tools.bench import avr_bench

REASON = avr_bench.missing_reason()
ROOM = 389
KIT = KITS[1][1]
# The end of one instruction that pushes a number, and the beginning of a longer one.
NUMBERS = (
    *range(23), *range(30, 121, 10), 99, 127, 128, 129, 250, 255, 256, 3276, 3277, 32767, 32768,
    32769, 65535, 65536, 65537, 100000, 2147483, 2147483.647, 2147483.648, 2147484, 429496729.6,
    4294967296, 0.1, 0.5, 1.5, 2.0, "2.00", "20.000", "5.0004", "5.0005", 12.7, 12.8, 12.9, 13.1,
    25.5, 25.6, 127.5, 0.01, 0.001, 1.25, 32.766, 32.767, 32.768, 32.769, 65.535, 65.536, 327.67,
    327.68, 3276.7, 3276.8, 3276.9, 6553.5, 40000.5,
)  # fmt: skip


def chip_numbers(answer: Answer) -> list[int]:
    """Return the chip's answer: kind, start or problem, length or column, and a checksum."""
    numbers = {name: number for number, name in PROBLEM_NAMES.items()}
    if answer.problem:
        return [4, numbers[answer.problem], answer.column, 0]
    checksum = crc32(answer.code)
    checksum -= (checksum >> 31) << 32
    return [3, STARTS.index(answer.start), len(answer.code), checksum]


def texts() -> list[bytes]:
    codes = some_texts(400, 150)
    codes += [
        f"{sign}{number}".join(("F(1, ABS(", "))")).encode()
        for number in NUMBERS
        for sign in ("", "-")
    ]
    return [text + b"\n" for text in codes if text.strip() and len(text) < 800]


@pytest.mark.skipif(bool(REASON), reason=REASON or "there is a chip")
def test_the_chip_gives_the_same_answers() -> None:
    reader = TextReader(KIT, ROOM, NO_DEFS)
    program = avr_bench.build("reader", avr_bench.SOURCES, "-Dtiniscript_with_remote")
    head = pack("<HH", ROOM, len(kit_words(KIT))) + kit_words(KIT)
    request, expected, compared_count = head, list[list[int]](), 0
    for text in [*texts(), b""]:
        more = pack("<H", len(text)) + text
        if not text or len(request) + len(more) + 2 > avr_bench.REQUEST_BYTES:
            lines = avr_bench.run(program, request + b"\0\0")
            numbers = [int(line.split()[-1]) for line in lines]
            answers = [numbers[k : k + 4] for k in range(0, len(numbers), 4)]
            answers = [
                [3 if answer[0] == 1 else answer[0], *answer[1:]] for answer in answers
            ]  # no program: 1
            assert answers == expected
            request, expected, compared_count = head, [], compared_count + len(answers)
        answer = reader.read(text)
        if answer.is_program or answer.problem:  # otherwise a block is open
            request += more
            expected.append(chip_numbers(answer))
    reader.close()
    assert compared_count > 500
