"""Who talks to a virtual robot: over TCP from this computer alone, or over a pseudo-terminal.

One at a time, as on a cable: whoever comes second is told so and has to leave. A caller comes in
when its first bytes may be meant for a robot; those of a browser never are. Callers have a number
and a time, so no connections keep out for ever the next one that speaks. Bytes go in and out; what
they mean is not known here.
"""

from __future__ import annotations

import contextlib
import os
import select
import socket
import sys
from time import monotonic, sleep

from tiniscript.virtual.first_bytes import is_for_robot

LOCAL = "127.0.0.1"
READ_BYTES = 1024
KEPT_BYTES = 65_536  # for a guest who does not read; more is lost, as on a serial line
TAKEN = b"Port already in use: another program is talking to this robot.\r\n"
PATIENT_S = 0.3  # for which a second caller waits before it is told
FAREWELL_S = 2.5  # for which it may read that
CALLERS = 64  # at a time: file descriptors are few (macOS: 256)
YOUNG_S = 0.25  # for which a caller is not dropped for a newer one
SILENT_S = 60.0  # for which a caller may say nothing,
OPENING_S = 10.0  # and for which its first bytes or line may take
IDLE_S = 10.0  # a guest that is silent for so long leaves its place to one who speaks
BACKLOG = 128


class Guests:
    """A port on this computer. Raises OSError where it cannot be had."""

    def __init__(self, port: int = 0, has_terminal: bool = False) -> None:
        self._server = socket.create_server((LOCAL, port), backlog=BACKLOG)
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
        self._heard_s = 0.0  # when the guest has said something
        self._callers: list[_Caller] = []  # the oldest first
        self._full_s = 0.0  # when there was no room for one more open file
        self._unsent = bytearray()

    @property
    def is_connected(self) -> bool:
        """Whether somebody is there. Of a pseudo-terminal nobody knows."""
        return self._guest is not None

    def wait(self, limit_s: float, is_full: bool = False) -> None:
        """Wait until something comes, at most for so long. `is_full`: nothing more is wanted."""
        watched: list[socket.socket | int] = [self._server] if self._has_room() else []
        watched += [each.peer for each in self._callers if each.is_told or not each.may_enter]
        limit_s = min(limit_s, PATIENT_S) if self._callers else limit_s
        if not watched:
            limit_s = min(limit_s, YOUNG_S / 4)
        if not is_full:
            if self._guest is not None:
                watched.append(self._guest)
            elif self._ours >= 0:
                watched.append(self._ours)
        if watched or sys.platform != "win32":
            select.select(watched, [], [], limit_s)
        else:  # Windows does not wait for nothing
            sleep(limit_s)

    def receive(self) -> bytes:
        """Return what has come. Lets guests in and out."""
        data = self._heard()
        first = self._let_in()
        return data if first is None else first

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
            self._heard_s = monotonic()
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
            each.peer.close()
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

    def _let_in(self) -> bytes | None:
        """Let the next caller in where there is room, and tell the others that there is none.

        Return the first bytes of a guest that has come, or None where none has.
        """
        self._accept()
        now_s = monotonic()
        self._callers = [each for each in self._callers if not each.has_left(now_s)]
        first = None
        speaker = next((each for each in self._callers if each.is_next), None)
        if speaker is not None and self._guest is not None and now_s > self._heard_s + IDLE_S:
            self._part()
        if speaker is not None and self._guest is None:
            self._callers.remove(speaker)
            self._guest, first = speaker.peer, speaker.opening
            self._unsent.clear()
            self._heard_s = now_s
            self.visits += 1
        if self._guest is not None:
            for caller in self._callers:
                caller.tell(now_s)
        return first

    def _accept(self) -> None:
        """Take new callers in, the oldest ones going first where there are too many."""
        for _ in range(CALLERS):
            if not self._has_room():
                return
            try:
                peer = self._server.accept()[0]
            except BlockingIOError:
                return
            except ConnectionError:  # it has gone already
                continue
            except OSError:  # this process has too many files open
                self._drop_oldest()
                self._full_s = monotonic()
                return
            if len(self._callers) >= CALLERS:
                self._drop_oldest()
            self._callers.append(_Caller(peer, monotonic()))

    def _has_room(self) -> bool:
        """Whether one more may come: each has had a moment in which to say something."""
        past_s = monotonic() - YOUNG_S
        is_few = len(self._callers) < CALLERS or self._callers[0].came_s < past_s
        return is_few and self._full_s < past_s

    def _drop_oldest(self) -> None:
        if self._callers:
            self._callers.pop(0).peer.close()

    def _part(self) -> None:
        if self._guest is not None:
            self._guest.close()
        self._guest = None
        self._unsent.clear()


class _Caller:
    """Somebody who wants to come in. Who waits for a while is told that another one is there.

    Not at once: the one before may be about to go, and pyserial throws away what it hears first.
    Whoever is told has time to read it: closing at once would take the word back.
    """

    def __init__(self, peer: socket.socket, came_s: float) -> None:
        peer.setblocking(False)
        with contextlib.suppress(OSError):  # it has gone already
            peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.peer = peer
        self.came_s = came_s
        self.opening = b""  # what it has said
        self.may_enter = False
        self.is_told = False
        self._limit_s = came_s + SILENT_S

    @property
    def is_next(self) -> bool:
        return self.may_enter and not self.is_told

    def has_left(self, now_s: float) -> bool:
        """Hear it; return whether it is gone, or has to go."""
        try:
            if self.may_enter and not self.is_told:
                is_over = not self.peer.recv(1, socket.MSG_PEEK)
            else:
                is_over = not self._hear(now_s)
        except BlockingIOError:
            is_over = False
        except OSError:
            is_over = True
        if is_over or (now_s > self._limit_s and not self.is_next):
            self.peer.close()
            return True
        return False

    def _hear(self, now_s: float) -> bool:
        """Take what has come; return whether more may come."""
        data = self.peer.recv(READ_BYTES)
        if not data or self.is_told:
            return bool(data)
        if not self.opening:
            self._limit_s = now_s + OPENING_S
        self.opening += data
        verdict = is_for_robot(self.opening)
        self.may_enter = verdict is True
        return verdict is not False

    def tell(self, now_s: float) -> None:
        if self.is_told or now_s < self.came_s + PATIENT_S:
            return
        self.is_told = True
        self._limit_s = now_s + FAREWELL_S
        with contextlib.suppress(OSError):  # it has gone already
            self.peer.send(TAKEN)
            self.peer.shutdown(socket.SHUT_WR)


def can_have_terminal() -> bool:
    """Whether this system has pseudo-terminals."""
    return hasattr(os, "openpty")
