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
LISTEN_S = 0.3  # after which a guest who has said nothing hears that
FAREWELL_S = 2.0  # for which it may be read


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
        self._leaving: list[_Leaver] = []
        self._unsent = bytearray()

    @property
    def is_connected(self) -> bool:
        """Whether somebody is there. Of a pseudo-terminal nobody knows."""
        return self._guest is not None

    def wait(self, limit_s: float, is_full: bool = False) -> None:
        """Wait until something comes, at most for so long. `is_full`: nothing more is wanted."""
        watched: list[socket.socket | int] = [self._server, *(each.guest for each in self._leaving)]
        if not is_full:
            if self._guest is not None:
                watched.append(self._guest)
            elif self._ours >= 0:
                watched.append(self._ours)
        select.select(watched, [], [], limit_s)

    def receive(self) -> bytes:
        """Return what has come. Lets guests in and out."""
        self._let_in()
        self._see_off()
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
        for each in self._leaving:
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
        for guest in self._knocking():
            guest.setblocking(False)
            if self._guest is None:
                guest.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._guest = guest
                self._unsent.clear()
                self.visits += 1
            else:
                self._leaving.append(_Leaver(guest, monotonic()))

    def _knocking(self) -> Iterator[socket.socket]:
        while True:
            try:
                yield self._server.accept()[0]
            except OSError:
                return

    def _see_off(self) -> None:
        """Let those leave who cannot stay."""
        self._leaving = [each for each in self._leaving if not each.has_left()]

    def _part(self) -> None:
        if self._guest is not None:
            self._guest.close()
        self._guest = None
        self._unsent.clear()


class _Leaver:
    """A guest who has to leave, and is told so when it has said something.

    pyserial throws away what it hears before; and closing at once would take the word back.
    """

    def __init__(self, guest: socket.socket, came_s: float) -> None:
        self.guest = guest
        self._came_s = came_s
        self._is_told = False

    def has_left(self) -> bool:
        here_s = monotonic() - self._came_s
        try:
            data: bytes | None = self.guest.recv(READ_BYTES)
        except BlockingIOError:
            data = None
        except OSError:
            data = b""
        if data == b"" or here_s > FAREWELL_S:
            self.guest.close()
            return True
        if not self._is_told and (data or here_s > LISTEN_S):
            self._is_told = True
            with contextlib.suppress(OSError):  # it has gone already
                self.guest.send(TAKEN)
                self.guest.shutdown(socket.SHUT_WR)
        return False


def can_have_terminal() -> bool:
    """Whether this system has pseudo-terminals."""
    return hasattr(os, "openpty")
