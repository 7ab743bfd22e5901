"""Serial ports: simultaneous reads by another program, and the end of a port."""

from __future__ import annotations

import errno
import os
import select
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing, nullcontext
from io import FileIO
from typing import NamedTuple

import pytest
from serial import SerialException, SerialTimeoutException

from tests.support.waiting import until
from tiniscript.link import errors
from tiniscript.link.errors import PortError
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
    port = os.ttyname(device_end)
    with FileIO(end, "r+") as our_end, ExitStack() as stack:
        if not request.param:
            stack.enter_context(closing(serial.open_port(port, 9600, 20.0)))
        with pytest.raises(PortError) if not request.param else nullcontext():
            serial.open_port(port, 9600, 20.0).close()  # the lock of another program ends with it
        device = serial.open_port(port, 9600, 20.0, is_exclusive=request.param)
        os.close(device_end)
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


@pytest.mark.parametrize("is_exclusive", [True, False])
def test_a_write_that_nobody_reads_ends(
    monkeypatch: pytest.MonkeyPatch, is_exclusive: bool
) -> None:
    """Of a stop past another program's lock, too."""
    monkeypatch.setattr(serial, "WRITE_S", 0.01)
    end, device_end = pty.openpty()
    tty.setraw(device_end)
    with FileIO(end, "r+"):
        device = serial.open_port(os.ttyname(device_end), 9600, 20.0, is_exclusive)
        failures: list[Exception] = []

        def write() -> None:
            try:
                device.write(bytes(1_000_000))
            except Exception as error:
                failures.append(error)

        writer = threading.Thread(target=write, daemon=True)
        writer.start()
        writer.join(10)
        assert [type(error) for error in failures] == [SerialTimeoutException]
        os.close(device_end)
        device.close()


def open_with(monkeypatch: pytest.MonkeyPatch, failure: BaseException) -> PortError:
    """Return what a port that cannot be opened because of a failure raises."""

    def fail(*_: object) -> None:
        raise failure

    monkeypatch.setattr(serial, "_make_serial", fail)
    with pytest.raises(PortError) as exception_info:
        serial.open_port("COM5", 9600, 20.0)
    return exception_info.value


@pytest.mark.parametrize(("reason", "numbers", "texts"), [
    (errors.MISSING, (errno.ENOENT, errno.ENODEV, errno.ENXIO),
     ("could not open port 'COM5': FileNotFoundError(2, 'x', None, 2)",)),
    (errors.FORBIDDEN, (errno.EACCES, errno.EPERM), ()),
    (errors.BUSY, (errno.EBUSY, errno.EAGAIN),
     ("could not open port 'COM5': PermissionError(13, 'x', None, 5)",)),
    (errors.UNREACHABLE,
     (errno.ECONNREFUSED, errno.ETIMEDOUT, errno.EHOSTUNREACH, errno.ENETUNREACH, errno.EHOSTDOWN),
     ("Could not open port socket://h:1: [Errno 111] Connection refused",
      "Could not open port rfc2217://h:1: timed out",
      "Remote does not seem to support RFC2217 or BINARY mode [we-BINARY:False(INITIALLY)]",
      "timeout while waiting for option 'baudrate'")),
    (errors.NO_PORT, (errno.ENOTTY, errno.EISDIR, errno.EINVAL),
     ("Could not configure port: (25, 'Inappropriate ioctl for device')",
      'expected a string in the form "socket://<host>:<port>"')),
    (errors.BROKEN, (errno.EIO, errno.ENOSPC), ("something new",)),
])  # fmt: skip
def test_a_failure_to_open_has_its_reason(
    monkeypatch: pytest.MonkeyPatch, reason: str, numbers: tuple[int, ...], texts: tuple[str, ...]
) -> None:
    """As a system's number, in an error of pyserial or without it, or as pyserial's text."""
    for number in numbers:
        for kind in (OSError, SerialException):
            error = open_with(monkeypatch, kind(number, os.strerror(number)))
            assert (error.reason, error.detail) == (reason, os.strerror(number)), number
    for text in texts:
        error = open_with(monkeypatch, SerialException(text))
        assert (error.reason, error.detail) == (reason, text)
    for bad_name in (ValueError("x"), NotImplementedError("x")):
        assert open_with(monkeypatch, bad_name).reason == errors.NO_PORT


def test_a_bug_that_opens_no_port_is_no_failure_of_the_port(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(ZeroDivisionError):
        open_with(monkeypatch, ZeroDivisionError())


def test_a_port_that_never_opens_holds_no_process_up(monkeypatch: pytest.MonkeyPatch) -> None:
    hangs, opening = threading.Event(), list[threading.Thread]()

    def hang(*_: object) -> None:
        opening.append(threading.current_thread())
        hangs.wait(10)

    monkeypatch.setattr(serial, "_make_serial", hang)
    for count in (1, 2):
        with pytest.raises(PortError) as exception_info:
            serial.open_port("COM5", 9600, 0.01)
        assert exception_info.value.reason == errors.SLOW
        until(lambda: bool(opening), "it opens")
        assert all(thread.daemon for thread in opening) and len(opening) <= count
    hangs.set()
