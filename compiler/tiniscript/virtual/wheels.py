"""The wheels of a robot with discs: they come up to speed, slip, and turn a disc with uneven holes.

Knows time and chance, and neither floor nor firmware. All that happens lies on a grid of
milliseconds: it does not depend on when it is asked.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random
from typing import NamedTuple

from tiniscript.robots.profile import Body, Wiring

LAG_MS = 60.0  # average time in which a motor gets within 1/e of its speed
LAG_RANGE = (0.75, 1.25)  # range of that time's factor between motors
STEADY_PERCENT = 0.05  # smallest change of speed in percent
SLIP_CM = 5.0  # a wheel slips as much for so far
COUNT_MODULUS = 1 << 16
ANSWER_FLAG = 1 << 31


class Roughness(NamedTuple):
    """`slip` is the part of its way that a wheel slips on average: each 5 cm it is another part,
    from none to twice as much. `jitter` is how far an edge of a disc is from its place at most: a
    part of the way between two edges.
    """

    slip: float = 0.0
    jitter: float = 0.1


class Wheel:
    def __init__(
        self, body: Body, wiring: Wiring, roughness: Roughness, random_source: Random
    ) -> None:
        self._random_source = random_source
        self._roughness = roughness
        self._percent_cm = body.speed_cm_s / 100 / 1000  # cm in a millisecond, of a percent
        edge_count = 2 * wiring.settings["holes"]
        self.edge_cm = math.pi * wiring.settings["wheel_cm"] / 1000 / edge_count
        self._edge_offsets = [
            random_source.uniform(-roughness.jitter, roughness.jitter) for _ in range(edge_count)
        ]
        self.turned_cm = random_source.uniform(
            0, self.edge_cm * edge_count
        )  # angle of the disc when switched on
        self._lag_ms = LAG_MS * random_source.uniform(*LAG_RANGE)
        self._slip_start_cm = 0.0
        self._slip = 0.0
        self._edge_number = self._edges()
        self.wanted_speed = self.speed = 0.0  # percent
        self.counted_edges = 0
        self.has_working_sensor = True  # whether its sensor works

    def _edges(self) -> int:
        """Return the number of edges since the disc was at its first one."""
        edge_position = self.turned_cm / self.edge_cm
        nearest_edge = round(edge_position)
        return (
            nearest_edge
            if edge_position
            >= nearest_edge + self._edge_offsets[nearest_edge % len(self._edge_offsets)]
            else nearest_edge - 1
        )

    def step(self, has_two_channels: bool) -> float:
        """Go on for a millisecond. Return its speed over the floor, in percent."""
        if not self.speed and not self.wanted_speed:
            return 0.0
        self.speed += (self.wanted_speed - self.speed) / self._lag_ms
        if not self.wanted_speed and abs(self.speed) < 1:
            self.speed = 0.0
        self.turned_cm += self.speed * self._percent_cm
        if abs(self.turned_cm - self._slip_start_cm) > SLIP_CM:
            self._slip_start_cm = self.turned_cm
            self._slip = self._random_source.uniform(0, 2 * self._roughness.slip)
        edge_number = self._edges()
        passed_edges = edge_number - self._edge_number
        self._edge_number = edge_number
        if self.has_working_sensor:
            self.counted_edges += passed_edges if has_two_channels else abs(passed_edges)
        return self.speed * (1 - self._slip)


class Wheels:
    """Both wheels; `drive` is called for each change of their speed over the floor."""

    def __init__(
        self, body: Body, discs: Wiring, has_two_channels: bool, roughness: Roughness, seed: int,
        drive: Callable[[float, float, float], None],
    ) -> None:  # fmt: skip
        random_source = Random(seed)
        self.wheels = tuple(Wheel(body, discs, roughness, random_source) for _ in range(2))
        self._has_two_channels = has_two_channels
        self._drive = drive
        self._now_ms = 0
        self._floor_speeds = (0.0, 0.0)

    def set(self, now_ms: int, left: float, right: float) -> None:
        """Set the speeds that the motors give them, in percent."""
        self.go_on(now_ms)
        self.wheels[0].wanted_speed, self.wheels[1].wanted_speed = left, right

    def go_on(self, now_ms: int) -> None:
        if not any(wheel.speed or wheel.wanted_speed for wheel in self.wheels):
            self._now_ms = max(self._now_ms, now_ms)
        while self._now_ms < now_ms:
            left, right = (wheel.step(self._has_two_channels) for wheel in self.wheels)
            last_speeds = self._floor_speeds
            is_still = not left and not right
            if (
                is_still
                or max(abs(left - last_speeds[0]), abs(right - last_speeds[1])) > STEADY_PERCENT
            ):
                self._floor_speeds = (left, right)
                self._drive(self._now_ms, left, right)
            self._now_ms += 1

    def edges(self, now_ms: int) -> int:
        """Return both counts as the board says them: the left one in the lower 16 bits."""
        self.go_on(now_ms)
        left, right = (wheel.counted_edges % COUNT_MODULUS for wheel in self.wheels)
        return (right * COUNT_MODULUS + left + ANSWER_FLAG) % (2 * ANSWER_FLAG) - ANSWER_FLAG

    def brake(self) -> None:
        """Stop the wheels at once, as when the robot is lifted or switched off."""
        for wheel in self.wheels:
            wheel.speed = wheel.wanted_speed = 0.0
        self._floor_speeds = (0.0, 0.0)
