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

LAG_MS = 60.0  # in which a motor comes 1 - 1/e nearer to its speed: on average
LAG_RANGE = (0.75, 1.25)  # of that, from motor to motor
STEADY_PERCENT = 0.05  # percent of speed: a smaller change is none
SLIP_CM = 5.0  # a wheel slips as much for so far
CLOCK = 1 << 16
ANSWER_FLAG = 1 << 31


class Roughness(NamedTuple):
    """`slip` is the part of its way that a wheel slips on average: each 5 cm it is another part,
    from none to twice as much. `jitter` is how far an edge of a disc is from its place at most: a
    part of the way between two edges.
    """

    slip: float = 0.0
    jitter: float = 0.1


class Wheel:
    def __init__(self, body: Body, wiring: Wiring, rough: Roughness, chance: Random) -> None:
        self._chance = chance
        self._rough = rough
        self._full = body.speed_cm_s / 100 / 1000  # cm in a millisecond, of a percent
        count = 2 * wiring.settings["holes"]
        self.edge_cm = math.pi * wiring.settings["wheel_cm"] / 1000 / count
        self._off = [chance.uniform(-rough.jitter, rough.jitter) for _ in range(count)]
        self.turned_cm = chance.uniform(0, self.edge_cm * count)  # as it stands when switched on
        self._lag_ms = LAG_MS * chance.uniform(*LAG_RANGE)
        self._slips_to_cm = 0.0
        self._slip = 0.0
        self._place = self._edges()
        self.wanted = self.speed = 0.0  # percent
        self.counted = 0
        self.is_seen = True  # its sensor tells something

    def _edges(self) -> int:
        """Return how many edges have passed since the disc was at its first one."""
        place = self.turned_cm / self.edge_cm
        nearest = round(place)
        return nearest if place >= nearest + self._off[nearest % len(self._off)] else nearest - 1

    def step(self, has_two: bool) -> float:
        """Go on for a millisecond. Return its speed over the floor, in percent."""
        if not self.speed and not self.wanted:
            return 0.0
        self.speed += (self.wanted - self.speed) / self._lag_ms
        if not self.wanted and abs(self.speed) < 1:
            self.speed = 0.0
        self.turned_cm += self.speed * self._full
        if abs(self.turned_cm - self._slips_to_cm) > SLIP_CM:
            self._slips_to_cm = self.turned_cm
            self._slip = self._chance.uniform(0, 2 * self._rough.slip)
        place = self._edges()
        passed = place - self._place
        self._place = place
        if self.is_seen:
            self.counted += passed if has_two else abs(passed)
        return self.speed * (1 - self._slip)


class Wheels:
    """Both wheels; `drive` is told each change of their speed over the floor."""

    def __init__(
        self, body: Body, discs: Wiring, has_two: bool, rough: Roughness, seed: int,
        drive: Callable[[float, float, float], None],
    ) -> None:  # fmt: skip
        chance = Random(seed)
        self.both = tuple(Wheel(body, discs, rough, chance) for _ in range(2))
        self._has_two = has_two
        self._drive = drive
        self._now_ms = 0
        self._driven = (0.0, 0.0)

    def set(self, now_ms: int, left: float, right: float) -> None:
        """Set the speeds that the motors give them, in percent."""
        self.go_on(now_ms)
        self.both[0].wanted, self.both[1].wanted = left, right

    def go_on(self, now_ms: int) -> None:
        if not any(wheel.speed or wheel.wanted for wheel in self.both):
            self._now_ms = max(self._now_ms, now_ms)
        while self._now_ms < now_ms:
            left, right = (wheel.step(self._has_two) for wheel in self.both)
            before = self._driven
            is_still = not left and not right
            if is_still or max(abs(left - before[0]), abs(right - before[1])) > STEADY_PERCENT:
                self._driven = (left, right)
                self._drive(self._now_ms, left, right)
            self._now_ms += 1

    def edges(self, now_ms: int) -> int:
        """Return both counts as the board says them: the left one in the lower 16 bits."""
        self.go_on(now_ms)
        left, right = (wheel.counted % CLOCK for wheel in self.both)
        return (right * CLOCK + left + ANSWER_FLAG) % (2 * ANSWER_FLAG) - ANSWER_FLAG

    def brake(self) -> None:
        """They stand at once, as where somebody lifts the robot or switches it off."""
        for wheel in self.both:
            wheel.speed = wheel.wanted = 0.0
        self._driven = (0.0, 0.0)
