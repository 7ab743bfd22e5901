"""The virtual robot on a terminal: its world, its way, and what it senses, does and plays.

Knows the terminal as `drawing` does, and braille. The picture is that of `tsc run --show`, with a
world around it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import floor, log10

from rich.text import Text

from tiniscript.cli.terminal.run_drawing import ARROWS, DOTS, ROUND, Picture, Sketch
from tiniscript.cli.texts.common import text
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.geometry import Point
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.world import World
from tiniscript.vm.trace import Event

WALLS, WAY, LAMP, ROBOT = "", "cyan", "bold yellow", "bold green"


class WorldPicture(Picture):
    """What is known of a virtual robot; `footer` is a line below it."""

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
        found = super().lines(width, height - has_footer, now_ms - self.began_ms)
        if has_footer:
            found.append(Text(self.footer, style="dim"))
            found[-1].truncate(width, overflow="ellipsis")
        return found

    def _title(self, width: int) -> Text:
        found = super()._title(width)
        name = f"── {self.labels['robot']} ── {self.virtual.world.labels[self.language]} "
        if len(name) + len(self.sketch.ruler()) < width:
            found.plain = name + found.plain[len(name) :]
        return found


class WorldSketch(Sketch):
    """The floor in braille: x to the right, y up, all of it."""

    def __init__(self, robot: VirtualRobot) -> None:
        super().__init__(robot.profile)
        self.robot = robot
        self.world = robot.world
        self.floor: Floor | None = None

    def set_motors(self, now_ms: float, left: int, right: int) -> None:
        self.way.left, self.way.right = left, right

    def ruler(self) -> str:
        if self.floor is None:
            return ""
        return f" ├────────┤ {20 * self.floor.cm_per_dot:g} cm "

    def drawn(self, columns: int, rows: int, now_ms: float) -> list[Text]:
        ground = self.floor
        if ground is None or (ground.columns, ground.rows) != (columns, rows):
            ground = self.floor = Floor(self.world, columns, rows)
        driving = self.robot.driving
        pose = self.robot.pose
        way = ground.way(driving.corners, pose)
        hull = bytearray(columns * rows)
        outline = driving.hull.outline(pose, 16)
        ground.join(hull, [*outline, outline[0]])
        lines = []
        for row in range(rows):
            line = Text()
            for k in range(row * columns, (row + 1) * columns):
                bits = ground.walls[k] | way[k] | hull[k]
                style = ROBOT if hull[k] else WAY if way[k] else WALLS
                line.append(chr(0x2800 + bits) if bits else " ", style=style)
            lines.append(line)
        for lamp in self.world.lamps:
            ground.mark(lines, lamp.place, "*", LAMP)
        arrow = ARROWS[round((pose.heading - 90) / 45) % 8]
        ground.mark(lines, pose, arrow, ROBOT)
        return lines


class Floor:
    """A floor on so many characters of a terminal."""

    def __init__(self, world: World, columns: int, rows: int) -> None:
        self.columns, self.rows = columns, rows
        needed = max(
            world.width_cm / max(1, 2 * columns - 1), world.height_cm / max(1, 4 * rows - 1)
        )
        tens = 10.0 ** floor(log10(needed))
        self.cm_per_dot = next(each * tens for each in (*ROUND, 20) if each * tens >= needed)
        self.height_cm = world.height_cm
        self.walls = bytearray(columns * rows)
        self._way = bytearray(columns * rows)
        self._last: Sequence[Pose] = []
        for segment in world.obstacles():
            self.join(self.walls, segment)
        for line in world.lines:
            self.join(self.walls, line.points)

    def dot(self, point: Point | Pose) -> tuple[int, int]:
        """Return the dots from the left and from the top."""
        x, y = point[:2]
        return round(x / self.cm_per_dot), round((self.height_cm - y) / self.cm_per_dot)

    def way(self, corners: Sequence[Pose], pose: Pose) -> bytearray:
        """Return the way up to `pose`; the corners that were there before are drawn already."""
        known = len(self._last)
        if known > 1 and corners[: known - 1] == self._last[: known - 1]:
            self.join(self._way, corners[known - 2 :])
        else:
            self._way = bytearray(len(self._way))
            self.join(self._way, corners)
        self._last = list(corners)
        found = bytearray(self._way)
        self.join(found, [corners[-1], pose])
        return found

    def join(self, cells: bytearray, points: Sequence[Point | Pose]) -> None:
        """Draw straight lines from point to point, as far as they are on the floor."""
        dots = [self.dot(each) for each in points]
        for (ax, ay), (bx, by) in pairwise(dots):
            steps = min(max(abs(bx - ax), abs(by - ay), 1), 10_000)
            for k in range(steps + 1):
                right = ax + ((bx - ax) * k * 2 + steps) // (2 * steps)
                down = ay + ((by - ay) * k * 2 + steps) // (2 * steps)
                if 0 <= right < 2 * self.columns and 0 <= down < 4 * self.rows:
                    place = down // 4 * self.columns + right // 2
                    cells[place] |= DOTS[down % 4][right % 2]

    def mark(self, lines: list[Text], point: Point | Pose, letter: str, style: str) -> None:
        right, down = self.dot(point)
        column, row = right // 2, down // 4
        if 0 <= column < self.columns and 0 <= row < self.rows:
            line = lines[row]
            plain = line.plain
            line.plain = plain[:column] + letter + plain[column + 1 :]
            line.stylize(style, column, column + 1)
