"""A body among obstacles, and the readings of its sensors there, calculated by hand."""

from __future__ import annotations

import math
from itertools import pairwise
from random import Random

import pytest

from tests.support.virtual_robot import floor
from tiniscript import robots
from tiniscript.base.fixed_point import ONE
from tiniscript.robots.kinematics import Pose, move_pose
from tiniscript.robots.profile import Robot
from tiniscript.virtual.driving import TOUCH_CM, Driving, Hull
from tiniscript.virtual.geometry import (
    Point,
    Segment,
    crosses,
    gap_between,
    nearest_point,
    nearest_seen,
)
from tiniscript.virtual.sensing import Sensing
from tiniscript.virtual.world import World

TINIBOT = robots.load("tinibot")
LINER = robots.load("liner")
GRABBER = robots.load("grabber")
RIGHT, LEFT, DISTANCE = range(3)  # indexes of tinibot's sensors
NOSE_CM = 13  # distance from its wheels to its distance sensor
WALL_ACROSS = Segment(Point(10, -5), Point(10, 5))


# -- geometry -------------------------------------------------------------------------------------


def test_the_nearest_point_is_inside_or_an_end() -> None:
    assert nearest_point(WALL_ACROSS, 3, 2) == (10, 2)
    assert nearest_point(WALL_ACROSS, 3, 9) == (10, 5)
    assert nearest_point(Segment(Point(1, 1), Point(1, 1)), 4, 5) == (1, 1)


def test_segments_cross_or_are_a_distance_apart() -> None:
    assert crosses(WALL_ACROSS, Segment(Point(0, 0), Point(20, 0)))
    assert not crosses(WALL_ACROSS, Segment(Point(0, 0), Point(9, 0)))
    assert gap_between(WALL_ACROSS, Segment(Point(0, 0), Point(20, 0)))[0] == 0
    assert gap_between(WALL_ACROSS, Segment(Point(0, 0), Point(6, 3))) == (
        4,
        Point(10, 3),
        Point(6, 3),
    )


@pytest.mark.parametrize(
    ("heading", "half", "distance_cm"),
    [
        (0, 15, 10.0),
        (20, 15, 10 / math.cos(math.radians(5))),  # the cone's border is 5 degrees off
        (90, 15, None),
        (180, 15, None),
        (45, 15, None),  # the end is at 26.6 degrees
        (45, 20, math.hypot(10, 10 * math.tan(math.radians(25)))),
    ],
)
def test_a_cone_sees_the_nearest_point_inside(
    heading: float, half: float, distance_cm: float
) -> None:
    nearest_cm = nearest_seen([WALL_ACROSS], Point(0, 0), math.radians(heading), math.radians(half))
    assert nearest_cm == pytest.approx(distance_cm)
    for y in (-5, 5):  # walls that end on the border
        assert nearest_seen([Segment(Point(10, 0), Point(10, y))], Point(0, 0), 0, 0) == 10


# -- driving --------------------------------------------------------------------------------------


def make_driving(world: World, start: Pose | None = None, robot: Robot = TINIBOT) -> Driving:
    return Driving(robot.body, world.obstacles(), start or world.start)


def test_without_obstacles_the_path_follows_the_wheels() -> None:
    drive = make_driving(floor(size=2000, start="x_cm = 1000\ny_cm = 1000"))
    pose = Pose(1000, 1000, 0)
    now_ms = 0.0
    ways = ((80, 80, 1000), (60, -60, 500), (100, 30, 2500), (-50, 20, 700))
    for black_on_left, right, duration_ms in ways:
        drive.set_motors(now_ms, black_on_left, right)
        now_ms += duration_ms
        pose = move_pose(TINIBOT.body, pose, black_on_left, right, duration_ms)
        assert drive.advance_to(now_ms) == pytest.approx(pose, abs=1e-6)
    assert drive.bumps == 0


def test_a_robot_stops_at_a_wall_that_it_drives_into() -> None:
    drive = make_driving(floor())
    drive.set_motors(0, 100, 100)
    pose = drive.advance_to(10_000)
    assert pose == pytest.approx((200 - NOSE_CM, 100, 0), abs=0.01)
    assert drive.bumps == 1
    assert drive.driven_cm == pytest.approx(100 - NOSE_CM, abs=0.1)
    drive.set_motors(10_000, -100, -100)
    assert drive.advance_to(11_000).x_cm == pytest.approx(200 - NOSE_CM - 45, abs=0.01)


