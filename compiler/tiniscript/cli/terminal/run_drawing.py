"""`tsc run --show`: the way and the values of a run, drawn on a terminal as they come.

Knows the terminal, the time that passes in front of it, and braille: a character has 2 x 4 dots.
The picture goes to standard error, the trace to standard output. Knows no programs and no
machine; where a robot gets to is in `kinematics`.
"""

from __future__ import annotations

import os
import sys
import time
from collections import deque
from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import floor, log10
from typing import NamedTuple, Protocol

from rich.console import Console
from rich.control import Control
from rich.live import Live
from rich.segment import ControlType
from rich.text import Text

from tiniscript.cli.texts.common import text
from tiniscript.fixed_point import as_text
from tiniscript.robots.kinematics import START, Pose, Way
from tiniscript.robots.profile import Robot
from tiniscript.vm.trace import Ending, Event

FRAME_S = 1 / 15
SLOWEST_S = 0.2  # a frame that took longer (a long computation, Ctrl-Z) does not skip a move
CORNERS = 5000  # of the way that stay in the picture
SHOWN = 5  # values of SHOW that stay in the picture
BESIDE = 60  # columns from which on the values are beside the way, not below it
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # of U+2800, by row and column
ARROWS = "↑↖←↙↓↘→↗"  # every 45 degrees, counterclockwise from straight ahead
ROUND = (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10)  # scales at which the ruler has a round length
PLAIN = str.maketrans("│─├┤█▌▐♪…↑↖←↙↓↘→↗", "|-||#==~.^\\</v\\>/")


def watch(events: Iterator[Event | Ending], robot: Robot, pace: float, language: str) -> Ending:
    """Print the trace and draw the picture, `pace` times as fast as the robot; return the end.

    With a `pace` of 0 only the last picture is drawn.
    """
    screen = Screen()
    picture = Picture(robot, language)
    now_ms = 0.0
    try:
        if pace:
            screen.begin()
        for event in events:
            if isinstance(event, Ending):
                screen.draw(picture, picture.now_ms)
                return event
            while pace and event.time_ms > now_ms:
                screen.draw(picture, now_ms)
                now_ms += screen.rest() * 1000 * pace
            picture.take(event)
            screen.say(str(event))
            if pace and screen.is_late():
                screen.draw(picture, picture.now_ms)
        raise AssertionError("a run without an ending")
    finally:
        screen.end()


class Drawable(Protocol):
    """A picture: at most `height` lines of at most `width` columns."""

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]: ...


