"""Fuzzers find no errors in the robot's C++."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.harnesses import NAMES, first_inputs, fuzz, harness, missing
from tests.support.needs import need


@pytest.fixture(autouse=True)
def needs_a_fuzzer() -> None:
    """The check takes half a second, so it is not done at collection, in each process."""
    need(missing())


RUN_COUNTS = {"machine": 30_000, "link": 6_000, "large_link": 3_000, "store": 1_500, "mqtt": 7_500}
SEED = 1

# Inputs in which something was wrong: they stay right. Those of a harness, as hexadecimal digits.
FOUND_INPUTS: dict[str, tuple[str, ...]] = {
    "link": (
        # a BEGIN that is answered BUSY leaves the program that was begun before
        "00010a010002001b230600000040320a0910020000110000030040320b08000000aa4e4e4e4e4e4e"
        "4ec26e40320402000040320a09000200000f000f0400030040320b0600000144325040320402000040320a09000200000f000f0400030040320b0600000144325040320c04e2027ea740320a0900020000ff0000ffff40320a0900020000e8030000ff000096004032",
        # Text that depends on a turning speed in the kit.
        "008f53497c4628464f52455645522c36308f293b5748454e2854525545293b52288f3930204445472c3630293b454e445f855748454e0a4032",
    ),
}


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", NAMES)
def test_fuzzing_finds_no_error(name: str, tmp_path: Path) -> None:
    inputs = first_inputs(name, tmp_path)
    for number, text in enumerate(FOUND_INPUTS.get(name, ())):
        (inputs / f"found-{number}").write_bytes(bytes.fromhex(text))
    report = fuzz(harness(name), inputs, RUN_COUNTS[name], SEED)
    assert not report.wrong, f"{report.wrong}\ninput: {report.input.hex()}"
    assert report.runs >= RUN_COUNTS[name]
