"""`tsc run --show`: the way and the values of a run, drawn on a terminal as they come.

It knows what a picture of a run shows, and where. Knows no programs and no machine; the terminal is
known by `screen`, the way by `sketch`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from rich.cells import cell_len, set_cell_size
from rich.text import Text

from tiniscript.base.fixed_point import as_text
from tiniscript.base.kit import REMOTE_SIGNS
from tiniscript.base.trace import Ending, Event
from tiniscript.cli.terminal.screen import Screen
from tiniscript.cli.terminal.sketch import Sketch
from tiniscript.cli.texts import text
from tiniscript.robots.profile import Robot

MAX_SHOWN_VALUES = 5  # values of SHOW that stay in the picture
MAX_VALUE_COLUMNS = 80  # columns of the values, if the path leaves that many
COLUMNS_FOR_VALUES_BESIDE = 60  # columns from which on the values are beside the path, not below it


def watch(events: Iterator[Event | Ending], robot: Robot, pace: float, language: str) -> Ending:
    """Print the trace and draw the picture, `pace` times as fast as the robot; return the end.

    With a `pace` of 0, only the last picture is drawn.
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
                now_ms += screen.wait_for_frame() * 1000 * pace
            picture.add_event(event)
            screen.print_line(str(event))
            if pace and screen.reset_frame_clock_if_late():
                screen.draw(picture, picture.now_ms)
        raise AssertionError("a run without an ending")
    finally:
        screen.end()


class Picture:
    """The state of a run, as lines of text."""

    def __init__(self, robot: Robot, language: str) -> None:
        self.robot = robot
        self.language = language
        self.labels = {**REMOTE_SIGNS, **robot.labels[language]}
        self.sketch = Sketch(robot)
        self.now_ms = 0  # time of the newest event
        self.value_by_sensor: dict[int, int] = {}
        self.value_by_actuator: dict[int, int] = {}
        self.shown_values: deque[str] = deque(maxlen=MAX_SHOWN_VALUES)
        self.hertz, self.silent_ms = 0, 0  # the newest note, and when it ends
        self.ending = ""
        self.column_widths = [0, 0]  # columns of values and units, so far

    def add_event(self, event: Event) -> None:
        self.now_ms, name, values, event_text, _ = event
        if name == "MOTORS":
            self.sketch.set_motors(self.now_ms, *values)
        elif name == "READ":
            self.value_by_sensor[values[0]] = values[1]
        elif name == "SET":
            self.value_by_actuator[values[0]] = values[1]
        elif name == "RELEASE":
            self.value_by_actuator.pop(values[0], None)
        elif name == "SHOW":
            self.shown_values.append(event_text.removeprefix("SHOW "))
        elif name == "BEEP":
            self.hertz, self.silent_ms = values[0], self.now_ms + values[1]
        else:
            self.sketch.set_motors(self.now_ms, 0, 0)
            self.ending = text(f"ended_{name}", self.language)
            self.sketch.view = None  # the last picture has no need of room to grow

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return at most `height` lines of at most `width` columns."""
        room = max(1, height - 1)  # below the title
        if width >= COLUMNS_FOR_VALUES_BESIDE:
            columns = self.sketch.fit_columns(width - min(44, width * 11 // 20) - 2, room)
            value_lines = self._values(min(MAX_VALUE_COLUMNS, width - columns - 2), room, now_ms)
            way_lines = self.sketch.draw(columns, room, now_ms)
            value_lines += [Text()] * (room - len(value_lines))
            for line in way_lines:
                line.align("left", columns + 2)
            lines_below = [line + value for line, value in zip(way_lines, value_lines, strict=True)]
        else:
            value_lines = self._values(width, max(room - 3, min(room, 3)), now_ms)
            rows = room - len(value_lines)
            lines_below = (
                self.sketch.draw(width, rows, now_ms) if rows > 1 < width else []
            ) + value_lines
        lines = [self._title(width), *lines_below]
        for line in lines:
            line.rstrip()
            line.truncate(max(1, width), overflow="ellipsis")
        while self.ending and len(lines) > 1 and not lines[-1]:
            lines.pop()
        return lines[: max(1, height)]

    def _title(self, width: int) -> Text:
        ruler = self.sketch.ruler()
        name = f"── {self.labels['robot']} "
        return Text(name + "─" * (width - cell_len(name) - cell_len(ruler)) + ruler, style="dim")

    def _values(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return a line for each: a name, a value with its unit, and a remark, if any."""
        language, kit = self.language, self.robot.kit
        left, right = self.sketch.way.left, self.sketch.way.right
        clock = as_text(self.now_ms) if self.ending else f"{now_ms / 1000:.1f}"
        note = f"♪ {self.hertz} Hz" if now_ms < self.silent_ms else ""
        rows = [
            (text("time", language), clock, "s", self.ending or note),
            (text("motor_left", language), str(left), "%", _bar(left)),
            (text("motor_right", language), str(right), "%", _bar(right)),
        ]
        for devices, values in (
            (kit.readings, self.value_by_sensor),
            (kit.actuators, self.value_by_actuator),
        ):
            for number in sorted(values):
                name, unit = devices[number].name, devices[number].unit
                rows.append((name, devices[number].text(values[number]), unit, self.labels[name]))
        if self.shown_values:
            *older_values, newest_value = self.shown_values
            older_text = text("before", language).format(values=", ".join(reversed(older_values)))
            rows.append(("SHOW", newest_value, "", older_text if older_values else ""))
        if len(rows) > height:
            rows[1:3] = [(text("motors", language), f"{left} {right}", "%", "")]
        # values have a column that only grows: one that jumps cannot be read
        name_width, *widths = (max(cell_len(row[k]) for row in rows) for k in range(3))
        self.column_widths = [max(pair) for pair in zip(self.column_widths, widths, strict=True)]
        value_width, unit_width = self.column_widths
        name_width = min(name_width, max(6, width // 3))
        lines = []
        for name, value, unit, detail in rows[:height]:
            line = Text(name)
            line.truncate(name_width, overflow="ellipsis", pad=True)
            line.append(f" {value:>{value_width}} ", style="bold")
            line.append(f"{set_cell_size(unit, unit_width)}  ")
            line.append(detail, style="" if "│" in detail or detail is self.ending else "dim")
            line.truncate(width, overflow="ellipsis")
            lines.append(line)
        return lines


def _bar(percent: int) -> str:
    """Return eleven columns: to the right of the line is forward, to the left backward."""
    full_cells, half_cells = divmod(max(1, round(abs(percent) / 10)) if percent else 0, 2)
    if percent < 0:
        return f"{'▐' * half_cells + '█' * full_cells:>5}│     "
    return f"     │{'█' * full_cells + '▌' * half_cells:5}"
