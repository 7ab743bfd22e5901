"""Prints how fast the C++ machine is: `python -m tools.bench.machine`.

Cycles come from a simulated ATmega328P and are exact: the same sources give the same ones. Every
run is checked: a machine that shows a wrong value ends the command with an error. A measurement
without its tools shows a `-`, and a sentence names the missing tool.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from struct import pack

from tools import uno
from tools.bench import avr_bench, firmware_size, page, sketch_cycles, workloads
from tools.bench.workloads import Workload, check, code_of

JUMP_BUDGET = 100  # jumps back in a call of `tick`: it may take 200,000 cycles
DONE_STATUS = 2  # Status::kDone
# All of `tick`; and with all that comes between, the main loop of the sketch and its interrupts.
ROWS = ("TiniScript", "TiniScript, in the shipped sketch")


def run_on_chip(
    code: bytes, readings: Sequence[int], budget: int, *extra_flags: str
) -> tuple[list[int], int]:
    """Return the values that the chip shows, and the cycles in `tick` in all."""
    request = pack(f"<BB{len(readings)}iH", budget, len(readings), *readings, len(code)) + code
    lines = avr_bench.run(avr_bench.build("cycles", avr_bench.SOURCES, *extra_flags), request)
    *shown_lines, print_cycles, status = (line.split() for line in lines)
    if status != ["STATUS", str(DONE_STATUS)]:
        raise RuntimeError(f"the program did not end, or a tick was too long: {lines[-5:]}")
    return [int(value) for _, value in shown_lines], int(print_cycles[1])


def per_iteration(work: Workload) -> float:
    """Return the cycles of a whole run, all but the robot, for each time around its loop."""
    shown_values, print_cycles = run_on_chip(code_of(work), work.thousandths, JUMP_BUDGET)
    check("ATmega328P", work, shown_values)
    return print_cycles / work.loop_count


def main() -> int:
    try:
        print_cycles()
    except workloads.WrongResult as error:
        print(f"wrong result: {error}", file=sys.stderr)
        return 1
    except RuntimeError as error:  # the firmware is not built
        print(error, file=sys.stderr)
        return 2
    return 0


def print_cycles() -> None:
    machine_cells = sketch_cells = ["-" for _ in workloads.WORKLOADS]
    if not avr_bench.missing_reason():
        machine_cells = [f"{per_iteration(work):,.0f}" for work in workloads.WORKLOADS]
    if not uno.missing():
        firmware = firmware_size.measure("uno").firmware
        cycle_counts = [sketch_cycles.per_iteration(firmware, work) for work in workloads.WORKLOADS]
        sketch_cells = [f"{cycle_count:,.0f}" for cycle_count in cycle_counts]
    rows = zip(ROWS, (machine_cells, sketch_cells), strict=True)
    page.show("machine", [(row, "thousandths", *figures) for row, figures in rows])
    for reason in filter(None, (avr_bench.missing_reason(), uno.missing())):
        print(f"\n{reason}")


if __name__ == "__main__":
    sys.exit(main())
