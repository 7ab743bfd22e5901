"""The command `tsc` as tests use it: in this process, or as a process of its own."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import ClassVar
from unittest import mock
from weakref import WeakSet

import pytest

from tests.support.casefile import ROOT
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.cli import main

PROGRAM = "SI|F(5,80)"
OBSTACLE = (ROOT / "examples" / "obstacle.ts").read_text(encoding="utf-8")
FOREVER = "SI|LOOP(FOREVER);F(1, 80);END_LOOP"
# more than one frame, and of many short moves
LONG_PROGRAM = "LOOP(2);" + "".join(f"M({k}, 50);W(0.01);" for k in range(1, 54)) + "END_LOOP"
TSC = [sys.executable, "-m", "tiniscript"]


class CommandResult:
    """The result of a command: its exit code and its output."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, out, err
        assert "Traceback" not in err
        assert "ran into something unexpected" not in err
        if code:
            assert (err + out).strip(), "an exit code without a word"

    def __repr__(self) -> str:
        """Return the text that a failing test shows."""
        return f"exit code {self.code}, out {self.out!r}, err {self.err!r}"

    def gives(self, code: int, *err: str, out: str | tuple[str, ...] = ()) -> CommandResult:
        """Assert its exit code, and words of its errors and of its output: "" is nothing at all."""
        assert self.code == code, self
        for stream, expected in (
            (self.err, err),
            (self.out, (out,) if isinstance(out, str) else out),
        ):
            for words in expected:
                assert words in stream if words else not stream, (words, self)
        return self


class Tsc:
    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self.capsys = capsys

    def __call__(self, *arguments: str | Path) -> CommandResult:
        code = main([str(argument) for argument in arguments])
        capture_result = self.capsys.readouterr()
        return CommandResult(code, capture_result.out, capture_result.err)


def run_in_process(*arguments: str | Path, data: bytes = b"") -> CommandResult:
    """Run `tsc` in this process."""
    streams = [
        io.TextIOWrapper(io.BytesIO(data_in), encoding="utf-8") for data_in in (data, b"", b"")
    ]
    stdin, out, err = streams
    with mock.patch.object(sys, "stdin", stdin), redirect_stdout(out), redirect_stderr(err):
        code = main([str(argument) for argument in arguments])
        out.flush()
        err.flush()
    return CommandResult(
        code, *(text_iowrapper.buffer.getvalue().decode() for text_iowrapper in (out, err))
    )


def run_subprocess(*arguments: str | Path, data: bytes = b"") -> CommandResult:
    """Run `tsc` as a process of its own."""
    words = [*TSC, *map(str, arguments)]
    completed = subprocess.run(words, input=data, capture_output=True, timeout=HANG_LIMIT_S)
    return CommandResult(completed.returncode, completed.stdout.decode(), completed.stderr.decode())


class Command:
    """A `tsc` that stays."""

    started_commands: ClassVar[WeakSet[Command]] = WeakSet()

    def __init__(
        self, *arguments: str, code: str = "", data: bytes = b"",
        env: Mapping[str, str] | None = None,
    ) -> None:  # fmt: skip
        words = [sys.executable, "-c", code] if code else TSC
        self.process = subprocess.Popen(
            [*words, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, env={**os.environ, **(env or {})},
        )  # fmt: skip
        Command.started_commands.add(self)
        if data:
            assert self.process.stdin
            self.process.stdin.write(data)
            self.process.stdin.flush()

    def until(self, text: str, is_aside: bool = False) -> None:
        """Wait until it has printed a line with these words, on standard error if `is_aside`."""
        stream = self.process.stderr if is_aside else self.process.stdout
        assert stream
        for line in stream:
            if text in line.decode():
                return
        raise AssertionError(f"never printed: {text}. {self.wait_for_result().err}")

    @classmethod
    def is_any_there(cls) -> bool:
        """Return whether a robot in real time is still running."""
        return any(command.process.poll() is None for command in cls.started_commands)

    def signal(self, number: int) -> None:
        self.process.send_signal(number)

    def kill(self) -> None:
        self.process.kill()
        self.process.communicate()

    def wait_for_result(self) -> CommandResult:
        out, err = self.process.communicate(timeout=HANG_LIMIT_S)
        return CommandResult(self.process.returncode, out.decode(), err.decode())


def rest_of(terminal: int) -> bytes:
    """Return the output at a pseudo-terminal, or no bytes once it is closed."""
    try:
        return os.read(terminal, 65536)
    except OSError:  # Linux: the other end is closed
        return b""
