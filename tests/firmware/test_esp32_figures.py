"""What `docs/esp32.md` says of an ESP32's instructions, bytes and turns is what is measured."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.machines import qemu
from tests.machines.esp32 import missing
from tools.bench import emulated_counts, esp32_frames
from tools.bench.workloads import WORKS
from tools.builds.chips import CHIPS

ROOT = Path(__file__).resolve().parent.parent.parent
DOCUMENT = (ROOT / "docs" / "esp32.md").read_text(encoding="utf-8")
CHIP = "rv32imc"


def row(begin: str) -> list[int]:
    [found] = [line for line in DOCUMENT.splitlines() if line.startswith(f"| {begin}")]
    numbers = re.findall(r"(?<=\| )[\d,]+(?= \|)", found)
    return [int(number.replace(",", "")) for number in numbers]


@pytest.mark.skipif(bool(qemu.missing(CHIP)), reason=qemu.missing(CHIP) or "there is QEMU")
def test_an_iteration_takes_so_many_instructions() -> None:
    counting = emulated_counts.Counting(CHIP)
    found = [counting.per_iteration(work) for work in WORKS]
    counting.close()
    for once, said in zip(found, row(f"{CHIPS[CHIP].board} | instructions"), strict=True):
        assert said * 0.97 < once < said * 1.03


@pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")
def test_bytes_over_bluetooth_and_turns_to_a_pin() -> None:
    first = esp32_frames.image_of(esp32_frames.FIRST)
    found = {mtu: list(esp32_frames.carried(first, mtu)) for mtu in esp32_frames.MTUS}
    for mtu, numbers in found.items():
        assert row(f"`SI\\|F(2, 80)` | {mtu}") == [mtu, *numbers]
    assert [esp32_frames.to_pin(is_stop)[0] for is_stop in (False, True)] == [1, 1]
