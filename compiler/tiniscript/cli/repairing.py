"""Repairs of a program's file: which text it gets, and how the change is shown.

Knows bytes, lines and colors. `diagnostics.fixing` decides which mistakes are repaired.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from difflib import unified_diff
from typing import NamedTuple

from tiniscript.base.source import printable
from tiniscript.cli import compilations
from tiniscript.cli.inputs import Input
from tiniscript.cli.streams import has_colors
from tiniscript.diagnostics.fixing import repair_program
from tiniscript.library.compiling import Compilation, text_of
from tiniscript.robots.profile import Robot

_BOM = b"\xef\xbb\xbf"
_COLORS = {"+": "\033[32m", "-": "\033[31m", "@": "\033[36m"}
_RESET = "\033[0m"


class RepairedProgram(NamedTuple):
    """A program with its certain repairs: the file's bytes, their number, and the remaining
    mistakes.
    """

    data: bytes
    repair_count: int
    compilation: Compilation


def repair(program_input: Input, robot: Robot) -> RepairedProgram:
    """Return a program with its sure repairs; bytes that are no program stay as they are."""
    text = text_of(program_input.data, program_input.name)
    if not isinstance(text, str):
        return RepairedProgram(program_input.data, 0, text)

    def compile_data(data: bytes) -> Compilation:
        return compilations.compile_input(program_input._replace(data=data), robot, is_strict=False)

    repaired_program = repair_program(
        text, lambda new_text: compile_data(new_text.encode()).diagnostics
    )
    new_data = repaired_program.text.encode()
    if program_input.data.startswith(_BOM):
        new_data = _BOM + new_data
    return RepairedProgram(new_data, repaired_program.repair_count, compile_data(new_data))


def print_difference(old_data: bytes, new_data: bytes, name: str) -> None:
    """Print the differences between two texts, as `diff -u` does; on a terminal in colors."""
    has_color = has_colors(sys.stdout)
    for line in _difference(old_data.decode(), new_data.decode(), printable(name)):
        color_code = (
            _COLORS.get(line[:1], "") if has_color and line[:3] not in ("+++", "---") else ""
        )
        print(color_code + line + (_RESET if color_code else ""))


def _difference(old_text: str, new_text: str, name: str) -> Iterator[str]:
    rows = unified_diff(_rows(old_text), _rows(new_text), name, name, lineterm="", n=2)
    for k, row in enumerate(rows):
        yield row if k < 2 else printable(row[:1] + row[1:].replace("\t", "    "))


def _rows(text: str) -> list[str]:
    """Return the lines of a text as the compiler counts them."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
