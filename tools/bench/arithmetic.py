"""Compares a million operations on a simulated ATmega328P with `fixed_point.py`.

`python -m tools.bench.arithmetic` does those of `test_cpp_avr_arithmetic.py` with more seeds:
numbers of every size, one in eight an edge. It names the first operation that differs.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tests.vm.test_cpp_avr_arithmetic import BLOCK, BLOCKS, compare
from tools.bench import avr_bench

SEEDS = 40


def main() -> int:
    parser = argparse.ArgumentParser(description="Compare the AVR's arithmetic with Python's.")
    parser.add_argument("--seeds", type=int, default=SEEDS, help="of 25,000 operations each")
    seeds: int = parser.parse_args().seeds
    if avr_bench.missing():
        print(avr_bench.missing(), file=sys.stderr)
        return 2
    for seed in range(1, seeds + 1):
        compare(seed)
    print(f"{seeds * BLOCK * BLOCKS:,} operations, none differs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
