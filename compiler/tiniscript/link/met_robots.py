"""Which robot of this person has answered where, and which other robots the person has accepted.

The file lies beside that of the keys: whoever answers at a port is compared with it. Where it
cannot be read nobody has been met.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from tiniscript.base import files

FILE_BYTES = 1_000_000
MOST_PLACES = 2000  # places, and robots; the oldest go first
FILE_MODE = 0o600  # only this person reads it


class MetRobots(NamedTuple):
    """`places` maps each port to the id of the robot that has proved there who it is."""

    places: dict[str, int]
    accepted: list[int]


def read_met_robots(path: Path) -> MetRobots:
    """Return what is in the file."""
    try:
        fields = json.loads(files.read_limited(path, FILE_BYTES))
        places = {str(place): int(robot, 16) for place, robot in fields["places"].items()}
        return MetRobots(places, [int(robot, 16) for robot in fields["accepted"]])
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return MetRobots({}, [])


def meet(path: Path, place: str, robot: int) -> None:
    """Remember which robot is at a place. Where the file cannot be written it is not remembered."""
    if read_met_robots(path).places.get(place) == robot:
        return

    def with_place_added(before: MetRobots) -> MetRobots:
        others = {value: other for value, other in before.places.items() if value != place}
        return before._replace(places={**others, place: robot})

    with suppress(OSError, ValueError):
        _change(path, with_place_added)


def accept(path: Path, robot: int) -> None:
    """Remember that a robot may answer where another one did. Raises OSError."""

    def with_robot_accepted(before: MetRobots) -> MetRobots:
        others = [item for item in before.accepted if item != robot]
        return before._replace(accepted=[*others, robot])

    _change(path, with_robot_accepted)


def _change(path: Path, change: Callable[[MetRobots], MetRobots]) -> None:
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with files.lock_file(path, FILE_MODE):
        now = change(read_met_robots(path))
        fields = {
            "places": {
                place: f"{robot:08x}" for place, robot in list(now.places.items())[-MOST_PLACES:]
            },
            "accepted": [f"{robot:08x}" for robot in now.accepted[-MOST_PLACES:]],
        }
        files.replace(path, json.dumps(fields, indent=1).encode() + b"\n", FILE_MODE)
