"""Lets a program drive in the world of a seed, and records what a teacher would see.

The robot is the virtual one, in its own time: a run takes no longer than it must, and gives the
same on every computer. A run is cut after the lesson's seconds, and after MAX_EVENTS actions, so
that no program holds a checker up.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.base.trace import Event
from tiniscript.bytecode.image import Image
from tiniscript.lessons.lesson import Lesson, Press
from tiniscript.lessons.variation import presses_of, vary
from tiniscript.link.remote import NOTHING_PRESSED
from tiniscript.link.remote import remote_state_of as held
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import Robot
from tiniscript.virtual.computer import Computer
from tiniscript.virtual.geometry import join_points
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.world import World

STEP_MS = 20  # between two looks at where the robot is
MAX_EVENTS = 200_000  # most events in a run
UPLOAD_LIMIT_MS = 60_000  # limit for the way of a program to the robot
PUSH_MS = 60

# The ways in which a run ends.
DONE, FAULT, LIMIT, BUSY, ASKS = "DONE", "FAULT", "LIMIT", "BUSY", "ASKS"


class Sample(NamedTuple):
    """The robot's pose at a time, in milliseconds since the start of the run."""

    ms: int
    pose: Pose


class Collision(NamedTuple):
    """A collision: `obstacle` is "wall", "box" or "border"."""

    ms: int
    obstacle: str


class ShownValue(NamedTuple):
    """A value of SHOW in thousandths (0 and 1 for yes/no), and where the robot was then."""

    ms: int
    value: int
    is_yes_no: bool
    pose: Pose


class Beep(NamedTuple):
    ms: int
    hertz: int
    pose: Pose


class SwitchedOn(NamedTuple):
    """An actuator that was switched on, by its number."""

    ms: int
    actuator: int
    is_moving: bool


class Run(NamedTuple):
    """The record of a program's run. `ending` is DONE, FAULT, LIMIT, BUSY (no time passed) or ASKS
    (PING).

    `motors` are the settings of both motors, each with its time; `event_words` are words of
    `criteria.EVENTS` in their order.
    """

    seed: int
    ending: str
    fault: str
    end_ms: int
    track: tuple[Sample, ...]
    collisions: tuple[Collision, ...]
    shown_values: tuple[ShownValue, ...]
    beeps: tuple[Beep, ...]
    switched_on: tuple[SwitchedOn, ...]
    motors: tuple[tuple[int, int, int], ...]
    event_words: tuple[str, ...]
    driven_cm: float
    robot: VirtualRobot
    presses: tuple[Press, ...] = ()

    @property
    def world(self) -> World:
        return self.robot.world


def run(image: Image, profile: Robot, lesson: Lesson, seed: int) -> Run:
    """Return the run of a program in the world of a seed.

    Raises WorldRefused if the robot does not fit into that world.
    """
    run = Trial(image, profile, lesson, seed).advance()
    assert run is not None, "it goes on to the end"
    return run


class Trial:
    """A program on its way through the world of a seed."""

    def __init__(self, image: Image, profile: Robot, lesson: Lesson, seed: int) -> None:
        """Raises WorldRefused if the robot does not fit into that world."""
        robot = self.robot = VirtualRobot(
            profile, vary(lesson, seed), Settings(seed=seed, noise=lesson.noise, eeprom_us=0)
        )
        self._presses = presses_of(lesson, seed)
        self._witness = _Witness(robot, seed, self._presses)
        self._is_ping = image.start == "PING"
        if self._is_ping:
            return
        self._computer = _upload(robot, image)
        self._witness.record_state()
        end_ms = robot.now_ms + UPLOAD_LIMIT_MS
        while self._witness.started_ms is None and robot.now_ms < end_ms:
            robot.step(robot.now_ms + 1)
            self._witness.record_state()
        assert self._witness.started_ms is not None, "the program does not begin"
        self._limit_ms = self._witness.started_ms + round(lesson.seconds * 1000)

    def advance(self, most_ms: int | None = None) -> Run | None:
        """Advance the robot's time by at most `most_ms`; return the run once it is over."""
        robot, witness = self.robot, self._witness
        if self._is_ping:
            return witness.run(ASKS)
        until_ms = self._limit_ms if most_ms is None else robot.now_ms + most_ms
        while robot.is_running:
            if robot.now_ms >= self._limit_ms:
                robot.rest()
                return witness.run(LIMIT)
            if robot.now_ms >= until_ms:
                return None
            self.step(min(robot.now_ms + STEP_MS, self._limit_ms))
            witness.record_state()
            if witness.events > MAX_EVENTS:
                robot.rest()
                return witness.run(BUSY)
        return witness.run(FAULT if robot.fault else DONE)

    def step(self, until_ms: int) -> None:
        """Advance the robot's time by at most STEP_MS, with the keys held as planned."""
        robot = self.robot
        if not self._presses:
            robot.step(until_ms)
            return
        assert self._witness.started_ms is not None
        seconds = (robot.now_ms - self._witness.started_ms) / 1000
        keys = (
            press.key for press in self._presses if press.at_seconds <= seconds < press.end_seconds
        )
        key = next(keys, "")
        self._computer.session.press(
            *(held([key.removeprefix("KEY_")]) if key else NOTHING_PRESSED)
        )
        self._computer.wait(until_ms - robot.now_ms)


