"""Prints sizes of programs, and the time of `tsc compile` next to Python's own start-up time.

Sizes are exact. Times on a busy machine are noisy, so they are medians of pairs taken in turn:
compare ratios, not milliseconds.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from tiniscript import compile_text, robots
from tools import ROOT
from tools.bench import page

KIT = robots.load(robots.DEFAULT).kit
OBSTACLE_PROGRAM = (
    "SI|START;LOOP(FOREVER);F(1, 80);DISTANCE;IF(DISTANCE < 10);STOP;R(1, 60);ENDIF;END_LOOP"
)
PROGRAMS = ("SI|F(5,80)", "SI|LOOP(3);F(2,50);END_LOOP", OBSTACLE_PROGRAM)
ROWS = *(f"`{text}`" for text in PROGRAMS[:2]), "the paper's obstacle program"


def main() -> None:
    print_sizes()
    print_start_ratio()


def print_sizes() -> None:
    size_rows = []
    for name, text in zip(ROWS, PROGRAMS, strict=True):
        compilation = compile_text(text, KIT)
        size_rows.append(
            (name, *(f"{len(data)} bytes" for data in (compilation.code, compilation.image)))
        )
    page.show("compiler", size_rows)


def median_pair(
    own_work: Callable[[], object], other_work: Callable[[], object], run_count: int
) -> list[float]:
    """Return the median times of both, in seconds, and of their ratio; taken in turn."""
    pairs = []
    for _ in range(run_count):
        durations_s = []
        for work in (own_work, other_work):
            start = time.perf_counter()
            work()
            durations_s.append(time.perf_counter() - start)
        pairs.append((durations_s[0], durations_s[1], durations_s[0] / durations_s[1]))
    return [statistics.median(column) for column in zip(*pairs, strict=True)]


def print_start_ratio() -> None:
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "obstacle.ts"
        program.write_text(OBSTACLE_PROGRAM, encoding="utf-8")
        python_command = [sys.executable, "-c", "pass"]

        def start(*arguments: str) -> Callable[[], object]:
            command = [sys.executable, "-m", "tiniscript", *arguments]
            environ = {"PYTHONPATH": str(ROOT / "compiler"), "XDG_CACHE_HOME": folder}
            return lambda: subprocess.run(command, check=True, capture_output=True, env=environ)

        def start_python() -> object:
            return subprocess.run(python_command, check=True, capture_output=True)

        command = start("compile", str(program))
        command()  # fills the caches
        ratio = median_pair(command, start_python, 21)[-1]
    print(f"A whole `tsc compile` takes about {ratio:.1f} times as long as `python -c pass`.")


if __name__ == "__main__":
    main()
