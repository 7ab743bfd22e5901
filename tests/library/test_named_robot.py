"""`// robot: liner`: how a program names its robot."""

from __future__ import annotations

import pytest

from tests.support.rows import each_row
from tiniscript.base.source import Source
from tiniscript.library.named_robot import named_robot, rename_robot
from tiniscript.syntax.formatter import format_source

NAMING = [
    "// robot: liner\nSI|F(1, 80)",
    "//robot:liner",
    "// Robot : LINER  \r\nF(1, 80)",
    "\ufeff\n\n  // a title\n\t//\n//// rob\u00f4: liner\r// robot: tinibot\nS",
    "// ROBO\u0302: Liner\nS",
    "// robo: liner\u200b\nS",
]
NAMELESS = [
    "", "S", "// robot:", "// robot: liner, with a hat\nS", "// my robot: liner\nS",
    "// robots: liner\nS", "SI|S // robot: liner", "SI|S\n// robot: liner", ";// robot: liner\nS",
    "/ / robot: liner\nS", "robot: liner", "// // robot: liner\nS",
]  # fmt: skip


@each_row("text", NAMING)
def test_a_comment_before_the_first_instruction_names_it(text: str) -> None:
    name_span = named_robot(text)
    assert name_span is not None
    assert name_span.name.lower() == "liner" and text[slice(*name_span.span)] == name_span.name


@each_row("text", NAMELESS)
def test_any_other_comment_names_no_robot(text: str) -> None:
    assert named_robot(text) is None
    assert rename_robot(text, "grabber") == text


@each_row("text", [text for text in NAMING if "\nS" in text or "\nF" in text])
def test_the_formatter_keeps_the_named_robot(text: str) -> None:
    laid_out = format_source(Source(text.removeprefix("\ufeff")))
    name_span = named_robot(laid_out)
    assert name_span is not None and name_span.name.lower() == "liner"
    assert laid_out == format_source(Source(laid_out))


@pytest.mark.parametrize("text", NAMING)
def test_another_named_robot_replaces_it(text: str) -> None:
    renamed_text = rename_robot(text, "grabber")
    name_span = named_robot(renamed_text)
    assert name_span is not None and name_span.name == "grabber"
    assert renamed_text[: name_span.span.start] + renamed_text[
        name_span.span.end :
    ] == text.replace(text[slice(*_span(text))], "", 1)


def _span(text: str) -> tuple[int, int]:
    name_span = named_robot(text)
    assert name_span is not None
    return name_span.span


def test_a_long_line_is_scanned_once() -> None:
    """No search of this file goes back and forth in a comment."""
    assert named_robot("//" * 100_000 + "robot: x y") is None
    assert named_robot("// robot:" + " " * 200_000 + "a b") is None
    assert named_robot("\n" * 200_000) is None
