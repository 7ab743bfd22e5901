"""A remote control drives the firmware of an Uno and of a Nano: from its word to the motor pins.

`python -m tools.bench.keys` measures the same 300 times, and with another baud.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tiniscript import robots
from tiniscript.link.remote import NOTHING_PRESSED
from tools.bench.keys import (
    MAX_HELD_MS,
    MAX_LET_GO_MS,
    MAX_LOST_MS,
    PAD_AHEAD,
    PAD_PROGRAM,
    Hand,
)

BAUD = robots.load("tinibot").board.baud
TRIES = 5


@pytest.mark.sampled("sketch_name")
@pytest.mark.parametrize("sketch_name", ["uno", "nano"])
def test_held_keys_reach_the_motors(sketch_name: str, sketches: Callable[[str], Path]) -> None:
    """So do released keys; and a lost line releases all."""
    with Hand(sketches(sketch_name), BAUD, PAD_PROGRAM) as hand:
        for _ in range(TRIES):
            assert 0 < hand.measure_change_ms(PAD_AHEAD) <= MAX_HELD_MS[BAUD]
            assert 0 < hand.measure_change_ms(NOTHING_PRESSED) <= MAX_LET_GO_MS[BAUD]
        assert 0 < hand.measure_loss_ms() <= MAX_LOST_MS
