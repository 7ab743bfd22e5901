"""A virtual robot whose disc flickers."""

from __future__ import annotations

from tiniscript.robots.drivers import discs_of
from tiniscript.virtual.robot import VirtualRobot


class Flicker:
    """The disc of a wheel flickers: it shows an edge so often, while the wheel hardly turns."""

    def __init__(self, robot: VirtualRobot, number: int, hertz: float) -> None:
        discs = robot.profile.board.discs
        assert robot.wheels and discs
        self.wheel, self.wheels = robot.wheels.wheels[number], robot.wheels
        self.has_two = discs_of(discs).has_two_channels
        self.period_ms = 1000 / hertz
        self.edges = robot.wheels.edges
        self.shown_count = 0
        self.next_ms: float = robot.now_ms
        robot.wheels.edges = self.flickering  # type: ignore[method-assign]

    def flickering(self, now_ms: int) -> int:
        self.wheels.go_on(now_ms)
        if abs(self.wheel.speed) > 5:
            self.next_ms = now_ms + self.period_ms
        while self.next_ms <= now_ms:
            self.next_ms += self.period_ms
            self.wheel.counted_edges += -1 if self.has_two and self.shown_count % 2 else 1
            self.shown_count += 1
        return self.edges(now_ms)
