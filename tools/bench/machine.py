"""Prints how fast the C++ machine is: `python -m tools.bench.machine`.

Cycles come from a simulated ATmega328P and are exact: the same sources give the same ones. Every
run is checked: a machine that shows a wrong value ends the command with an error. What lacks its
tools has a `-`, and a sentence says which.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from struct import pack

from tools import uno
from tools.bench import avr_bench, firmware_size, page, sketch_cycles, workloads
from tools.bench.workloads import Work, check, code_of

BUDGET = 100  # jumps back in a call of `tick`: it may take 200,000 cycles
DONE = 2  # Status::kDone
# All of `tick`; and with all that comes between, the main loop of the sketch and its interrupts.
ROWS = ("TiniScript", "TiniScript, in the shipped sketch")


def count(code: bytes, readings: Sequence[int], budget: int, *more: str) -> tuple[list[int], int]:
    """Return the values that the chip shows, and the cycles in `tick` in all."""
    request = pack(f"<BB{len(readings)}iH", budget, len(readings), *readings, len(code)) + code
    text = avr_bench.run(avr_bench.build("cycles", avr_bench.SOURCES, *more), request)
    *shown, cycles, status = (line.split() for line in text)
    if status != ["STATUS", str(DONE)]:
        raise RuntimeError(f"the program did not end, or a tick was too long: {text[-5:]}")
    return [int(value) for _, value in shown], int(cycles[1])


def per_iteration(work: Work) -> float:
    """Return the cycles of a whole run, all but the robot, for each time around its loop."""
    shown, cycles = count(code_of(work), work.thousandths, BUDGET)
    check("ATmega328P", work, shown)
    return cycles / work.times


def main() -> int:
    try:
        cycles()
    except workloads.WrongResult as error:
        print(f"wrong result: {error}", file=sys.stderr)
        return 1
    except RuntimeError as error:  # the firmware is not built
        print(error, file=sys.stderr)
        return 2
    return 0


def cycles() -> None:
    machine_cells = sketch_cells = ["-" for _ in workloads.WORKS]
    if not avr_bench.missing():
        machine_cells = [f"{per_iteration(work):,.0f}" for work in workloads.WORKS]
    if not uno.missing():
        firmware = firmware_size.measure("uno").firmware
        cycle_counts = [sketch_cycles.per_iteration(firmware, work) for work in workloads.WORKS]
        sketch_cells = [f"{item:,.0f}" for item in cycle_counts]
    rows = zip(ROWS, (machine_cells, sketch_cells), strict=True)
    page.show("machine", [(row, "thousandths", *figures) for row, figures in rows])
    for why in filter(None, (avr_bench.missing(), uno.missing())):
        print(f"\n{why}")


if __name__ == "__main__":
    sys.exit(main())
