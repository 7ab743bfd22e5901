"""A virtual robot in time: the clock on the wall, and whoever talks to it.

Time goes by for the robot as on the wall, or quicker while a program runs; slower where this
computer is busy. What the robot is, `robot` knows, and who talks to it, `guests`.
"""

from __future__ import annotations

from random import Random
from time import monotonic

from tiniscript.virtual.heartbeat import Heartbeat
from tiniscript.virtual.line_faults import BadLine
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.transports import Guests

BEHIND_S = 0.25  # more than that behind, the robot's clock goes slower
BUSY_S = 0.002  # between two looks while bytes are under way,
NEAR_S = 0.02  # while somebody is there or something runs,
CALM_S = 0.25  # and otherwise
TRAFFIC_S = 0.05  # for which bytes are expected where some were
STRIDE_MS = 100  # of a robot in a hurry, between two looks at the line
TURN_S = 0.01  # for which it may hurry before others have their turn
FULL_BYTES = 512  # that wait for the robot; then nothing more is taken from the line
PUSH_MS = 60  # for which a finger is on the button


class Host:
    """`hurry` is how many times as fast a running program goes; 0 is as fast as possible.

    Of 1000 bytes of the line, about `faults` meet a fault, both ways.
    """

    def __init__(
        self, robot: VirtualRobot, guests: Guests, hurry: float = 1.0, faults: float = 0.0
    ) -> None:
        self.robot = robot
        self.guests = guests
        self.hurry = hurry
        self.end_ms: int | None = None  # of the robot's time: then it is over
        self.lasts_ms: int | None = None  # or so long after its first program has begun
        chance = Random(robot.settings.seed ^ 0x5A5A)
        self.there, self.back = BadLine(faults, chance), BadLine(faults, chance)
        self._heartbeat = Heartbeat()
        self._wall_s = self._traffic_s = monotonic()
        self._owed_ms = 0.0  # of the robot's time, less than one
        self._visits = 0
        self._let_go_ms: int | None = None
        self._is_wanted = False  # a push that has to wait
        self._up_until_ms = 0  # a button that was let go stays up so long

    @property
    def over_ms(self) -> int | None:
        """When the robot's time is over, if that is known."""
        began_ms = self.robot.started_ms
        if self.lasts_ms is not None and began_ms is not None:
            return began_ms + self.lasts_ms
        return self.end_ms

    @property
    def is_over(self) -> bool:
        over_ms = self.over_ms
        return over_ms is not None and self.robot.now_ms >= over_ms

    def push(self) -> None:
        """Push the start button and let it go; where it is down or just was, a moment later."""
        now_ms = self.robot.now_ms
        self._is_wanted = self._let_go_ms is not None or now_ms < self._up_until_ms
        if not self._is_wanted:
            self.robot.press()
            self._let_go_ms = now_ms + PUSH_MS
            self._up_until_ms = now_ms + 2 * PUSH_MS

    @property
    def waiting(self) -> int:
        """How many bytes the robot has still to hear."""
        return self.robot.unheard + self.there.waiting

    def turn(self, limit_s: float = CALM_S) -> None:
        """Wait for what comes, at most for so long; then the robot goes on to now."""
        is_full = self.waiting >= FULL_BYTES
        self.guests.wait(min(limit_s, self._pause_s()), is_full)
        wall_s = monotonic()
        passed_s = min(wall_s - self._wall_s, BEHIND_S)
        self._wall_s = wall_s
        data = b"" if is_full else self.guests.receive()
        if self.guests.visits != self._visits:
            self._visits = self.guests.visits
            self._heartbeat.forget()
            self.there.clear()
            self.back.clear()
        if data:
            self._traffic_s = wall_s
            self._heartbeat.hear(data, wall_s)
            self.there.put(data, self.robot.now_ms)
        self._go_on(passed_s)
        self.guests.send(b"")

    def _pause_s(self) -> float:
        if self._is_hurrying():
            return 0.0 if not self.hurry else BUSY_S
        if self._wall_s - self._traffic_s < TRAFFIC_S or self.robot.unheard:
            return BUSY_S
        if self.robot.is_running or self.guests.is_connected or self._is_pushing:
            return NEAR_S
        return CALM_S

    @property
    def _is_pushing(self) -> bool:
        return self._is_wanted or self._let_go_ms is not None

    def _is_hurrying(self) -> bool:
        return self.robot.is_running and self.hurry != 1 and not self.is_over

    def _go_on(self, passed_s: float) -> None:
        self._owed_ms += passed_s * 1000 * (self.hurry if self._is_hurrying() and self.hurry else 1)
        until_s = self._wall_s + TURN_S
        while True:
            is_hurrying = self._is_hurrying()
            step_ms = STRIDE_MS if is_hurrying else int(self._owed_ms)
            if is_hurrying and self.hurry:
                step_ms = min(step_ms, int(self._owed_ms))
            step_ms = self._until_over(step_ms)
            if step_ms < 1:
                break
            self._step(step_ms, is_hurrying)
            self._owed_ms = max(0.0, self._owed_ms - step_ms)
            if monotonic() > until_s:
                self._owed_ms = min(self._owed_ms, BEHIND_S * 1000)
                break
            if not is_hurrying:
                break

    def _until_over(self, step_ms: int) -> int:
        """Return how far a step may go: a program ends with the robot's time, to the ms."""
        if self.lasts_ms is not None and self.is_over and self.robot.is_running:
            self.robot.rest()
        over_ms = self.over_ms
        if self.lasts_ms is not None and self.robot.started_ms is None:
            return min(step_ms, STRIDE_MS, self.lasts_ms)  # a program may begin in this step
        if over_ms is None or self.is_over:
            return step_ms
        return min(step_ms, over_ms - self.robot.now_ms)

    def _step(self, step_ms: int, is_hurrying: bool) -> None:
        now_ms = self.robot.now_ms
        if self._let_go_ms is not None and now_ms >= self._let_go_ms:
            self._let_go_ms = None
            self.robot.let_go()
        elif self._is_wanted:
            self.push()
        data = self.there.take(now_ms)
        if is_hurrying and self.guests.is_connected and not data:
            data = self._heartbeat.due(now_ms, self._wall_s)
        sent = self.robot.step(now_ms + step_ms, data)
        if sent:
            self._traffic_s = self._wall_s
            self.back.put(sent, self.robot.now_ms)
        self.guests.send(self.back.take(self.robot.now_ms))
