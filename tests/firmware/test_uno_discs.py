"""A tinibot2 on a simulated Uno, whose wheels turn discs: how far it goes, and what is stuck."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.uno import needed
from tests.support.platformio import firmware, shared
from tests.support.uno_with_discs import ENVIRONMENT, Driven
from tiniscript.virtual.wheels import Roughness


@pytest.fixture(scope="module")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needed()
    return firmware(ENVIRONMENT, tmp_path_factory.mktemp("sketch"), shared(tmp_path_factory))


def test_it_goes_and_turns_as_far_as_was_said(sketch: Path) -> None:
    robot = Driven(sketch, 1, (107.5, 92.5), Roughness(0.005))
    with robot.uno:
        assert robot.drive("F(30 CM, 60); R(90 DEG, 60)") == "DONE"
        pose = robot.pose
    assert abs(pose.x_cm - 30) <= 1.5 and abs(pose.y_cm) <= 2 and abs(pose.heading + 90) <= 6


def test_a_wheel_whose_disc_tells_nothing_is_stuck(sketch: Path) -> None:
    robot = Driven(sketch, 2, (100, 100), Roughness())
    robot.wheels.both[1].is_seen = False
    with robot.uno:
        assert robot.drive("F(30 CM, 60)") == "FAULT"
        assert not any(wheel.wanted for wheel in robot.wheels.both)
