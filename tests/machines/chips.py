"""What a chip answers to the request to run an image, whichever chip it is.

`vm_arduino/chip/runner.cpp` is the other side.
"""

from __future__ import annotations

from tests.machines.host import REFUSAL_NAMES, RULE_NAMES, Ran
from tiniscript.image import ImageRefused
from tiniscript.verify import Refused


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
