"""`tsc monitor --plot`: the values that a robot shows, as a curve that moves with the time.

Drawn below what is printed. Knows values and times; the terminal is known by `screen`.
"""

from __future__ import annotations

import time
from collections import deque

from rich.text import Text

from tiniscript.base.fixed_point import as_text
from tiniscript.cli.terminal import FRAME_S
from tiniscript.cli.terminal.canvas import ACROSS, DOWN, Canvas, layered
from tiniscript.cli.terminal.screen import Screen
from tiniscript.link.outcomes import Event

SECONDS = 30  # from the left edge to the right one
ROWS = 12  # at most
KEPT = 5000  # values, the newest
STEPS = 4  # between the marks of the axis, about


class Board(Screen):
    """The terminal while values come: what is told, and below it the curve."""

    def __init__(self, waiting: str) -> None:
        super().__init__()
        self.plot = Plot(waiting)
        self.drawn_s = 0.0

    def __enter__(self) -> Board:
        self.begin()
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def take(self, time_ms: int, event: Event) -> None:
        if event.name == "SHOW":
            self.plot.take(time_ms, event.value, bool(event.is_yes_no))

    def draw_plot(self, now_ms: int) -> None:
        """Draw the curve as it is now, where the last frame is over."""
        if time.monotonic() - self.drawn_s >= FRAME_S:
            self.drawn_s = time.monotonic()
            self.draw(self.plot, now_ms)


class Plot:
    """`now_ms` is the time of the newest value; `waiting` is said until there is one."""

    def __init__(self, waiting: str = "") -> None:
        self.waiting = waiting
        self.now_ms = 0
        self.values: deque[tuple[int, int]] = deque(maxlen=KEPT)  # when, and thousandths
        self.margin = 0  # columns of the labels

    def take(self, time_ms: int, value: int, is_yes_no: bool) -> None:
        self.now_ms = time_ms
        self.values.append((time_ms, value * 1000 if is_yes_no else value))

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return at most `height` lines of at most `width` columns: a title and the curve."""
        width -= 2  # the ^C of the terminal stands behind the last line
        begin_ms = now_ms - SECONDS * 1000
        while len(self.values) > 1 and self.values[1][0] < begin_ms:
            self.values.popleft()
        known = [value for _, value in self.values]
        low, high, step = scale(min(known, default=0), max(known, default=1000))
        rows = min(ROWS, height - 1)
        ticks = [as_text(value) for value in range(low, high + 1, step)]
        self.margin = max(self.margin, *(len(each) + 1 for each in ticks))  # it never jumps back
        margin = self.margin
        columns = width - margin
        newest = as_text(known[-1]) if known else self.waiting
        title = Text(f"── SHOW {newest} ".ljust(width - 6, "─") + f" {SECONDS} s ", style="dim")
        title.truncate(max(1, width))
        if rows < 2 or columns < 4:
            return [title]
        canvas = self._curve(columns, rows, begin_ms, low, high)
        found = [title]
        marks = {
            round((high - value) / (high - low) * (rows - 1)): as_text(value)
            for value in range(low, high + 1, step)
        }
        for row, curve in enumerate(layered([(canvas, "cyan")])):
            label = marks.get(row, "")
            found.append(Text(f"{label:>{margin - 1}} ", style="dim").append_text(curve))
        return found

    def _curve(self, columns: int, rows: int, begin_ms: float, low: int, high: int) -> Canvas:
        """Return the curve: each value holds until the next one."""
        canvas = Canvas(columns, rows)
        if not self.values:
            return canvas
        right, bottom = ACROSS * columns - 1, DOWN * rows - 1
        before: int | None = None
        ends = [*[time_ms for time_ms, _ in self.values][1:], begin_ms + SECONDS * 1000]
        for (time_ms, value), end_ms in zip(self.values, ends, strict=True):
            x, end = (
                round(min(1.0, max(0.0, (each - begin_ms) / (SECONDS * 1000))) * right)
                for each in (time_ms, end_ms)
            )
            y = round((high - value) / (high - low) * bottom)
            canvas.lines([(x, y if before is None else before), (x, y), (end, y)])
            before = y
        return canvas


def scale(low: int, high: int) -> tuple[int, int, int]:
    """Return an axis around these values: its ends and the distance of its marks, all thousandths.

    Marks are at most STEPS apart in number, at multiples of 1, 2 or 5 times a power of ten.
    """
    if low == high:
        low, high = low - 1000, high + 1000
    step = 1
    while (high - low) > STEPS * step:
        step = step * 5 // 2 if str(step).startswith("2") else step * 2
    return low // step * step, -(-high // step) * step, step
