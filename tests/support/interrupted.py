"""A bell at which Ctrl-C is pressed while somebody waits for the first time."""

from __future__ import annotations

from collections.abc import Callable

from tiniscript.base.bell import Bell


def interrupted_bell(until_pressed: Callable[[], object]) -> type[Bell]:
    """Return a kind of bell whose first wait lasts until then, and raises KeyboardInterrupt."""

    class InterruptedBell(Bell):
        has_waited = False

        def wait(self, timeout_s: float) -> bool:
            if not self.has_waited:
                self.has_waited = True
                until_pressed()
                raise KeyboardInterrupt
            return super().wait(timeout_s)

    return InterruptedBell
