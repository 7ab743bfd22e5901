"""Writes what a robot tells of a run into a file: what `tsc upload --record` leaves.

The form of the file is that of `studio/recordings.py`, which reads it. Each line is on the disk
before the next one comes.
"""

from __future__ import annotations

import json
from time import monotonic

from tiniscript.cli.robot.rows import Rows

MOST = 10_000  # events; then it is over
ENDS = ("DONE", "FAULT", "STOPPED", "MISSED")


class Recorder:
    """The recording of a run that has just begun, or that begins with its first event.

    Until there is one, the old file stays. Raises CommandError where it cannot be written.
    """

    def __init__(self, name: str, program: int, robot: str, has_begun: bool) -> None:
        from tiniscript.studio.recordings import VERSION

        head = {"tiniscript_recording": VERSION, "program": f"{program:08x}", "robot": robot}
        self._began_s = monotonic() if has_begun else None
        self._count = 0
        self._last_ms = 0
        self._is_over = False
        self._rows = Rows(name, (json.dumps(head) + "\n").encode(), "unwritable_recording")

    def add(self, _: int, name: str, what: str) -> None:
        """Add an event as `EventPrinter` tells it: times are those at which it came here."""
        if self._is_over or name not in ("SHOW", *ENDS):
            return
        from tiniscript.studio.recordings import MOST_MS

        now_s = monotonic()
        self._began_s = now_s if self._began_s is None else self._began_s
        ms = round((now_s - self._began_s) * 1000)
        self._count += 1
        if ms > MOST_MS or self._count >= MOST:
            self.end("STOPPED")
            return
        self._last_ms = ms
        if name in ENDS:
            self.end(f"FAULT {what}" if name == "FAULT" else name)
        else:
            self._put(f"SHOW {what}")

    def end(self, event: str) -> None:
        """The recording is over, if it was not: `event` is the last one."""
        if not self._is_over:
            self._is_over = True
            self._put(event)

    def close(self) -> None:
        """Close the file; a run whose end nobody has told was stopped by this computer."""
        try:
            self.end("STOPPED")
        finally:
            self._rows.close()

    def _put(self, event: str) -> None:
        self._rows.line(json.dumps({"ms": self._last_ms, "event": event}))
