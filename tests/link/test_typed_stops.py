"""Typed stops where bytes arrive: found after any earlier bytes, and never in a whole frame.

Prefixes, frames and damage are made and judged in C++ with the robot's receiver, which reads a line
backwards to know whether it is a stop.
`python -m tests.link.test_typed_stops 1000000` tries more than the tests, and a hundred frames for
each prefix.
"""

from __future__ import annotations

import pytest

from tests.machines.damage import CppDamage, cpp_damage
from tests.support.campaign import make_options

PREFIXES = 100_000  # in the tests
FRAMES = 1_000_000
LINES = 200  # asked for at a time; a line has 1,024 frames
SEED = 7


def false_stops(
    cpp: CppDamage, count: int, seed: int, is_damaged: bool = False, is_odd: bool = True
) -> tuple[int, int]:
    """Send so many frames; return how many, and how many typed stops were found in them."""
    frames = stops = lines = 0
    while frames < count:
        stops_and_lines = cpp.typed_stops(seed, lines, LINES, is_damaged, is_odd)
        frames, stops, lines = (
            frames + stops_and_lines[0],
            stops + stops_and_lines[1],
            lines + LINES,
        )
    return frames, stops


@pytest.mark.parametrize("is_large", [False, True])
def test_a_stop_is_seen_after_any_prefix(is_large: bool) -> None:
    cpp_damage(is_large).type_after(SEED, 0, PREFIXES)


@pytest.mark.parametrize("is_large", [False, True])
def test_no_frame_that_is_whole_stops(is_large: bool) -> None:
    count = FRAMES if not is_large else FRAMES // 10
    frames, stops = false_stops(cpp_damage(is_large), count, SEED)
    assert frames >= count and stops == 0


def test_few_damaged_frames_stop() -> None:
    """One with any bytes in it has to have a line S among them, and to be damaged."""
    frames, stops = false_stops(cpp_damage(), FRAMES // 5, SEED, is_damaged=True, is_odd=False)
    assert stops <= frames / 1000


if __name__ == "__main__":
    options = make_options(1_000_000, 1_000_000)
    for both in (False, True):
        for start_index in range(0, options.count, PREFIXES):
            prefix_count = min(PREFIXES, options.count - start_index)
            cpp_damage(both).type_after(options.seed, start_index, prefix_count)
    looked_at, stops = false_stops(cpp_damage(), 100 * options.count, options.seed)
    assert stops == 0, f"{stops} of {looked_at} undamaged frames stop"
    of, stops = false_stops(cpp_damage(), FRAMES, options.seed, is_damaged=True, is_odd=False)
    print(f"{stops} of {of} damaged frames stop, and none of {looked_at} whole ones")
