"""The table of handlers, which turn instructions into functions; each family adds its own.

A handler is called once for each instruction of a program, with the machine, the offset after the
instruction and the operands; it returns the step that runs it, with these values bound. So the
running program needs no lookups. Knows no instruction.
"""

from __future__ import annotations

from collections.abc import Callable

Step = Callable[[], int]  # returns where the next instruction begins, `mark_stop` of that, or STAY
Handler = Callable[..., Step]

STAY = -(2**31)  # stop for now, and run this instruction again

HANDLERS: dict[str, Handler] = {}


def mark_stop(pc: int) -> int:
    """Mark an offset: the machine stops for now and continues at `pc`. Applied twice it is
    undone."""
    return ~pc


def handles(*names: str) -> Callable[[Handler], Handler]:
    """Note a handler under the names of its instructions."""

    def register(handler: Handler) -> Handler:
        for name in names:
            HANDLERS[name] = handler
        return handler

    return register
