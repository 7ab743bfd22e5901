"""Other programs that run for this one: what they say meanwhile, and that they end with it.

Knows processes. Does not know what they do; prints nothing.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from threading import Thread

LOG_BYTES = 1 << 20  # of what a program says; the last ones
LOOK_S = 0.2
KILLED_AFTER_S = 5.0  # that a program has to end by itself


def run(
    command: list[str],
    folder: Path,
    look: Callable[[str], None],
    environment: Mapping[str, str] | None = None,
    may_end: Callable[[str], bool] = lambda said: True,
) -> tuple[int, str]:
    """Run a program in a folder; return its exit code, and what it has said.

    `look` gets what it has said until now, five times a second. An exception, such as Ctrl-C,
    ends the program and its children; where it may not end after what it has said, it is waited for
    first. Raises OSError where it cannot be started.
    """
    running = subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,  # it has children, which end with it
    )
    assert running.stdout
    pipe, said = running.stdout, bytearray()

    def read() -> None:
        with pipe:
            while data := os.read(pipe.fileno(), 1 << 16):
                said.extend(data)
                del said[:-LOG_BYTES]

    reader = Thread(target=read, daemon=True)
    reader.start()
    try:
        while reader.is_alive():
            reader.join(LOOK_S)
            look(said.decode(errors="replace"))
        code = running.wait()
    except BaseException:
        if may_end(said.decode(errors="replace")):
            _end(running)
        else:
            running.wait()
        raise
    return code, said.decode(errors="replace")


def _end(running: subprocess.Popen[bytes]) -> None:
    """End a program and its children: it may be in the middle of keeping what it has fetched."""
    for gently in (True, False):
        try:
            if sys.platform == "win32":
                running.kill()
            else:
                os.killpg(running.pid, signal.SIGINT if gently else signal.SIGKILL)
            running.wait(KILLED_AFTER_S)
        except subprocess.TimeoutExpired:
            continue
        except OSError:
            pass
        return


def reason(log: str) -> str:
    """Return the most useful line of what a program has said: the first error, else the last."""
    rows = [row.strip() for row in log.splitlines() if re.search(r"\w", row)]
    errors = [row for row in rows if re.search(r"\berror\b", row, re.IGNORECASE)]
    others = [row for row in rows if "Error" in row]
    chosen = (errors or others or rows[-1:] or [""])[0]
    return chosen[-200:].rstrip(": ")
