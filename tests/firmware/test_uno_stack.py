"""The stack on a simulated Uno: what the whole sketch leaves free of the RAM at its heaviest."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tiniscript import robots
from tools.bench.firmware_stack import LEAST_FREE, measured


@pytest.mark.sampled(of="long ways of a chip")
@pytest.mark.parametrize(
    ("environment", "robot"),
    [("uno", "tinibot"), ("nano_liner", "liner"), ("uno_tinibot2", "tinibot2")],
)
def test_the_sketch_leaves_stack_free(
    environment: str,
    robot: str,
    sketches: Callable[[str], Path],
    capsys: pytest.CaptureFixture[str],
) -> None:
    stack = measured(sketches(environment), robots.load(robot), environment.partition("_")[0])
    with capsys.disabled():
        print(f"\n  {stack.untouched} bytes untouched, {stack.least_free} at least", end=" ")
    assert stack.program > 100 and stack.interrupt > 20
    assert stack.least_free <= stack.untouched + 4
    assert stack.untouched >= LEAST_FREE
    assert stack.least_free >= LEAST_FREE
