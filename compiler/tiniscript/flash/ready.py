"""The firmware that the package brings: a file for each robot on each board that it fits.

`tools/build_firmware.py` makes them. A package that was made without them has none.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).resolve().parent / "ready"
NOTICE = "NOTICE.txt"
DATA = "00"  # in the row of a HEX file
BUILD_COMMAND = "python tools/build_firmware.py"


class Ready(NamedTuple):
    """A firmware: an Intel HEX file."""

    robot: str
    board: str
    path: Path

    @property
    def bytes(self) -> int:
        """How many it puts into the flash."""
        rows = self.path.read_text(encoding="ascii").splitlines()
        return sum(int(row[1:3], 16) for row in rows if row[7:9] == DATA)


def name_of(robot: str, board: str) -> str:
    return f"{robot}-{board}.hex"


def files(folder: Path = FOLDER) -> list[Ready]:
    """Return what the package brings, by robot and board."""
    found = []
    for path in sorted(folder.glob("*-*.hex")):
        robot, _, board = path.stem.rpartition("-")
        found.append(Ready(robot, board, path))
    return found
