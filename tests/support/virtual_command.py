"""A virtual robot as the command starts it, and its visitors."""

from __future__ import annotations

import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.support.command import Command, CommandResult

FOREVER = "SI|LOOP(FOREVER);L(1, 30);END_LOOP"


class Robot:
    """A `tsc robot` that runs."""

    def __init__(self, *words: str | Path) -> None:
        self.command = Command("robot", *map(str, words))
        self.port = self.line()

    def line(self) -> str:
        assert self.command.process.stdout
        return self.command.process.stdout.readline().decode().removesuffix("\n")

    def until(self, text: str) -> list[str]:
        """Return the lines up to one that ends so."""
        lines: list[str] = []
        while not lines or not lines[-1].endswith(text):
            lines.append(self.line())
            assert lines[-1], f"it ends without {text}: {lines}"
        return lines

    def kill(self) -> None:
        self.command.kill()

    def end(self, number: int = signal.SIGINT) -> CommandResult:
        if self.command.process.poll() is None:
            self.command.signal(number)
        return self.command.wait_for_result()


@contextmanager
def robot(*arguments: str | Path) -> Iterator[Robot]:
    running_robot = Robot(*arguments)
    try:
        yield running_robot
    finally:
        running_robot.end(signal.SIGTERM)


def visitor(port: str) -> socket.socket:
    return socket.create_connection(("127.0.0.1", int(port.rpartition(":")[2])))