class Screen:
    """The terminal: the trace, and below it the picture."""

    def __init__(self) -> None:
        self.console = Console(stderr=True)
        self.live = Live(console=self.console, auto_refresh=False, redirect_stdout=False,
                         redirect_stderr=False, vertical_overflow="crop")  # fmt: skip
        self.lines: list[str] = []  # of the trace, for the next frame
        self.widths: list[int] = []  # of the lines of the picture
        self.frame_s = time.monotonic()
        # where the trace goes to this very terminal, it has to go around the picture
        self.is_shared = sys.stdout.isatty() and (
            os.fstat(sys.stdout.fileno()).st_rdev == os.fstat(sys.stderr.fileno()).st_rdev
        )

    def begin(self) -> None:
        self.live.start()

    def end(self) -> None:
        try:
            self.flush()
        finally:
            if self.live.is_started:
                try:
                    self.live.stop()
                finally:
                    self.console.show_cursor(True)

    def say(self, line: str) -> None:
        """Print a line of the trace, at the next frame at the latest."""
        if self.is_shared and self.live.is_started:
            self.lines.append(line)
        else:
            sys.stdout.write(f"{line}\n")

    def flush(self) -> None:
        sys.stdout.flush()
        if self.lines:
            said = Text("\n".join(self.lines))
            self.lines = []
            self.console.print(said, soft_wrap=True)

    def rest(self) -> float:
        """Wait for the next frame; return the seconds since the last one."""
        last_s = self.frame_s
        time.sleep(max(0.0, last_s + FRAME_S - time.monotonic()))
        self.frame_s = time.monotonic()
        return min(self.frame_s - last_s, SLOWEST_S)

    def is_late(self) -> bool:
        """Return whether a frame is overdue: much has happened that takes the robot no time."""
        now_s = time.monotonic()
        if now_s - self.frame_s < 2 * FRAME_S:
            return False
        self.frame_s = now_s
        return True

    def draw(self, picture: Drawable, now_ms: float) -> None:
        """Print what was said, and the picture below it."""
        width, height = self.console.size
        lines = picture.lines(width - 1, height - max(3, height // 4), now_ms)
        if not self.console.encoding.startswith("utf"):
            for line in lines:
                line.plain = "".join("*" if "⠀" <= c <= "⣿" else c for c in line.plain)
                line.plain = line.plain.translate(PLAIN)
        drawn = Text("\n", no_wrap=True).join(lines)
        if not self.live.is_started:
            self.flush()
            self.console.print(drawn)
            return
        # A terminal that has become narrower has wrapped the picture; rich does not know it.
        wrapped = sum(max(0, cells - 1) // width for cells in self.widths)
        if wrapped:
            up = (ControlType.ERASE_IN_LINE, 2), (ControlType.CURSOR_UP, 1)
            self.console.control(Control(ControlType.CARRIAGE_RETURN, *up * wrapped))
        self.widths = [line.cell_len for line in lines]
        self.live.update(drawn)
        self.flush()
        self.live.refresh()


class Picture:
    """What is known of a run, as lines of text."""

    def __init__(self, robot: Robot, language: str) -> None:
        self.robot = robot
        self.language = language
        self.labels = robot.labels[language]
        self.sketch = Sketch(robot)
        self.now_ms = 0  # when the newest event was
        self.readings: dict[int, int] = {}
        self.settings: dict[int, int] = {}
        self.shown: deque[str] = deque(maxlen=SHOWN)
        self.hertz, self.silent_ms = 0, 0  # the newest note, and when it ends
        self.ending = ""

    def take(self, event: Event) -> None:
        self.now_ms, what, values, said = event
        if what == "MOTORS":
            self.sketch.set_motors(self.now_ms, *values)
        elif what == "READ":
            self.readings[values[0]] = values[1]
        elif what == "SET":
            self.settings[values[0]] = values[1]
        elif what == "RELEASE":
            self.settings.pop(values[0], None)
        elif what == "SHOW":
            self.shown.append(said.removeprefix("SHOW "))
        elif what == "BEEP":
            self.hertz, self.silent_ms = values[0], self.now_ms + values[1]
        else:
            self.sketch.set_motors(self.now_ms, 0, 0)
            self.ending = text(f"ended_{what}", self.language)
            self.sketch.view = None  # the last picture has no need of room to grow

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return at most `height` lines of at most `width` columns."""
        room = max(1, height - 1)  # below the title
        if width >= BESIDE:
            values_width = min(44, width * 11 // 20)
            values = self._values(values_width, room, now_ms)
            way = self.sketch.drawn(width - values_width - 2, room, now_ms)
            values += [Text()] * (room - len(values))
            for line in way:
                line.align("left", width - values_width)
            below = [line + value for line, value in zip(way, values, strict=True)]
        else:
            values = self._values(width, max(room - 3, min(room, 3)), now_ms)
            rows = room - len(values)
            below = (self.sketch.drawn(width, rows, now_ms) if rows > 1 < width else []) + values
        lines = [self._title(width), *below]
        for line in lines:
            line.rstrip()
            line.truncate(max(1, width), overflow="ellipsis")
        while self.ending and len(lines) > 1 and not lines[-1]:
            lines.pop()
        return lines[: max(1, height)]

    def _title(self, width: int) -> Text:
        ruler = self.sketch.ruler()
        name = f"── {self.labels['robot']} "
        return Text(name + "─" * (width - len(name) - len(ruler)) + ruler, style="dim")

    def _values(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return a line for each: a name, a value with its unit, and what else is to say."""
        language, kit = self.language, self.robot.kit
        left, right = self.sketch.way.left, self.sketch.way.right
        clock = as_text(self.now_ms) if self.ending else f"{now_ms / 1000:.1f}"
        note = f"♪ {self.hertz} Hz" if now_ms < self.silent_ms else ""
        rows = [
            (text("time", language), clock, "s", self.ending or note),
            (text("motor_left", language), str(left), "%", _bar(left)),
            (text("motor_right", language), str(right), "%", _bar(right)),
        ]
        for devices, values in ((kit.sensors, self.readings), (kit.actuators, self.settings)):
            for number in sorted(values):
                name, unit = devices[number].name, devices[number].unit
                rows.append((name, devices[number].text(values[number]), unit, self.labels[name]))
        if self.shown:
            *older, newest = self.shown
            before = text("before", language).format(values=", ".join(reversed(older)))
            rows.append(("SHOW", newest, "", before if older else ""))
        if len(rows) > height:
            rows[1:3] = [(text("motors", language), f"{left} {right}", "%", "")]
        names, numbers, units = (max(len(row[k]) for row in rows) for k in range(3))
        names = min(names, max(6, width // 3))
        lines = []
        for name, value, unit, more in rows[:height]:
            line = Text(name)
            line.truncate(names, overflow="ellipsis", pad=True)
            line.append(f" {value:>{numbers}} ", style="bold")
            line.append(f"{unit:{units}}  ")
            line.append(more, style="" if "│" in more or more is self.ending else "dim")
            line.truncate(width, overflow="ellipsis")
            lines.append(line)
        return lines


def _bar(percent: int) -> str:
    """Return eleven columns: to the right of the line is forward, to the left backward."""
    full, half = divmod(max(1, round(abs(percent) / 10)) if percent else 0, 2)
    if percent < 0:
        return f"{'▐' * half + '█' * full:>5}│     "
    return f"     │{'█' * full + '▌' * half:5}"


class View(NamedTuple):
    """The part of the floor that is drawn: ahead is up. `x_cm` and `y_cm` are its middle."""

    columns: int
    rows: int
    cm_per_dot: float
    x_cm: float
    y_cm: float

    def dot(self, pose: Pose) -> tuple[int, int]:
        """Return the dots from the left and from the top."""
        right, down = (self.y_cm - pose.y_cm), (self.x_cm - pose.x_cm)
        return (
            floor(right / self.cm_per_dot + self.columns),
            floor(down / self.cm_per_dot + 2 * self.rows),
        )

    def holds(self, pose: Pose) -> bool:
        right, down = self.dot(pose)
        return 0 <= right < 2 * self.columns and 0 <= down < 4 * self.rows


class Sketch:
    """The way of the robot in braille, in a view that grows with it."""

    def __init__(self, robot: Robot) -> None:
        self.way = Way(robot.body)
        self.view: View | None = None
        self.cells = bytearray()  # the way up to its last corner
        self.joined = 0  # corners that `cells` shows
        length_cm = robot.body.length_cm
        self.seen = (-length_cm, length_cm, -length_cm, length_cm)  # x and y, from and to, in cm

    def set_motors(self, now_ms: float, left: int, right: int) -> None:
        self.way.set_motors(now_ms, left, right)
        if len(self.way.corners) > CORNERS:
            self.way.thin_out(CORNERS // 2)
            self.cells, self.joined = bytearray(len(self.cells)), 0

    def ruler(self) -> str:
        """Return how long ten columns are."""
        if self.view is None:
            return ""
        cm = 20 * self.view.cm_per_dot
        length = f"{cm:g} cm" if cm < 100 else f"{cm / 100:g} m" if cm < 1e5 else f"{cm / 1e5:g} km"
        return f" ├────────┤ {length} "

    def drawn(self, columns: int, rows: int, now_ms: float) -> list[Text]:
        ahead = self.way.ahead(now_ms)
        view = self._view(columns, rows, ahead)
        corners = self.way.corners
        _join(self.cells, view, corners[max(0, self.joined - 1) :])
        self.joined = len(corners)
        cells = bytearray(self.cells)
        _join(cells, view, [corners[-1], *ahead])
        text_of = [[chr(0x2800 + bits) if bits else " " for bits in cells[k : k + columns]]
                   for k in range(0, columns * rows, columns)]  # fmt: skip
        here = self.way.pose(now_ms)
        marks = [(START, "o"), (here, ARROWS[round(here.heading / 45) % 8])]
        for pose, mark in marks:
            right, down = view.dot(pose)
            text_of[down // 4][right // 2] = mark
        lines = [Text("".join(line), style="cyan") for line in text_of]
        lines[down // 4].stylize("bold green", right // 2, right // 2 + 1)
        return lines

    def _view(self, columns: int, rows: int, ahead: Sequence[Pose]) -> View:
        """Return the view as it is, or one with more room where the way leaves it."""
        for pose in (*self.way.corners[self.joined :], *ahead):
            low_x, high_x, low_y, high_y = self.seen
            self.seen = (min(low_x, pose.x_cm), max(high_x, pose.x_cm),
                         min(low_y, pose.y_cm), max(high_y, pose.y_cm))  # fmt: skip
        low_x, high_x, low_y, high_y = self.seen
        view = self.view
        if view and (view.columns, view.rows) == (columns, rows) and (
            view.holds(Pose(low_x, low_y, 0)) and view.holds(Pose(high_x, high_y, 0))
        ):  # fmt: skip
            return view
        needed = max((high_x - low_x) / (4 * rows - 3), (high_y - low_y) / (2 * columns - 3))
        if self.view is not None:
            needed *= 1.2
        tens = 10.0 ** floor(log10(needed))
        scale = next(each * tens for each in (*ROUND, 20) if each * tens >= needed)
        self.view = View(columns, rows, scale, (low_x + high_x) / 2, (low_y + high_y) / 2)
        self.cells = bytearray(columns * rows)
        self.joined = 0
        return self.view


def _join(cells: bytearray, view: View, corners: Sequence[Pose]) -> None:
    """Draw straight lines from corner to corner."""
    for a, b in pairwise(map(view.dot, corners)):
        steps = max(abs(b[0] - a[0]), abs(b[1] - a[1]), 1)
        for k in range(steps + 1):
            right = a[0] + ((b[0] - a[0]) * k * 2 + steps) // (2 * steps)
            down = a[1] + ((b[1] - a[1]) * k * 2 + steps) // (2 * steps)
            cells[down // 4 * view.columns + right // 2] |= DOTS[down % 4][right % 2]
