"""The store of the robot: whenever the plug is pulled, the old program is there or the new one.

`vm_arduino/extras/powercut` pulls it at every write, in every way in which a byte may be torn,
and looks at the next starts. `python -m tests.firmware.test_store 10000000` looks at more cases
than the tests.
"""

from __future__ import annotations

import argparse
import random
import re
import subprocess
import time
from itertools import count
from pathlib import Path
from struct import pack as struct_pack
from typing import NamedTuple
from zlib import crc32

import pytest

from tests.machines.host import FLAGS, ROOT, SOURCES, WARNINGS, compiled
from tiniscript.bytecode.image import HEADER_BYTES, pack
from tools.bench import avr_bench

needs_chip = pytest.mark.skipif(
    bool(avr_bench.missing()), reason=avr_bench.missing() or "there is a simulated chip"
)

# Bytes of code, or records; and the stride of the cuts in saves.
SAMPLES = (("3", "3"), ("24", "9"), ("389", "97"), ("records", "9"))
CAMPAIGN = (("3", "1"), ("24", "1"), ("64", "2"), ("389", "5"), ("records", "2"))
MEGA = "-D__AVR_ATmega2560__"
STORE = SOURCES / "src" / "store" / "store.cpp"
SEEDS = range(1, 3)  # in which a break must be noticed
CODE_BYTES = 389  # kStoredCodeBytes on an Uno
SAVED, SAVING = 3, 2  # StoreState


class Found(NamedTuple):
    """What a run of the program has looked at."""

    cases: int
    saves: int
    most_erases: int  # of one byte, in one save
    most_writes: int  # of one save


CHECKSUM = ("crc32.cpp", "crc32.h", "image.h", "bytecode.h")


def parts(sources: Path) -> list[Path]:
    return [
        *sorted((sources / "src" / "store").glob("*")),
        *sorted((sources / "extras" / "powercut").glob("*")),
        *(sources / "src" / "vm" / name for name in CHECKSUM),
    ]


def run(program: Path, seed: int, sample: tuple[str, ...]) -> Found:
    words = [str(program), str(seed), *sample]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]
    return Found(*(int(line.split()[1]) for line in done.stdout.splitlines()))


# -- the plug -----------------------------------------------------------------------------------


@pytest.mark.parametrize("sample", SAMPLES)
def test_old_or_new(sample: tuple[str, ...]) -> None:
    assert run(compiled(parts(SOURCES), FLAGS), 1, sample).cases > 10_000


def test_with_the_plug_in() -> None:
    assert run(compiled(parts(SOURCES), FLAGS), 1, ()).cases == 0


def test_no_byte_is_erased_twice_by_a_save() -> None:
    """Each of the image once, the generation and three marks; that these go away takes no erase."""
    found = run(compiled(parts(SOURCES), FLAGS), 2, (str(CODE_BYTES), "400"))
    assert found.saves == 16
    assert found.most_erases == 1
    assert found.most_writes == CODE_BYTES + HEADER_BYTES + 1 + 3 + 3


def test_the_layout_of_a_mega() -> None:
    assert run(compiled(parts(SOURCES), (*FLAGS, MEGA)), 1, ("3", "9")).cases > 10_000


def steps(*names: str) -> str:
    """Return steps as they stand in the store."""
    return "\n    ".join(f"step(WriteStep::k{name})," for name in names)


CLEARS = steps("Clear, 3", "Clear, 2", "Clear, 1")
EMPTIES = steps("Empty, 0", "Empty, kBodyAt", "Empty, 1")

GIVES_UP = (
    "  state_ = StoreState::kIdle;\n  is_busy_ = false;\n}\n\ntini_noinline bool Store::begin_save"
)

# What must be noticed: a change of the store.
BREAKS = {
    "the mark comes before the body": (
        steps("Generation", "Body", "Check", "Mark, 1"),
        steps("Generation", "Mark, 1", "Body", "Check"),
    ),
    "the old mark is not taken away": (
        f"// saving\n    {CLEARS}",
        f"// saving\n    {steps('Clear, 3', 'Clear, 2', 'Clear, 2')}",
    ),
    "the old seals are not taken away": (
        f"// saving\n    {CLEARS}",
        f"// saving\n    {steps('Clear, 1', 'Clear, 1', 'Clear, 1')}",
    ),
    "the body goes before the marks": (
        f"// saving\n    {CLEARS}",
        f"// saving\n    {steps('Clear, 4', 'Clear, 2', 'Clear, 1')}",
    ),
    "what counts is not settled": ("!= mark   ? kKeeping", "!= mark ? kKeepingEnd"),
    "what does not count is not settled": (
        "first == kEmptied ? kEmptyingEnd : kEmptying;",
        "first == kEmptied ? kEmptyingEnd : kEmptyingEnd;",
    ),
    "settling begins with the mark": ("kKeeping = 15;", "kKeeping = 16;"),
    "the checksum is not looked at": ("!= kBehindItself) return false;", "== 0) return false;"),
    "equal bytes are never written": (
        "is_stable_ = held_[slot_] != kNothing;",
        "is_stable_ = true;",
    ),
    "the generation is not in the body": ("at == 0 ? byte ^ nvm_read(place) : byte;", "byte;"),
    "the mark is the same for each generation": ("generation_ ^ kMarkOf;", "kMarkOf;"),
    "what is emptied still fits": (
        "step(WriteStep::kEmpty, kBodyAt),",
        "step(WriteStep::kEmpty, 0),",
    ),
    "the emptied mark comes first": (
        EMPTIES,
        steps("Empty, 1", "Empty, kBodyAt", "Empty, 0"),
    ),
    "the second seal is ignored": (": nvm_read(place + 3) != mark ? kKeepingMarks", ": false ? 0"),
    "the older one counts": (">= kGenerations / 2;", "< kGenerations / 2;"),
    "generations do not go around": ("ahead % kGenerations >= kGenerations / 2", "first > second"),
    "what counts is written over": ("slot ^ 1);\n}", "slot);\n}"),
    "what was given up counts": (GIVES_UP, f"  held_[slot_] = generation_;\n{GIVES_UP}"),
}


