"""The effect of `--fix` on wrong programs: `python -m tools.meant FOLDER` prints two figures.

The folder contains programs, `NAME.ts`, and for those whose meaning is known also the meant
program, `NAME.meant.ts`. A program that is correct after `--fix` but behaves differently from that
one is harmful.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from tiniscript import robots
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import repair_program
from tiniscript.library.compiling import compile_source
from tiniscript.library.named_robot import robot_of

MEANT_SUFFIX = ".meant.ts"


class Figures(NamedTuple):
    """`known_count` counts the programs whose meaning is known."""

    program_count: int = 0
    right_count: int = 0
    known_count: int = 0
    harmful: tuple[str, ...] = ()


def compile_image(text: str) -> bytes:
    """Return the code of a program for the robot that it names, or no bytes for a wrong one."""
    robot = robot_of(text.encode(), robots.load(robots.DEFAULT))
    return compile_source(text.encode(), robot, "", is_strict=True).image


def check(text: str) -> list[Diagnostic]:
    robot = robot_of(text.encode(), robots.load(robots.DEFAULT))
    return compile_source(text.encode(), robot, "", is_strict=True).diagnostics


def figures(folder: Path) -> Figures:
    figures = Figures()
    for path in sorted(folder.rglob("*.ts")):
        if path.name.endswith(MEANT_SUFFIX):
            continue
        repaired_image = compile_image(repair_program(path.read_text(encoding="utf-8"), check).text)
        meant_path = path.with_name(path.name.removesuffix(".ts") + MEANT_SUFFIX)
        has_meant_program = meant_path.exists()
        is_harmful = has_meant_program and repaired_image not in (
            b"",
            compile_image(meant_path.read_text(encoding="utf-8")),
        )
        name = path.relative_to(folder).as_posix()
        figures = Figures(figures.program_count + 1, figures.right_count + bool(repaired_image),
                          figures.known_count + has_meant_program,
                          (*figures.harmful, name) if is_harmful else figures.harmful)  # fmt: skip
    return figures


def main(arguments: Iterable[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Count what --fix makes of wrong programs.")
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args(None if arguments is None else [*arguments]).folder
    all_figures = figures(folder)
    if not all_figures.program_count:
        sys.exit(f"{folder} has no programs (*.ts).")
    print(f"right after --fix: {all_figures.right_count} of {all_figures.program_count}")
    print(
        f"harmful: {len(all_figures.harmful)} of {all_figures.known_count} whose meaning is known",
        *all_figures.harmful,
    )
    return bool(all_figures.harmful)


if __name__ == "__main__":
    sys.exit(main())
