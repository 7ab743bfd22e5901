"""Many robots on the terminal: a line for each, with what it does now."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence

from rich.cells import cell_len, set_cell_size
from rich.text import Text

from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.member import Member
from tiniscript.cli.terminal.screen import Screen
from tiniscript.cli.texts import text

STYLES = {"": "", "ok": "green", "bad": "red", "absent": "dim"}


class FleetTable:
    """The terminal while robots work: the table, with messages above it."""

    def __init__(self, members: Sequence[Member], language: str) -> None:
        self.members = members
        self.language = language
        self.screen = Screen()
        self.column_widths = [0, 0]  # columns of names and ports, so far

    def __enter__(self) -> FleetTable:
        self.screen.begin()
        return self

    def __exit__(self, *_: object) -> None:
        self.screen.end()

    def print_line(self, line: str) -> None:
        self.screen.print_line(line)

    def end(self, rows: Iterable[str]) -> None:
        """Leave plain rows in place of the table."""
        self.members = []
        self.draw()
        self.screen.end()
        for row in rows:
            self.screen.print_line(row)

    def draw(self) -> None:
        """Wait for the next frame, and draw it."""
        self.screen.wait_for_frame()
        self.screen.draw(self, time.monotonic() * 1000)

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]:
        """Return at most `height` lines; if not all fit, the unfinished ones come first."""
        if not self.members:
            return []
        done_count = sum(member.result is not None for member in self.members)
        title = text("crew_title", self.language).format(over=done_count, all=len(self.members))
        lines = [Text(f"── {title} ".ljust(width, "─"), style="dim")]
        rows = list(self.members)
        hidden_count = 0
        if len(rows) > height - 1:
            rows.sort(key=lambda member: member.mark == "ok")  # the others stay in their order
            hidden_count = len(rows) - max(0, height - 2)
            rows = rows[: len(rows) - hidden_count]
        # Widths include hidden rows, so that columns do not jump when other rows are shown.
        self.column_widths = [
            max(old_width, *map(cell_len, column))
            for old_width, column in zip(self.column_widths, _columns(self.members), strict=True)
        ]
        widths = self.column_widths
        for member, name, port in zip(rows, *_columns(rows), strict=True):
            line = Text(f"{set_cell_size(name, widths[0])}  {set_cell_size(port, widths[1])}  ")
            line.append(member.state_text(self.language), style=STYLES[member.mark])
            lines.append(line)
        if hidden_count:
            hidden_text = text("crew_more", self.language).format(n=hidden_count)
            lines.append(Text(hidden_text, style="dim"))
        for line in lines:
            line.truncate(max(1, width), overflow="ellipsis")
        return lines[: max(1, height)]


def _columns(members: Sequence[Member]) -> tuple[list[str], list[str]]:
    """Return names and ports."""
    names = [printable_name(member.name or "?") for member in members]
    return names, [printable_name(member.target.port) for member in members]
