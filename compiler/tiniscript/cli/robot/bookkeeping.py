"""The values that `tsc live` makes a robot show only to keep its variables, which are not
printed.
"""

from __future__ import annotations

from tiniscript.link.outcomes import Event

BOOKKEEPING_MARK = -(2**31)  # the smallest number there is


class Bookkeeping:
    """Recognizes the values in a run that `tsc live` uses to keep its variables."""

    def __init__(self) -> None:
        self.is_on = False

    def filter_event(self, event: Event) -> bool:
        if event.name in ("STARTED", "DONE", "FAULT", "STOPPED", "RESTARTED"):
            self.is_on = False
        elif event.name != "SHOW":
            return False
        elif event.value == BOOKKEEPING_MARK and not event.is_yes_no:
            self.is_on = True
        return self.is_on

    def filter_trace_event(self, name: str, values: tuple[int, ...]) -> bool:
        """Return whether to print an action in the trace of a virtual robot."""
        if name in ("START", "DONE", "FAULT", "STOP", "OFF"):
            self.is_on = False
        elif name == "SHOW" and values == (BOOKKEEPING_MARK,):
            self.is_on = True
        return self.is_on and name == "SHOW"
