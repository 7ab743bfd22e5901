"""The store of the robot: whenever the plug is pulled, the old program is there or the new one.

`vm_arduino/extras/powercut` pulls it at every write, in every way in which a byte may be torn,
and looks at the next starts. `python -m tests.firmware.test_store 10000000` looks at more cases
than the tests.
"""

from __future__ import annotations

import random
import re
import subprocess
from itertools import count
from pathlib import Path
from struct import pack as struct_pack
from typing import NamedTuple
from zlib import crc32

import pytest

from tests.machines.host import FLAGS, ROOT, SOURCES, compile_program
from tests.support.campaign import make_options
from tiniscript.bytecode.image import HEADER_BYTES, pack
from tools.bench import avr_bench

needs_chip = pytest.mark.skipif(
    bool(avr_bench.missing_reason()),
    reason=avr_bench.missing_reason() or "there is a simulated chip",
)

# Bytes of code, or records; and the stride of the cuts in saves.
SAMPLES = (("3", "3"), ("24", "9"), ("389", "97"), ("records", "9"))
CAMPAIGN = (("3", "1"), ("24", "1"), ("64", "2"), ("389", "5"), ("records", "2"))
MEGA = "-D__AVR_ATmega2560__"
STORE = SOURCES / "src" / "store" / "store.cpp"
CODE_BYTES = 389  # kStoredCodeBytes on an Uno
SAVED, SAVING = 3, 2  # StoreState


class Found(NamedTuple):
    """The findings of a run of the checker."""

    cases: int
    saves: int
    max_erases: int  # most erases of one byte in one save
    max_writes: int  # most writes of one save


CHECKSUM = ("crc32.cpp", "crc32.h", "image.h", "bytecode.h")


def parts(sources: Path) -> list[Path]:
    return [
        *sorted((sources / "src" / "store").glob("*")),
        *sorted((sources / "extras" / "powercut").glob("*")),
        *(sources / "src" / "vm" / name for name in CHECKSUM),
    ]


def run(program: Path, seed: int, sample: tuple[str, ...]) -> Found:
    words = [str(program), str(seed), *sample]
    completed = subprocess.run(words, capture_output=True, text=True)
    assert completed.returncode == 0, (completed.stdout + completed.stderr)[-4000:]
    return Found(*(int(line.split()[1]) for line in completed.stdout.splitlines()))


# -- the plug -----------------------------------------------------------------------------------


@pytest.mark.sampled(of="layouts of the store", keep=2)
@pytest.mark.parametrize("sample", SAMPLES)
def test_an_interrupted_save_leaves_the_old_or_the_new_data(sample: tuple[str, ...]) -> None:
    assert run(compile_program(parts(SOURCES), FLAGS), 1, sample).cases > 10_000


def test_an_uninterrupted_save_stores_the_new_data() -> None:
    assert run(compile_program(parts(SOURCES), FLAGS), 1, ()).cases == 0


def test_no_byte_is_erased_twice_by_a_save() -> None:
    """Each of the image once, the generation and three marks; that these go away takes no erase."""
    wear = run(compile_program(parts(SOURCES), FLAGS), 2, (str(CODE_BYTES), "400"))
    assert wear.saves == 16
    assert wear.max_erases == 1
    assert wear.max_writes == CODE_BYTES + HEADER_BYTES + 1 + 3 + 3


@pytest.mark.sampled(of="layouts of the store", keep=2)
def test_the_layout_of_a_mega_is_as_documented() -> None:
    assert run(compile_program(parts(SOURCES), (*FLAGS, MEGA)), 1, ("3", "9")).cases > 10_000


# -- the document -------------------------------------------------------------------------------


@pytest.mark.parametrize(("column", "flags"), [(1, ()), (2, (MEGA,))])
def test_the_document_states_the_memory_layout(column: int, flags: tuple[str, ...]) -> None:
    text = (ROOT / "docs" / "develop" / "store.md").read_text(encoding="utf-8")
    rows = [row.split("|") for row in text.splitlines() if re.match(r"\| \d[\d, ]* \| \d", row)]
    places = [int(word) for row in rows[:6] for word in re.findall(r"\d+", row[column])]
    code = re.search(r"has at most ([\d,]+) bytes of code, or ([\d,]+)", text)
    assert len(places) == 10 and code
    names = [f"place_of({slot})" for slot in (2, 3, 4, 5, 0, 1)]
    owners = [f"place_of({slot}) + kProgramSlot" for slot in (0, 1)]
    facts = dict(zip([*names, *owners, "kMemoryBytes"], places[1:], strict=True))
    facts["kStoredCodeBytes"] = int(code[column].replace(",", ""))
    facts["place_of(0) + kProgramSlot + kOwnerSlot"] = places[6]
    facts["place_of(1) + kProgramSlot + kOwnerSlot"] = places[9]
    facts["place_of(2) + kRecordSlot"] = places[2]
    probe = f'#include "{STORE.parent}/layout.h"\nusing namespace tiniscript;\n'
    probe += "".join(f'static_assert({a} == {b}, "{a}");\n' for a, b in facts.items())
    command = ["g++", "-std=c++11", "-fsyntax-only", *flags, "-xc++", "-"]
    completed = subprocess.run(command, input=probe, capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr


# -- on a chip ----------------------------------------------------------------------------------


def expected_lines(image: bytes) -> list[str]:
    return [f"KEPT {len(image)}", f"CRC {crc32(image)}"]


@needs_chip
@pytest.mark.parametrize(("size", "ticks"), [(3, 0), (24, 20), (CODE_BYTES, 700)])
def test_the_store_works_on_a_chip(size: int, ticks: int) -> None:
    """The registers of a simulated ATmega328P: saved, left in the middle of a save, saved."""
    rng = random.Random(size)
    first, second = (pack("SI", 0, rng.randbytes(size)) for _ in range(2))
    request = struct_pack("<H", ticks)
    for image in (first, second):
        request += struct_pack("<H", len(image)) + image
    *lines, start, save = avr_bench.run(avr_bench.build("store"), request)
    saved_text, saving = f"STATE {SAVED}", f"STATE {SAVING}"
    assert lines == [
        *expected_lines(b""),
        *(saved_text, *expected_lines(first)),
        *(saving, *expected_lines(first)),
        *(saved_text, *expected_lines(second)),
    ]
    assert int(start.split()[1]) < 16_000 * 8  # cycles: 8 ms, the checksum of a program
    assert int(save.split()[1]) < 16 * 25  # 25 microseconds


# -- the campaign -------------------------------------------------------------------------------


if __name__ == "__main__":
    options = make_options(10_000_000, 1)
    cases = 0
    for number in count(options.seed):
        for campaign_case in CAMPAIGN:
            cases += run(compile_program(parts(SOURCES), FLAGS), number, campaign_case).cases
        print(f"{cases:,} cases to seed {number}: nothing wrong", flush=True)
        if cases >= options.count:
            break
