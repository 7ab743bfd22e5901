"""Counts the warnings that programs get, the rarest first: `python -m tools.warned FOLDER`.

The folder has programs, `NAME.ts`; without one it takes the right answers of the lessons. A warning
that no program gets is listed, too: `docs/develop/decisions.md` explains its purpose.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from tiniscript import robots
from tiniscript.diagnostics import codes
from tiniscript.lessons import catalogue
from tiniscript.library.compiling import compile_source
from tiniscript.library.named_robot import robot_of


def programs_in(folder: Path | None) -> Iterator[str]:
    """Yield the programs of a folder, or the right answers of all lessons."""
    if folder is not None:
        for path in sorted(folder.rglob("*.ts")):
            yield path.read_text(encoding="utf-8")
        return
    for lesson in catalogue.folders():
        right_answers, _ = catalogue.answers(lesson)
        yield from (answer.program for answer in right_answers)


def warnings_in(program: str) -> set[str]:
    """Return the numbers of the warnings that a program gets on the robot that it names."""
    data = program.encode()
    robot = robot_of(data, robots.load(robots.DEFAULT))
    diagnostics = compile_source(data, robot, "", is_strict=False).diagnostics
    return {diagnostic.code.number for diagnostic in diagnostics if not diagnostic.is_mistake}


def main(arguments: Iterable[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Count which warnings programs get.")
    parser.add_argument("folder", type=Path, nargs="?")
    folder = parser.parse_args(None if arguments is None else [*arguments]).folder
    programs = [*programs_in(folder)]
    if not programs:
        sys.exit(f"{folder} has no programs (*.ts).")
    counts = Counter(number for program in programs for number in warnings_in(program))
    numbers = [code.number for code in codes.CODES.values() if not code.is_mistake]
    for number in sorted(numbers, key=lambda number: (counts[number], number)):
        print(f"{number} {counts[number]} of {len(programs)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
