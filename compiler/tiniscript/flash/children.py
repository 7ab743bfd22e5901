"""Child programs: reads their output while they run, and ensures that they end with this process.

Knows processes. It does not know what they do, and prints nothing.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Thread, current_thread, main_thread

LOG_BYTES = 1 << 20  # most bytes of a program's output that are kept, the last ones
POLL_INTERVAL_S = 0.1
KILL_DELAY_S = 5.0  # time that a program gets to exit by itself


class CannotStart(OSError):
    """A program is not there, or may not be started."""


def run(
    command: list[str],
    folder: Path | None,
    on_output: Callable[[str], None],
    environment: Mapping[str, str] | None = None,
    may_end: Callable[[str], bool] = lambda output: True,
    exit_timeout_s: float | None = None,
) -> tuple[int, str]:
    """Run a program in a folder, or here; return its exit code, and its output.

    `on_output` gets the output so far, ten times a second. An exception, such as Ctrl-C, ends the
    program and its children; if its output shows that it must not be interrupted, it is awaited
    first. Raises CannotStart, and TimeoutExpired where it has not ended `exit_timeout_s` after its
    last output.
    """
    with _hold_interrupt() as release_interrupt:
        try:
            process = subprocess.Popen(
                command,
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                # Puts its children in the same group, so that they end with it.
                start_new_session=True,
            )
        except OSError as error:
            raise CannotStart(*error.args) from error
        assert process.stdout
        pipe, output = process.stdout, bytearray()

        def read() -> None:
            with pipe:
                while data := os.read(pipe.fileno(), 1 << 16):
                    output.extend(data)
                    del output[:-LOG_BYTES]

        reader = Thread(target=read, daemon=True)
        try:
            release_interrupt()
            reader.start()
            while True:  # looks at least once, because it may already have ended
                reader.join(POLL_INTERVAL_S)
                on_output(output.decode(errors="replace"))
                if not reader.is_alive():
                    break
            exit_code = process.wait(exit_timeout_s)
        except BaseException:
            if may_end(output.decode(errors="replace")):
                _end(process)
            else:
                process.wait()
                _kill(process)
            if reader.is_alive():  # a thread that reads while Python ends can take it down
                reader.join(KILL_DELAY_S)
            raise
    _kill(process)  # its children may continue, and hold a port
    return exit_code, output.decode(errors="replace")


@contextmanager
def _hold_interrupt() -> Iterator[Callable[[], None]]:
    """Delay Ctrl-C until the yielded function is called, because a starting program could not be
    ended.

    Only the main thread gets it.
    """
    if current_thread() is not main_thread():
        yield lambda: None
        return
    interrupts: list[int] = []
    handler_before = signal.signal(signal.SIGINT, lambda number, frame: interrupts.append(number))

    def release_interrupt() -> None:
        signal.signal(signal.SIGINT, handler_before)
        if interrupts:
            interrupts.clear()
            signal.raise_signal(signal.SIGINT)

    try:
        yield release_interrupt
    finally:
        release_interrupt()


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a program and its children: it may be in the middle of storing a download."""
    try:
        if sys.platform != "win32":
            with suppress(OSError, subprocess.TimeoutExpired):
                os.killpg(process.pid, signal.SIGINT)
                process.wait(KILL_DELAY_S)
    finally:  # a second Ctrl-C must not skip this
        _kill(process)


def _kill(process: subprocess.Popen[bytes]) -> None:
    with suppress(OSError):  # the process and its group may be gone
        if sys.platform != "win32":
            os.killpg(process.pid, signal.SIGKILL)
        elif process.poll() is None:
            words = ["taskkill", "/F", "/T", "/PID", str(process.pid)]
            subprocess.run(words, capture_output=True, check=False)
    process.kill()
    process.wait()


def reason(log: str) -> str:
    """Return the most useful line of a program's output: the first error, else the last."""
    rows = [row.strip() for row in log.splitlines() if re.search(r"\w", row)]
    errors = [row for row in rows if re.search(r"\berror\b", row, re.IGNORECASE)]
    error_like_rows = [row for row in rows if "Error" in row]
    best_row = (errors or error_like_rows or rows[-1:] or [""])[0]
    return best_row[-200:].rstrip(": ")
