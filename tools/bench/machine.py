"""Prints how fast the C++ machine is: `python -m tools.bench.machine`.

Cycles come from a simulated ATmega328P and are exact: the same sources give the same ones. Every
run is checked: a machine that shows a wrong value ends the command with an error. A chip whose
tools are missing has a `-` and a sentence that says which.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.bench import (
    avr_bench,
    interpreters,
    machine_cycles,
    machine_size,
    native_cycles,
    sketch_cycles,
    workloads,
)
from tools.bench import machine_speed as timing

NONE = "-"
ROUNDS = 5
TIMES = 20_000  # around each loop beside other interpreters: what it takes to begin does not count


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Print how fast the C++ machine is.")
    parser.add_argument("parts", nargs="*", metavar="part", help=f"only some of {', '.join(PARTS)}")
    parts: list[str] = parser.parse_args(arguments).parts
    for name in parts:
        if name not in PARTS:
            parser.error(f"no part is called {name}")
    for name in parts or PARTS:
        try:
            PARTS[name]()
        except workloads.WrongResult as wrong:
            print(f"wrong result: {wrong}", file=sys.stderr)
            return 1
        except RuntimeError as why:  # the firmware is not built
            print(why, file=sys.stderr)
            return 2
    return 0


def table(title: str, head: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print a table of Markdown: columns of numbers to the right, others to the left."""
    lines = [list(head), *([shown(cell) for cell in row] for row in rows)]
    columns = []
    for name, *cells in zip(*lines, strict=True):
        width = max(len(cell) for cell in (name, *cells))
        right = any(cells) and all(is_number(cell) for cell in cells)
        rule = "-" * (width - 1) + (":" if right else "-")
        columns.append([f"{cell:{'>' if right else '<'}{width}}" for cell in (name, *cells)])
        columns[-1].insert(1, rule)
    print(f"\n{title}\n")
    for line in zip(*columns, strict=True):
        print(f"| {' | '.join(line)} |")


def shown(cell: object) -> str:
    return f"{cell:,.1f}".removesuffix(".0") if isinstance(cell, int | float) else str(cell)


def is_number(cell: str) -> bool:
    return cell in ("", NONE) or cell[0].isdigit()


def cycles() -> None:
    ours: list[tuple[object, ...]] = [("TiniScript", "thousandths", NONE, NONE, NONE)]
    if not avr_bench.missing():
        found = [round(machine_cycles.per_iteration(work), 1) for work in workloads.WORKS]
        ours = [("TiniScript, all of `tick`", "thousandths", *found)]
    if not sketch_cycles.missing():
        firmware = sketch_cycles.built()
        found = [round(sketch_cycles.per_iteration(firmware, work), 1) for work in workloads.WORKS]
        ours.append(("TiniScript, in the shipped sketch", "thousandths", *found))
    rows = [
        *ours,
        ("  must", "", *workloads.MUST),
        ("  aim", "", *workloads.AIM),
        *((name, numbers, *figures) for name, numbers, figures in workloads.OTHERS),
    ]
    table("Cycles of one iteration on a simulated ATmega328P", ("", "numbers", "A", "B", "C"), rows)
    beside_c()
    for work in workloads.ALL_WORKS:
        before = f"`{work.before[:-1]}`, " if work.name == "F" else ""
        print(f"\n{work.name}: {before}`{work.body[:-1]}`, {work.times:,} times.", end="")
    print(
        f"\n`tick` is called for {machine_cycles.BUDGET} times around a loop, and for half as many "
        "in D and E. In the sketch all is\ncounted that comes between, its main loop and its "
        "interrupts; D and E need a robot that costs nothing.\nThe others were "
        "measured once, with loops of the same work in their own languages. Fewer bits\nare less "
        "work; Snek, Microvium and "
        "uLisp are far larger languages; TinyBASIC, Bitlash and\nuBASIC read the text of each line "
        "anew."
    )
    for why in filter(None, (avr_bench.missing(), sketch_cycles.missing())):
        print(f"\n{why}")


def beside_c() -> None:
    """Print the cycles of each work and those of C alone, which were counted in the same run."""
    rows: list[tuple[object, ...]] = []
    for work in sorted(workloads.ALL_WORKS, key=lambda work: work.name):
        ours: object = NONE
        sketch: object = NONE
        c: list[object] = [NONE, NONE]
        times: object = NONE
        if not avr_bench.missing():
            found = machine_cycles.per_iteration(work)
            alone = native_cycles.per_iteration(work)
            ours, c[0], times = found, alone, found / alone
            if work.name in native_cycles.THOUSANDTHS:
                c[1] = native_cycles.per_iteration(work, has_thousandths=True)
        if not sketch_cycles.missing() and not work.has_robot:
            sketch = sketch_cycles.per_iteration(sketch_cycles.built(), work)
        rows.append((work.name, ours, sketch, *c, times))
    head = ("", "all of `tick`", "in the sketch", "C, int32", "C, thousandths", "times C, int32")
    table("The same beside C alone, compiled for the same chip with variables in RAM", head, rows)


