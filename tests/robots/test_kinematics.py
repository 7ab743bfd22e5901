"""The geometry of two wheels: where a robot gets to, and the points that show its way."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from tiniscript.robots.kinematics import ARC_STEP, START, Pose, Way, move_pose, points
from tiniscript.robots.profile import Body

BODY = Body(
    wheel_base_cm=10,
    speed_cm_s=40,
    turn_s=math.degrees(8),
    length_cm=20,
    width_cm=15,
    places={},
)
SETTINGS = [(50, 50), (-80, -80), (60, -60), (-30, 30), (20, 70), (70, 20), (0, 50), (-10, -90),
            (90, -20), (100, 99), (0, 0)]  # fmt: skip
# Time of a quarter turn at 100 %.
QUARTER_MS = 1000 * (math.pi / 2 * BODY.wheel_base_cm / 2) / BODY.speed_cm_s


def approximate_pose(pose: Pose) -> Pose:
    return pytest.approx(pose, abs=1e-9)  # type: ignore[return-value]


def test_one_wheel_alone_turns_the_robot_around_the_other() -> None:
    half_turn_ms = 4 * QUARTER_MS
    assert move_pose(BODY, START, 0, 100, half_turn_ms) == approximate_pose(
        Pose(0, BODY.wheel_base_cm, 180)
    )


def test_an_arc_stays_on_its_circle() -> None:
    # the inner wheel at half the speed of the outer: 1.5 bases from the outer to the middle
    radius_cm = 1.5 * BODY.wheel_base_cm
    for pose in points(BODY, START, 40, 80, 3000):
        assert math.dist(pose[:2], (0, radius_cm)) == pytest.approx(radius_cm)


@pytest.mark.parametrize(("left", "right"), SETTINGS)
def test_a_move_in_parts_gives_the_same_path(left: int, right: int) -> None:
    pose = Pose(5, -3, 20)
    for part_ms in (20, 0, 333, 1, 646):
        pose = move_pose(BODY, pose, left, right, part_ms)
    assert pose == approximate_pose(move_pose(BODY, Pose(5, -3, 20), left, right, 1000))


# ---- points


@pytest.mark.parametrize(("left", "right"), SETTINGS)
def test_path_points_are_close_and_reach_the_end(left: int, right: int) -> None:
    way = [START, *points(BODY, START, left, right, 1500)]
    assert way[-1] == move_pose(BODY, START, left, right, 1500)
    if left != -right:
        for a, b in pairwise(way):
            turn = abs(b.heading - a.heading) % 360
            assert min(turn, 360 - turn) <= ARC_STEP + 1e-9


def test_many_rounds_are_one_circle_and_the_path_to_the_end() -> None:
    way = points(BODY, START, 20, 80, 10**9)
    assert len(way) <= 2 * 360 / ARC_STEP
    assert way[-1] == move_pose(BODY, START, 20, 80, 10**9)
    assert math.dist(way[-1][:2], way[-2][:2]) < 1


# ---- a way of several settings


def test_a_path_has_its_corners_and_the_current_pose() -> None:
    way = Way(BODY)
    way.set_motors(0, 50, 50)
    way.set_motors(1000, 0, 0)
    way.set_motors(2000, -100, 100)
    way.set_motors(2000 + QUARTER_MS, 50, 50)
    assert way.pose(3000 + QUARTER_MS) == approximate_pose(Pose(20, 20, 90))
    assert way.corners == [START, approximate_pose(Pose(20, 0, 0))]
    assert way.points_ahead(3000 + QUARTER_MS) == [approximate_pose(Pose(20, 20, 90))]


def test_the_same_setting_again_is_not_a_corner() -> None:
    way = Way(BODY)
    for now_ms in range(0, 1000, 20):
        way.set_motors(now_ms, 50, 50)
    assert way.corners == [START]
    assert way.pose(1000) == approximate_pose(Pose(20, 0, 0))


def test_thinned_out_corners_keep_the_shape() -> None:
    way = Way(BODY)
    for k in range(1000):
        way.set_motors(k, 100, 100 - k % 2)
    pose, last_corner = way.pose(1000), way.corners[-1]
    way.thin_out(800)
    assert len(way.corners) < 800
    assert way.corners[0] == START
    assert way.corners[-1] == last_corner
    assert way.pose(1000) == pose
    way.thin_out(10)
    assert len(way.corners) == 10
    assert way.corners[-1] == last_corner
