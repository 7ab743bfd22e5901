"""The simulated ESP32 refuses what the real one refuses: each row of `refuses.md` is done once."""

from __future__ import annotations

import re
import subprocess
from functools import lru_cache
from pathlib import Path

import pytest

from tests.machines.esp32 import SIMULATED, STAND_INS, flags_of
from tests.machines.host import BUILDS, FLAGS, made, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")
TEXT = (STAND_INS / "refuses.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("| ").split(" | ")]
    for line in TEXT.splitlines()
    if line.startswith("| ") and not line.startswith(("| ---", "| refuses when"))
]
CHIPS = (("esp32dev", 2), ("esp32c3", 3))
NOT_HERE = 2


@lru_cache
def program(chip: str, major: int) -> Path:
    flags = (*FLAGS, *flags_of(chip, major))
    names = ("refusals.cpp", *(name for name in SIMULATED if name not in ("main.cpp",)))
    code = [STAND_INS / name for name in names]
    texts = [path.read_bytes() for path in [*code, *sorted(STAND_INS.rglob("*.h"))]]
    BUILDS.mkdir(mode=0o700, exist_ok=True)
    words = [*map(str, code), "-Dtiniscript_no_mbedtls"]
    return made("g++", BUILDS, "", flags, texts, words)


@pytest.mark.parametrize("row", ROWS, ids=[row[0] for row in ROWS])
def test_it_is_refused(row: list[str]) -> None:
    """On an ESP32 with core 2, on an ESP32-C3 with core 3, or on both."""
    what, here, on_the_chip, source = row
    assert here in ("ends", "says so", "cuts it") and on_the_chip and source
    found = []
    for chip, major in CHIPS:
        done = subprocess.run(
            [program(chip, major), what], capture_output=True, text=True, check=False, timeout=60
        )
        if done.returncode != NOT_HERE:
            found.append(done)
    assert found
    for done in found:
        if here == "ends":
            assert done.returncode < 0 and done.stderr.endswith(f"MISUSE {what}\n"), done
        else:
            assert done.returncode == 0, done


def test_every_refusal_has_its_row() -> None:
    said: set[str] = set()
    for path in STAND_INS.glob("*.cpp"):
        text = re.sub(r'"\s*"', "", path.read_text(encoding="utf-8"))
        said |= set(re.findall(r'expect(?:_free)?\([^;]*?"([^"]+)"\);', text))
    assert said == {row[0] for row in ROWS if row[1] == "ends"}
