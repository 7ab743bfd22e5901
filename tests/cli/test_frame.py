"""A picture on a terminal: it is right, and only changes are written."""

from __future__ import annotations

import io
import random

import pyte
import pytest
from rich.console import Console
from rich.text import Text

from tiniscript.cli.commands import firmware_wiring
from tiniscript.cli.terminal.canvas import Canvas, merge_layers, put_letter
from tiniscript.cli.terminal.plot import MAX_ROWS, Plot, scale
from tiniscript.cli.terminal.run_drawing import Picture
from tiniscript.cli.terminal.screen import BEGIN_UPDATE, END_UPDATE, Frame

COLUMNS, LINES = 40, 12
SIGNS = ["a", "b", "─", "⣿", " ", "ñ", "漢"]
STYLES = ["", "red", "bold", "dim"]


class Terminal:
    """A terminal that reads what a frame writes."""

    def __init__(self, columns: int = COLUMNS) -> None:
        self.output = io.StringIO()
        self.console = Console(
            file=self.output, force_terminal=True, width=columns, height=LINES,
            color_system="standard", legacy_windows=False,
        )  # fmt: skip
        self.frame = Frame(self.console)
        self.screen = pyte.HistoryScreen(columns, LINES, history=10_000)
        self.stream = pyte.Stream(self.screen)

    def draw(self, lines: list[Text], text_above: str = "") -> str:
        """Draw it; return the output."""
        self.output.seek(0)
        self.output.truncate()
        self.frame.draw(lines, text_above)
        output = self.output.getvalue()
        self.stream.feed(output.replace("\n", "\r\n"))  # line ends as a terminal writes them
        return output

    def all_lines(self) -> list[str]:
        """All lines, with those that have scrolled away."""
        rows = [*self.screen.history.top, *(self.screen.buffer[k] for k in range(LINES))]
        column_count = self.screen.columns
        return ["".join(row[k].data for k in range(column_count)).rstrip() for row in rows]


def line(rng: random.Random) -> Text:
    text = Text()
    while text.cell_len < rng.randrange(COLUMNS - 2):
        text.append(rng.choice(SIGNS), style=rng.choice(STYLES))
    text.rstrip()
    return text


@pytest.mark.parametrize("seed", range(40))
def test_the_terminal_shows_the_last_picture_below_all_printed_lines(seed: int) -> None:
    """Includes lines that appear, vanish and change, and lines printed above."""
    rng = random.Random(seed)
    terminal = Terminal()
    lines_above: list[str] = []
    lines = [line(rng) for _ in range(5)]
    for number in range(30):
        lines = [text.copy() for text in lines]
        for k in range(len(lines)):
            if rng.random() < 0.3:
                lines[k] = line(rng)
        if rng.random() < 0.2:
            lines = lines[: rng.randrange(len(lines) + 1)]
        if rng.random() < 0.2 and len(lines) < LINES - 4:
            lines.append(line(rng))
        text_above = f"said {number}" if rng.random() < 0.3 else ""
        lines_above += [text_above] if text_above else []
        terminal.draw(lines, text_above)
        expected = [*lines_above, *(text.plain for text in lines)]
        shown_lines = terminal.all_lines()
        assert shown_lines[: len(expected)] == expected
        assert not any(shown_lines[len(expected) :])


def test_unchanged_parts_are_not_rewritten() -> None:
    terminal = Terminal()
    lines = [Text("one"), Text("two", style="red")]
    assert terminal.draw(lines)
    assert terminal.draw([text.copy() for text in lines]) == ""


def test_an_unchanged_line_is_not_rewritten() -> None:
    terminal = Terminal()
    lines = [Text(f"value {k}") for k in range(8)]
    terminal.draw(lines)
    lines[3] = Text("other")
    output = terminal.draw(lines)
    assert output.startswith(BEGIN_UPDATE) and output.endswith(END_UPDATE)
    assert "other" in output and "value" not in output
    assert [line for line in terminal.all_lines() if line] == [text.plain for text in lines]


@pytest.mark.parametrize("rows", [1, 3, 4, 5, 30])
def test_long_rows_and_many_rows_are_printed_in_full(rows: int) -> None:
    """A row that wraps, and more rows than there is room for above the picture."""
    terminal = Terminal()
    lines = [Text(f"value {k}") for k in range(8)]
    terminal.draw(lines)
    long_text = "\n".join(f"row {k}" for k in range(rows))
    terminal.draw(lines, long_text)
    terminal.draw(lines, "x" * COLUMNS * 2)
    terminal.draw(lines, "y" * (COLUMNS - 1))
    expected = [*long_text.split("\n"), "x" * COLUMNS, "x" * COLUMNS, "y" * (COLUMNS - 1)]
    expected += [text.plain for text in lines]
    assert [line for line in terminal.all_lines() if line] == expected


def test_a_different_colour_is_a_change() -> None:
    terminal = Terminal()
    terminal.draw([Text("stop", style="green"), Text("x")])
    terminal.draw([Text("stop", style="red"), Text("x")])
    assert terminal.screen.buffer[0][0].fg == "red"


