"""Writes what a robot tells of a run into a file: what `tsc upload --record` leaves.

The form of the file is that of `studio/recordings.py`, which reads it. Each line is flushed
before the next one comes.
"""

from __future__ import annotations

import json
from time import monotonic

from tiniscript.cli.robot.rows import Rows

MOST = 10_000  # events; then it is over
ENDS = ("DONE", "FAULT", "STOPPED", "MISSED")


class Recorder:
    """The recording of a run that began at `began_s` (monotonic); None: at its first event.

    Until there is one, the old file stays. Raises CommandError where it cannot be written.
    """

    def __init__(self, name: str, program: int, robot: str, began_s: float | None) -> None:
        from tiniscript.studio.recordings import VERSION

        head = {"tiniscript_recording": VERSION, "program": f"{program:08x}", "robot": robot}
        self._began_s = began_s
        self._count = 0
        self._is_over = False
        self._rows = Rows(name, (json.dumps(head) + "\n").encode(), "unwritable_recording")

    def add(self, _: int, name: str, what: str) -> None:
        """Add an event as `EventPrinter` tells it: times are those at which it came here."""
        if self._is_over or name not in ("SHOW", *ENDS):
            return
        from tiniscript.studio.recordings import MOST_MS

        now_s = monotonic()
        self._began_s = now_s if self._began_s is None else self._began_s
        ms = self._ms(now_s)
        self._count += 1
        if ms > MOST_MS or self._count >= MOST:
            self._end(ms, "STOPPED")
        elif name in ENDS:
            self._end(ms, f"FAULT {what}" if name == "FAULT" else name)
        else:
            self._put(ms, f"SHOW {what}")

    def end(self, event: str) -> None:
        """The recording is over now, if it was not: `event` is the last one."""
        if not self._is_over:
            self._end(self._ms(monotonic()), event)

    def close(self) -> None:
        """Close the file; a run whose end nobody has told was stopped by this computer."""
        try:
            self.end("STOPPED")
        finally:
            self._rows.close()

    def _ms(self, now_s: float) -> int:
        return 0 if self._began_s is None else round((now_s - self._began_s) * 1000)

    def _end(self, ms: int, event: str) -> None:
        from tiniscript.studio.recordings import MOST_MS

        self._is_over = True
        self._put(min(ms, MOST_MS), event)

    def _put(self, ms: int, event: str) -> None:
        self._rows.line(json.dumps({"ms": ms, "event": event}))
