"""What a chip answers to the request to run an image, whichever chip it is.

`vm_arduino/extras/chip/runner.cpp` is the other side.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from tests.machines.host import REFUSAL_NAMES, RULE_NAMES, Ran
from tiniscript.base.kit import Kit
from tiniscript.base.limits import CODE_BYTES
from tiniscript.bytecode.image import HEADER_BYTES, ImageRefused
from tiniscript.bytecode.verify import Refused

if TYPE_CHECKING:
    from tests.machines import Senses


def ran(answer: str) -> Ran:
    """Return the run that an answer tells of, or raise what refuses the image."""
    trace, _, last = answer.removesuffix("\n").rpartition("\n")
    words = last.split()
    assert len(words) == 3, f"the chip ends with {answer[-2000:]!r}"
    first, second = int(words[1]), int(words[2])
    if words[0] == "REFUSED":
        raise ImageRefused(REFUSAL_NAMES[first])
    if words[0] == "BREAKS":
        raise Refused(RULE_NAMES[first], second)
    assert words[0] == "RAN", last
    return Ran(first, second, trace + "\n")


class Chip(NamedTuple):
    """`missing` says why there is none. `run` returns a run or raises what refuses the image."""

    missing: str
    run: Callable[[bytes, Kit, Senses], Ran]
    most_bytes: int = CODE_BYTES + HEADER_BYTES  # of an image
    counts_jumps: bool = False  # back, and calls: a limit of steps cuts later than elsewhere

    def agrees(self, got: Ran, want: Ran, max_ms: int) -> bool:
        """Whether the chip has done what the machine in Python has."""
        if not self.counts_jumps:
            return got == want
        before, _, last = want.trace.removesuffix("\n").rpartition("\n")
        if last.endswith(" LIMIT") and last != f"{max_ms} LIMIT":
            return got.trace.startswith(before) and got.steps <= want.steps
        return got._replace(steps=0) == want._replace(steps=0) and got.steps <= want.steps
