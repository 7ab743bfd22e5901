"""Prints how fast the C++ machine is: `python tools/cpp_benchmark.py`.

Cycles come from a simulated ATmega328P and are exact: the same sources give the same ones. Every
run is checked: a machine that shows a wrong value ends the command with an error. A chip whose
tools are missing has a `-` and a sentence that says which.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools import avr_bench, chip_cycles, works

NONE = "-"


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Print how fast the C++ machine is.")
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], help="some of them alone")
    for name in parser.parse_args(arguments).parts or PARTS:
        try:
            PARTS[name]()
        except works.WrongResult as wrong:
            print(f"wrong result: {wrong}", file=sys.stderr)
            return 1
    return 0


def table(title: str, head: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print a table: texts to the left, numbers to the right."""
    lines = [list(head), *([shown(cell) for cell in row] for row in rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    print(f"\n{title}\n")
    for number, line in enumerate(lines):
        cells = [
            cell.rjust(width) if is_number(cell) or (number == 0 and k) else cell.ljust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        ]
        print(f"| {' | '.join(cells)} |")
        if number == 0:
            rules = ("-" * width for width in widths)
            print(f"| {' | '.join(rules)} |")


def shown(cell: object) -> str:
    return f"{cell:,.1f}".removesuffix(".0") if isinstance(cell, int | float) else str(cell)


def is_number(cell: str) -> bool:
    return cell == NONE or cell[:1].isdigit()


def cycles() -> None:
    ours: list[tuple[object, ...]] = [("TiniScript", "thousandths", NONE, NONE, NONE)]
    if not avr_bench.missing():
        ours = []
        for name, budget in (
            ("TiniScript", chip_cycles.BUDGET),
            ("TiniScript, as the sketch calls it", chip_cycles.SKETCH_BUDGET),
        ):
            found = [round(chip_cycles.per_iteration(work, budget), 1) for work in works.WORKS]
            ours.append((name, "thousandths", *found))
    rows = [
        *ours,
        ("  must", "", *works.MUST),
        ("  later", "", *works.LATER),
        *((name, numbers, *figures) for name, numbers, figures in works.OTHERS),
    ]
    title = (
        "Cycles of one iteration on an ATmega328P, simulated: A is X = X + K; B counts, and counts "
        f"again from 501;\nC adds twice, multiplies, divides and takes a remainder. With `tick`, "
        f"{chip_cycles.BUDGET} instructions a call; the sketch calls it for "
        f"{chip_cycles.SKETCH_BUDGET}."
    )
    table(title, ("", "numbers", "A", "B", "C"), rows)
    if avr_bench.missing():
        print(f"\n{avr_bench.missing()}")


def instructions() -> None:
    """Print the cycles of single instructions: those of the works, and arithmetic by itself."""
    if avr_bench.missing():
        print(f"\nCycles of an instruction: {avr_bench.missing()}")
        return
    rows = []
    for name in chip_cycles.ARITHMETIC:
        each = chip_cycles.of_arithmetic(name)
        rows.append((name, each[0], sum(each) / len(each), each[-1]))
    title = f"Cycles of an instruction, with {len(chip_cycles.PAIRS)} pairs as in a classroom"
    table(title, ("", "least", "mean", "most"), rows)
    means = [
        (work.name, name, mean)
        for work in works.WORKS
        for name, mean in chip_cycles.of_instructions(work).items()
    ]
    table("Cycles of an instruction in the loops of the works", ("", "", "mean"), means)


PARTS: dict[str, Callable[[], None]] = {"cycles": cycles, "instructions": instructions}

if __name__ == "__main__":
    sys.exit(main())
