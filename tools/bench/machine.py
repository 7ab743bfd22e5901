"""Prints how fast the C++ machine is: `python -m tools.bench.machine`.

Cycles come from a simulated ATmega328P and are exact: the same sources give the same ones. Every
run is checked: a machine that shows a wrong value ends the command with an error. What lacks its
tools has a `-`, and a sentence says which.
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.bench import avr_bench, machine_cycles, sketch_cycles, workloads
from tools.bench.compiler import table


def main() -> int:
    try:
        cycles()
    except workloads.WrongResult as wrong:
        print(f"wrong result: {wrong}", file=sys.stderr)
        return 1
    except RuntimeError as why:  # the firmware is not built
        print(why, file=sys.stderr)
        return 2
    return 0


def cycles() -> None:
    alone = sketch = ["-" for _ in workloads.WORKS]
    if not avr_bench.missing():
        alone = [f"{machine_cycles.per_iteration(work):,.0f}" for work in workloads.WORKS]
    if not sketch_cycles.missing():
        firmware = sketch_cycles.built()
        found = [sketch_cycles.per_iteration(firmware, work) for work in workloads.WORKS]
        sketch = [f"{each:,.0f}" for each in found]
    rows = [
        ("all of `tick`", *alone),
        ("in the shipped sketch", *sketch),
    ]
    title = "Cycles of one iteration on a simulated ATmega328P"
    table(title, ("", *(work.name for work in workloads.WORKS)), rows)
    for work in workloads.WORKS:
        print(f"\n{work.name}: `{work.body[:-1]}`, {work.times:,} times.", end="")
    print(
        f"\n`tick` is called for {machine_cycles.BUDGET} times around a loop. In the sketch all "
        "between is counted, its main loop and its interrupts."
    )
    for why in filter(None, (avr_bench.missing(), sketch_cycles.missing())):
        print(f"\n{why}")


if __name__ == "__main__":
    sys.exit(main())
