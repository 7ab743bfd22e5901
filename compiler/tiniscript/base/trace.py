"""The trace of a run: what a robot did, real, virtual or none at all.

Knows how each event is written. Knows no machine and no clock.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from tiniscript.base.fixed_point import clamp, round_to_whole, value_text
from tiniscript.base.kit import Kit


class Event(NamedTuple):
    """An action of a robot at `time_ms`: MOTORS, READ, BEEP, SHOW, SET, DONE, FAULT or LIMIT.

    `values` are percent for MOTORS, hertz and milliseconds for BEEP, the number of the device and
    thousandths for READ and SET, thousandths for SHOW; `text` is what a trace prints; `offset` is
    where a SHOW is in the code, if the robot reports it.
    """

    time_ms: int
    kind: str
    values: tuple[int, ...]
    text: str
    offset: int = -1

    def __str__(self) -> str:
        return f"{self.time_ms} {self.text}"


class Ending(NamedTuple):
    """The end of a run: `kind` is DONE, FAULT or LIMIT; `offset` is the place in the code."""

    kind: str
    fault: str
    offset: int
    steps: int


class Senses:
    """Readings from lists: each takes the next value, the last one repeats, no list is 0."""

    def __init__(self, kit: Kit, readings_by_sensor: Mapping[int, Sequence[int]]) -> None:
        """`readings_by_sensor` maps the number of a sensor to its readings, in thousandths."""
        self.readings = [
            list(readings_by_sensor.get(i, ())) or [0] for i in range(len(kit.readings))
        ]
        self.read_counts = [0] * len(kit.readings)

    def __call__(self, sensor: int) -> int:
        values = self.readings[sensor]
        value = values[min(self.read_counts[sensor], len(values) - 1)]
        self.read_counts[sensor] += 1
        return value


class TracedRobot:
    """A robot that only records its commands."""

    def __init__(self, kit: Kit, senses: Callable[[int], int]) -> None:
        self.kit = kit
        self.senses = senses
        self.now_ms = 0
        self.events: list[Event] = []

    def record(self, name: str, values: tuple[int, ...], text: str) -> None:
        self.events.append(Event(self.now_ms, name, values, text))

    def motors(self, left: int, right: int) -> None:
        self.record("MOTORS", (left, right), f"MOTORS {left} {right}")

    def off(self) -> None:
        """Record nothing: the final stop is not part of a trace."""

    def read(self, sensor: int) -> int | None:
        value = self.senses(sensor)
        device = self.kit.readings[sensor]
        self.record("READ", (sensor, value), f"READ {device.name} {device.text(value)}")
        return value

    def go_ms(self, extent: int, power: int, is_turn: bool) -> int:
        return self.kit.go_ms(extent, power, is_turn)

    def beep(self, hertz: int, duration_ms: int) -> None:
        self.record("BEEP", (hertz, duration_ms), f"BEEP {hertz} {duration_ms}")

    def show(self, value: int, is_yes_no: bool) -> bool:
        self.record("SHOW", (value,), f"SHOW {value_text(value, is_yes_no)}")
        return True

    def set(self, actuator: int, value: int) -> None:
        device = self.kit.actuators[actuator]
        if not device.is_yes_no:
            value = clamp(round_to_whole(value) * 1000, device.low, device.high)
        self.record("SET", (actuator, value), f"SET {device.name} {device.text(value)}")
