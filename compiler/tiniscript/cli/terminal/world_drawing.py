"""The virtual robot on a terminal: its world, its way, and what it senses, does and plays.

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
from tiniscript.cli.terminal.sketch import ARROWS, ROBOT, WAY, Sketch, round_scale
from tiniscript.cli.texts import text
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.geometry import Point
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.world import World

WALLS, LAMP, RIVAL = "", "bold yellow", "bold magenta"
RING_CORNERS = 48


class WorldPicture(Picture):
    """The state of a virtual robot; `footer` is a line below it."""

    def __init__(self, robot: VirtualRobot, language: str, footer: str = "") -> None:
        super().__init__(robot.profile, language)
        self.virtual = robot
        self.footer = footer
        self.sketch: WorldSketch = WorldSketch(robot)
        self.began_ms = 0
        self.is_new = True  # nothing has run yet

    def take(self, event: Event) -> None:
        if event.what == "START":
            self.began_ms, self.now_ms, self.ending = event.time_ms, 0, ""
            self.is_new = False
            self.shown.clear()
            self.settings = dict(self.virtual.actuators)
            return
        super().take(event._replace(time_ms=event.time_ms - self.began_ms))

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return at most `height` lines of at most `width` columns."""
        robot = self.virtual
        if self.is_new:
            self.ending = text("robot_waits" if robot.is_lit else "robot_empty", self.language)
            self.now_ms = 0
        for number in range(len(robot.profile.kit.sensors)):
            self.readings[number] = robot.sensing.look(number, robot.pose)
        has_footer = bool(self.footer) and height > 4
        lines = super().lines(width, height - has_footer, now_ms - self.began_ms)
        if has_footer:
            lines.append(Text(self.footer, style="dim"))
            lines[-1].truncate(width, overflow="ellipsis")
        return lines

    def _title(self, width: int) -> Text:
        text = super()._title(width)
        name = f"── {self.labels['robot']} ── {self.virtual.world.labels[self.language]} "
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
        self._room = (0, 0, 0)  # columns and rows that there were, and the columns that it takes

    def set_motors(self, now_ms: float, left: int, right: int) -> None:
        self.way.left, self.way.right = left, right

    def ruler(self) -> str:
        if self.floor is None:
            return ""
        return f" ├────────┤ {10 * DOTS_PER_COLUMN * self.floor.cm_per_dot:g} cm "

    def columns(self, most_columns: int, rows: int) -> int:
        """Return how many columns the floor takes; the values are beside it, not at the edge."""
        if self._room[:2] != (most_columns, rows):
            right, _ = Floor(self.world, most_columns, rows).dot(Point(self.world.width_cm, 0))
            self._room = most_columns, rows, min(most_columns, right // DOTS_PER_COLUMN + 1)
        return self._room[2]

    def draw(self, columns: int, rows: int, now_ms: float) -> list[Text]:
        ground = self.floor
        if ground is None or (ground.columns, ground.rows) != (columns, rows):
            ground = self.floor = Floor(self.world, columns, rows)
        driving = self.robot.driving
        pose = self.robot.pose
        hull = Canvas(columns, rows)
        outline = driving.hull.outline(pose, 16)
        hull.lines(map(ground.dot, [*outline, outline[0]]))
        rivals = Canvas(columns, rows)
        for segment in driving.others():
            rivals.lines(map(ground.dot, segment))
        way = ground.way(driving.corners, pose)
        lines = merge_layers([(hull, ROBOT), (rivals, RIVAL), (way, WAY), (ground.walls, WALLS)])
        for lamp in self.world.lamps:
            put_letter(lines, ground.dot(lamp.place), "*", LAMP)
        put_letter(lines, ground.dot(pose), ARROWS[round((pose.heading - 90) / 45) % 8], ROBOT)
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
        self.walls = Canvas(columns, rows)
        self._way = Canvas(columns, rows)
        self._last: Sequence[Pose] = []
        for segment in world.obstacles():
            self.walls.lines(map(self.dot, segment))
        for line in world.lines:
            self.walls.lines(map(self.dot, line.points))
        for ring in world.rings:
            self.walls.lines(map(self.dot, ring.outline(RING_CORNERS)))

    def dot(self, point: Point | Pose) -> Dot:
        """Return where a place lies on the canvas."""
        x, y = point[:2]
        return round(x / self.cm_per_dot), round((self.height_cm - y) / self.cm_per_dot)

    def way(self, corners: Sequence[Pose], pose: Pose) -> Canvas:
        """Return the way up to `pose`; the corners that were there before are drawn already."""
        drawn_count = len(self._last)
        if drawn_count > 1 and corners[: drawn_count - 1] == self._last[: drawn_count - 1]:
            self._way.lines(map(self.dot, corners[drawn_count - 2 :]))
        else:
            self._way.clear()
            self._way.lines(map(self.dot, corners))
        self._last = list(corners)
        canvas = self._way.copy()
        canvas.lines(map(self.dot, [corners[-1], pose]))
        return canvas
