"""A long flashing that progresses is waited for, and a stalled one is not: on a fake clock."""

from __future__ import annotations

import random

import pytest

from tiniscript.flash import avrdude
from tiniscript.flash.avrdude import (
    BAR_MARKS,
    NO_ANSWER_TIMEOUT_S,
    RUN_TIMEOUT_S,
    SILENCE_TIMEOUT_S,
    StepProgress,
    WriteResult,
)

LOOK_S = 0.1
MEGA_S = 50.0  # writing its 256 KB and reading them back
SIGNATURE = "Reading | " + "#" * BAR_MARKS + " | 100% 0.01s\n"


class Clock:
    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made_clock = Clock()
    monkeypatch.setattr(avrdude, "monotonic", made_clock)
    return made_clock


def output(rng: random.Random, whole_s: float, longest_s: float) -> list[tuple[float, str]]:
    """Return the output of an avrdude and when it comes: never later than that after the last."""
    parts = [SIGNATURE, "Writing | ", *"#" * BAR_MARKS, " |\nReading | ", *"#" * BAR_MARKS, " |\n"]
    gaps_s = [rng.random() ** 4 for _ in parts]
    total = sum(gaps_s)
    time_s, lines = 0.0, []
    for gap_s, part in zip(gaps_s, parts, strict=True):
        time_s += min(gap_s / total * whole_s, longest_s)
        lines.append((time_s, part))
    return lines


def watch_parts(
    clock: Clock, parts: list[tuple[float, str]], until_s: float
) -> tuple[WriteResult | None, float]:
    """Return the watch's verdict, or None, and its time."""
    all_progress: list[StepProgress | None] = []
    watch = avrdude._Watch(all_progress.append)
    start_s = clock.now_s
    while clock.now_s - start_s < until_s:
        passed_s = clock.now_s - start_s
        try:
            watch("".join(part for time_s, part in parts if time_s <= passed_s))
        except avrdude._GivenUp as given_up:
            return given_up.result, passed_s
        clock.now_s += LOOK_S
    percents = [
        progress.percent + 100 * (progress.phase == avrdude.READING)
        for progress in all_progress
        if progress
    ]
    assert percents == sorted(percents) and percents[-1] == 200
    return None, until_s


@pytest.mark.parametrize("seed", range(40))
def test_a_write_that_progresses_is_waited_for(clock: Clock, seed: int) -> None:
    """A Mega, and one that is as slow as may be, with pauses that are nearly too long."""
    rng = random.Random(seed)
    parts = output(rng, rng.choice((10, MEGA_S, 200)), NO_ANSWER_TIMEOUT_S - 1)
    assert watch_parts(clock, parts, parts[-1][0] + 1) == (None, parts[-1][0] + 1)


@pytest.mark.parametrize("seed", range(40))
def test_a_write_without_progress_is_ended(clock: Clock, seed: int) -> None:
    rng = random.Random(seed)
    parts = output(rng, MEGA_S, NO_ANSWER_TIMEOUT_S - 1)
    first_parts = parts[: rng.randrange(len(parts) - 1)]
    last_s = first_parts[-1][0] if first_parts else 0.0
    result, end_s = watch_parts(clock, first_parts, RUN_TIMEOUT_S + 1)
    assert result and result.outcome == (
        avrdude.BROKEN_OFF if len(first_parts) > 1 else avrdude.NOBODY
    )
    timeout_s = SILENCE_TIMEOUT_S if len(first_parts) > 1 else NO_ANSWER_TIMEOUT_S
    assert timeout_s - LOOK_S < end_s - last_s < timeout_s + 2 * LOOK_S


@pytest.mark.parametrize("failed", range(4))
def test_a_bootloader_that_misses_the_first_try_is_waited_for(clock: Clock, failed: int) -> None:
    """One that misses more is none: avrdude would go on for a minute."""
    tries = [
        (5.0 * k, f"avrdude: stk500_getsync() attempt {k} of 10: not in sync: resp=0x00\n")
        for k in range(1, failed + 1)
    ]
    good_parts = output(random.Random(failed), MEGA_S, NO_ANSWER_TIMEOUT_S - 1)
    parts = [*tries, *((5.0 * failed + time_s, part) for time_s, part in good_parts)]
    result, end_s = watch_parts(clock, parts, parts[-1][0] + 1)
    assert result == (WriteResult(avrdude.NOBODY) if failed > 1 else None)
    assert failed < 2 or end_s < 5.0 * 2 + 2 * LOOK_S


def test_output_without_progress_does_not_prevent_the_timeout(clock: Clock) -> None:
    parts = [(0.0, SIGNATURE + "Writing | #"), *((k * 1.0, ".") for k in range(1000))]
    result, end_s = watch_parts(clock, parts, RUN_TIMEOUT_S + 10)
    assert result == WriteResult(avrdude.ENDLESS) and end_s < RUN_TIMEOUT_S + 2 * LOOK_S
