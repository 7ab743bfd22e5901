"""A fleet of robots: each the whole firmware, all of them attended to by one thread.

Like `tests.support.pty_robot`, but cheap enough for 30 of them on one computer: a robot runs when
bytes arrive for it, and otherwise every few milliseconds, in one longer step.
"""

from __future__ import annotations

import os
import select
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from unittest import mock

from tests.machines.host_firmware import EMPTY_EEPROM, TICKS, HostFirmware
from tests.support import waiting
from tests.support.pty_robot import drives_now
from tests.support.simulated_port import PtyPort, simulate
from tiniscript.base.kit import Kit
from tiniscript.link import known_ports, ports

STEP_MS = 10  # interval between two steps of an idle robot


class Pupil(PtyPort):
    """A robot and its port. Its faults are chosen before anything is sent."""

    def __init__(self, kit: Kit, number: int) -> None:
        super().__init__()
        self.number = number
        self.robot = HostFirmware(kit, EMPTY_EEPROM, seed=0x1000 + number)
        self.babble = b""  # bytes that it sends repeatedly, as fast as its port accepts them
        self.deaf_after: int | None = None  # bytes after which it neither hears nor answers

    @property
    def actions(self) -> list[str]:
        return [line.split(" ", 1)[1] for line in self.robot.did]

    @property
    def moves(self) -> bool:
        return drives_now(self.actions)

    def advance_ms(self, milliseconds: int, data: bytes = b"") -> bytes:
        """Let time pass, with received bytes at its end; return the bytes sent."""
        with self._lock:
            return self._advance_ms(milliseconds, data)

    def _advance_ms(self, milliseconds: int, data: bytes) -> bytes:
        self.received += data
        if self.deaf_after is not None:
            data = data[: self.deaf_after]
            self.deaf_after -= len(data)
        robot = self.robot
        robot.now_ms += milliseconds - 1
        sent_bytes = robot.step(self._through_noise(data), 0, TICKS * milliseconds)
        if self.babble:
            return self.babble
        return b"" if self.deaf_after == 0 else self._through_noise(sent_bytes)

    def close(self) -> None:
        self.robot.close()
        self._close()


class RobotFleet:
    """A fleet of robots in real time, unless this process has opened the port."""

    def __init__(self, kits: Sequence[Kit]) -> None:
        self.pupils = [Pupil(kit, number) for number, kit in enumerate(kits)]
        self._is_over = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        self._in_here = ExitStack()

    def __enter__(self) -> RobotFleet:
        self._in_here.enter_context(simulate(*self.pupils))
        return self

    def __exit__(self, *_: object) -> None:
        self._in_here.close()
        self._is_over = True
        self._thread.join()
        for pupil in self.pupils:
            pupil.close()

    def until(self, is_reached: Callable[[], bool], description: str) -> None:
        """Wait until something is so."""
        waiting.until(is_reached, description)

    def _run(self) -> None:
        by_end = {pupil.our_end: pupil for pupil in self.pupils}
        lasts = dict.fromkeys(by_end, time.monotonic())
        while not self._is_over:
            ready_ends, _, _ = select.select(list(by_end), [], [], STEP_MS / 2000)
            now_s = time.monotonic()
            for end, pupil in by_end.items():
                passed_ms = int((now_s - lasts[end]) * 1000)
                if passed_ms < (1 if end in ready_ends else STEP_MS):
                    continue
                lasts[end] += passed_ms / 1000
                if pupil.simulated is not None:
                    continue
                data = os.read(end, 4096) if end in ready_ends else b""
                sent_bytes = pupil.advance_ms(min(passed_ms, 5 * STEP_MS), data)
                if sent_bytes and select.select([], [end], [], 0)[1]:
                    os.write(end, sent_bytes)


@contextmanager
def known_fleet(kits: Sequence[Kit]) -> Iterator[RobotFleet]:
    """Start robots whose ports are remembered, without other ports, which would cause waits."""
    with mock.patch.object(ports, "list_ports", list), RobotFleet(kits) as fleet:
        for pupil in fleet.pupils:
            known_ports.remember(pupil.port, f"R{pupil.number}", is_used=False)
        yield fleet
