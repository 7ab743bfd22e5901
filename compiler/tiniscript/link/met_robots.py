"""Remembers which robot of this person has answered where, and which other robots were accepted.

The file is next to that of the keys: whoever answers at a port is compared with it. If it cannot be
read, no robot has been met.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from tiniscript.base import files

FILE_BYTES = 1_000_000
MAX_PLACES = 2000  # places, and robots; the oldest go first
FILE_MODE = 0o600  # readable by this user only


class MetRobots(NamedTuple):
    """`id_by_place` maps each port to the id of the robot that has proved its identity there."""

    id_by_place: dict[str, int]
    accepted_ids: list[int]


def read_met_robots(path: Path) -> MetRobots:
    """Return the content of the file."""
    try:
        fields = json.loads(files.read_limited(path, FILE_BYTES))
        id_by_place = {str(place): int(robot, 16) for place, robot in fields["places"].items()}
        return MetRobots(id_by_place, [int(robot, 16) for robot in fields["accepted"]])
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return MetRobots({}, [])


def remember_robot(path: Path, place: str, robot_id: int) -> None:
    """Remember which robot is at a place. If the file cannot be written, the robot is not
    remembered."""
    if read_met_robots(path).id_by_place.get(place) == robot_id:
        return

    def with_place_added(met_robots: MetRobots) -> MetRobots:
        other_places = {
            value: other for value, other in met_robots.id_by_place.items() if value != place
        }
        return met_robots._replace(id_by_place={**other_places, place: robot_id})

    with suppress(OSError, ValueError):
        _change(path, with_place_added)


def accept(path: Path, robot_id: int) -> None:
    """Remember that a robot may answer where another one did. Raises OSError."""

    def with_robot_accepted(met_robots: MetRobots) -> MetRobots:
        other_places = [other_id for other_id in met_robots.accepted_ids if other_id != robot_id]
        return met_robots._replace(accepted_ids=[*other_places, robot_id])

    _change(path, with_robot_accepted)


def _change(path: Path, change: Callable[[MetRobots], MetRobots]) -> None:
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with files.lock_file(path, FILE_MODE):
        met_robots = change(read_met_robots(path))
        fields = {
            "places": {
                place: f"{robot:08x}"
                for place, robot in list(met_robots.id_by_place.items())[-MAX_PLACES:]
            },
            "accepted": [f"{robot:08x}" for robot in met_robots.accepted_ids[-MAX_PLACES:]],
        }
        files.replace(path, json.dumps(fields, indent=1).encode() + b"\n", FILE_MODE)
