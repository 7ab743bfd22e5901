"""Counts the instructions of the machine on the emulated chips of ESP boards.

QEMU's clock goes on by the same time for each instruction (`-icount`). What a loop takes is the
difference of two runs, one of which goes around it twice as often: all else is in both.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path
from struct import pack

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tests.machines import Senses
from tests.machines.qemu import Emulated, built, missing
from tools.bench.workloads import KIT, Work, check, image_of

TIMES = 1000  # around a loop, and twice as often
SPIN = 500_000  # turns of two instructions
WHOLE = 1 << 32  # of the clock
COUNTING = ("-icount", "shift=7,sleep=off")

__all__ = ("Counting", "missing")


@dataclass
class Counting:
    """An emulator of a chip that counts."""

    name: str

    def __post_init__(self) -> None:
        self._chip = Emulated(self.name, built(self.name), COUNTING)
        one, two = self._spun(SPIN), self._spun(2 * SPIN)
        self._of_one = (two - one) / (2 * SPIN)

    def close(self) -> None:
        self._chip.close()

    def per_iteration(self, work: Work) -> float:
        """Return the instructions of all of `tick`, for each time around a loop.

        Raises WrongResult.
        """
        one, two = (self._ran(work._replace(times=times)) for times in (TIMES, 2 * TIMES))
        return (two - one) / self._of_one / TIMES

    def _ran(self, work: Work) -> int:
        senses = Senses({"DISTANCE": work.thousandths})
        before = self._clock()
        said = self._chip.run(image_of(work), KIT, senses).trace
        took = (self._clock() - before) % WHOLE
        shown = [round(1000 * float(text)) for text in re.findall(r" SHOW (\S+)", said)]
        check(self.name, work, shown)
        return took

    def _spun(self, times: int) -> int:
        before = self._clock()
        return (self._clock(times) - before) % WHOLE

    def _clock(self, times: int = 0) -> int:
        return int.from_bytes(self._chip.ask(b"C", pack("<I", times)), "little")
