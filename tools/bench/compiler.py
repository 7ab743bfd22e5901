"""Prints what is measured: sizes, and times as ratios within one run.

`python -m tools.bench.compiler` takes about half a minute; `tools.bench.machine` measures the
machines. Sizes are exact. Times on a busy machine are noisy, so they are medians of pairs taken
in turn; compare ratios, not milliseconds. The figures of others are those of the same programs,
measured once with their own tools.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "compiler"))

from tiniscript import compile_text, robots

KIT = robots.load(robots.DEFAULT).kit
OBSTACLE = "SI|START;LOOP(FOREVER);F(1, 80);DISTANCE;IF(DISTANCE < 10);STOP;R(1, 60);ENDIF;END_LOOP"
PROGRAMS = ("SI|F(5,80)", "SI|LOOP(3);F(2,50);END_LOOP", OBSTACLE)

# Bytes of the same three programs: text, and what others make of them.
OTHERS = (
    ("TiniScript text", (10, 27, 87)),
    ("MicroPython .mpy (mpy-cross 1.29 -O3)", (32, 49, 71)),
    ("Microvium 8 snapshot", (74, 94, 130)),
    ("WebAssembly (zig cc -Os, stripped)", (86, 103, 140)),
    ("Aseba bytecode", (22, 44, 58)),
    ("AVR machine code, function only, int16", (12, 36, 38)),
)

TEN_LINES = """\
SPEED = 40;
LOOP(3);
  IF(DISTANCE < 10 AND SPEED > 3);
    F(1, SPEED);
    SPEED = SPEED + 1;
  ELSE;
    R(0.5, 60);
  ENDIF;
  W(0.5);
END_LOOP;
"""


def main() -> None:
    sizes()
    processes()
    by_size()


def table(title: str, head: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    lines = [head, *([str(cell) for cell in row] for row in rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    print(f"\n{title}")
    for line in lines:
        first, *rest = zip(line, widths, strict=True)
        print(first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in rest), sep="   ")


def sizes() -> None:
    ours = [compile_text(text, KIT) for text in PROGRAMS]
    rows: list[tuple[object, ...]] = [
        ("code_bytes", *(len(each.code) for each in ours)),
        ("image_bytes", *(len(each.image) for each in ours)),
        ("  must, code_bytes", 6, 10, 24),
        ("  aim, code_bytes", 4, 7, 16),
        *((name, *figures) for name, figures in OTHERS),
    ]
    table("Bytes", ("", "F(5,80)", "LOOP(3) ...", "obstacle"), rows)


def median_pair(ours: Callable[[], object], theirs: Callable[[], object], runs: int) -> list[float]:
    """Return the median times of both, in seconds, and of their ratio; taken in turn."""
    pairs = []
    for _ in range(runs):
        times = []
        for each in (ours, theirs):
            start = time.perf_counter()
            each()
            times.append(time.perf_counter() - start)
        pairs.append((times[0], times[1], times[0] / times[1]))
    return [statistics.median(column) for column in zip(*pairs, strict=True)]


def processes() -> None:
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "obstacle.ts"
        program.write_text(OBSTACLE, encoding="utf-8")
        nothing = [sys.executable, "-c", "pass"]

        def start(*arguments: str) -> Callable[[], object]:
            command = [sys.executable, "-m", "tiniscript", *arguments]
            environ = {"PYTHONPATH": str(ROOT / "compiler"), "XDG_CACHE_HOME": folder}
            return lambda: subprocess.run(command, check=True, capture_output=True, env=environ)

        def bare() -> object:
            return subprocess.run(nothing, check=True, capture_output=True)

        rows = []
        image = str(program.with_suffix(".bin"))
        for verb, arguments in {
            "tsc compile": ("compile", str(program)),
            "tsc check": ("check", str(program)),
            "tsc run (10 s simulated)": ("run", image, "--max-time", "10"),
            "tsc show": ("show", image),
        }.items():
            command = start(*arguments)
            command()  # what is cached is cached now
            ours, theirs, ratio = median_pair(command, bare, 21)
            rows.append((verb, f"{ours * 1000:.0f} ms", f"{theirs * 1000:.0f} ms", f"{ratio:.1f}x"))
        rows.append(("  must 5x (compile, check)", "", "", ""))
    table("Whole processes (medians of 21 pairs)", ("", "tsc", "python -c pass", "ratio"), rows)


def by_size() -> None:
    rows = []
    times = {}
    for lines in (10, 100, 1000, 10_000):
        text = TEN_LINES * (lines // 10)
        best = []
        for _ in range(5 if lines < 10_000 else 2):
            start = time.perf_counter()
            compiled = compile_text(text, KIT)
            best.append(time.perf_counter() - start)
        times[lines] = min(best)
        growth = f"{times[lines] / times[lines // 10]:.1f}x" if lines > 10 else ""
        rows.append((lines, f"{times[lines] * 1000:.1f} ms", growth, len(compiled.code)))
    head = ("lines", "compile_text, warm", "against a tenth", "code_bytes")
    table("Compiling by size (must: 100 lines in 5 ms, 10x the text in 12x the time)", head, rows)


if __name__ == "__main__":
    main()
