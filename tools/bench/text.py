"""Prints how quick a typed line is, from its end to the motor pins, on a simulated Uno.

Builds the firmware of the robot `tinibot` for each baud, offline stand-ins included, and types as a
terminal does: no session, no frames. Cycles are exact; radio modules and USB chips are not in them.
The figures of others were measured once.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools import uno
from tools.bench.compiler import OBSTACLE
from tools.bench.link import BAUDS, PHASE_CYCLES, built, first_move, row
from tools.uno import CYCLES_PER_MS, Uno

SHORT = "SI|F(2,80)"
SILENCE_MS = 1100  # what comes sooner after a stop is ignored
TRIES = 20  # the main loop is elsewhere each time: the slowest counts
MUST_MS, AIM_MS = 5.0, 1.0  # for the short line
OBSTACLE_AIM_MS = 10.0

OTHERS = (
    ("Snek 1.9, last character of a line to a pin", "2.5 ms"),
    ("FlashForth 5, the same", "6.9 ms"),
    ("Bitlash 2.0, the same", "0.6 ms"),
)


def typed(board: Uno, line: str, wait: int) -> tuple[float, float]:
    """Return the ms from the last byte of a line, its end, to the pins, and from its first."""
    board.run_to(board.cycle + wait * PHASE_CYCLES)
    began = board.cycle
    board.send(line.encode() + b"\n")
    board.run_ms(3 * len(line) + 200)
    at = first_move(board, began)
    heard = [byte for byte in board.received if began <= byte.began and byte.cycle <= at]
    if len(heard) != len(line) + 1:
        raise RuntimeError(f"the robot moved after {len(heard)} of {len(line) + 1} bytes")
    board.send(b"S\n")
    board.run_ms(SILENCE_MS)
    return (at - heard[-1].cycle) / CYCLES_PER_MS, (at - heard[0].began) / CYCLES_PER_MS


def slowest(board: Uno, line: str) -> tuple[float, float]:
    found = [typed(board, line, 300 + k) for k in range(TRIES)]
    ends, starts = zip(*found, strict=True)
    return max(ends), max(starts)


def measured(firmware: Path, baud: int) -> list[tuple[float, float]]:
    with Uno(firmware, baud=baud) as board:
        board.run_ms(SILENCE_MS)
        return [slowest(board, line) for line in (SHORT, OBSTACLE)]


def main() -> int:
    if uno.missing():
        print(uno.missing(), file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as name:
        try:
            found = {baud: measured(built(baud, Path(name)), baud) for baud in BAUDS}
        except RuntimeError as why:
            print(why, file=sys.stderr)
            return 2
    head = " | ".join(f"{baud} baud" for baud in BAUDS)
    print(f"| typed on a simulated Uno, ms | {head} | must | aim |\n|---|---:|---:|---:|---:|")
    rows = ((f"`{SHORT}`", str(MUST_MS), str(AIM_MS)),
            ("the paper's obstacle program", "", str(OBSTACLE_AIM_MS)))  # fmt: skip
    for number, (line, must, aim) in enumerate(rows):
        ends, starts = zip(*(each[number] for each in found.values()), strict=True)
        row(f"{line}, its end to the motor pins", [f"{each:.2f}" for each in ends], must, aim)
        row(f"{line}, its first start bit to the same", [f"{each:.2f}" for each in starts])
    print("\nBeside it:\n")
    for what, figure in OTHERS:
        print(f"- {what}: {figure}")
    return int(any(each[0][0] > MUST_MS for each in found.values()))


if __name__ == "__main__":
    sys.exit(main())
