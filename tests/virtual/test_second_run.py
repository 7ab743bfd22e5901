"""After any history, a virtual robot acts like one that was just switched on in its place.

A random program ends, or is ended in a random way at any moment; then comes another one. A second
robot begins in a world whose start is the current place of the first one: both do the same at the
same times, see the same, and arrive at the same place.

`python -m tests.virtual.test_second_run 2000` tries more.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Callable
from math import hypot
from typing import NamedTuple

import pytest

from tests.oracle.task_programs import task_program
from tests.support.campaign import each_seed, make_options
from tests.support.virtual_robot import Talk, floor, robot_in, trace
from tiniscript.link.messages import STOP_BYTES
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.robot import POWER_ON, RESET_BUTTON, VirtualRobot

WALL = "[[boxes]]\nx_cm = 140\ny_cm = 140\nlength_cm = 20\nwidth_cm = 20\nheading = 20\n"
TOLERANCE_CM, TOLERANCE_DEGREES = 0.5, 1.0
RUN_MS = 2500


def push_button(talk: Talk) -> None:
    talk.robot.press()
    talk.wait(60)
    talk.robot.let_go()


def type_stop(talk: Talk) -> None:
    talk.robot.step(talk.robot.now_ms + 20, b"\nS\n")


def stop_by_computer(talk: Talk) -> None:
    talk.session.stop(talk.robot.now_ms)
    talk.wait(200)


END_ACTIONS: dict[str, Callable[[Talk], object]] = {
    "nothing": lambda talk: talk.wait(4000),
    "zeros": lambda talk: talk.robot.step(talk.robot.now_ms + 20, bytes(STOP_BYTES)),
    "a line": type_stop,
    "its computer": stop_by_computer,
    "the button": push_button,
    "silence": lambda talk: talk.robot.step(talk.robot.now_ms + 3000),
    "a reset": lambda talk: talk.robot.power_cycle(RESET_BUTTON),
    "off and on": lambda talk: talk.robot.power_cycle(),
    "the next program": lambda talk: None,
}


OFF = ("a reset", "off and on")


def program(rng: random.Random, name: str) -> str:
    text = re.sub(r"RANDOM\(\d, \d\)", "2", task_program(rng)[0]).replace("\n", ";")
    ending = rng.choice(("", "F(0.3, 60);", "X = 0;W(0.05);SHOW(1 / X);", "M(30, -30);W(0.2);"))
    if name == "grabber":
        text = text.replace("LIGHT_L", "TEMPERATURE")
        text = rng.choice(("", "GRIPPER(40);LED(TRUE);", "LED(DISTANCE < 40);")) + text
    return f"SI|SHOW(DISTANCE);{text};{ending}"


class Observation(NamedTuple):
    trace: list[str]
    state: tuple[str, bool, bool, str]
    pose: Pose
    actuators: dict[int, int]


def run_program(talk: Talk, text: str) -> Observation:
    robot = talk.robot
    robot.take_events()
    assert talk.upload(text).status == 0
    talk.wait(RUN_MS)
    state = robot.fault, robot.is_running, robot.ended_ms is None, robot.saved_state
    return Observation(trace(robot.take_events()), state, robot.pose, robot.actuators)


def check(seed: int) -> str:
    rng = random.Random(seed)
    name = rng.choice(("grabber", "tinibot2"))
    robot = robot_in(floor(WALL), name, baud=0)
    talk = Talk(robot)
    assert talk.upload(program(rng, name), is_detached=rng.random() < 0.3).status == 0
    talk.wait(rng.choice((0, 1, 30, 300, 900)))
    ending = rng.choice([*END_ACTIONS])
    END_ACTIONS[ending](talk)
    assert ending not in OFF or (not robot.is_running and robot.offset is None), seed
    robot.step(robot.now_ms + 20, b"\0S\n")
    robot.step(robot.now_ms + 1500)  # until the robot stops
    pose = robot.pose
    is_done = "DONE" in [event.kind for event in robot.take_events()][-2:]
    text = program(rng, name)
    other = robot_in(floor(WALL)._replace(start=pose), name, baud=0)
    other.step(1500)
    actions, expected = run_program(Talk(robot, 7), text), run_program(Talk(other, 7), text)
    explanation = f"seed {seed} {ending} {name} {text}\n{actions}\nnot\n{expected}"
    assert actions[:2] == expected[:2], explanation
    actual_pose, expected_pose = actions.pose, expected.pose
    assert (
        hypot(actual_pose.x_cm - expected_pose.x_cm, actual_pose.y_cm - expected_pose.y_cm)
        < TOLERANCE_CM
    ), explanation
    assert abs(actual_pose.heading - expected_pose.heading) < TOLERANCE_DEGREES, explanation
    actuators_left = {
        k: value for k, value in actions.actuators.items() if k not in expected.actuators
    }
    assert {**expected.actuators, **actuators_left} == actions.actuators, explanation
    # Outputs that the program's own end leaves on.
    assert is_done or not any(actuators_left.values()), explanation
    return ending if len(expected.trace) > 3 else "little"


def check_power_on(seed: int) -> int:
    """However long it was on before, a robot acts like one that is switched on for the first time
    in its place, with its memory; return the number of its actions."""
    rng = random.Random(seed)
    name, reset = rng.choice(("grabber", "tinibot2")), rng.choice((POWER_ON, RESET_BUTTON))
    robot = robot_in(floor(WALL), name, baud=0)
    talk = Talk(robot)
    assert talk.upload(program(rng, name)).status == 0
    talk.wait(rng.choice((0, 30, 900, 5000)))
    robot.step(robot.now_ms + rng.choice((0, 1, 60_000)))
    place = floor(WALL)._replace(start=robot.pose)
    other = robot_in(place, name, robot.memory, baud=0)
    both_robots = (robot, other)
    for started_robot in both_robots:
        started_robot.power_cycle(reset)
        started_robot.take_events()
    begin_times_ms, count = (robot.now_ms, other.now_ms), 0
    for _ in range(60):
        key = rng.choice((VirtualRobot.press, VirtualRobot.let_go, lambda _: None))
        duration_ms, data = rng.choice((0, 0, 0, 1, 100)), rng.choice((b"", b"", b"\nSHOW(1)\n"))
        for started_robot in both_robots:
            key(started_robot)
            started_robot.step(started_robot.now_ms + duration_ms, data)
        events, other_events = (
            [f"{event.time_ms - begin_ms} {event.text}" for event in started_robot.take_events()]
            for started_robot, begin_ms in zip(both_robots, begin_times_ms, strict=True)
        )
        assert events == other_events, f"seed {seed} {name} {reset}"
        count += len(events)
    return count


@pytest.mark.parametrize("part", range(2))
def test_each_power_on_is_as_the_first(part: int) -> None:
    assert sum(check_power_on(seed) for seed in range(part * 10, (part + 1) * 10)) > 30


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(20))
def test_a_second_run_is_as_on_a_freshly_started_robot(part: int) -> None:
    counts = Counter(check(seed) for seed in range(part * 15, (part + 1) * 15))
    assert counts["little"] < 8, counts


if __name__ == "__main__":
    each_seed(check, make_options(500, 5_000))
