"""The cases, and samples of random programs and codes, on a simulated ATmega328P."""

from __future__ import annotations

import os
import random

import pytest

from tests.casefile import Case
from tests.kits import KITS
from tests.machines import Senses
from tests.machines.avr import missing, run_avr
from tests.machines.python import run_python
from tests.oracle import programs
from tests.test_cases import compiled, having, listings_alone, robot_and_senses
from tests.test_cpp_agreement import random_codes
from tiniscript import compile_text
from tiniscript.image import ImageRefused, pack
from tiniscript.kit import Kit
from tiniscript.listing import read_listing
from tiniscript.verify import Refused

needs_chip = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a simulated chip")


def test_the_simulated_chip_is_there() -> None:
    """Without its tools this leg is left out, and says so; in CI that is a failure."""
    if missing():
        assert not os.environ.get("CI"), missing()
        pytest.skip(missing())


def same_on_the_chip(image: bytes, kit: Kit, senses: Senses) -> str:
    """Assert that the chip says and does the same as Python; return the last line."""
    try:
        want = run_python(image, kit, senses)
    except (Refused, ImageRefused) as refused:
        want = repr(refused)
    try:
        got = run_avr(image, kit, senses)
    except (Refused, ImageRefused) as refused:
        got = repr(refused)
    # only code that no compiler makes sounds a comparison: Python then prints its own FALSE
    assert got == want.replace("False", "0").replace("True", "1"), image.hex(" ")
    return want.splitlines()[-1]


@needs_chip
@pytest.mark.parametrize("case", having("tiniscript", "robot"))
def test_robot(case: Case) -> None:
    robot, senses = robot_and_senses(case)
    assert run_avr(compiled(case).image, robot.kit, senses) == case.parts["robot"]


@needs_chip
@pytest.mark.parametrize("case", listings_alone())
def test_listing_runs_or_is_refused(case: Case) -> None:
    robot, _ = robot_and_senses(case)
    code = read_listing(case.parts["bytecode"])
    ending = same_on_the_chip(
        pack("SI", robot.kit.fingerprint, code), robot.kit, Senses(max_ms=5000, max_steps=5000)
    )
    assert ("Refused" in ending) == ("refused" in case.parts)


@needs_chip
@pytest.mark.parametrize("seed", range(4))
def test_random_programs(seed: int) -> None:
    for number in range(100):
        rng = random.Random(seed * 1000 + number)
        oracle_kit, kit = KITS[number % 2]
        image = compile_text(programs.program(rng, oracle_kit), kit).image
        if len(image) <= 700:
            readings = programs.senses(rng, oracle_kit)
            same_on_the_chip(image, kit, Senses(readings, 3000, 2000, number + 1))


@needs_chip
@pytest.mark.parametrize("seed", range(4))
def test_random_codes(seed: int) -> None:
    endings = set()
    kit = KITS[seed % 2][1]
    for number, code in enumerate(random_codes(seed, 8000)):
        if number % 20 < 1 or number % 40 == 16:  # deep blocks and expressions among them
            if len(code) <= 680:
                image = pack("SB", kit.fingerprint, code)
                ending = same_on_the_chip(image, kit, Senses(max_ms=3000, max_steps=300))
                endings.add(ending.split(" ", 1)[-1])
    assert {"DONE", "FAULT OVERFLOW"} <= endings