@pytest.fixture(scope="module")
def objects(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """All but the store, compiled once."""
    folder = tmp_path_factory.mktemp("objects")
    code = [path for path in parts(SOURCES) if path.suffix == ".cpp" and path != STORE]
    command = ["g++", "-std=c++11", "-O2", *WARNINGS, "-c", *map(str, code)]
    subprocess.run(command, cwd=folder, check=True)
    return [str(folder / f"{path.stem}.o") for path in code]


def break_of(name: str) -> str:
    """Return the store with a break, without what the compiler would say of it."""
    text = STORE.read_text(encoding="utf-8")
    old, new = BREAKS[name]
    assert old in text
    text = re.sub(r"^static_assert[^;]*;", "", text.replace(old, new), flags=re.M)
    return text.replace('#include "', f'#include "{STORE.parent}/')


def quick(source: Path, objects: list[str], folder: Path) -> Path:
    """Return the program with another store, without sanitizers."""
    program = folder / "program"
    command = ["g++", "-std=c++11", "-O2", str(source), *objects, "-o", str(program)]
    subprocess.run(command, check=True)
    return program


def test_what_breaks_are_noticed_by_finds_nothing(objects: list[str], tmp_path: Path) -> None:
    program = quick(STORE, objects, tmp_path)
    for seed in SEEDS:
        assert run(program, seed, ("3",)).cases > 10_000


@pytest.mark.sampled("name", keep=6)
@pytest.mark.parametrize("name", BREAKS)
def test_a_break_is_noticed(name: str, objects: list[str], tmp_path: Path) -> None:
    source = tmp_path / "store.cpp"
    source.write_text(break_of(name), encoding="utf-8")
    program = quick(source, objects, tmp_path)
    for seed in SEEDS:
        words = [str(program), str(seed), "3"]
        done = subprocess.run(words, capture_output=True, text=True, timeout=300)
        if done.returncode:
            assert re.match(r"WRONG .*: .*, cut \d at \d+", done.stdout), done.stdout
            return
    raise AssertionError("not noticed")


# -- the document -------------------------------------------------------------------------------


@pytest.mark.parametrize(("column", "flags"), [(1, ()), (2, (MEGA,))])
def test_the_document_says_where_everything_lies(column: int, flags: tuple[str, ...]) -> None:
    text = (ROOT / "docs" / "store.md").read_text(encoding="utf-8")
    rows = [row.split("|") for row in text.splitlines() if re.match(r"\| \d[\d, ]* \| \d", row)]
    places = [int(word) for row in rows[:6] for word in re.findall(r"\d+", row[column])]
    code = re.search(r"has at most ([\d,]+) bytes of code, on a Mega ([\d,]+)", text)
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
    done = subprocess.run(command, input=probe, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


# -- on a chip ----------------------------------------------------------------------------------


def kept(image: bytes) -> list[str]:
    return [f"KEPT {len(image)}", f"CRC {crc32(image)}"]


@needs_chip
@pytest.mark.parametrize(("size", "ticks"), [(3, 0), (24, 20), (CODE_BYTES, 700)])
def test_on_a_chip(size: int, ticks: int) -> None:
    """The registers of a simulated ATmega328P: saved, left in the middle of a save, saved."""
    dice = random.Random(size)
    first, second = (pack("SI", 0, dice.randbytes(size)) for _ in range(2))
    request = struct_pack("<H", ticks)
    for image in (first, second):
        request += struct_pack("<H", len(image)) + image
    *said, start, save = avr_bench.run(avr_bench.built("store"), request)
    saved, saving = f"STATE {SAVED}", f"STATE {SAVING}"
    assert said == [
        *kept(b""),
        *(saved, *kept(first)),
        *(saving, *kept(first)),
        *(saved, *kept(second)),
    ]
    assert int(start.split()[1]) < 16_000 * 8  # cycles: 8 ms, the checksum of a program
    assert int(save.split()[1]) < 16 * 25  # 25 microseconds


# -- the campaign -------------------------------------------------------------------------------


def main() -> None:
    parser = argparse.ArgumentParser(description="Pull the plug of the store, many times.")
    parser.add_argument("cases", type=int, help="how many cases, at least")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program = compiled(parts(SOURCES), FLAGS)
    begun = time.monotonic()
    cases = saves = erases = 0
    for seed in count(options.seed):
        for sample in CAMPAIGN:
            found = run(program, seed, sample)
            cases += found.cases
            saves += found.saves
            erases = max(erases, found.most_erases)
            seconds = time.monotonic() - begun
            print(
                f"{cases:,} cases in {seconds:.0f} s: nothing wrong; {saves} whole saves, at most "
                f"{erases} erase of a byte in one; seed {seed}, {sample[0]}",
                flush=True,
            )
        if cases >= options.cases:
            return


if __name__ == "__main__":
    main()
