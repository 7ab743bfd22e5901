"""Who talks to a virtual robot: over TCP from this computer alone, or over a pseudo-terminal.

One at a time, as on a cable: whoever comes second is told so and has to leave. Bytes go in and out;
what they mean is not known here.
"""

from __future__ import annotations

import contextlib
import os
import select
import socket
from collections.abc import Iterator
from time import monotonic

LOCAL = "127.0.0.1"
READ_BYTES = 1024
KEPT_BYTES = 65_536  # for a guest who does not read; more is lost, as on a serial line
TAKEN = b"Port already in use: another program is talking to this robot.\r\n"
PATIENT_S = 0.3  # for which one who comes second stands at the door
FAREWELL_S = 2.5  # after which it has left


class Guests:
    """A port on this computer. Raises OSError where it cannot be had."""

    def __init__(self, port: int = 0, has_terminal: bool = False) -> None:
        self._server = socket.create_server((LOCAL, port), backlog=8)
        self._server.setblocking(False)
        self.port: int = self._server.getsockname()[1]
        self.address = f"socket://{LOCAL}:{self.port}"
        self.terminal = ""  # the path of the pseudo-terminal
        self.visits = 0  # how many have come to stay
        self._ours, self._theirs = -1, -1
        if has_terminal:
            try:
                self._open_terminal()
            except BaseException:
                self._server.close()
                raise
        self._guest: socket.socket | None = None
        self._callers: list[_Caller] = []
        self._unsent = bytearray()

    @property
    def is_connected(self) -> bool:
        """Whether somebody is there. Of a pseudo-terminal nobody knows."""
        return self._guest is not None

    def wait(self, limit_s: float, is_full: bool = False) -> None:
        """Wait until something comes, at most for so long. `is_full`: nothing more is wanted."""
        watched: list[socket.socket | int] = [self._server]
        watched += [each.guest for each in self._callers if each.is_told]
        limit_s = min(limit_s, PATIENT_S) if self._callers else limit_s
        if not is_full:
            if self._guest is not None:
                watched.append(self._guest)
            elif self._ours >= 0:
                watched.append(self._ours)
        select.select(watched, [], [], limit_s)

    def receive(self) -> bytes:
        """Return what has come. Lets guests in and out."""
        data = self._heard()
        self._let_in()
        return data

    def _heard(self) -> bytes:
        if self._guest is not None:
            try:
                data = self._guest.recv(READ_BYTES)
            except BlockingIOError:
                return b""
            except OSError:
                data = b""
            if not data:
                self._part()
            return data
        if self._ours >= 0:
            with contextlib.suppress(OSError):  # nothing there
                return os.read(self._ours, READ_BYTES)
        return b""

    def send(self, data: bytes) -> None:
        """Send bytes to whoever is there; nobody, and they are lost."""
        if self._guest is None:
            if self._ours >= 0 and data:
                with contextlib.suppress(OSError):  # nobody reads, and its buffer is full
                    os.write(self._ours, data)
            return
        self._unsent += data[: KEPT_BYTES - len(self._unsent)]
        if not self._unsent:
            return
        try:
            done = self._guest.send(self._unsent)
            del self._unsent[:done]
        except BlockingIOError:
            pass
        except OSError:
            self._part()

    def close(self) -> None:
        self._part()
        for each in self._callers:
            each.guest.close()
        self._server.close()
        for end in (self._ours, self._theirs):
            if end >= 0:
                os.close(end)

    def _open_terminal(self) -> None:
        import pty
        import tty

        self._ours, self._theirs = pty.openpty()  # ours to keep, both: or it would hang up
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.terminal = os.ttyname(self._theirs)

    def _let_in(self) -> None:
        """Let the next one in where there is room, and tell the others that there is none."""
        self._callers += [_Caller(each, monotonic()) for each in self._knocking()]
        self._callers = [each for each in self._callers if not each.has_left()]
        for caller in self._callers:
            if self._guest is None and not caller.is_told:
                self._guest = caller.guest
                self._unsent.clear()
                self.visits += 1
        self._callers = [each for each in self._callers if each.guest is not self._guest]
        for caller in self._callers:
            caller.tell()

    def _knocking(self) -> Iterator[socket.socket]:
        while True:
            try:
                yield self._server.accept()[0]
            except OSError:  # nobody, or gone already
                return

    def _part(self) -> None:
        if self._guest is not None:
            self._guest.close()
        self._guest = None
        self._unsent.clear()


class _Caller:
    """Somebody at the door. Who has stood there for a while is told to leave.

    Not at once: the one before may be about to go, and pyserial throws away what it hears first.
    Whoever is told has time to read it: closing at once would take the word back.
    """

    def __init__(self, guest: socket.socket, came_s: float) -> None:
        guest.setblocking(False)
        with contextlib.suppress(OSError):  # it has gone already
            guest.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.guest = guest
        self.is_told = False
        self._came_s = came_s

    def has_left(self) -> bool:
        try:
            is_gone = not self.guest.recv(1, socket.MSG_PEEK)
            if self.is_told and not is_gone:
                self.guest.recv(READ_BYTES)
        except BlockingIOError:
            is_gone = False
        except OSError:
            is_gone = True
        if is_gone or monotonic() > self._came_s + FAREWELL_S:
            self.guest.close()
            return True
        return False

    def tell(self) -> None:
        if self.is_told or monotonic() < self._came_s + PATIENT_S:
            return
        self.is_told = True
        with contextlib.suppress(OSError):  # it has gone already
            self.guest.send(TAKEN)
            self.guest.shutdown(socket.SHUT_WR)


def can_have_terminal() -> bool:
    """Whether this system has pseudo-terminals."""
    return hasattr(os, "openpty")
