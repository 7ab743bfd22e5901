"""A program on the virtual robot, for the page: the robot's firmware, its world and the link.

Time only goes on when it is asked to. Knows no page and no clock.
"""

from __future__ import annotations

from typing import Any

from tiniscript.bytecode.image import unpack
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.studio.checking import profile_of
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.world import World

LONGEST_MS = 10_000  # for a robot to answer
PUSH_MS = 60
FAULT_MS = 500  # for a robot to tell of a fault
NONCE = 1  # the same program makes the same run


class Simulation:
    """A robot that stands at the start of a world and has the program."""

    def __init__(self, robot: str, world: World, image: bytes) -> None:
        """Raises WorldRefused where the robot does not fit into the world."""
        profile = profile_of(robot)
        self.robot = VirtualRobot(profile, world)
        self.session = Session(NONCE, profile.board.baud, profile.kit.fingerprint)
        self.is_stopped = False
        self.fault_at: int | None = None  # where the last fault was, as the robot has told
        pending = self.session.upload(unpack(image), runs=True, saves=True)
        self._until(lambda: pending.outcome is not None)
        assert pending.outcome is not None and pending.outcome.status == OK, "not taken"

    def go(self, duration_ms: int) -> None:
        """Let time go on; after a fault a little longer, until the robot has told where it was."""
        self._go(duration_ms)
        if not self.robot.fault:
            self.fault_at = None
        for _ in range(FAULT_MS):
            if not self.robot.fault or self.fault_at is not None:
                return
            self._go(1)

    def _go(self, duration_ms: int) -> None:
        for _ in range(duration_ms):
            now_ms = self.robot.now_ms + 1
            sent = self.robot.step(now_ms, self.session.poll(now_ms))
            self.session.receive(sent, now_ms)
        for event in self.session.events():
            self.is_stopped = self.is_stopped or event.name == "STOPPED"
            if event.name == "FAULT":
                self.fault_at = event.at

    def go_to_next(self, offsets: list[int], limit_ms: int) -> None:
        """Let time go on until another part of the text runs; parts begin at `offsets`."""
        began = self._part(offsets)
        for _ in range(limit_ms):
            self.go(1)
            if self._part(offsets) != began or not self.robot.is_running:
                return

    def stop(self) -> None:
        """Stop the robot, as any computer at its line does, and wait until it has confirmed it."""
        self.is_stopped = False
        self.session.stop(self.robot.now_ms)
        self._until(lambda: self.is_stopped)

    def push(self) -> None:
        """Push the start button."""
        self.robot.press()
        self.go(PUSH_MS)
        self.robot.let_go()
        self.go(1)

    def close(self) -> None:
        self.robot.switch_off()

    def state(self) -> dict[str, Any]:
        """Return what is to be seen, and what has happened since the last time."""
        robot = self.robot
        x_cm, y_cm, heading = robot.pose
        kit = robot.profile.kit
        readings = [robot.sensing.look(number, robot.pose) for number in range(len(kit.sensors))]
        return {
            "now_ms": robot.now_ms,
            "began_ms": robot.started_ms,
            "pose": [x_cm, y_cm, heading],
            "motors": [round(robot.driving.left), round(robot.driving.right)],
            "is_running": robot.is_running,
            "is_waiting": robot.is_lit and not robot.is_running,
            "fault": robot.fault,
            "fault_at": self.fault_at if robot.fault else None,
            "bumps": robot.driving.bumps,
            "at": robot.at,
            "readings": [{"value": value / 1000, "text": device.text(value)}
                         for device, value in zip(kit.sensors, readings, strict=True)],
            "events": [[event.time_ms, event.text] for event in robot.take_events()],
        }  # fmt: skip

    def _part(self, offsets: list[int]) -> int:
        at = self.robot.at
        return -1 if at is None else sum(offset <= at for offset in offsets)

    def _until(self, is_over: Any) -> None:
        for _ in range(LONGEST_MS):
            if is_over():
                return
            self.go(1)
        raise AssertionError("the virtual robot does not answer")