@pytest.mark.parametrize("heading", [30, -30, 2])
def test_a_robot_turns_along_a_wall_that_it_drives_into(heading: float) -> None:
    """Its nose is pushed aside, though both motors get the same."""
    drive = make_driving(floor(start=f"x_cm = 150\ny_cm = 100\nheading = {heading}"))
    drive.set_motors(0, 100, 100)
    pose = drive.advance_to(2400)
    assert pose.heading == pytest.approx(math.copysign(90, heading), abs=2)
    assert pose.x_cm == pytest.approx(200 - drive.hull.radius_cm, abs=0.1)
    assert 15 < abs(pose.y_cm - 100) < 90


@pytest.mark.parametrize("turn_s", [180, 360, 500])
def test_no_wheel_slips_aside_while_a_wall_turns_a_robot(turn_s: float) -> None:
    """Its turns may be slower and faster than the distance of its wheels says."""
    robot = TINIBOT._replace(body=TINIBOT.body._replace(turn_s=turn_s))
    drive = make_driving(floor(start="x_cm = 150\ny_cm = 100\nheading = 30"), robot=robot)
    drive.set_motors(0, 100, 100)
    poses = [drive.advance_to(now_ms) for now_ms in range(0, 2400, 10)]
    aside_cm = 0.0
    for (x, y, heading), (next_x, next_y, next_heading) in pairwise(poses):
        along = math.radians(heading + next_heading) / 2
        aside_cm += abs((next_y - y) * math.cos(along) - (next_x - x) * math.sin(along))
    assert poses[-1].heading == pytest.approx(90, abs=1)
    assert aside_cm < 0.5


@pytest.mark.parametrize("aside", [2, 5, -7])
def test_the_end_of_a_wall_does_not_hold_a_robot_by_its_side(aside: float) -> None:
    end = 100 + aside
    drive = make_driving(floor(f"[[walls]]\npoints = [[120, {end}], [140, {end}]]\n"))
    drive.set_motors(0, 60, 60)
    assert drive.advance_to(4000).x_cm > 150
    assert drive.bumps >= 1


@pytest.mark.sampled("robot")
@pytest.mark.parametrize("robot", [TINIBOT, LINER, GRABBER], ids=lambda robot: robot.name)
@pytest.mark.parametrize("powers", [(100, 100), (100, 90), (-100, -80), (100, -100), (90, 0)])
def test_nothing_is_driven_through(robot: Robot, powers: tuple[int, int]) -> None:
    """This holds in a corner and at the end of a wall, however long it pushes."""
    world = floor("[[walls]]\npoints = [[20, 140], [120, 140], [120, 160]]\n")
    for heading in range(0, 360, 40):
        drive = make_driving(world, Pose(60, 100, heading), robot)
        drive.set_motors(0, *powers)
        advance_to_before = drive.advance_to(0)
        for now_ms in range(250, 15_000, 250):
            pose = drive.advance_to(now_ms)
            contact = drive.hull.contact(pose, drive.obstacles)
            assert contact and contact.gap_cm > -0.01
            assert not any(
                crosses(Segment(Point(*advance_to_before[:2]), Point(*pose[:2])), obstacle)
                for obstacle in drive.obstacles
            )
            advance_to_before = pose


def test_looking_changes_nothing() -> None:
    """A picture of it may be drawn whenever one likes."""
    end_poses = []
    for look_times_ms in ([], [1, 99, 100, 101, 5432, 7000], list(range(0, 8000, 7))):
        drive = make_driving(
            floor("[[boxes]]\nx_cm=150\ny_cm=95\nlength_cm=20\nwidth_cm=20\nheading=20")
        )
        drive.set_motors(0, 90, 80)
        for now_ms in look_times_ms:
            drive.pose_at(now_ms)
        end_poses.append(drive.advance_to(8000))
    assert end_poses[0] == end_poses[1] == end_poses[2]


def test_the_path_has_no_gaps_and_few_corners() -> None:
    drive = make_driving(floor())
    drive.set_motors(0, 50, 50)
    drive.set_motors(3000, 30, -30)
    drive.set_motors(4000, 50, 50)
    drive.advance_to(20_000)
    assert len(drive.corners) < 300
    length_cm = sum(math.dist(a[:2], b[:2]) for a, b in pairwise(drive.corners))
    assert length_cm == pytest.approx(drive.driven_cm, rel=1e-6)
    assert drive.corners[-1][:2] == drive.advance_to(20_000)[:2]


def test_the_hull_reaches_to_the_sensors() -> None:
    hull = Hull(TINIBOT.body)
    assert hull.front_cm + hull.radius_cm == NOSE_CM
    spine = hull.spine(Pose(0, 0, 90))
    assert spine.b == pytest.approx((0, hull.front_cm))
    for point in hull.outline(Pose(0, 0, 90)):
        assert abs(point.x) <= 7.5 + 1e-9 and -10.5 - 1e-9 <= point.y <= NOSE_CM + 1e-9


# -- sensing --------------------------------------------------------------------------------------


