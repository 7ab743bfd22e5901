"""Gives each PWM pin of an ESP32 a channel of LEDC.

Two neighbouring channels share a timer, and so a frequency: motors, servos and the buzzer have one
each. So each of these three starts with an even channel.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain

from tiniscript.robots.drivers import DRIVERS
from tiniscript.robots.profile import Board, Wiring

CHANNELS_PER_TIMER = 2  # channels
FREQUENCIES = (
    "tone",
    "pwm",
    "servo",
)  # names from `boards.ABILITIES`, in the order of their channels


def channels_of(board: Board) -> dict[int, int]:
    """Return the channel of each pin that needs one."""
    pins_by_ability: dict[str, list[int]] = {ability: [] for ability in FREQUENCIES}
    if board.buzzer is not None:
        pins_by_ability["tone"].append(board.buzzer)
    wirings = chain(
        [("motors", board.motors)],
        (("sensors", wiring) for wiring in board.sensors),
        (("actuators", wiring) for wiring in board.actuators),
    )
    for used_by, wiring in wirings:
        for pin, ability in _pin_needs(used_by, wiring):
            if ability in pins_by_ability:
                pins_by_ability[ability].append(pin)
    channels = {}
    first_channel = 0
    for pins in pins_by_ability.values():
        channels.update({pin: channel for channel, pin in enumerate(pins, first_channel)})
        first_channel += timers_of(len(pins)) * CHANNELS_PER_TIMER
    return channels


def timers_of(pin_count: int) -> int:
    """Return the number of timers for this many pins of one frequency."""
    return -(-pin_count // CHANNELS_PER_TIMER)


def _pin_needs(used_by: str, wiring: Wiring) -> Iterable[tuple[int, str]]:
    """Return the pins of a device with the needs of each."""
    for (use, name), driver in DRIVERS.items():
        if name == wiring.driver and use.split()[0] == used_by:
            for pin in driver.pins:
                if pin.key in wiring.pins:
                    yield wiring.pins[pin.key], pin.ability
            return
