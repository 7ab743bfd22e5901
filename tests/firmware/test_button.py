"""The start button and its wire: a stop is early, a start is late, and a spike has no effect."""

from __future__ import annotations

import random

import pytest

from tests.machines.uno import skip_unless_available
from tests.support.button_signals import ButtonEvents, button_events
from tests.support.robot_on_uno import AWAY_PROGRAM, OFF, computer, send, states
from tools.uno import CYCLES_PER_MS, Uno

SPIKE_US = 150
TURNS_US = (100, 370, 1000, 2900, 8000)  # durations of a turn of the main loop
STEADY_US = 30_000


def letters(events: ButtonEvents) -> str:
    return "".join(letter for _, letter in events)


def spikes(count: int, spacing_us: int) -> list[int]:
    return [us for k in range(count) for us in (k * spacing_us, k * spacing_us + SPIKE_US)]


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_spikes_start_nothing_whatever_their_spacing(count: int) -> None:
    cases = [
        (turn, first, spikes(count, spacing_ms * 1000))
        for turn in TURNS_US
        for first in range(0, turn, max(50, turn // 5))
        for spacing_ms in range(1, 201)
    ]
    event_rows = button_events(cases)
    assert len(event_rows) == len(cases) > 1000
    assert not [row for row in event_rows if "R" in letters(row) or "H" in letters(row)]
    assert any(letters(row) for row in event_rows), "the spikes fell between all looks"


@pytest.mark.parametrize("turn", TURNS_US)
def test_a_press_is_reported_at_once_and_its_release_late(turn: int) -> None:
    rng = random.Random(turn)
    cases = []
    for _ in range(200):
        chatter = sorted(rng.sample(range(1, 5000), 4))
        up_us = rng.randrange(300_000, 500_000)
        cases.append((turn, 0, [0, *chatter, up_us, *(up_us + offset_us for offset_us in chatter)]))
    for (_, _, edges), events in zip(cases, button_events(cases), strict=True):
        assert letters(events) == "PHR"
        pressed_us, held_us, released_us = (us for us, _ in events)
        assert pressed_us <= 5000 + turn
        assert held_us >= pressed_us + STEADY_US - 1000
        assert released_us >= edges[5] + STEADY_US - 1000
        if turn <= 1000:
            assert released_us <= edges[-1] + STEADY_US + 3000


def test_a_brief_release_does_not_count() -> None:
    """Spikes while the button is held down, at all spacings."""
    cases = [
        (turn, 0, [0, *(100_000 + us for us in spikes(5, spacing_ms * 1000)), 2_000_000])
        for turn in TURNS_US
        for spacing_ms in range(1, 201)
    ]
    for events in button_events(cases):
        assert letters(events) == "PHR"
        assert events[-1][0] >= 2_000_000 + STEADY_US - 1000


def test_a_press_after_a_spike_is_reported() -> None:
    """Its first edge may count as the spike's chatter: then it is reported once it has lasted."""
    cases = [(100, 0, [0, SPIKE_US, gap_us, 500_000]) for gap_us in range(200, 60_000, 700)]
    for (_, _, edges), events in zip(cases, button_events(cases), strict=True):
        assert letters(events) in ("PHR", "PPHR")
        first = min(us for us, letter in events[1:] if letter in "PH")
        assert edges[2] <= first <= edges[2] + STEADY_US + 1000


def test_an_uno_is_not_started_by_spikes(uno: Uno) -> None:
    """The whole firmware holds a program; spikes come in twos and fives."""
    skip_unless_available()
    wired_uno = computer(uno)
    send(wired_uno, AWAY_PROGRAM.replace("SI", "SB"))
    wired_uno.run(300)
    for spacing_ms in (1, 3, 10, 20, 25, *range(28, 36), 60, 100, 200):
        for count in (2, 5):
            for k in range(count):
                cycle = uno.cycle + (1 + k * spacing_ms) * CYCLES_PER_MS
                uno.drive("button", False, at_cycle=cycle)
                uno.drive("button", None, at_cycle=cycle + SPIKE_US * CYCLES_PER_MS // 1000)
            uno.run_ms(count * spacing_ms + 80)
            assert states(uno) == OFF, (spacing_ms, count)
    assert not [change for change in uno.pins.history("left") if change.state == "pwm"]


def test_the_first_edge_stops_a_running_uno(uno: Uno) -> None:
    wired_uno = computer(uno)
    send(wired_uno, AWAY_PROGRAM)
    wired_uno.run(100)
    cycle = uno.cycle + CYCLES_PER_MS
    uno.drive("button", False, at_cycle=cycle)
    uno.run_ms(3)
    assert states(uno) == OFF
    off_cycle = max(uno.pins[name].cycle for name in OFF)
    assert off_cycle - cycle < CYCLES_PER_MS