def read(world: World, number: int, pose: Pose, robot: Robot = TINIBOT) -> float:
    return Sensing(robot, world).read(number, pose) / ONE


def test_distance_is_that_of_the_nearest_wall_in_the_cone() -> None:
    world = floor()
    assert read(world, DISTANCE, Pose(100, 100, 0)) == 100 - NOSE_CM
    assert read(world, DISTANCE, Pose(100, 100, 90)) == 100 - NOSE_CM
    # 20 degrees off: the border of the cone is 5 degrees off
    eye_cm = 100 - NOSE_CM * math.cos(math.radians(20))
    expected = eye_cm / math.cos(math.radians(5))
    assert read(world, DISTANCE, Pose(100, 100, 20)) == pytest.approx(expected, abs=0.05)


def test_distance_has_the_limits_of_its_sensor() -> None:
    assert read(floor(), DISTANCE, Pose(200 - NOSE_CM - 1, 100, 0)) == 2
    wide_floor = floor(size=2000, start="x_cm = 1000\ny_cm = 1000")
    assert read(wide_floor, DISTANCE, Pose(1000, 1000, 0)) == 400


def test_a_lamp_is_brighter_near_and_ahead_and_not_through_a_wall() -> None:
    lamp = "[light]\nambient_percent = 0\n[[lamps]]\nx_cm = 112\ny_cm = 195\nreach_cm = 50\n"
    world = floor(lamp)
    # the left sensor is at (112, 105) and looks 30 degrees to the left: the lamp is 60 off
    expected = math.cos(math.radians(60)) / (1 + (90 / 50) ** 2)
    assert read(world, LEFT, Pose(100, 100, 0)) == round(1023 * expected)
    assert read(world, RIGHT, Pose(100, 100, 0)) == 0  # 120 degrees off
    wall = "[[walls]]\npoints = [[60, 150], [160, 150]]\n"
    # Turned round, the lamp is out of sight: as bright as without a lamp.
    assert read(world, LEFT, Pose(112, 150, 180)) == 0
    dim = "[light]\nambient_percent = 20\n"
    floor_after = floor(lamp.replace("[light]\nambient_percent = 0\n", dim))
    assert (
        read(floor_after, LEFT, Pose(112, 150, 180))
        == read(floor(dim), LEFT, Pose(112, 150, 180))
        > 0
    )
    assert read(floor(lamp + wall), LEFT, Pose(100, 100, 0)) == 0
    bright = floor(lamp.replace("ambient_percent = 0", "ambient_percent = 100"))
    assert read(bright, LEFT, Pose(100, 100, 0)) == 1023


def test_a_line_sensor_is_over_a_line_or_not() -> None:
    line = floor("[[lines]]\npoints = [[107.5, 20], [107.5, 180]]\nwidth_cm = 2\n")
    black_on_left = 0
    for x, y, is_black in ((100, 100, 1), (101, 100, 1), (101.1, 100, 0), (100, 190, 0)):
        assert read(line, black_on_left, Pose(x, y, 0), LINER) * ONE == is_black


def test_a_bumper_notices_an_obstacle_in_front() -> None:
    hull, bumper = Hull(LINER.body), 2
    for heading, is_touched in ((0, True), (30, True), (80, False), (180, False)):
        cos = math.cos(math.radians(heading))
        along = max(hull.front_cm * cos, hull.back_cm * cos)
        touching = Pose(200 - hull.radius_cm - along, 100, heading)
        assert read(floor(), bumper, touching, LINER) * ONE == is_touched, heading
        off = touching._replace(x_cm=touching.x_cm - TOUCH_CM - 0.01)
        assert read(floor(), bumper, off, LINER) == 0


def test_a_sensor_without_a_place_gives_a_plausible_or_set_value() -> None:
    pose = Pose(100, 100, 0)
    assert read(floor(), 3, pose, LINER) == 5  # BATTERY, 0 to 10 V
    assert read(floor(), 1, pose, GRABBER) == 20  # TEMPERATURE
    sensing = Sensing(LINER, floor(), given_readings={3: [7000, 6500], 0: [1]})
    assert [sensing.read(3, pose) for _ in range(3)] == [7000, 6500, 6500]
    assert sensing.read(0, pose) == 1
    assert sensing.peek(3, pose) == 6500


def test_noise_is_about_as_large_as_specified() -> None:
    sensing = Sensing(TINIBOT, floor(), 0.05, Random(1))
    pose = Pose(100, 100, 0)
    readings = [sensing.read(DISTANCE, pose) / ONE / 87 for _ in range(400)]
    spread = math.sqrt(sum((reading - 1) ** 2 for reading in readings) / len(readings))
    assert 0.04 < spread < 0.06
    assert sensing.peek(DISTANCE, pose) == 87_000