def test_a_terminal_that_becomes_wider_or_narrower_gets_all_of_it() -> None:
    terminal = Terminal()
    terminal.draw([Text("a" * 30), Text("b")])
    for columns in (60, 34):
        terminal.console.width = columns
        terminal.screen.resize(LINES, columns)
        output = terminal.draw([Text("a" * 30), Text("b")])
        assert "a" * 30 in output
        assert [line for line in terminal.all_lines() if line] == ["a" * 30, "b"]


# -- the curve of tsc monitor --plot


@pytest.mark.parametrize(
    ("low", "high"),
    [(0, 1000), (3_000, 97_000), (412_000, 419_000), (-5000, 5000), (7, 7), (0, 1), (-9, 10**9)],
)
def test_an_axis_has_round_marks_around_the_values(low: int, high: int) -> None:
    low_end, end, step = scale(low, high)
    assert low_end <= low and end >= high
    assert low_end % step == 0 and end % step == 0
    digits = str(step).rstrip("0")
    assert digits in ("1", "2", "5"), step
    assert 1 <= (end - low_end) // step <= 6


def test_a_small_change_of_the_values_does_not_move_the_axis() -> None:
    plot = Plot()
    plot.add_value(0, 0, False)
    plot.add_value(100, 97_300, False)
    lines_before = plot.lines(80, 20, 200)
    plot.add_value(200, 98_900, False)
    lines_after = plot.lines(80, 20, 300)
    assert [text.plain[:8] for text in lines_before[1:]] == [
        text.plain[:8] for text in lines_after[1:]
    ]
    assert len(lines_after) <= MAX_ROWS + 1
    assert sum(bool(text.plain[:5].strip()) for text in lines_after[1:]) >= 3, "marks"


def test_columns_of_values_only_grow() -> None:
    from tiniscript import robots
    from tiniscript.base.trace import Event

    picture = Picture(robots.load("tinibot"), "en")
    places = []
    for k, value in enumerate((5, 400, 7)):
        picture.add_event(Event(k * 100, "READ", (2, value * 1000), ""))
        row = next(text for text in picture.lines(100, 20, k * 100) if "DISTANCE" in text.plain)
        places.append(row.plain.index(" cm"))
    assert places[0] <= places[1] == places[2]


# -- the canvas of dots ---------------------------------------------------------------------------


def plain(canvas: Canvas) -> list[str]:
    return [line.plain for line in merge_layers([(canvas, "")])]


@pytest.mark.parametrize(("dot", "expected"), [
    ((0, 0), "⠁"), ((1, 0), "⠈"), ((0, 1), "⠂"), ((1, 1), "⠐"),
    ((0, 2), "⠄"), ((1, 2), "⠠"), ((0, 3), "⡀"), ((1, 3), "⢀"),
])  # fmt: skip
def test_a_character_has_eight_dots(dot: tuple[int, int], expected: str) -> None:
    canvas = Canvas(1, 1)
    canvas.draw_lines([dot, dot])
    assert plain(canvas) == [expected]


def test_a_line_goes_from_dot_to_dot() -> None:
    canvas = Canvas(3, 2)
    canvas.draw_lines([(0, 0), (5, 0), (5, 7)])
    assert plain(canvas) == ["⠉⠉⢹", "  ⢸"]


def test_points_outside_the_canvas_are_not_drawn() -> None:
    canvas = Canvas(2, 1)
    canvas.draw_lines([(-9, 1), (90, 1)])
    canvas.draw_lines([(0, -5), (0, -1)])
    canvas.draw_lines([(0, 4), (3, 9)])
    assert plain(canvas) == ["⠒⠒"]


def test_an_overlong_line_is_clipped_quickly() -> None:
    canvas = Canvas(2, 1)
    canvas.draw_lines([(0, 0), (10**12, 0)])
    assert plain(canvas) == ["⠁ "]


def test_a_copy_is_independent_of_its_canvas() -> None:
    canvas = Canvas(1, 1)
    copied_canvas = canvas.copy()
    copied_canvas.draw_lines([(0, 0), (0, 0)])
    assert plain(canvas) == [" "]
    copied_canvas.clear()
    assert plain(copied_canvas) == [" "]


def test_a_character_has_the_dots_of_all_layers_and_the_style_of_the_topmost() -> None:
    top, lower_canvas = Canvas(3, 1), Canvas(3, 1)
    top.draw_lines([(0, 0), (0, 0)])
    lower_canvas.draw_lines([(0, 3), (3, 3)])
    [line] = merge_layers([(top, "red"), (lower_canvas, "blue")])
    assert line.plain == "⣁⣀ "
    assert [(span.start, span.end, span.style) for span in line.spans] == [
        (0, 1, "red"), (1, 2, "blue"),
    ]  # fmt: skip


def test_a_letter_replaces_the_character_that_contains_its_dot() -> None:
    lines = [Text("abc"), Text("def")]
    put_letter(lines, (3, 5), "X", "bold")
    for dot in ((-1, 0), (0, -1), (6, 0), (0, 8)):
        put_letter(lines, dot, "X")
    assert [line.plain for line in lines] == ["abc", "dXf"]


def test_a_table_stays_aligned_with_wide_characters(
    capsys: pytest.CaptureFixture[str],
) -> None:
    firmware_wiring._print_rows([("左モーター", "D5", "a"), ("motor", "D6", "b")])
    assert capsys.readouterr().out == "左モーター  D5  a\nmotor       D6  b\n"
