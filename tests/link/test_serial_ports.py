"""Serial ports: simultaneous reads by another program, and the end of a port."""

from __future__ import annotations

import os
import select
from collections.abc import Iterator
from io import FileIO
from typing import NamedTuple

import pytest

from tiniscript.link.transports import Port, serial

NO_PTY = "Windows has no pseudo-terminals"
pty = pytest.importorskip("pty", reason=NO_PTY)
tty = pytest.importorskip("tty", reason=NO_PTY)


class Line(NamedTuple):
    our_end: FileIO  # the other end
    port: Port


@pytest.fixture(params=[True, False], ids=["alone", "past a lock"])
def line(request: pytest.FixtureRequest) -> Iterator[Line]:
    end, device_end = pty.openpty()
    tty.setraw(device_end)
    device = serial.open_port(os.ttyname(device_end), 9600, 20.0, is_exclusive=request.param)
    os.close(device_end)
    with FileIO(end, "r+") as our_end:
        yield Line(our_end, device)
    device.close()


@pytest.fixture
def without_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulate a wait that reports bytes at once, like that of a process suspended afterwards."""
    monkeypatch.setattr(select, "select", lambda readers, *_: (readers[:1], [], []))


@pytest.mark.usefixtures("without_wait")
def test_bytes_read_by_another_program_end_nothing(line: Line) -> None:
    line.our_end.write(b"ab")
    assert [line.port.read(1) for _ in range(4)] == [b"a", b"b", b"", b""]
    line.our_end.write(b"c")
    assert line.port.read(1) == b"c"


def test_a_vanished_port_raises_an_error(line: Line) -> None:
    line.our_end.write(b"a")
    assert line.port.read(1) == b"a"
    line.our_end.close()
    with pytest.raises(OSError):
        line.port.read(1)
