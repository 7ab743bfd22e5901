"""The simulated ESP32 refuses what the real one refuses: each row of `refusals.cpp` once."""

from __future__ import annotations

import re
import subprocess
from functools import lru_cache
from pathlib import Path

import pytest

from tests.machines.esp32 import SIMULATED, STAND_INS, flags_of
from tests.machines.host import BUILDS, FLAGS, made

ROWS = re.findall(r'row == "([^"]+)"', (STAND_INS / "refusals.cpp").read_text(encoding="utf-8"))


def ends() -> set[str]:
    """Return the rows at which the simulated chip ends a run; the others say no."""
    texts = [re.sub(r'"\s*"', "", path.read_text("utf-8")) for path in STAND_INS.glob("*.cpp")]
    return {
        row for text in texts for row in re.findall(r'expect(?:_free)?\([^;]*?"([^"]+)"\);', text)
    }


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


@pytest.mark.parametrize("row", ROWS)
def test_it_is_refused(row: str) -> None:
    """On an ESP32 with core 2, on an ESP32-C3 with core 3, or on both."""
    found = []
    for chip, major in CHIPS:
        done = subprocess.run(
            [program(chip, major), row], capture_output=True, text=True, check=False, timeout=60
        )
        if done.returncode != NOT_HERE:
            found.append(done)
    assert found
    for done in found:
        if row in ends():
            assert done.returncode < 0 and done.stderr.endswith(f"MISUSE {row}\n"), done
        else:
            assert done.returncode == 0, done


def test_every_refusal_has_its_row() -> None:
    assert len(ROWS) == len(set(ROWS)) > 40
    assert len(ends()) > 30 and ends() <= set(ROWS)
