"""Wrong programs as pupils write them, and what is said of each.

They are in the files `*.txt` here. Below a program stands a line for each message,
`> 1 TS012 F(1.5, 80)`: its line, its code and what to try, in Spanish; then, where
`tsc check --fix` changes it, the program that it makes, each line behind a `=`, without spaces at
its end. A program of which nothing is said has a `>` alone below it.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

from tiniscript import robots
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.rendering import message
from tiniscript.library.compiling import compiled
from tiniscript.repairs.fixing import fixed
from tiniscript.source import Source

FOLDER = Path(__file__).parent
PART = re.compile(r"((?:(?![>=]).*\n)+)((?:>.*\n)*)((?:=.*\n)*)")


class Entry(NamedTuple):
    """`file` is the name of the file that has the program."""

    file: str
    program: str
    said: tuple[str, ...]
    mended: str | None


@cache
def entries() -> tuple[Entry, ...]:
    found = []
    for file in sorted(FOLDER.glob("*.txt")):
        for part in PART.findall(file.read_text(encoding="utf-8")):
            program, said, mended = (each.split("\n")[:-1] for each in part)
            messages = tuple(line[2:] for line in said if line != ">")
            kept = "\n".join(line[1:].removeprefix(" ") for line in mended)
            found.append(Entry(file.name, "\n".join(program), messages, kept or None))
    return tuple(found)


def check(text: str) -> list[Diagnostic]:
    robot = robots.load(robots.DEFAULT)
    return compiled(text.encode(), robot, "prog.ts", is_strict=False).diagnostics


def found_in(entry: Entry) -> Entry:
    """Return what is said of a program now, and what becomes of it."""
    program = entry.program
    found = check(program)
    source = Source(program)
    messages = [message(each, source, "es") for each in found]
    mended = fixed(program, check).text
    said = tuple(f"{each.line} {each.code} {each.fix}".rstrip() for each in messages)
    kept = "\n".join(line.rstrip() for line in mended.split("\n"))  # as the file keeps it
    return Entry(entry.file, program, said, kept or None if mended != program else None)


def write(found: list[Entry]) -> None:
    for file in {entry.file for entry in found}:
        rows = []
        for entry in found:
            if entry.file == file:
                mended = entry.mended.split("\n") if entry.mended else []
                rows += [entry.program, *(f"> {said}" for said in entry.said)]
                rows += [f"= {line}".rstrip() for line in mended]
                rows += [] if entry.said or mended else [">"]
        (FOLDER / file).write_text("\n".join(rows) + "\n", encoding="utf-8")
