"""A simulated device on a pseudo-terminal: `tsc` opens `port`.

It uses wall-clock time or, if this process opens the port, the time of the simulation behind it.

A pseudo-terminal has no speed, but it keeps the one that was set: bytes at another speed than that
of the other end arrive garbled, as on a wire.
"""

from __future__ import annotations

import os
import select
import termios
import threading
import time
from contextlib import ExitStack

from tests.support.simulated_port import PtyPort, simulate
from tests.support.simulated_wire import OtherEnd, garble

_SPEEDS = {
    getattr(termios, name): int(name[1:])
    for name in ("B9600", "B19200", "B38400", "B57600", "B115200")
}
LARGEST_LAG_S = 1.0  # largest lag before its clock slows down


class PtyEnd(PtyPort):
    def __init__(self, end: OtherEnd) -> None:
        super().__init__()
        self.end = end
        self._in_here = ExitStack()
        self._is_over = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def __enter__(self) -> PtyEnd:
        self._in_here.enter_context(simulate(self))
        return self

    def __exit__(self, *_: object) -> None:
        self._in_here.close()
        self.pull()

    def pull(self) -> None:
        """Pull the cable out."""
        if self._is_over:
            return
        self._is_over = True
        self._thread.join()
        self._close()

    def _baud(self) -> int:
        """Return the speed that the computer has set."""
        return _SPEEDS.get(termios.tcgetattr(self.our_end)[5], 0) or self.end.baud

    def advance_ms(self, milliseconds: int, data: bytes = b"") -> bytes:
        reply = b""
        with self._lock:
            self.received += data
            for _ in range(milliseconds):
                speed = self.end.baud  # an answer has the speed of before the command
                answer = self.end.step(garble(data, self._baud(), speed))
                reply += garble(answer, speed, self._baud())
                data = b""
        return reply

    def _run(self) -> None:
        next_s = time.monotonic()
        while not self._is_over:
            next_s = max(next_s + 0.001, time.monotonic() - LARGEST_LAG_S)
            ready_ends, _, _ = select.select([self.our_end], [], [], 0)
            if self.simulated is None:
                reply = self.advance_ms(1, os.read(self.our_end, 4096) if ready_ends else b"")
                if reply:
                    os.write(self.our_end, reply)
            time.sleep(max(0.0, next_s - time.monotonic()))
