"""A process that a test talks to, and what it says when it fails."""

from __future__ import annotations

import subprocess
import tempfile
import weakref
from collections.abc import Sequence
from pathlib import Path
from typing import IO


class Child:
    """A process with pipes; `who` it is stands in its mistakes.

    It ends with its object: one that nobody closes would stay for as long as the tests take, and a
    process has room for about a thousand pipes.
    """

    def __init__(self, command: Sequence[str | Path], who: str) -> None:
        self._who = who
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
        )
        self._closed = weakref.finalize(self, _close, self._process, self._errors)

    def end(self) -> None:
        self._process.kill()

    def close(self) -> None:
        self._closed()

    def has_ended(self) -> bool:
        return self._process.poll() is not None

    @property
    def pipes(self) -> tuple[IO[bytes], IO[bytes]]:
        """What it reads, and what it writes."""
        assert self._process.stdin and self._process.stdout
        return self._process.stdin, self._process.stdout

    def said(self) -> str:
        """Return the last words of a process that has ended: the sanitizers' report."""
        status = self._process.wait()
        self._errors.seek(0)
        report = self._errors.read().decode(errors="replace")
        return f"{self._who} ended with status {status}:\n{report[:4000]}"


def _close(process: subprocess.Popen[bytes], errors: IO[bytes]) -> None:
    process.kill()
    process.communicate()
    errors.close()
