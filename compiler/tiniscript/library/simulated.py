"""A virtual robot in this process: its firmware, its body and its world.

A thread runs its clock; the connection uses a socket, as with any other robot.
"""

from __future__ import annotations

import math
import os
from threading import Thread
from typing import NamedTuple

from tiniscript.library import install_advice
from tiniscript.library.connection import VERB, RobotConnection
from tiniscript.library.errors import UsageError
from tiniscript.library.programs import Language, profile_of
from tiniscript.library.runs import LARGEST_SEED, Readings, thousandths, whole, within
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import Robot
from tiniscript.virtual import directory, worlds
from tiniscript.virtual.module import NoWebAssembly
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.simulator import Simulator
from tiniscript.virtual.transports import Transports
from tiniscript.virtual.world import WorldRefused, describe

MOST_NOISE = 0.5
SLOWEST_HURRY, FASTEST_HURRY = 0.1, 10_000
LEAST_MOTOR, MOST_MOTOR = 10, 200  # percent
JOIN_S = 5.0
TURN_S = 0.05  # the longest wait of the robot's thread


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
        within("hurry", hurry, SLOWEST_HURRY, FASTEST_HURRY, language)
    whole("seed", seed, 1, LARGEST_SEED, language)
    within("noise", noise, 0, MOST_NOISE, language)
    left, right = motors
    for motor in (left, right):
        within("motors", motor, LEAST_MOTOR, MOST_MOTOR, language)
    told = thousandths(sensors or {}, profile, language)
    settings = Settings(seed=seed, noise=noise, motors=(left, right), told=told)
    simulated = Simulated(
        _made(profile, os.fspath(world), settings, language), 0.0 if hurry == math.inf else hurry
    )
    return VirtualRobotConnection(simulated, profile, language)


class VirtualRobotConnection(RobotConnection):
    """A connection to a virtual robot, with its true position in the world."""

    def __init__(self, simulated: Simulated, profile: Robot, language: Language) -> None:
        """Internal: use `virtual_robot` instead."""
        self._simulated = simulated
        super().__init__(simulated.address, profile, True, None, language)

    @property
    def pose(self) -> tuple[float, float, float]:
        """The position, x and y in cm from the lower left corner of the floor, and the heading in
        degrees, 0 to the right and 90 up."""
        x_cm, y_cm, heading = self._simulated.seen.pose
        return x_cm, y_cm, heading

    @property
    def driven_cm(self) -> float:
        """The distance that it has driven, in cm."""
        return self._simulated.seen.driven_cm

    @property
    def bumps(self) -> int:
        """The number of collisions."""
        return self._simulated.seen.bumps

    def push_button(self) -> None:
        """Push and release its start button."""
        self._simulated.push()

    def _part(self) -> None:
        try:
            super()._part()
        finally:
            self._simulated.close()


class Seen(NamedTuple):
    pose: Pose
    driven_cm: float
    bumps: int


class Simulated:
    """The robot, and the thread that runs its clock until `close`."""

    def __init__(self, robot: VirtualRobot, hurry: float) -> None:
        self._robot = robot
        self._transports = Transports()
        self.address = self._transports.address
        self._simulator = Simulator(robot, self._transports, hurry)
        self.seen = self._look()  # as of the last turn
        self._is_pushed = self._is_over = False
        self._bug: BaseException | None = None
        running = directory.Running(
            self.address, robot.profile.name, robot.world.name, "", "", VERB
        )
        self._note = directory.announce(running)
        self._thread = Thread(target=self._run, name="virtual robot", daemon=True)
        self._thread.start()

    def _look(self) -> Seen:
        driving = self._robot.driving
        return Seen(self._robot.pose, driving.driven_cm, driving.bumps)

    def push(self) -> None:
        self._is_pushed = True

    def close(self) -> None:
        directory.withdraw(self._note)
        self._is_over = True
        self._thread.join(JOIN_S)
        self._transports.close()
        if self._bug is not None:
            raise self._bug

    def _run(self) -> None:
        try:
            while not self._is_over:
                if self._is_pushed:
                    self._is_pushed = False
                    self._simulator.push()
                self._simulator.turn(TURN_S)
                self._robot.take_events()  # discarded: nothing draws them
                self.seen = self._look()
            self._robot.switch_off()
        except BaseException as bug:
            self._bug = bug
            self._transports.close()


def _made(profile: Robot, world: str, settings: Settings, language: Language) -> VirtualRobot:
    """Return the robot in its world. Raises UsageError."""
    try:
        return VirtualRobot(profile.speaking(language), worlds.load(world), settings)
    except NoWebAssembly as why:
        how = install_advice.command(install_advice.VIRTUAL)
        raise UsageError("no_wasmtime", language, {"why": str(why), "how": how}) from None
    except WorldRefused as refused:
        said = {"reasons": "\n".join(describe(refused, language))}
        raise UsageError("world_refused", language, said) from None
