"""A computer at the port of a virtual robot, in the robot's own time: nobody waits."""

from __future__ import annotations

from typing import TypeVar

from tiniscript.link.authority import KeyRing
from tiniscript.link.connection import PendingRequest
from tiniscript.link.requests import Reply
from tiniscript.link.session import Session
from tiniscript.virtual.robot import VirtualRobot

T = TypeVar("T")

LIMIT_MS = 60_000  # for a robot to answer


class Computer:
    def __init__(self, robot: VirtualRobot, nonce: int, keys: KeyRing | None = None) -> None:
        profile = robot.profile
        self.robot = robot
        self.session = Session(nonce, profile.board.baud, profile.kit.fingerprint, keys=keys)

    def wait(self, milliseconds: int) -> None:
        """Let the robot's time go on."""
        for _ in range(milliseconds):
            now_ms = self.robot.now_ms + 1
            sent = self.robot.step(now_ms, self.session.poll(now_ms))
            self.session.receive(sent, self.robot.now_ms)

    def until(self, request: PendingRequest[T], limit_ms: int = LIMIT_MS) -> Reply[T]:
        """Let time go on until a request has its outcome."""
        end_ms = self.robot.now_ms + limit_ms
        while request.outcome is None:
            assert self.robot.now_ms < end_ms, "the robot does not answer"
            self.wait(1)
        return request.outcome
