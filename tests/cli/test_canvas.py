"""The canvas of dots: where a dot is, what a line is made of, which layer gives the style."""

from __future__ import annotations

import pytest
from rich.text import Text

from tiniscript.cli.commands import wiring
from tiniscript.cli.terminal.canvas import Canvas, layered, put


def plain(canvas: Canvas) -> list[str]:
    return [line.plain for line in layered([(canvas, "")])]


@pytest.mark.parametrize(("dot", "seen"), [
    ((0, 0), "⠁"), ((1, 0), "⠈"), ((0, 1), "⠂"), ((1, 1), "⠐"),
    ((0, 2), "⠄"), ((1, 2), "⠠"), ((0, 3), "⡀"), ((1, 3), "⢀"),
])  # fmt: skip
def test_a_character_has_eight_dots(dot: tuple[int, int], seen: str) -> None:
    canvas = Canvas(1, 1)
    canvas.lines([dot, dot])
    assert plain(canvas) == [seen]


def test_a_line_goes_from_dot_to_dot() -> None:
    canvas = Canvas(3, 2)
    canvas.lines([(0, 0), (5, 0), (5, 7)])
    assert plain(canvas) == ["⠉⠉⢹", "  ⢸"]


def test_what_lies_outside_is_not_drawn() -> None:
    canvas = Canvas(2, 1)
    canvas.lines([(-9, 1), (90, 1)])
    canvas.lines([(0, -5), (0, -1)])
    canvas.lines([(0, 4), (3, 9)])
    assert plain(canvas) == ["⠒⠒"]


def test_a_line_that_is_too_long_to_be_drawn_whole_ends_soon() -> None:
    canvas = Canvas(2, 1)
    canvas.lines([(0, 0), (10**12, 0)])
    assert plain(canvas) == ["⠁ "]


def test_a_copy_is_another_canvas() -> None:
    canvas = Canvas(1, 1)
    copied = canvas.copy()
    copied.lines([(0, 0), (0, 0)])
    assert plain(canvas) == [" "]
    copied.clear()
    assert plain(copied) == [" "]


def test_a_character_has_the_dots_of_all_layers_and_the_style_of_the_topmost() -> None:
    top, below = Canvas(3, 1), Canvas(3, 1)
    top.lines([(0, 0), (0, 0)])
    below.lines([(0, 3), (3, 3)])
    [line] = layered([(top, "red"), (below, "blue")])
    assert line.plain == "⣁⣀ "
    assert [(span.start, span.end, span.style) for span in line.spans] == [
        (0, 1, "red"), (1, 2, "blue"),
    ]  # fmt: skip


def test_a_letter_takes_the_place_of_the_character_that_a_dot_lies_in() -> None:
    lines = [Text("abc"), Text("def")]
    put(lines, (3, 5), "X", "bold")
    for dot in ((-1, 0), (0, -1), (6, 0), (0, 8)):
        put(lines, dot, "X")
    assert [line.plain for line in lines] == ["abc", "dXf"]


def test_a_table_is_straight_with_letters_that_take_two_columns(
    capsys: pytest.CaptureFixture[str],
) -> None:
    wiring._print_rows([("左モーター", "D5", "a"), ("motor", "D6", "b")])
    assert capsys.readouterr().out == "左モーター  D5  a\nmotor       D6  b\n"
