"""Prints how much flash and RAM machine, link and reader of text take on each chip, linked.

The rows of `machine_size`, `link_size` and `text_size`, in one table. The link has what every robot
has: one transport, with the reader of text.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT)]

from tools.bench import link_size, machine_size, text_size
from tools.bench.machine_size import AVR, EMULATED, Size, missing
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


def main() -> int:
    print("| chip |", " | ".join(f"{part}: flash | RAM" for part in PARTS), "|")
    print("| --- |", " | ".join("---: | ---:" for _ in PARTS), "|")
    for name in (AVR, *EMULATED):
        if missing(name):
            print(missing(name), file=sys.stderr)
            continue
        sizes = [measure(name) for measure in PARTS.values()]
        print(f"| {name} |", " | ".join(f"{each.flash:,} | {each.ram}" for each in sizes), "|")
    return 0


if __name__ == "__main__":
    sys.exit(main())
