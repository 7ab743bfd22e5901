"""`tsc monitor --plot`: the values that a robot shows, as curves that move with the time.

There is one for each SHOW of its program, with that SHOW's name. It is drawn below the printed
text. Knows values and times; the terminal is known by `screen`.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from itertools import chain

from rich.text import Text

from tiniscript.base.fixed_point import as_text
from tiniscript.cli.terminal import FRAME_S
from tiniscript.cli.terminal.canvas import DOTS_PER_COLUMN, DOTS_PER_ROW, Canvas, merge_layers
from tiniscript.cli.terminal.screen import Screen
from tiniscript.link.outcomes import Event, ShownEvent

SHOWN_SECONDS = 30  # seconds from the left edge to the right one
MAX_ROWS = 12  # most rows of a plot
MAX_VALUES = 5000  # values of a curve, the newest
STYLES = ("cyan", "magenta", "yellow", "green", "blue", "red")  # one style for each curve
NAMELESS_CURVE = "SHOW"  # the curve of all values without a name
AXIS_STEPS = 4  # between the marks of the axis, about


class PlotScreen(Screen):
    """The terminal while values arrive: messages, with the curves below."""

    def __init__(self, waiting_text: str) -> None:
        super().__init__()
        self.plot = Plot(waiting_text)
        self.drawn_s = 0.0

    def __enter__(self) -> PlotScreen:
        self.begin()
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def add_event(self, time_ms: int, event: Event, name_of: Callable[[ShownEvent], str]) -> None:
        if event.name == "SHOW":
            self.plot.add_value(time_ms, event.value, bool(event.is_yes_no), name_of(event))

    def draw_plot(self, now_ms: int) -> None:
        """Draw the curves as they are now, where the last frame is over."""
        if time.monotonic() - self.drawn_s >= FRAME_S:
            self.drawn_s = time.monotonic()
            self.draw(self.plot, now_ms)


Values = deque[tuple[int, int]]  # time in ms, and thousandths


class Plot:
    """`now_ms` is the time of the newest value; `waiting_text` is said until there is one."""

    def __init__(self, waiting_text: str = "") -> None:
        self.waiting_text = waiting_text
        self.now_ms = 0
        self.values_by_name: dict[str, Values] = {}  # in the order of the first values
        self.style_by_name: dict[str, str] = {}
        self.margin = 0  # columns of the labels

    def add_value(self, time_ms: int, value: int, is_yes_no: bool, name: str = "") -> None:
        self.now_ms = time_ms
        name = name or NAMELESS_CURVE
        if name not in self.values_by_name:
            self._add_curve(name)
        self.values_by_name[name].append((time_ms, value * 1000 if is_yes_no else value))

    def _add_curve(self, name: str) -> None:
        """Begin a curve; where all styles are taken, the one without a value for longest ends."""
        if len(self.values_by_name) == len(STYLES):
            oldest = min(
                self.values_by_name, key=lambda curve_name: self.values_by_name[curve_name][-1][0]
            )
            del self.values_by_name[oldest], self.style_by_name[oldest]
        self.values_by_name[name] = deque(maxlen=MAX_VALUES)
        self.style_by_name[name] = next(
            style for style in STYLES if style not in self.style_by_name.values()
        )

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return at most `height` lines of at most `width` columns: a title and the curves."""
        width -= 2  # the terminal's ^C is after the last line
        begin_ms = now_ms - SHOWN_SECONDS * 1000
        for values in self.values_by_name.values():
            while len(values) > 1 and values[1][0] < begin_ms:
                values.popleft()
        shown_values = [value for _, value in chain.from_iterable(self.values_by_name.values())]
        low, high, step = scale(min(shown_values, default=0), max(shown_values, default=1000))
        rows = min(MAX_ROWS, height - 1)
        ticks = [as_text(value) for value in range(low, high + 1, step)]
        # The margin never shrinks.
        self.margin = max(self.margin, *(len(tick) + 1 for tick in ticks))
        margin = self.margin
        columns = width - margin
        title = self._title(width)
        if rows < 2 or columns < 4:
            return [title]
        canvases = [
            (self._curve(values, columns, rows, begin_ms, low, high), self.style_by_name[name])
            for name, values in self.values_by_name.items()
        ] or [(Canvas(columns, rows), "")]
        lines = [title]
        marks = {
            round((high - value) / (high - low) * (rows - 1)): as_text(value)
            for value in range(low, high + 1, step)
        }
        for row, curve in enumerate(merge_layers(canvases)):
            label = marks.get(row, "")
            lines.append(Text(f"{label:>{margin - 1}} ", style="dim").append_text(curve))
        return lines

    def _title(self, width: int) -> Text:
        """Return the names with their newest values, each in the colour of its curve."""
        title = Text("── ", style="dim")
        for name, values in self.values_by_name.items():
            style = f"not dim {self.style_by_name[name]}" if len(self.values_by_name) > 1 else ""
            title.append(f"{name} {as_text(values[-1][1])}", style).append("  ")
        if self.values_by_name:
            title.right_crop(1)
        else:
            title.append(f"{NAMELESS_CURVE} {self.waiting_text} ")
        end = f" {SHOWN_SECONDS} s "
        title.append("─" * (width - 6 - title.cell_len) + end)
        title.truncate(max(1, width))
        return title

    def _curve(
        self, values: Values, columns: int, rows: int, begin_ms: float, low: int, high: int
    ) -> Canvas:
        """Return a curve: each value holds until the next one."""
        canvas = Canvas(columns, rows)
        right, bottom = DOTS_PER_COLUMN * columns - 1, DOTS_PER_ROW * rows - 1
        last_y: int | None = None
        end_times_ms = [*[time_ms for time_ms, _ in values][1:], begin_ms + SHOWN_SECONDS * 1000]
        for (time_ms, value), end_ms in zip(values, end_times_ms, strict=True):
            x, end_x = (
                round(min(1.0, max(0.0, (instant_ms - begin_ms) / (SHOWN_SECONDS * 1000))) * right)
                for instant_ms in (time_ms, end_ms)
            )
            y = round((high - value) / (high - low) * bottom)
            canvas.draw_lines([(x, y if last_y is None else last_y), (x, y), (end_x, y)])
            last_y = y
        return canvas


def scale(low: int, high: int) -> tuple[int, int, int]:
    """Return an axis around these values: its ends and the distance of its marks, all thousandths.

    Marks are at most STEPS apart in number, at multiples of 1, 2 or 5 times a power of ten.
    """
    if low == high:
        low, high = low - 1000, high + 1000
    step = 1
    while (high - low) > AXIS_STEPS * step:
        step = step * 5 // 2 if str(step).startswith("2") else step * 2
    return low // step * step, -(-high // step) * step, step