def _upload(robot: VirtualRobot, image: Image) -> Computer:
    """Bring a program to the robot and start it, by its button where it begins with SB."""
    computer = Computer(robot, robot.settings.seed)
    session = computer.session
    for reply in (
        computer.wait_for(session.hello()),
        computer.wait_for(session.upload(image, True, False, True)),
    ):
        assert not reply.status, reply
    if image.start == "SB":
        robot.press()
        robot.step(robot.now_ms + PUSH_MS)
        robot.let_go()
    return computer


class _Witness:
    """Records a robot's actions from the start of its program."""

    def __init__(self, robot: VirtualRobot, seed: int, presses: tuple[Press, ...]) -> None:
        self.robot = robot
        self.seed = seed
        self._presses = presses
        self.started_ms: int | None = None
        self.events = 0
        self._bump_count = 0
        self._track: list[Sample] = []
        self._collisions: list[Collision] = []
        self._shown_values: list[ShownValue] = []
        self._beeps: list[Beep] = []
        self._switched_on: list[SwitchedOn] = []
        self._value_of_actuator: dict[int, int] = {}
        self._motors: list[tuple[int, int, int]] = []
        self._event_words: list[str] = []
        self._is_moving = False

    def record_state(self) -> None:
        """Record the events since the last call."""
        robot = self.robot
        pose = robot.pose
        for event in robot.take_events():
            self.events += 1
            if event.kind == "START" and self.started_ms is None:
                self.started_ms = event.time_ms
                self._track.append(Sample(0, robot.world.start))
            elif self.started_ms is not None:
                self._record_event(event, event.time_ms - self.started_ms, pose)
        if self.started_ms is None:
            return
        ms = robot.now_ms - self.started_ms
        if pose != self._track[-1].pose:
            self._track.append(Sample(ms, pose))
        if robot.driving.bumps != self._bump_count:
            self._bump_count = robot.driving.bumps
            self._collisions.append(Collision(ms, self._nearest_obstacle(pose)))

    def _record_event(self, event: Event, ms: int, pose: Pose) -> None:
        if event.kind == "MOTORS":
            powers_before = self._motors[-1][1:] if self._motors else (0, 0)
            self._motors.append((ms, event.values[0], event.values[1]))
            if any(event.values) and event.values[:2] != powers_before:
                self._event_words.append("moves")
            elif self._is_moving and not any(event.values):
                self._add_stop(ms)
            self._is_moving = any(event.values)
        elif event.kind == "BEEP":
            self._beeps.append(Beep(ms, event.values[0], pose))
            self._event_words.append("beeps")
        elif event.kind == "SET":
            actuator, value = event.values
            if value and not self._value_of_actuator.get(actuator):
                self._switched_on.append(SwitchedOn(ms, actuator, self._is_moving))
            self._value_of_actuator[actuator] = value
        elif event.kind == "SHOW":
            self._event_words.append("shows")
            is_yes_no = event.text.endswith(("TRUE", "FALSE"))
            self._shown_values.append(ShownValue(ms, event.values[0], is_yes_no, pose))

    def _add_stop(self, ms: int) -> None:
        """Record a stop before the values shown at the same moment."""
        count_at_once = 0
        for shown_value, word in zip(
            reversed(self._shown_values), reversed(self._event_words), strict=False
        ):
            if word != "shows" or shown_value.ms != ms:
                break
            count_at_once += 1
        self._event_words.insert(len(self._event_words) - count_at_once, "stops")

    def _nearest_obstacle(self, pose: Pose) -> str:
        """Return the kind of the nearest obstacle."""
        world, hull = self.robot.world, self.robot.driving.hull
        segments_of_kind = {
            "wall": [segment for wall in world.walls for segment in join_points(list(wall))],
            "box": [segment for box in world.boxes for segment in join_points([*box, box[0]])],
            "border": world._replace(walls=(), boxes=()).obstacles(),
        }
        gaps_and_kinds = []
        for kind, segments in segments_of_kind.items():
            contact = hull.contact(pose, segments)
            if contact is not None:
                gaps_and_kinds.append((contact.gap_cm, kind))
        return min(gaps_and_kinds)[1]

    def run(self, ending: str) -> Run:
        robot = self.robot
        end_ms = 0
        if self.started_ms is not None:
            ended_ms = robot.now_ms if robot.ended_ms is None else robot.ended_ms
            end_ms = ended_ms - self.started_ms
        if self._is_moving:
            self._add_stop(end_ms)
        return Run(
            self.seed, ending, robot.fault, end_ms,
            tuple(self._track) or (Sample(0, robot.world.start),),
            tuple(self._collisions), tuple(self._shown_values), tuple(self._beeps),
            tuple(self._switched_on), tuple(self._motors), tuple(self._event_words),
            robot.driving.driven_cm, robot, self._presses,
        )  # fmt: skip
