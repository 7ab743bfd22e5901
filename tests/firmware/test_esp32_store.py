"""The store of an ESP32: whenever the plug is pulled, the old program is there or the new one.

`vm_arduino/extras/esp32/powercut.cpp` pulls it at every write of NVS, in every way in which that
may leave an entry: as it was, as it becomes, or lost.
"""

from __future__ import annotations

import re
import subprocess
from itertools import pairwise
from pathlib import Path

import pytest

from tests.machines.esp32 import STAND_INS_FOLDER, flags_of
from tests.machines.host import BUILD_CACHE, FLAGS, SOURCES, WARNINGS, compile_once

STORE = SOURCES / "src" / "store" / "store.cpp"
NVS = SOURCES / "src" / "boards" / "esp32" / "nvs.cpp"
OTHERS = [
    SOURCES / "src" / "vm" / "crc32.cpp",
    SOURCES / "extras" / "powercut" / "contents.cpp",
    STAND_INS_FOLDER / "simulated_chip.cpp",
    STAND_INS_FOLDER / "powercut.cpp",
]
PAGE_BYTES = 4096  # bytes of an NVS page
MIN_SPIFFS_PAGES = 5  # NVS pages in min_spiffs.csv
FIRST_PARTITION, FLASH_BYTES = 0x9000, 4 << 20
WRITES = 7  # writes of a save besides its blobs: the generation, and three marks removed and set
BLOB_BYTES, HEADER_BYTES = 1024, 15


def program(store: Path = STORE) -> Path:
    headers = [
        path
        for part in ("src", "extras/esp32", "extras/powercut")
        for path in (SOURCES / part).rglob("*.h")
    ]
    flags = (*FLAGS, *WARNINGS, *flags_of("esp32dev", 2))
    texts = [path.read_bytes() for path in (*sorted(headers), NVS)]
    objects = [
        str(
            compile_once(
                "g++",
                BUILD_CACHE,
                ".o",
                flags,
                [*texts, str(path).encode(), path.read_bytes()],
                ["-c", str(path)],
            )
        )
        for path in (store, *OTHERS)
    ]
    return compile_once("g++", BUILD_CACHE, "", flags, [name.encode() for name in objects], objects)


def run(
    made_of: Path, seed: int, size: int, pages: int | None = None
) -> subprocess.CompletedProcess[str]:
    """Run it; with `pages` of NVS there is no cut, and programs are saved one after the other."""
    words = [str(made_of), str(seed), str(size), *([] if pages is None else [str(pages)])]
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=300)


@pytest.mark.sampled("size")
@pytest.mark.parametrize("size", [3, 389, 8192])
def test_an_interrupted_save_leaves_the_old_or_the_new_data(size: int) -> None:
    completed = run(program(), 1, size)
    assert completed.returncode == 0, (completed.stdout + completed.stderr)[-2000:]
    cases, writes = (int(line.split()[1]) for line in completed.stdout.splitlines())
    assert cases > 5_000
    blobs = -(-(size + HEADER_BYTES) // BLOB_BYTES)
    assert writes <= WRITES + blobs, "a program takes a few writes, not one for each byte"


def test_partitions_fit_the_flash_and_the_simulated_nvs_is_as_large() -> None:
    """The simulated NVS has the room of the partition; that of min_spiffs.csv is too small."""
    text = (SOURCES / "partitions.csv").read_text(encoding="utf-8")
    rows = [re.split(r",\s*", row) for row in text.splitlines() if not row.startswith("#")]
    places = sorted((int(offset, 0), int(size, 0), name) for name, _, _, offset, size in rows)
    assert places[0][0] >= FIRST_PARTITION and sum(places[-1][:2]) <= FLASH_BYTES
    assert all(a + size <= b for (a, size, _), (b, *_) in pairwise(places)), "two overlap"
    (nvs_bytes,) = (size for _, size, name in places if name == "nvs")
    header = (STAND_INS_FOLDER / "simulated_chip.h").read_text(encoding="utf-8")
    (pages,) = map(int, re.findall(r"nvs_room = (\d+) \* kPageEntries", header))
    assert pages + 1 == nvs_bytes // PAGE_BYTES


@pytest.mark.parametrize(("pages", "is_enough"), [(15, True), (MIN_SPIFFS_PAGES - 1, False)])
def test_the_largest_programs_are_saved_again_and_again(pages: int, is_enough: bool) -> None:
    completed = run(program(), 1, 8192, pages)
    assert (completed.returncode == 0) == is_enough, (completed.stdout + completed.stderr)[-2000:]
    assert is_enough or "a save fails" in completed.stdout
