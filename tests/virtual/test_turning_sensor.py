"""A sensor that a servo carries looks where the servo has turned it."""

from __future__ import annotations

import random

import pytest

from tests.support.edited_robots import TEXTS
from tests.support.virtual_robot import Talk
from tiniscript import robots
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import Robot
from tiniscript.robots.reader import read
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.sensing import Sensing


def with_neck(low: int = 0, high: int = 180) -> Robot:
    """The grabber, whose servo carries its distance sensor."""
    text = TEXTS["grabber"].replace(
        'sees = "distance"', 'sees = "distance", turns_with = "GRIPPER"'
    )
    return read(text.replace("range = [0, 180]", f"range = [{low}, {high}]"), "necked")


@pytest.mark.parametrize(("low", "high"), [(0, 180), (-90, 90), (20, 160)])
def test_a_turned_sensor_reads_like_one_facing_that_way(low: int, high: int) -> None:
    """This holds anywhere in a world, for any names of its range: in the middle, it looks ahead."""
    necked_robot, world = with_neck(low, high), worlds.load("obstacles")
    rng = random.Random(3)
    readings = set()
    for _ in range(60):
        pose = Pose(rng.uniform(20, 200), rng.uniform(20, 180), rng.uniform(0, 360))
        value = rng.randint(low, high)
        place = necked_robot.body.places["DISTANCE"]
        fixed_place = place._replace(heading=value - (low + high) / 2, turns_with="")
        body = necked_robot.body._replace(places={"DISTANCE": fixed_place})
        turned_sensing, looks = (
            Sensing(necked_robot, world),
            Sensing(necked_robot._replace(body=body), world),
        )
        turned_sensing.turn(0, value * 1000)
        assert turned_sensing.peek(0, pose) == looks.peek(0, pose)
        readings.add((turned_sensing.peek(0, pose), Sensing(necked_robot, world).peek(0, pose)))
    assert sum(a != b for a, b in readings) > 30, "it turns, and sees something else"


def test_a_sensor_keeps_its_direction_when_its_servo_is_released() -> None:
    """A stop releases the servo, which then does not turn back."""
    robot = VirtualRobot(with_neck(), worlds.load("maze"), Settings(1))
    talk = Talk(robot)
    ahead = robot.sensing.peek(0, robot.pose)
    talk.upload("SI|GRIPPER(0);W(0.2)", is_detached=True)
    robot.step(robot.now_ms + 1000)
    robot.actuators_off(robot.now_ms)
    assert robot.actuators == {}
    assert robot.sensing.turn_of_actuator == {"GRIPPER": -90.0}
    assert robot.sensing.peek(0, robot.pose) != ahead
    talk.upload("SI|GRIPPER(90);W(0.2)", is_detached=True)
    robot.step(robot.now_ms + 1000)
    assert robot.sensing.peek(0, robot.pose) == ahead


def test_another_actuator_turns_no_sensor() -> None:
    robot = VirtualRobot(robots.load("grabber"), worlds.load("maze"), Settings(1))
    Talk(robot).upload("SI|GRIPPER(0);LED(TRUE);W(0.2)", is_detached=True)
    robot.step(robot.now_ms + 100)
    assert robot.sensing.turn_of_actuator == {}
