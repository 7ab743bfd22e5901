"""Compares a robot with the shipped ones: which kit is nearest to it, and how they differ."""

from __future__ import annotations

from typing import NamedTuple

from tiniscript import robots
from tiniscript.base.kit import Device, Kit
from tiniscript.robots.profile import Robot


class NearestRobot(NamedTuple):
    """The shipped robot that is nearest. The devices are names, as programs have them.

    `is_same`: the kits are one, so each runs the other's programs.
    """

    name: str
    is_same: bool
    shared_devices: tuple[str, ...]
    devices_only_there: tuple[str, ...]
    devices_only_here: tuple[str, ...]


def nearest_to(robot: Robot) -> NearestRobot:
    """Return the nearest of the shipped robots.

    That is the one with the most devices in common, then with the fewest others, then on the same
    board, then with the same driver of motors; the first of those that are as near.
    """
    own_devices = _devices(robot.kit)

    def distance(other: Robot) -> tuple[int, int, bool, bool]:
        other_devices = _devices(other.kit)
        return (
            -len(own_devices & other_devices),
            len(own_devices ^ other_devices),
            other.board.chip != robot.board.chip,
            other.board.motors.driver != robot.board.motors.driver,
        )

    nearest = min(map(robots.load, robots.names()), key=distance)
    best_devices = _devices(nearest.kit)
    return NearestRobot(
        nearest.name,
        nearest.kit.fingerprint == robot.kit.fingerprint,
        _names(robot.kit, own_devices & best_devices),
        _names(nearest.kit, best_devices - own_devices),
        _names(robot.kit, own_devices - best_devices),
    )


def _devices(kit: Kit) -> set[tuple[bool, Device]]:
    """Return the devices that programs know of a kit, and whether each is a sensor."""
    return {
        (is_sensor, device)
        for is_sensor, devices in ((True, kit.sensors), (False, kit.actuators))
        for device in devices
    }


def _names(kit: Kit, devices: set[tuple[bool, Device]]) -> tuple[str, ...]:
    """Return their names, in the order of the kit."""
    chosen_names = {device.name for _, device in devices}
    return tuple(
        device.name for device in (*kit.sensors, *kit.actuators) if device.name in chosen_names
    )
