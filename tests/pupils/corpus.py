"""Wrong programs as pupils write them, and their messages.

They are in `en.txt`, `es.txt` and `pt.txt`, by the language of their words; those with words of
TiniScript alone are in `en.txt`. Below a program stands a row for each message,
`> 1 TS012 F(1.5, 80)`: its line, its code and what to try, in Spanish. After `>=` that is what
`tsc check --fix` makes of the line, or of the part of it that is named: `>= 1 TS036 SI|  for  SI-`.
`=3 F(1, 80)` is another line that it changes; where it changes how many lines there are, all that
it makes stands there, each line after a `=`. None has spaces at its end. A program of which
nothing is said has a `>` alone below it; so has a new one until `--accept` writes what is said.

Where its writer said it, `>? forward for two seconds` is what a program was to do, `>! F(2, 80)`
what is written for that in TiniScript. `cover.txt` names the programs that each commit is tested
with: `cover.py` says how they are chosen.
"""

from __future__ import annotations

import re
from functools import cache, lru_cache
from pathlib import Path
from typing import NamedTuple

from tiniscript import robots
from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import repair_program
from tiniscript.diagnostics.rendering import message
from tiniscript.library.compiling import compile_source

FOLDER = Path(__file__).parent
LANGUAGES = ("en", "es", "pt")
INTENT_PREFIX, INTENDED_PROGRAM_PREFIX = ">? ", ">! "
PLACE_SEPARATOR = "  for  "
PART = re.compile(r"((?:(?![>=]).*\n)+)((?:>.*\n)*)((?:=.*\n)*)")


class Entry(NamedTuple):
    """`language` names the file that has the program; `asides` are the rows of what was meant."""

    language: str
    program: str
    messages: tuple[str, ...]
    mended: str | None
    asides: tuple[str, ...] = ()


@cache
def entries() -> tuple[Entry, ...]:
    entries = []
    for language in LANGUAGES:
        for part in PART.findall((FOLDER / f"{language}.txt").read_text(encoding="utf-8")):
            program, rows, changed_rows = (rows.split("\n")[:-1] for rows in part)
            asides = tuple(
                row for row in rows if row.startswith((INTENT_PREFIX, INTENDED_PROGRAM_PREFIX))
            )
            message_rows = [row for row in rows if row not in asides]
            messages = tuple(
                row.partition(" ")[2].partition(PLACE_SEPARATOR)[0]
                for row in message_rows
                if row != ">"
            )
            mended_text = _mend(program, message_rows, changed_rows)
            entries.append(Entry(language, "\n".join(program), messages, mended_text, asides))
    return tuple(entries)


def _mend(program: list[str], messages: list[str], changed_lines: list[str]) -> str | None:
    """Return the program that results from the rows below it, or None if they change nothing."""
    if changed_lines and not changed_lines[0][1:2].isdigit():
        return "\n".join(row[1:].removeprefix(" ") for row in changed_lines)
    lines = [line.rstrip() for line in program]
    rows = [row[1:].split(" ", 1) for row in changed_lines]
    for row in messages:
        if row.startswith(">="):
            number, _, fix = row[3:].split(" ", 2)
            line = program[int(number) - 1]
            fix, _, part = fix.partition(PLACE_SEPARATOR)
            rows.append([number, line.replace(part, fix, 1) if part else _indent(line) + fix])
    for number, *text in rows:
        lines[int(number) - 1] = "".join(text)
    return "\n".join(lines) if rows else None


def _part(line: str, fix: str, new_line: str) -> str:
    """Return the part of a line that `fix` replaces to get the new line, or an empty text."""
    for start in range(len(line)):
        if new_line.startswith(line[:start] + fix):
            rest = len(new_line) - start - len(fix)
            part = line[start : len(line) - rest]
            is_plain = part == part.strip() and PLACE_SEPARATOR not in part
            if part and is_plain and line.replace(part, fix, 1) == new_line:
                return part
    return ""


def _indent(line: str) -> str:
    return line[: len(line) - len(line.lstrip())]


@lru_cache(maxsize=10_000)
def check(text: str) -> list[Diagnostic]:
    """Return the diagnostics of a program, in a shared list that must not be changed."""
    robot = robots.load(robots.DEFAULT)
    return compile_source(text.encode(), robot, "prog.ts", is_strict=False).diagnostics


def current_entry(entry: Entry) -> Entry:
    """Return the current messages of a program, and its repaired text."""
    program = entry.program
    diagnostics = check(program)
    source = Source(program)
    messages = [message(diagnostic, source, "es") for diagnostic in diagnostics]
    mended_text = repair_program(program, check).text
    rows_of_messages = tuple(
        f"{message.line} {message.code} {message.fix}".rstrip() for message in messages
    )
    new_program = "\n".join(
        line.rstrip() for line in mended_text.split("\n")
    )  # in the form of the file
    return entry._replace(
        messages=rows_of_messages, mended=new_program or None if mended_text != program else None
    )


def write(entries: list[Entry]) -> None:
    for language in {entry.language for entry in entries}:
        rows = [row for entry in entries if entry.language == language for row in _rows(entry)]
        (FOLDER / f"{language}.txt").write_text("\n".join(rows) + "\n", encoding="utf-8")


def _rows(entry: Entry) -> list[str]:
    """Return a program and its messages in the form of the file."""
    message_rows = [f"> {row}" for row in entry.messages]
    above = [entry.program, *entry.asides]
    if entry.mended is None:
        return [*above, *(message_rows or [">"])]
    program, mended_lines = entry.program.split("\n"), entry.mended.split("\n")
    pairs = enumerate(zip(program, mended_lines, strict=False), 1)
    line_by_number = {
        number: new_line for number, (old_line, new_line) in pairs if old_line.rstrip() != new_line
    }
    marked = list(message_rows)
    for k, row in enumerate(entry.messages):
        number, _, fix = (*row.split(" ", 2), "")[:3]
        line, new_line = program[int(number) - 1], line_by_number.get(int(number))
        if fix and new_line == _indent(line) + fix:
            marked[k] = f">= {row}"
            del line_by_number[int(number)]
        elif fix and new_line is not None and (part := _part(line, fix, new_line)):
            marked[k] = f">= {row}{PLACE_SEPARATOR}{part}"
            del line_by_number[int(number)]
    rows = [f"={number} {line}".rstrip() for number, line in line_by_number.items()]
    if _mend(program, marked, rows) == entry.mended:
        return [*above, *marked, *rows]
    return [*above, *message_rows, *(f"= {line}".rstrip() for line in mended_lines)]


# Mistakes whose repair writes a number in another way: a unit, a letter for a digit, `X++`, `50.`,
# and how many times `I = 1 TO 4` and `LOOP(I = 0; I < 4; I++)` go round.
OTHER_NUMBERS = (
    codes.UNIT,
    codes.BAD_NUMBER,
    codes.OTHER_ASSIGNMENT,
    codes.LINE_NUMBER,
    codes.SETUP_UNKNOWN,  # `S1|` is SI
    codes.SETUP_NEEDS_BAR,  # the same applies to `S1;`
    codes.LOOP_COUNTS,
    codes.NEEDLESS_FRAME,  # including its `return 0`
    codes.LISTS,  # `V[0]` is V_1
    codes.PASTED,  # `[20:14] Luis:`
    codes.NO_BRACKETS_HERE,  # `TASK(1)`
)


def mistake_count(diagnostics: list[Diagnostic]) -> int:
    return sum(diagnostic.is_mistake for diagnostic in diagnostics)
