"""The interface of chips for tests."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from tests.machines.host import Ran
from tiniscript.base.kit import Kit
from tiniscript.base.limits import CODE_BYTES
from tiniscript.bytecode.image import HEADER_BYTES

if TYPE_CHECKING:
    from tests.machines import Senses


class Chip(NamedTuple):
    """`missing` is the reason why there is none. `run` returns a run, or raises the refusal of the
    image."""

    missing: str
    run: Callable[[bytes, Kit, Senses], Ran]
    max_bytes: int = CODE_BYTES + HEADER_BYTES  # most bytes of an image


def agrees(run: Ran, expected: Ran, max_ms: int) -> bool:
    """Return whether a chip has done the same as the machine in Python.

    It counts jumps back and calls: a limit of steps cuts later than elsewhere.
    """
    text_before, _, last_line = expected.trace.removesuffix("\n").rpartition("\n")
    if last_line.endswith(" LIMIT") and last_line != f"{max_ms} LIMIT":
        return run.trace.startswith(text_before)
    return run._replace(steps=0) == expected._replace(steps=0) and run.steps <= expected.steps
