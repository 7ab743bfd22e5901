"""The way of a robot in braille, in a view that grows with it.

Knows the floor that is in view and how it lies on a canvas; where a robot gets to is in
`kinematics`.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10
from typing import NamedTuple

from rich.text import Text

from tiniscript.cli.terminal.canvas import (
    DOTS_PER_COLUMN,
    DOTS_PER_ROW,
    Canvas,
    Dot,
    merge_layers,
    put_letter,
)
from tiniscript.robots.kinematics import START, Pose, Way
from tiniscript.robots.profile import Robot

MAX_CORNERS = 5000  # most points of the path that stay in the picture
WAY_STYLE, ROBOT_STYLE = "cyan", "bold green"
ARROWS = "↑↖←↙↓↘→↗"  # every 45 degrees, counterclockwise from straight ahead
_ROUND_SCALES = (
    1,
    1.5,
    2,
    2.5,
    3,
    4,
    5,
    6,
    8,
    10,
    20,
)  # scales at which the ruler has a round length


def round_scale(cm_per_dot: float) -> float:
    """Return the least scale, not below this one, at which the ruler has a round length."""
    tens = 10.0 ** floor(log10(cm_per_dot))
    return next(scale * tens for scale in _ROUND_SCALES if scale * tens >= cm_per_dot)


class View(NamedTuple):
    """The part of the floor that is drawn: ahead is up. `x_cm` and `y_cm` are its middle."""

    columns: int
    rows: int
    cm_per_dot: float
    x_cm: float
    y_cm: float

    def dot(self, pose: Pose) -> Dot:
        """Return the place of a pose on the canvas."""
        right, down = (self.y_cm - pose.y_cm), (self.x_cm - pose.x_cm)
        return (
            floor(right / self.cm_per_dot + DOTS_PER_COLUMN / 2 * self.columns),
            floor(down / self.cm_per_dot + DOTS_PER_ROW / 2 * self.rows),
        )

    def holds(self, pose: Pose) -> bool:
        right, down = self.dot(pose)
        return 0 <= right < DOTS_PER_COLUMN * self.columns and 0 <= down < DOTS_PER_ROW * self.rows


class Sketch:
    """The way of a robot so far: ahead is up."""

    def __init__(self, robot: Robot) -> None:
        self.way = Way(robot.body)
        self.view: View | None = None
        self.canvas = Canvas(0, 0)  # the way up to its last corner
        self.drawn_corner_count = 0  # corners that `canvas` shows
        length_cm = robot.body.length_cm
        self.seen_bounds_cm = (
            -length_cm,
            length_cm,
            -length_cm,
            length_cm,
        )  # x and y, from and to, in cm

    def set_motors(self, now_ms: float, left: int, right: int) -> None:
        self.way.set_motors(now_ms, left, right)
        if len(self.way.corners) > MAX_CORNERS:
            self.way.thin_out(MAX_CORNERS // 2)
            self.canvas.clear()
            self.drawn_corner_count = 0

    def ruler(self) -> str:
        """Return the length of ten columns."""
        if self.view is None:
            return ""
        cm = 10 * DOTS_PER_COLUMN * self.view.cm_per_dot
        length = f"{cm:g} cm" if cm < 100 else f"{cm / 100:g} m" if cm < 1e5 else f"{cm / 1e5:g} km"
        return f" ├────────┤ {length} "

    def fit_columns(self, most_columns: int, rows: int) -> int:
        """Return the number of columns that the picture needs, at most `most_columns`."""
        return most_columns

    def draw(self, columns: int, rows: int, now_ms: float) -> list[Text]:
        poses_ahead = self.way.points_ahead(now_ms)
        view = self._view(columns, rows, poses_ahead)
        corners = self.way.corners
        self.canvas.draw_lines(map(view.dot, corners[max(0, self.drawn_corner_count - 1) :]))
        self.drawn_corner_count = len(corners)
        full_canvas = self.canvas.copy()
        full_canvas.draw_lines(map(view.dot, [corners[-1], *poses_ahead]))
        lines = merge_layers([(full_canvas, WAY_STYLE)])
        pose_now = self.way.pose(now_ms)
        put_letter(lines, view.dot(START), "o", WAY_STYLE)
        put_letter(lines, view.dot(pose_now), ARROWS[round(pose_now.heading / 45) % 8], ROBOT_STYLE)
        return lines

    def _view(self, columns: int, rows: int, poses_ahead: Sequence[Pose]) -> View:
        """Return the view as it is, or one with more room where the way leaves it."""
        for pose in (*self.way.corners[self.drawn_corner_count :], *poses_ahead):
            low_x, high_x, low_y, high_y = self.seen_bounds_cm
            self.seen_bounds_cm = (min(low_x, pose.x_cm), max(high_x, pose.x_cm),
                         min(low_y, pose.y_cm), max(high_y, pose.y_cm))  # fmt: skip
        low_x, high_x, low_y, high_y = self.seen_bounds_cm
        view = self.view
        if view and (view.columns, view.rows) == (columns, rows) and (
            view.holds(Pose(low_x, low_y, 0)) and view.holds(Pose(high_x, high_y, 0))
        ):  # fmt: skip
            return view
        cm_per_dot = max(
            (high_x - low_x) / (DOTS_PER_ROW * rows - 3),
            (high_y - low_y) / (DOTS_PER_COLUMN * columns - 3),
        )
        if self.view is not None:
            cm_per_dot *= 1.2
        scale = round_scale(cm_per_dot)
        self.view = View(columns, rows, scale, (low_x + high_x) / 2, (low_y + high_y) / 2)
        self.canvas = Canvas(columns, rows)
        self.drawn_corner_count = 0
        return self.view
