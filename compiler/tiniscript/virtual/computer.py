"""A computer at the port of a virtual robot, in the robot's own time: nobody waits."""

from __future__ import annotations

from typing import TypeVar

from tiniscript.link.authority import KeyRing
from tiniscript.link.connection import PendingRequest
from tiniscript.link.requests import Reply
from tiniscript.link.session import Session
from tiniscript.virtual.robot import VirtualRobot

T = TypeVar("T")

ANSWER_TIMEOUT_MS = 60_000  # time for a robot to answer


class Computer:
    def __init__(self, robot: VirtualRobot, nonce: int, keys: KeyRing | None = None) -> None:
        profile = robot.profile
        self.robot = robot
        self.session = Session(nonce, profile.board.baud, profile.kit.fingerprint, keys=keys)
        self._until_ms: int | None = None  # the millisecond in which its program was paused
        self._sent_bytes = bytearray()  # bytes that the robot sent in that millisecond

    def wait(self, milliseconds: int) -> None:
        """Advance the robot's time.

        A millisecond that a held program interrupted continues once the program does: the session
        receives and sends exactly as without the hold.
        """
        for _ in range(milliseconds):
            firmware = self.robot.firmware
            if self._until_ms is not None and firmware.held_at is None:
                now_ms, data = self._until_ms, b""
            else:
                self._receive()
                now_ms = self.robot.now_ms + 1
                data = self.session.poll(now_ms)
            self._sent_bytes += self.robot.step(now_ms, data)
            self._until_ms = now_ms if firmware.held_at is not None else None
            if self._until_ms is None:
                self._receive()

    def _receive(self) -> None:
        sent_bytes, self._sent_bytes = bytes(self._sent_bytes), bytearray()
        self.session.receive(sent_bytes, self.robot.now_ms)

    def wait_for(self, request: PendingRequest[T], limit_ms: int = ANSWER_TIMEOUT_MS) -> Reply[T]:
        """Advance time until a request has its outcome."""
        end_ms = self.robot.now_ms + limit_ms
        while request.outcome is None:
            assert self.robot.now_ms < end_ms, "the robot does not answer"
            self.wait(1)
        return request.outcome