def instructions() -> None:
    """Print the cycles of arithmetic."""
    if avr_bench.missing():
        print(f"\nCycles of an instruction: {avr_bench.missing()}")
        return
    rows = []
    for name in machine_cycles.ARITHMETIC:
        each = machine_cycles.of_arithmetic(name)
        rows.append((name, each[0], sum(each) / len(each), each[-1], workloads.OF_C.get(name, "")))
    title = f"Cycles of an instruction, with {len(machine_cycles.PAIRS)} pairs as in a classroom"
    table(title, ("", "least", "mean", "most", "mean of C alone"), rows)
    print("\nC alone: thousandths in a function, with int64 where they need it, and no machine.")


def sizes() -> None:
    rows: list[tuple[object, ...]] = []
    said = []
    for name in (machine_size.AVR, *machine_size.EMULATED):
        if machine_size.missing(name):
            said.append(machine_size.missing(name))
            rows.append((name, NONE, NONE, NONE))
            continue
        small, whole = (machine_size.size(name, use) for use in ("machine and verifier", "all"))
        rows.append((name, small.flash, whole.flash, whole.ram))
        if name == machine_size.AVR:
            rows += [("  must", machine_size.MUST, "", ""), ("  aim", machine_size.AIM, "", "")]
    module = (ROOT / "compiler" / "tiniscript" / "vm" / "machine.wasm").stat().st_size
    rows.append(("WebAssembly, the whole module", NONE, module, NONE))
    rows += [
        (f"{name}, {what}", flash, "", ram) for name, what, flash, ram in workloads.OTHER_SIZES
    ]
    head = ("", "machine and verifier", "with the image reader", "RAM")
    table("Bytes of flash and of RAM, linked, with the compiler's library", head, rows)
    for sentence in said:
        print(f"\n{sentence}")


def speeds() -> None:
    """Print instructions a second: medians of rounds in which each machine is timed in turn."""
    with tempfile.TemporaryDirectory() as folder:
        machines = [timing.of_host(Path(folder) / "host"), timing.of_wasm(), timing.of_python()]
        there = [each for each in machines if not each.missing]
        rows = []
        for work in workloads.WORKS:
            steps = workloads.expected(work).steps
            rounds = [[each.seconds(work) for each in there] for _ in range(ROUNDS)]
            row: list[object] = [f"{work.name}, {steps:,} instructions"]
            for each in machines:
                if each.missing:
                    row += [NONE, NONE]
                    continue
                k = there.index(each)
                row.append(statistics.median(steps / line[k] / 1e6 for line in rounds))
                row.append(statistics.median(line[-1] / line[k] for line in rounds))
            rows.append(row[:-1])  # Python, the last one, is as fast as itself
    head = ["", *(word for each in machines for word in (each.name, "times Python"))][:-1]
    table("Million instructions a second on this computer", head, rows)
    for each in machines:
        if each.missing:
            print(f"\n{each.missing}")


def others() -> None:
    """Print iterations a second of other interpreters' loops, and of ours in the same rounds."""
    with tempfile.TemporaryDirectory() as folder:
        ours = [timing.of_host(Path(folder) / "host"), timing.of_wasm(), timing.of_python()]
        theirs = interpreters.all_of_them()
        there = [each for each in (*ours, *theirs) if not each.missing]
        works = [work._replace(times=TIMES) for work in workloads.WORKS]
        rounds = [[[each.seconds(work) for work in works] for each in there] for _ in range(ROUNDS)]
    rows = []
    for each in (*ours, *theirs):
        name = f"TiniScript, {each.name}" if each in ours else each.name
        row: list[object] = [name, "thousandths" if each in ours else "whole"]
        if each.missing:
            rows.append([*row, *(NONE for work in works)])
            continue
        lines = [line[there.index(each)] for line in rounds]
        found = [statistics.median(seconds) for seconds in zip(*lines, strict=True)]
        rows.append([*row, *(TIMES / seconds / 1e6 for seconds in found)])
    table("Million iterations a second on this computer", ("", "numbers", "A", "B", "C"), rows)
    print(
        "\nThe others run the same loops with whole numbers and local variables, and do not look "
        "for a stop;\nLua, MicroPython and Python are far larger languages."
    )
    for each in (*ours, *theirs):
        if each.missing:
            print(f"\n{each.missing}")


PARTS: dict[str, Callable[[], None]] = {
    "cycles": cycles,
    "instructions": instructions,
    "sizes": sizes,
    "speeds": speeds,
    "others": others,
}

if __name__ == "__main__":
    sys.exit(main())
