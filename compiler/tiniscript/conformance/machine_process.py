"""A machine as a process of its own: it is asked for runs on its standard input, and answers.

Knows the process, its time and its bounds: one that hangs, crashes, floods or continues after its
answer ends as a Problem. It does not know what an answer should be. The form:
`docs/develop/conformance.md`.
"""

from __future__ import annotations

import contextlib
import os
import queue
import shlex
import signal
import subprocess
import sys
import threading
import time
from typing import IO, NoReturn

ENDING_WORDS = (
    "DONE",
    "FAULT",
    "LIMIT",
    "REFUSED",
)  # a line with one of them is the last of an answer
CHUNK_BYTES = 1 << 16
SPARE_BYTES = 1 << 18  # bytes that an answer may exceed the right one by
TAIL_BYTES = 2000  # bytes of standard error that are kept to be shown
EXIT_TIMEOUT_S = 0.5  # time for a process to exit after its output has ended


class Problem(Exception):
    """No answer. `kind` is hang, crash, flood or more; `detail` is the exit code or its output;
    `rows` are the lines that came before."""

    def __init__(self, kind: str, detail: str, rows: tuple[str, ...]) -> None:
        super().__init__(kind)
        self.kind = kind
        self.detail = detail
        self.rows = rows


class CannotStart(Exception):
    """The command does not start a process."""


def ends_answer(row: str) -> bool:
    """Return whether a line ends an answer."""
    words = row.split(" ", 2)
    return words[0] == "REFUSED" or (
        len(words) > 1 and words[0].isdigit() and words[1] in ENDING_WORDS
    )


class MachineProcess:
    """Starts the command when it is asked first, and again where the process has ended."""

    def __init__(self, command: str, timeout_s: float) -> None:
        self.command = command
        self.timeout_s = timeout_s
        self._process: subprocess.Popen[bytes] | None = None
        self._answer_count = 0  # answers of this process

    def ask(self, request: str, expected_bytes: int) -> tuple[str, ...]:
        """Return the lines of an answer. Raises Problem and CannotStart.

        A process that has answered before may have ended since: then a new one is asked.
        """
        most_bytes = expected_bytes + SPARE_BYTES
        if self._answer_count:
            with contextlib.suppress(_ProcessEnded):
                return self._query(request, most_bytes)
            self.close()
        try:
            return self._query(request, most_bytes)
        except _ProcessEnded as error:
            exit_code = error.exit_code
        self._fail("crash", str(exit_code), [])

    def close(self) -> str:
        """End the process and all that it has started; return the end of its standard error."""
        process, self._process, self._answer_count = self._process, None, 0
        if process is None:
            return ""
        if sys.platform != "win32":
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)
        process.kill()
        process.wait()
        self._requests.put(b"")
        end_s = time.monotonic() + EXIT_TIMEOUT_S
        while self._reader.is_alive() and time.monotonic() < end_s:
            with contextlib.suppress(queue.Empty):  # the queue may be full
                self._chunks.get(timeout=0.01)
        self._error_reader.join(EXIT_TIMEOUT_S)
        lines = bytes(self._tail).decode("utf-8", "replace").strip().splitlines()
        return lines[-1] if lines else ""

    def _start(self) -> subprocess.Popen[bytes]:
        try:
            command: str | list[str] = self.command
            if sys.platform != "win32":  # Windows programs split their command lines themselves
                command = shlex.split(self.command)
            if not command:
                raise ValueError("no command")
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                start_new_session=True,
            )
        except (OSError, ValueError) as error:
            raise CannotStart(getattr(error, "strerror", None) or str(error)) from None
        assert process.stdin and process.stdout and process.stderr
        self._chunks: queue.Queue[bytes] = queue.Queue(maxsize=64)
        self._tail = bytearray()
        self._unread = b""
        self._error_reader = _start_thread(self._keep_tail, process.stderr)
        self._reader = _start_thread(self._read, process.stdout, self._chunks)
        self._requests: queue.Queue[bytes] = queue.Queue()
        _start_thread(self._write, process.stdin, self._requests)
        return process

    @staticmethod
    def _read(pipe: IO[bytes], chunks: queue.Queue[bytes]) -> None:
        """Pass on its output; an empty text is the end.

        Each thread closes its own pipe: if another thread closed it between `fileno` and `read`,
        the number could already belong to the pipe of the next process, whose answer would be read
        here.
        """
        data = b"?"
        with pipe:
            while data:
                try:
                    data = os.read(pipe.fileno(), CHUNK_BYTES)
                except OSError:
                    data = b""
                chunks.put(data)

    def _keep_tail(self, pipe: IO[bytes]) -> None:
        tail = self._tail
        with contextlib.suppress(OSError), pipe:
            while data := os.read(pipe.fileno(), CHUNK_BYTES):
                tail += data
                del tail[:-TAIL_BYTES]

    @staticmethod
    def _write(pipe: IO[bytes], requests: queue.Queue[bytes]) -> None:
        with contextlib.suppress(OSError), pipe:
            while request := requests.get():
                pipe.write(request)
                pipe.flush()

    def _query(self, request: str, most_bytes: int) -> tuple[str, ...]:
        if self._process is None:
            self._process = self._start()
        self._requests.put(request.encode())
        end_s = time.monotonic() + self.timeout_s
        rows: list[str] = []
        byte_count = 0
        while True:
            *lines, self._unread = self._unread.split(b"\n")
            for number, line in enumerate(lines, 1):
                rows.append(line.decode("utf-8", "replace").removesuffix("\r"))
                if ends_answer(rows[-1]):
                    extra = b"\n".join([*lines[number:], self._unread])
                    if extra:
                        self._fail("more", extra.decode("utf-8", "replace"), rows)
                    self._answer_count += 1
                    return tuple(rows)
            try:
                data = self._chunks.get(timeout=max(end_s - time.monotonic(), 0))
            except queue.Empty:
                self._fail("hang", self._unread.decode("utf-8", "replace"), rows)
            if not data:
                exit_code = self._exit_code()
                if rows or self._unread:
                    rows += [self._unread.decode("utf-8", "replace")] if self._unread else []
                    self._fail("crash", str(exit_code), rows)
                raise _ProcessEnded(exit_code)
            byte_count += len(data)
            self._unread += data
            if byte_count > most_bytes:
                self._fail("flood", "", rows)

    def _exit_code(self) -> int | None:
        assert self._process is not None
        try:
            return self._process.wait(EXIT_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            return None

    def _fail(self, kind: str, detail: str, rows: list[str]) -> NoReturn:
        tail = self.close()
        if kind == "crash" and tail:
            detail = f"{detail}: {tail}"
        raise Problem(kind, detail, tuple(rows))


class _ProcessEnded(Exception):
    """The process has ended without a byte of an answer."""

    def __init__(self, exit_code: int | None) -> None:
        super().__init__(exit_code)
        self.exit_code = exit_code


def _start_thread(target: object, *arguments: object) -> threading.Thread:
    thread = threading.Thread(target=target, args=arguments, daemon=True)  # type: ignore[arg-type]
    thread.start()
    return thread
