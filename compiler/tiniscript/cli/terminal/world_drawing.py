"""The virtual robot on a terminal: its world, its path, its readings, its actions and its sounds.

Knows the floor of a world and how it lies on a canvas. The picture is that of `tsc run --show`,
with a world around it.
"""

from __future__ import annotations

from collections.abc import Sequence

from rich.text import Text

from tiniscript.base.trace import Event
from tiniscript.cli.terminal.canvas import (
    DOTS_PER_COLUMN,
    DOTS_PER_ROW,
    Canvas,
    Dot,
    merge_layers,
    put_letter,
)
from tiniscript.cli.terminal.run_drawing import Picture
from tiniscript.cli.terminal.sketch import ARROWS, ROBOT_STYLE, WAY_STYLE, Sketch, round_scale
from tiniscript.cli.texts import text
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.geometry import Point
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.world import World

WALL_STYLE, LAMP_STYLE, RIVAL_STYLE = "", "bold yellow", "bold magenta"
RING_CORNERS = 48


class WorldPicture(Picture):
    """The state of a virtual robot; `footer` is a line below it."""

    def __init__(self, robot: VirtualRobot, language: str, footer: str = "") -> None:
        super().__init__(robot.profile, language)
        self.virtual_robot = robot
        self.footer = footer
        self.sketch: WorldSketch = WorldSketch(robot)
        self.began_ms = 0
        self.is_new = True  # no program has run yet

    def add_event(self, event: Event) -> None:
        if event.kind == "START":
            self.began_ms, self.now_ms, self.ending = event.time_ms, 0, ""
            self.is_new = False
            self.shown_values.clear()
            self.value_by_actuator = dict(self.virtual_robot.actuators)
            return
        super().add_event(event._replace(time_ms=event.time_ms - self.began_ms))

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return at most `height` lines of at most `width` columns."""
        robot = self.virtual_robot
        if self.is_new:
            self.ending = text("robot_waits" if robot.is_lit else "robot_empty", self.language)
            self.now_ms = 0
        for number in range(len(robot.profile.kit.sensors)):
            self.value_by_sensor[number] = robot.sensing.peek(number, robot.pose)
        has_footer = bool(self.footer) and height > 4
        lines = super().lines(width, height - has_footer, now_ms - self.began_ms)
        if has_footer:
            lines.append(Text(self.footer, style="dim"))
            lines[-1].truncate(width, overflow="ellipsis")
        return lines

    def _title(self, width: int) -> Text:
        text = super()._title(width)
        name = f"── {self.labels['robot']} ── {self.virtual_robot.world.labels[self.language]} "
        if len(name) + len(self.sketch.ruler()) < width:
            text.plain = name + text.plain[len(name) :]
        return text


class WorldSketch(Sketch):
    """The floor in braille: x to the right, y up, all of it."""

    def __init__(self, robot: VirtualRobot) -> None:
        super().__init__(robot.profile)
        self.robot = robot
        self.world = robot.world
        self.floor: Floor | None = None
        self._fitted_size = (
            0,
            0,
            0,
        )  # former columns and rows, and the columns needed now

    def set_motors(self, now_ms: float, left: int, right: int) -> None:
        self.way.left, self.way.right = left, right

    def ruler(self) -> str:
        if self.floor is None:
            return ""
        return f" ├────────┤ {10 * DOTS_PER_COLUMN * self.floor.cm_per_dot:g} cm "

    def fit_columns(self, most_columns: int, rows: int) -> int:
        """Return the columns that the floor needs; the values are beside it, not at the edge."""
        if self._fitted_size[:2] != (most_columns, rows):
            right, _ = Floor(self.world, most_columns, rows).dot(Point(self.world.width_cm, 0))
            self._fitted_size = most_columns, rows, min(most_columns, right // DOTS_PER_COLUMN + 1)
        return self._fitted_size[2]

    def draw(self, columns: int, rows: int, now_ms: float) -> list[Text]:
        floor = self.floor
        if floor is None or (floor.columns, floor.rows) != (columns, rows):
            floor = self.floor = Floor(self.world, columns, rows)
        driving = self.robot.driving
        pose = self.robot.pose
        hull_canvas = Canvas(columns, rows)
        outline = driving.hull.outline(pose, 16)
        hull_canvas.draw_lines(map(floor.dot, [*outline, outline[0]]))
        rival_canvas = Canvas(columns, rows)
        for segment in driving.other_outlines():
            rival_canvas.draw_lines(map(floor.dot, segment))
        way_canvas = floor.way(driving.corners, pose)
        lines = merge_layers(
            [
                (hull_canvas, ROBOT_STYLE),
                (rival_canvas, RIVAL_STYLE),
                (way_canvas, WAY_STYLE),
                (floor.wall_canvas, WALL_STYLE),
            ]
        )
        for lamp in self.world.lamps:
            put_letter(lines, floor.dot(lamp.place), "*", LAMP_STYLE)
        put_letter(lines, floor.dot(pose), ARROWS[round((pose.heading - 90) / 45) % 8], ROBOT_STYLE)
        return lines


class Floor:
    """A floor on so many characters of a terminal."""

    def __init__(self, world: World, columns: int, rows: int) -> None:
        self.columns, self.rows = columns, rows
        self.cm_per_dot = round_scale(
            max(
                world.width_cm / max(1, DOTS_PER_COLUMN * columns - 1),
                world.height_cm / max(1, DOTS_PER_ROW * rows - 1),
            )
        )
        self.height_cm = world.height_cm
        self.wall_canvas = Canvas(columns, rows)
        self._way_canvas = Canvas(columns, rows)
        self._last_corners: Sequence[Pose] = []
        for segment in world.obstacles():
            self.wall_canvas.draw_lines(map(self.dot, segment))
        for line in world.lines:
            self.wall_canvas.draw_lines(map(self.dot, line.points))
        for ring in world.rings:
            self.wall_canvas.draw_lines(map(self.dot, ring.outline(RING_CORNERS)))

    def dot(self, point: Point | Pose) -> Dot:
        """Return the place of a point on the canvas."""
        x, y = point[:2]
        return round(x / self.cm_per_dot), round((self.height_cm - y) / self.cm_per_dot)

    def way(self, corners: Sequence[Pose], pose: Pose) -> Canvas:
        """Return the way up to `pose`; the corners that were there before are drawn already."""
        drawn_count = len(self._last_corners)
        if drawn_count > 1 and corners[: drawn_count - 1] == self._last_corners[: drawn_count - 1]:
            self._way_canvas.draw_lines(map(self.dot, corners[drawn_count - 2 :]))
        else:
            self._way_canvas.clear()
            self._way_canvas.draw_lines(map(self.dot, corners))
        self._last_corners = list(corners)
        canvas = self._way_canvas.copy()
        canvas.draw_lines(map(self.dot, [corners[-1], pose]))
        return canvas
