"""Prints what the chips of robots take: flash and RAM of each part, and the machine's instructions.

The rows of `machine_size`, `link_size` and `text_size`, in one table. The link has what every robot
has: one transport, with the reader of text. Instructions of an ESP's chip are counted by QEMU,
which knows no cycles: the chips' pipelines, caches and flash are not in them. An AVR's are cycles.
Then what an upload takes over Bluetooth LE, and the host build of an ESP32 from a frame's last byte
to its pins.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT)]

from tools.bench import (
    emulated_counts,
    esp32_frames,
    link_size,
    machine_cycles,
    machine_size,
    text_size,
)
from tools.bench.avr_bench import missing as no_avr
from tools.bench.compiler import table
from tools.bench.machine_size import AVR, EMULATED, Size, missing
from tools.bench.workloads import WORKS
from tools.builds import chips


def link(name: str) -> Size:
    """Return what the link adds to a program with the machine."""
    if name == AVR:
        return link_size.size()
    with_it, without = (
        Size(*chips.size(EMULATED[name], link_size.probe(use), "link", "text"))
        for use in (link_size.LINK, "")
    )
    return Size(with_it.flash - without.flash, with_it.ram - without.ram)


PARTS: dict[str, Callable[[str], Size]] = {
    "machine and verifier": lambda name: machine_size.size(name, "machine and verifier"),
    "link, with text": link,
    "reader of text alone": lambda name: text_size.size(name, "reader"),
}


def sizes() -> None:
    print("| chip |", " | ".join(f"{part}: flash | RAM" for part in PARTS), "|")
    print("| --- |", " | ".join("---: | ---:" for _ in PARTS), "|")
    for name in (AVR, *EMULATED):
        if missing(name):
            print(missing(name), file=sys.stderr)
            continue
        found = [measure(name) for measure in PARTS.values()]
        print(f"| {name} |", " | ".join(f"{each.flash:,} | {each.ram}" for each in found), "|")


def instructions() -> None:
    rows: list[tuple[object, ...]] = []
    for name, chip in chips.CHIPS.items():
        if emulated_counts.missing(name):
            print(emulated_counts.missing(name), file=sys.stderr)
            continue
        counting = emulated_counts.Counting(name)
        found = [round(counting.per_iteration(work)) for work in WORKS]
        counting.close()
        rows.append((chip.board, "instructions", *found))
    if not no_avr():
        found = [round(machine_cycles.per_iteration(work)) for work in WORKS]
        rows.append((AVR, "cycles", *found))
    title = "One iteration of A, B and C, all of `tick`"
    table(title, ("", "of", "A", "B", "C"), rows)


def main() -> int:
    sizes()
    instructions()
    esp32_frames.main()
    return 0


if __name__ == "__main__":
    sys.exit(main())
