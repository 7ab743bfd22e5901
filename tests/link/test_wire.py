"""The wire of a port: how long it listens, and its reaction to a lost port."""

from __future__ import annotations

import pytest

from tiniscript.link.wire import MAX_BYTES, Wire


class Port:
    """The part of pyserial that a wire uses: `answers` arrive one for each wait."""

    def __init__(self, *answers: bytes) -> None:
        self.answers = list(answers)
        self.timeout = 0.0
        self.waits: list[float] = []
        self.in_waiting = 0
        self.lines: list[tuple[str, bool]] = []
        self._unread = b""

    def read(self, count: int) -> bytes:
        if not self._unread:
            self.waits.append(self.timeout)
            self._unread = self.answers.pop(0) if self.answers else b""
        data, self._unread = self._unread[:count], self._unread[count:]
        self.in_waiting = len(self._unread)
        return data

    def __setattr__(self, name: str, value: object) -> None:
        if name in ("dtr", "rts"):
            self.lines.append((name, bool(value)))
        if name == "baudrate" and value == 7:
            raise ValueError("no such speed")
        super().__setattr__(name, value)


def test_receive_waits_for_the_first_byte_and_then_for_silence() -> None:
    port = Port(b"OK\r", b"\n+")
    assert Wire(port).receive(500, 60) == b"OK\r\n+"
    assert port.waits == [0.5, 0.06, 0.06]
    assert Wire(Port()).receive(500) == b""


def test_receive_does_not_listen_for_ever() -> None:
    port = Port(*[b"x" * 100] * 1000)
    assert MAX_BYTES <= len(Wire(port).receive(500)) < MAX_BYTES + 100


def test_a_board_restarts_when_its_control_lines_return() -> None:
    port = Port()
    Wire(port).reset_board()
    assert sorted(port.lines[:2]) == [("dtr", False), ("rts", False)]
    assert sorted(port.lines[2:]) == [("dtr", True), ("rts", True)]


def test_failures_raise_an_os_error() -> None:
    class Closed(Port):
        def read(self, count: int) -> bytes:
            raise TypeError("None")  # pyserial, where the port is closed

        def write(self, data: bytes) -> None:
            raise TypeError("None")

    wire = Wire(Closed())
    for use in (lambda: wire.receive(10), lambda: wire.send(b"x"), lambda: wire.set_baud(7)):
        with pytest.raises(OSError):
            use()
