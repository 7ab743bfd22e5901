"""What a fuzzer makes finds nothing wrong in the robot's C++, and finds what is broken there."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.firmware.test_store import BREAKS as STORE_BREAKS
from tests.fuzz.harnesses import NAMES, fuzz, harness, missing, seeds
from tests.machines.host import SOURCES

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is libFuzzer")

RUNS = {"machine": 30_000, "link": 6_000, "large_link": 3_000, "store": 1_500, "mqtt": 7_500}
SEED = 1

# Inputs in which something was wrong: they stay right. Those of a harness, as hexadecimal digits.
FOUND: dict[str, tuple[str, ...]] = {
    "machine": (),
    "link": (  # a BEGIN that is answered BUSY leaves the program that was begun before
        "00010a010002001b230600000040320a0910020000110000030040320b08000000aa4e4e4e4e4e4e"
        "4ec26e40320402000040320a09000200000f000f0400030040320b0600000144325040320402000040320a09000200000f000f0400030040320b0600000144325040320c04e2027ea740320a0900020000ff0000ffff40320a0900020000e8030000ff000096004032",
    ),
    "large_link": (),
    "store": (),
    "mqtt": (),
}

# A break of each harness's sources: the file, what it has, and what becomes of that.
BREAKS = {
    "machine": (
        "src/vm/verify.cpp",
        "if (!in_range(kind, value))",
        "if (!in_range(kind, value) && false)",
    ),
    "link": ("src/link/link_writing.cpp", "size_ < most", "size_ < most + 128"),
    "large_link": ("src/link/receiver.h", "(place + 1) % kPlaces", "(place + 1) % (kPlaces + 1)"),
    "store": ("src/store/store.cpp", *STORE_BREAKS["what counts is written over"]),
    "mqtt": (
        "src/boards/esp32/mqtt.cpp",
        "topic_left_ > kMqttTopicBytes ?",
        "topic_left_ > kMqttTopicBytes + 1 ?",
    ),
}


def first_inputs(name: str, folder: Path) -> Path:
    inputs = folder / name
    inputs.mkdir()
    for number, data in enumerate(seeds(name)):
        (inputs / f"{number:04}").write_bytes(data)
    for number, text in enumerate(FOUND[name]):
        (inputs / f"found-{number}").write_bytes(bytes.fromhex(text))
    return inputs


@pytest.mark.sampled("name", keep=3)
@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_wrong(name: str, tmp_path: Path) -> None:
    found = fuzz(harness(name), first_inputs(name, tmp_path), RUNS[name], SEED)
    assert not found.wrong, f"{found.wrong}\ninput: {found.input.hex()}"
    assert found.runs >= RUNS[name]


@pytest.mark.sampled("name", keep=2)
@pytest.mark.parametrize("name", NAMES)
def test_a_break_is_found(name: str, tmp_path: Path) -> None:
    file, old, new = BREAKS[name]
    copy = tmp_path / "sources"
    for part in ("src", "extras"):
        shutil.copytree(SOURCES / part, copy / part)
    text = (copy / file).read_text(encoding="utf-8")
    assert old in text, "the sources were rewritten: BREAKS"
    (copy / file).write_text(text.replace(old, new), encoding="utf-8")
    found = fuzz(harness(name, copy), first_inputs(name, tmp_path), 40 * RUNS[name], SEED)
    assert found.wrong and found.input
