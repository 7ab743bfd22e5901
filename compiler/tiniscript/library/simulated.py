"""A virtual robot in this process; the connection uses a socket, as with any other robot."""

from __future__ import annotations

import math
import os
from typing import NamedTuple

from tiniscript.library import install_advice
from tiniscript.library.connection import VERB, RobotConnection
from tiniscript.library.errors import UsageError
from tiniscript.library.programs import Language, profile_of
from tiniscript.library.runs import (
    LARGEST_SEED,
    Readings,
    check_whole_number,
    checked_number,
    thousandths,
)
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import Robot
from tiniscript.robots.refusals import describe
from tiniscript.virtual import worlds
from tiniscript.virtual.module import NoWebAssembly
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.simulator import SimulatorThread
from tiniscript.virtual.world import WorldRefused

MAX_NOISE = 0.5
MIN_SPEEDUP, MAX_SPEEDUP = 0.1, 10_000
MIN_MOTOR_PERCENT, MAX_MOTOR_PERCENT = 10, 200  # percent


def virtual_robot(
    robot: str | os.PathLike[str] = "tinibot",
    *,
    world: str | os.PathLike[str] = "obstacles",
    hurry: float = 1,
    seed: int = 1,
    noise: float = 0,
    motors: tuple[float, float] = (100, 100),
    sensors: Readings | None = None,
    language: Language = "en",
) -> VirtualRobotConnection:
    """Start a virtual robot and connect to it; it ends when the connection is closed.

    `world` is obstacles, line, light or the path of a file. A program runs `hurry` times as fast
    as on a real robot, 0.1 to 10000; `math.inf` is as fast as this computer can. `seed` is that of
    all random numbers, `noise` the random part of a reading (0.05 is 5 %), `motors` the speed of
    each motor in percent. `sensors` has readings that replace those of the world, as for `run`.
    Needs the extra `virtual`. Raises UsageError, RobotError.
    """
    profile = profile_of(robot, language)
    if hurry != math.inf:
        checked_number("hurry", hurry, MIN_SPEEDUP, MAX_SPEEDUP, language)
    check_whole_number("seed", seed, 1, LARGEST_SEED, language)
    checked_number("noise", noise, 0, MAX_NOISE, language)
    left, right = motors
    for motor in (left, right):
        checked_number("motors", motor, MIN_MOTOR_PERCENT, MAX_MOTOR_PERCENT, language)
    reading_lists = thousandths(sensors or {}, profile, language)
    settings = Settings(seed=seed, noise=noise, motors=(left, right), given_readings=reading_lists)
    simulated_robot = SimulatedRobot(
        _make_robot(profile, os.fspath(world), settings, language),
        0.0 if hurry == math.inf else hurry,
    )
    return VirtualRobotConnection(simulated_robot, profile, language)


class VirtualRobotConnection(RobotConnection):
    """A connection to a virtual robot, with its true position in the world."""

    def __init__(self, simulated_robot: SimulatedRobot, profile: Robot, language: Language) -> None:
        """Internal: use `virtual_robot` instead."""
        self._simulated_robot = simulated_robot
        super().__init__(simulated_robot.port, profile, True, None, language)

    @property
    def pose(self) -> tuple[float, float, float]:
        """The position, x and y in cm from the lower left corner of the floor, and the heading in
        degrees, 0 to the right and 90 up."""
        x_cm, y_cm, heading = self._simulated_robot.drive_state.pose
        return x_cm, y_cm, heading

    @property
    def driven_cm(self) -> float:
        """The distance that it has driven, in cm."""
        return self._simulated_robot.drive_state.driven_cm

    @property
    def bumps(self) -> int:
        """The number of collisions."""
        return self._simulated_robot.drive_state.bumps

    def push_button(self) -> None:
        """Push and release its start button."""
        self._simulated_robot.push()

    def _close_port(self, holds_port: bool = False) -> None:
        """Close it at once: a virtual robot that has ended cannot be driven."""
        try:
            super()._close_port()
        finally:
            self._simulated_robot.close()


class DriveState(NamedTuple):
    pose: Pose
    driven_cm: float
    bumps: int


class SimulatedRobot(SimulatorThread):
    def __init__(self, robot: VirtualRobot, hurry: float) -> None:
        super().__init__(robot, VERB, hurry)
        self.on_turn()
        self._thread.start()

    def on_turn(self) -> None:
        self.robot.take_events()  # discarded: no one draws them
        driving = self.robot.driving
        self.drive_state = DriveState(self.robot.pose, driving.driven_cm, driving.bumps)


def _make_robot(profile: Robot, world: str, settings: Settings, language: Language) -> VirtualRobot:
    """Return the robot in its world. Raises UsageError."""
    try:
        return VirtualRobot(profile.with_language(language), worlds.load(world), settings)
    except NoWebAssembly as error:
        install_command = install_advice.command(install_advice.VIRTUAL)
        raise UsageError(
            "no_wasmtime", language, {"why": str(error), "how": install_command}
        ) from None
    except WorldRefused as error:
        values = {"reasons": "\n".join(describe(error, language))}
        raise UsageError("world_refused", language, values) from None
