"""The readings of a robot's sensors, calculated from its pose in a world.

Knows how sensors measure light, distance, a line, a white edge and a touch. Readings are
thousandths, as in the machine. A sensor without a place in the robot's body returns given readings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from random import Random

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import Place, Robot
from tiniscript.virtual.driving import TOUCH_CM, Hull
from tiniscript.virtual.geometry import Point, Segment, crosses, distance, join_points, nearest_seen
from tiniscript.virtual.world import World

NEAREST_CM, FARTHEST_CM = 2.0, 400.0  # range of an HC-SR04
CONE_RADIANS = math.radians(15)  # half angle of the cone
BUMPER_RADIANS = math.radians(60)  # half angle of the cone
ROOM_CELSIUS = 20_000
MAX_FINE_STEPS = 50  # a range of more steps than these has whole numbers


class Sensing:
    """The sensors of a robot in a world.

    `noise` is how far a reading is off, of its range (of the distance itself, where that is what
    is read), one time in three. `told` are readings for single sensors, by their number: each
    takes the next one, the last one stays.
    """

    def __init__(
        self,
        robot: Robot,
        world: World,
        noise: float = 0.0,
        random_source: Random | None = None,
        given_readings: Mapping[int, Sequence[int]] | None = None,
        other_outlines: Callable[[], Sequence[Segment]] = tuple,
    ) -> None:
        self.robot = robot
        self.world = world
        self._other_outlines = other_outlines  # outlines of moving bodies other than the robot
        self.noise = noise
        self.obstacles = world.obstacles()
        self.lines = [
            (segment, line.width_cm / 2)
            for line in world.lines
            for segment in join_points(list(line.points))
        ]
        self.hull = Hull(robot.body)
        self._random_source = random_source or Random(1)
        # Angle to the left of each servo that carries a sensor, by the actuator's name.
        self.turn_of_actuator: dict[str, float] = {}
        self._given_readings = {
            number: list(values) for number, values in (given_readings or {}).items()
        }
        self._near_obstacles: tuple[Pose, list[Segment]] | None = (
            None  # obstacles that a robot may touch there
        )

    def read(self, number: int, pose: Pose, remote: int = 0) -> int:
        """Return the reading of a sensor at `pose`, or what a remote control says there."""
        readings = self._given_readings.get(number)
        if readings:
            return readings.pop(0) if len(readings) > 1 else readings[0]
        if number >= len(self.robot.kit.sensors):
            return remote
        return self._sense(number, pose, self.noise)

    def set_reading(self, number: int, reading: int) -> None:
        """Set a sensor's reading from now on, within its range; in thousandths, or 0 and 1."""
        self._given_readings[number] = [_clamp_to_range(self.robot.kit.readings[number], reading)]

    def turn(self, actuator: int, value: int) -> None:
        """Turn the sensors that an actuator carries. They stay so when it gets no more pulses."""
        device = self.robot.kit.actuators[actuator]
        if any(place.turns_with == device.name for place in self.robot.body.places.values()):
            self.turn_of_actuator[device.name] = (value - (device.low + device.high) / 2) / ONE

    def peek(self, number: int, pose: Pose) -> int:
        """Return the reading without noise. This does not change later readings."""
        readings = self._given_readings.get(number)
        return readings[0] if readings else self._sense(number, pose, 0.0)

    def _sense(self, number: int, pose: Pose, noise: float) -> int:
        device = self.robot.kit.sensors[number]
        place = self.robot.body.places.get(device.name)
        if place is None:
            return _idle_reading(device)
        return _clamp_to_range(device, self._noisy_reading(device, place, pose, noise))

    def _noisy_reading(self, device: Device, place: Place, pose: Pose, noise: float) -> float:
        """Return a reading in thousandths, which may be out of range."""
        eye, heading = _sensor_pose(place, pose)
        heading += math.radians(self.turn_of_actuator.get(place.turns_with, 0.0))
        value_range = device.high - device.low
        deviation = self._random_source.gauss(0.0, noise) if noise else 0.0
        if place.sees == "distance":
            return round(self._distance_cm(eye, heading) * (1 + deviation), 1) * ONE
        if place.sees == "light":
            value = device.low + (self._light(eye, heading) + deviation) * value_range
            return round(value / ONE) * ONE if value_range > MAX_FINE_STEPS * ONE else value
        if place.sees == "touch":
            is_detected = self._is_touched(place, pose)
        else:
            is_detected = self._is_black(eye) == (place.sees == "line")
        return float(device.high if is_detected else device.low)

    def _distance_cm(self, eye: Point, heading: float) -> float:
        nearest = nearest_seen(
            [*self.obstacles, *self._other_outlines()], eye, heading, CONE_RADIANS
        )
        return FARTHEST_CM if nearest is None else min(max(nearest, NEAREST_CM), FARTHEST_CM)

    def _light(self, eye: Point, heading: float) -> float:
        """Return 0 to 1: lamps by their distance and angle, none through an obstacle."""
        level = self.world.ambient_light
        obstacles = [*self.obstacles, *self._other_outlines()] if self.world.lamps else []
        for lamp in self.world.lamps:
            ray = Segment(eye, lamp.place)
            if any(crosses(ray, obstacle) for obstacle in obstacles):
                continue
            distance_cm = math.dist(eye, lamp.place)
            angle = math.atan2(lamp.place.y - eye.y, lamp.place.x - eye.x) - heading
            facing = max(0.0, math.cos(angle)) if distance_cm else 1.0
            level += facing / (1 + (distance_cm / lamp.reach_cm) ** 2)
        return min(1.0, level)

    def _is_black(self, eye: Point) -> bool:
        x, y = eye
        for segment, half_cm in self.lines:
            (ax, ay), (bx, by) = segment
            if (
                min(ax, bx) - half_cm <= x <= max(ax, bx) + half_cm
                and min(ay, by) - half_cm <= y <= max(ay, by) + half_cm
                and distance(segment, x, y) <= half_cm
            ):
                return True
        return any(ring.is_dark(x, y) for ring in self.world.rings)

    def _is_touched(self, place: Place, pose: Pose) -> bool:
        """Return whether the body touches something on the side where a bumper sits."""
        # most often everything is far away: that is quickly known, and asked many times in a tick
        if self._near_obstacles is None or self._near_obstacles[0] != pose:
            reach_cm = self.hull.reach_cm + TOUCH_CM
            near_obstacles = [
                obstacle for obstacle in self.obstacles if distance(obstacle, *pose[:2]) < reach_cm
            ]
            self._near_obstacles = pose, near_obstacles
        near_obstacles = [*self._near_obstacles[1], *self._other_outlines()]
        contact = self.hull.contact(pose, near_obstacles) if near_obstacles else None
        if contact is None or contact.gap_cm >= TOUCH_CM:
            return False
        (_, _, heading), point = pose, contact.obstacle_point
        bumper_angle = math.atan2(place.y_cm, place.x_cm) if place.x_cm or place.y_cm else 0.0
        contact_angle = math.atan2(point.y - contact.body_point.y, point.x - contact.body_point.x)
        angle = (contact_angle - bumper_angle - math.radians(heading) + math.pi) % (
            2 * math.pi
        ) - math.pi
        return abs(angle) <= BUMPER_RADIANS


def _sensor_pose(place: Place, pose: Pose) -> tuple[Point, float]:
    """Return the position of a sensor on the floor, and its direction."""
    heading = math.radians(pose.heading)
    cos, sin = math.cos(heading), math.sin(heading)
    eye = Point(
        pose.x_cm + place.x_cm * cos - place.y_cm * sin,
        pose.y_cm + place.x_cm * sin + place.y_cm * cos,
    )
    return eye, heading + math.radians(place.heading)


def _idle_reading(device: Device) -> int:
    """Return the reading of a sensor that detects nothing in this world."""
    if device.is_yes_no:
        return 0
    if device.unit == "°C" and device.low <= ROOM_CELSIUS <= device.high:
        return ROOM_CELSIUS
    return round((device.low + device.high) / 2)


def _clamp_to_range(device: Device, value: float) -> int:
    return min(max(round(value), device.low), device.high)
