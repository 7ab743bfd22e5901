"""Faults by name on the line between a computer and its robot, as cables and radios cause them.

The time of a fault is its robot's: that of the wall, or slower where this computer is busy.
"""

from __future__ import annotations

from collections import deque
from random import Random
from typing import NamedTuple

from tests.machines.host_firmware import EMPTY_EEPROM
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.pty_robot import PtyRobot
from tiniscript import robots

KIT = robots.load("tinibot").kit
ESP32 = "tinibot32"
LATEST_MS = 2000  # a fault begins by then, even after few bytes
FOREVER_MS = 10**9


class Fault(NamedTuple):
    """The effect on bytes: delayed by `late_ms` each way, `rate` a second, a share `lost`.

    Starting at some moment, none pass for `held_ms`; then all pass at once, or with `drops` they
    are lost. `ways`: to the robot, and back. `pulls`, `resets` and `suspends` happen to the port,
    the robot and the command.
    """

    name: str
    late_ms: int = 0
    rate: int = 0
    lost: float = 0.0
    held_ms: int = 0
    drops: bool = False
    ways: tuple[bool, bool] = (True, True)
    pulls: bool = False
    resets: bool = False
    suspends: bool = False

    @property
    def has_end(self) -> bool:
        """Return whether a continuing command will reach its robot."""
        return self.held_ms < FOREVER_MS and not self.pulls


FAULTS = (
    Fault("nothing"),
    Fault("loses", lost=0.01),
    Fault("late", late_ms=300),
    Fault("very late", late_ms=1000),
    Fault("slow", rate=100),
    Fault("stalls", held_ms=4000),
    Fault("stalls long", held_ms=12_000),
    Fault("loses all for a while", held_ms=5000, drops=True),
    Fault("cut", held_ms=FOREVER_MS, drops=True),
    Fault("robot hears nothing", held_ms=FOREVER_MS, drops=True, ways=(True, False)),
    Fault("computer hears nothing", held_ms=FOREVER_MS, drops=True, ways=(False, True)),
    Fault("pulled out", pulls=True),
    Fault("off and on", resets=True),
    Fault("suspended", held_ms=4000, suspends=True),
)


class Way:
    """Bytes on their way."""

    def __init__(self, fault: Fault, is_held: bool, rng: Random) -> None:
        self._fault, self._is_held, self._rng = fault, is_held, rng
        self._under_way: deque[tuple[float, int]] = deque()  # arrival time of each byte
        self._free_ms = 0.0
        self.held_ms = (-1, -1)  # start and end of the time in which bytes are held back

    def put(self, data: bytes, now_ms: int) -> None:
        begin_ms, end_ms = self.held_ms
        is_lost = self._is_held and self._fault.drops and begin_ms <= now_ms < end_ms
        for byte in data:
            if self._fault.rate:
                self._free_ms = max(self._free_ms, now_ms) + 1000 / self._fault.rate
            if is_lost or self._rng.random() < self._fault.lost:
                continue
            at_ms = max(self._free_ms, now_ms) + self._fault.late_ms
            if self._is_held and begin_ms <= at_ms < end_ms:
                at_ms = end_ms
            self._under_way.append((at_ms, byte))

    def take_arrived(self, now_ms: int) -> bytes:
        arrived_bytes = bytearray()
        while self._under_way and self._under_way[0][0] <= now_ms:
            arrived_bytes.append(self._under_way.popleft()[1])
        return bytes(arrived_bytes)


class BehindBadLine(PtyRobot):
    """A robot on a line with a fault that begins after `after` bytes, or after a while.

    `mend` takes the fault away; what is still on its way arrives then.
    """

    def _open_line(self, fault: Fault, rng: Random, after: int) -> None:
        """Lay the line, before the robot begins."""
        self.fault = fault
        self.has_begun = False
        self._after = after
        self._line_ms = 0
        self._rng = rng
        self._ways = [Way(fault, is_held, rng) for is_held in fault.ways]
        self._is_mended = False
        self._since_ms: int | None = None  # the first byte

    def begin(self, fault: Fault, after: int = 0) -> None:
        """Start a fault now, or after so many bytes, instead of the previous one."""
        with self._lock:
            self.fault, self.has_begun, self._is_mended = fault, False, False
            self._after, self._since_ms = after, self._line_ms
            self._ways = [Way(fault, is_held, self._rng) for is_held in fault.ways]

    @property
    def is_used(self) -> bool:
        """Return whether the computer has sent a byte."""
        return self._since_ms is not None

    def mend(self) -> None:
        with self._lock:
            self._is_mended = True

    def advance_ms(self, milliseconds: int, data: bytes = b"") -> bytes:
        self._line_ms += milliseconds
        self._begin(len(data))
        to_robot, to_computer = self._ways
        if self._is_mended:
            to_robot._fault = to_computer._fault = Fault("nothing")
            to_robot.held_ms = to_computer.held_ms = (-1, -1)
        to_robot.put(data, self._line_ms)
        arrived_bytes = to_robot.take_arrived(FOREVER_MS if self._is_mended else self._line_ms)
        to_computer.put(super().advance_ms(milliseconds, arrived_bytes), self._line_ms)
        return to_computer.take_arrived(FOREVER_MS if self._is_mended else self._line_ms)

    def _begin(self, count: int) -> None:
        """Begin the fault."""
        self._after -= count
        if count and self._since_ms is None:
            self._since_ms = self._line_ms
        if self.has_begun or self._since_ms is None or self._is_mended:
            return
        if self._after <= 0 or self._line_ms - self._since_ms > LATEST_MS:
            self.has_begun = True
            if self.fault.held_ms and not self.fault.suspends:
                for way in self._ways:
                    way.held_ms = (self._line_ms, self._line_ms + self.fault.held_ms)
            if self.fault.resets:
                self._flags = []
                with self._lock:
                    self._take_power()
                    self._robot = self._make_robot(seed=0x9ABCDEF1)


class BadLine(BehindBadLine):
    """A bad line to an Uno."""

    def __init__(self, fault: Fault, rng: Random, after: int, memory: bytes = EMPTY_EEPROM) -> None:
        self._open_line(fault, rng, after)
        super().__init__(KIT, memory)


class BadEsp32Line(BehindBadLine, Esp32PtyRobot):
    """A bad line to an ESP32."""

    def __init__(self, fault: Fault, rng: Random, after: int) -> None:
        self._open_line(fault, rng, after)
        super().__init__(ESP32)
