"""A fleet of robots: each the whole firmware, all of them attended to by one thread.

Like `tests.support.pty_robot`, at a price that lets 30 of them be on one computer: a robot goes
on when bytes come for it, and else every few milliseconds, in one longer step.
"""

from __future__ import annotations

import os
import select
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from unittest import mock

from tests.machines.host_firmware import EMPTY, TICKS, HostFirmware
from tests.support import waiting
from tests.support.pty_robot import drives_now
from tests.support.simulated_port import PtyPort, simulated
from tiniscript.base.kit import Kit
from tiniscript.link import known_ports, ports

STEP_MS = 10  # between two steps of a robot for which nothing comes


class Pupil(PtyPort):
    """A robot and its port. What is wrong with it is chosen before something is sent."""

    def __init__(self, kit: Kit, number: int) -> None:
        super().__init__()
        self.number = number
        self.robot = HostFirmware(kit, EMPTY, seed=0x1000 + number)
        self.babble = b""  # what it says again and again, as fast as its port takes it
        self.deaf_after: int | None = None  # so many bytes more, and it hears and says nothing

    @property
    def did(self) -> list[str]:
        return [line.split(" ", 1)[1] for line in self.robot.did]

    @property
    def moves(self) -> bool:
        return drives_now(self.did)

    def pass_ms(self, milliseconds: int, data: bytes = b"") -> bytes:
        """Let time pass, at whose end bytes arrive; return what it has sent."""
        with self._lock:
            return self._pass_ms(milliseconds, data)

    def _pass_ms(self, milliseconds: int, data: bytes) -> bytes:
        self.heard += data
        if self.deaf_after is not None:
            data = data[: self.deaf_after]
            self.deaf_after -= len(data)
        robot = self.robot
        robot.now_ms += milliseconds - 1
        sent = robot.step(self._through_noise(data), 0, TICKS * milliseconds)
        if self.babble:
            return self.babble
        return b"" if self.deaf_after == 0 else self._through_noise(sent)

    def close(self) -> None:
        self.robot.close()
        self._close()


class RobotFleet:
    """So many robots; their time is that of the wall, unless this process has opened the port."""

    def __init__(self, kits: Sequence[Kit]) -> None:
        self.pupils = [Pupil(kit, number) for number, kit in enumerate(kits)]
        self._is_over = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        self._in_here = ExitStack()

    def __enter__(self) -> RobotFleet:
        self._in_here.enter_context(simulated(*self.pupils))
        return self

    def __exit__(self, *_: object) -> None:
        self._in_here.close()
        self._is_over = True
        self._thread.join()
        for pupil in self.pupils:
            pupil.close()

    def until(self, is_so: Callable[[], bool], what: str) -> None:
        """Wait until something is so."""
        waiting.until(is_so, what)

    def _run(self) -> None:
        by_end = {pupil.ours: pupil for pupil in self.pupils}
        lasts = dict.fromkeys(by_end, time.monotonic())
        while not self._is_over:
            ready, _, _ = select.select(list(by_end), [], [], STEP_MS / 2000)
            now_s = time.monotonic()
            for end, pupil in by_end.items():
                passed_ms = int((now_s - lasts[end]) * 1000)
                if passed_ms < (1 if end in ready else STEP_MS):
                    continue
                lasts[end] += passed_ms / 1000
                if pupil.simulated is not None:
                    continue
                data = os.read(end, 4096) if end in ready else b""
                sent = pupil.pass_ms(min(passed_ms, 5 * STEP_MS), data)
                if sent and select.select([], [end], [], 0)[1]:
                    os.write(end, sent)


@contextmanager
def known_fleet(kits: Sequence[Kit]) -> Iterator[RobotFleet]:
    """Have robots whose ports are remembered, and no other port: each would be waited for."""
    with mock.patch.object(ports, "list_ports", list), RobotFleet(kits) as fleet:
        for pupil in fleet.pupils:
            known_ports.remember(pupil.port, f"R{pupil.number}", is_used=False)
        yield fleet
