"""Anything at all arrives at a whole robot: bytes, words, frames, zeros, silences, the button.

After any input, no motor turns while the robot is latched, and after a second of silence the next
whole line is executed. `python -m tests.firmware.test_text 10000` is a campaign.
"""

from __future__ import annotations

import pytest

from tests.support.text_fuzz import run

SEEDS = 24  # seeds of the tests; a campaign runs more


@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_line_runs_after_any_input(seed: int) -> None:
    run(seed)
