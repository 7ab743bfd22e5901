"""Prints how quick a typed line is, from its end to the motor pins, on a simulated Uno.

Builds the firmware of the robot `tinibot` for each baud, offline stand-ins included, and types as a
terminal does: no session, no frames. Cycles are exact; radio modules and USB chips are not in them.
"""

from __future__ import annotations

import sys
from pathlib import Path

from tools.bench import page
from tools.bench.compiler import OBSTACLE_PROGRAM
from tools.bench.link import PHASE_CYCLES, first_move, on_each_baud
from tools.uno import CYCLES_PER_MS, Uno

SHORT_PROGRAM = "SI|F(2,80)"
ROWS = (f"`{SHORT_PROGRAM}`", "the paper's obstacle program")
SILENCE_MS = 1100  # silence after a stop, before which input is ignored
TRY_COUNT = 20  # the main loop is elsewhere each time: the slowest counts
LONGEST_MS = 5.0  # limit for the short line


def typed_line_ms(board: Uno, line: str, phase: int) -> float:
    """Return the ms from the last byte of a line, its end, to the pins."""
    board.run_to(board.cycle + phase * PHASE_CYCLES)
    begin_cycle = board.cycle
    board.send(line.encode() + b"\n")
    board.run_ms(3 * len(line) + 200)
    move_cycle = first_move(board, begin_cycle)
    line_bytes = [
        byte
        for byte in board.received_bytes
        if begin_cycle <= byte.began and byte.cycle <= move_cycle
    ]
    if len(line_bytes) != len(line) + 1:
        raise RuntimeError(f"the robot moved after {len(line_bytes)} of {len(line) + 1} bytes")
    board.send(b"S\n")
    board.run_ms(SILENCE_MS)
    return (move_cycle - line_bytes[-1].cycle) / CYCLES_PER_MS


def slowest(board: Uno, line: str) -> float:
    return max(typed_line_ms(board, line, 300 + k) for k in range(TRY_COUNT))


def measure(firmware: Path, baud: int) -> list[float]:
    with Uno(firmware, baud=baud) as board:
        board.run_ms(SILENCE_MS)
        return [slowest(board, line) for line in (SHORT_PROGRAM, OBSTACLE_PROGRAM)]


def main() -> int:
    return on_each_baud(measure, print_figures)


def print_figures(figures_by_baud: dict[int, list[float]], _: Path) -> bool:
    """Print the figures; return whether the short line's are kept."""
    by_line = zip(*figures_by_baud.values(), strict=True)
    page.show("text", [(row, *(f"{ms:.2f} ms" for ms in figures))
                       for row, figures in zip(ROWS, by_line, strict=True)])  # fmt: skip
    return all(short_ms <= LONGEST_MS for short_ms, _ in figures_by_baud.values())


if __name__ == "__main__":
    sys.exit(main())
