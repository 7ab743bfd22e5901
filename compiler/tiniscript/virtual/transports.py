"""The transports of a virtual robot: TCP from this computer and user, or a pseudo-terminal.

There is one client at a time, as on a cable: a second one is refused with a message. A caller
becomes the client when its first bytes may be meant for a robot; a browser's never are. The
number and the time of callers are limited, so idle connections cannot block a new client. Does
not know what the bytes mean. A line can be bad on purpose: bytes get lost or change, or come late.
"""

from __future__ import annotations

import contextlib
import os
import select
import socket
import sys
from collections import deque
from random import Random
from time import monotonic, sleep

from tiniscript.link.messages import SILENCE_MS
from tiniscript.link.sharing.peers import is_of_this_user
from tiniscript.link.typed_stop import is_at_stop
from tiniscript.virtual.directory import LOCAL_HOST
from tiniscript.virtual.protocol_sniffer import sniff_robot_client

READ_BYTES = 1024
KEPT_BYTES = 65_536  # buffer for a client that does not read; more is lost, as on a serial line
PORT_TAKEN = b"Port already in use: another program is talking to this robot.\r\n"
PATIENCE_S = 0.3  # a second caller waits this long before it is told
FAREWELL_S = 2.5  # and has this long to read the message
MOST_CALLERS = 64  # at a time: file descriptors are few (macOS: 256)
PROTECTED_S = 0.25  # a caller is not dropped for a newer one within this time
SILENT_S = 60.0  # timeout of a caller that sends nothing,
OPENING_S = 10.0  # and of one whose first bytes or line are incomplete
IDLE_S = 10.0  # a client that is silent for this time is replaced by a caller that sends
BACKLOG = 128


class Transports:
    """A port on this computer. Raises OSError where it cannot be had."""

    def __init__(self, port: int = 0, has_terminal: bool = False) -> None:
        self._server = socket.create_server((LOCAL_HOST, port), backlog=BACKLOG)
        self._server.setblocking(False)
        self.port: int = self._server.getsockname()[1]
        self.address = f"socket://{LOCAL_HOST}:{self.port}"
        self.terminal = ""  # the path of the pseudo-terminal
        self.visits = 0  # how many have come to stay
        self._ours, self._theirs = -1, -1
        if has_terminal:
            try:
                self._open_terminal()
            except BaseException:
                self._server.close()
                raise
        self._client: socket.socket | None = None
        self._heard_s = 0.0  # when the client has said something
        self._callers: list[_Caller] = []  # the oldest first
        self._full_s = 0.0  # when there was no room for one more open file
        self._unsent = bytearray()

    @property
    def is_connected(self) -> bool:
        """Whether somebody is there. Of a pseudo-terminal nobody knows."""
        return self._client is not None

    def wait(self, limit_s: float, is_full: bool = False) -> None:
        """Wait until something comes, at most for so long. `is_full`: nothing more is wanted."""
        watched: list[socket.socket | int] = [self._server] if self._has_room() else []
        watched += [
            caller.peer for caller in self._callers if caller.is_told or not caller.may_enter
        ]
        limit_s = min(limit_s, PATIENCE_S) if self._callers else limit_s
        if not watched:
            limit_s = min(limit_s, PROTECTED_S / 4)
        if not is_full:
            if self._client is not None:
                watched.append(self._client)
            elif self._ours >= 0:
                watched.append(self._ours)
        if watched or sys.platform != "win32":
            select.select(watched, [], [], limit_s)
        else:  # Windows does not wait for nothing
            sleep(limit_s)

    def receive(self) -> bytes:
        """Return what has come. Lets clients in and out."""
        data = self._receive_from_port()
        first = self._let_in()
        return data if first is None else first

    def take_stop(self) -> bool:
        """Return whether silence has ended a typed stop of a caller: it stops what runs."""
        now_s = monotonic()
        return any(caller.ends_with_stop(now_s) for caller in self._callers)

    def _receive_from_port(self) -> bytes:
        if self._client is not None:
            try:
                data = self._client.recv(READ_BYTES)
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
        if self._client is None:
            if self._ours >= 0 and data:
                with contextlib.suppress(OSError):  # nobody reads, and its buffer is full
                    os.write(self._ours, data)
            return
        self._unsent += data[: KEPT_BYTES - len(self._unsent)]
        if not self._unsent:
            return
        try:
            done = self._client.send(self._unsent)
            del self._unsent[:done]
        except BlockingIOError:
            pass
        except OSError:
            self._part()

    def close(self) -> None:
        self._part()
        for caller in self._callers:
            caller.peer.close()
        self._server.close()
        for end in (self._ours, self._theirs):
            if end >= 0:
                os.close(end)

    def _open_terminal(self) -> None:
        if sys.platform == "win32":
            raise OSError("Windows has no such terminals")
        import pty
        import tty

        self._ours, self._theirs = pty.openpty()  # ours to keep, both: or it would hang up
        tty.setraw(self._theirs)
        os.fchmod(self._theirs, 0o600)  # systems let a group write to terminals
        os.set_blocking(self._ours, False)
        self.terminal = os.ttyname(self._theirs)

    def _let_in(self) -> bytes | None:
        """Make the next caller the client if there is none, and refuse the other callers.

        Return the first bytes of a new client, or None if there is no new client.
        """
        self._accept()
        now_s = monotonic()
        self._callers = [caller for caller in self._callers if not caller.has_left(now_s)]
        first = None
        speaker = next((caller for caller in self._callers if caller.is_next), None)
        if speaker is not None and self._client is not None and now_s > self._heard_s + IDLE_S:
            self._part()
        if speaker is not None and self._client is None:
            self._callers.remove(speaker)
            self._client, first = speaker.peer, speaker.opening
            self._unsent.clear()
            self._heard_s = now_s
            self.visits += 1
        if self._client is not None:
            for caller in self._callers:
                caller.tell(now_s)
        return first

    def _accept(self) -> None:
        """Accept new callers; if there are too many, drop the oldest."""
        for _ in range(MOST_CALLERS):
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
            if not is_of_this_user(peer):
                peer.close()
                continue
            if len(self._callers) >= MOST_CALLERS:
                self._drop_oldest()
            self._callers.append(_Caller(peer, monotonic()))

    def _has_room(self) -> bool:
        """Return whether one more caller may be accepted: each has PROTECTED_S to send."""
        past_s = monotonic() - PROTECTED_S
        is_few = len(self._callers) < MOST_CALLERS or self._callers[0].came_s < past_s
        return is_few and self._full_s < past_s

    def _drop_oldest(self) -> None:
        if self._callers:
            self._callers.pop(0).peer.close()

    def _part(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client = None
        self._unsent.clear()


class _Caller:
    """A connection that is not the client yet. After PATIENCE_S it is told that there is another.

    Not at once: the client may be about to leave, and pyserial discards the first bytes. It stays
    open for FAREWELL_S, because closing at once would lose the message.
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
        self._heard_s = came_s
        self._line = 0  # where the bytes begin that have come since the last second of silence

    @property
    def is_next(self) -> bool:
        return self.may_enter and not self.is_told

    def has_left(self, now_s: float) -> bool:
        """Hear it; return whether it is gone, or has to go."""
        try:
            if self.may_enter and not self.is_told:
                is_over = not self.peer.recv(1, socket.MSG_PEEK)
            else:
                is_over = not self._receive(now_s)
        except BlockingIOError:
            is_over = False
        except OSError:
            is_over = True
        if is_over or (now_s > self._limit_s and not self.is_next):
            self.peer.close()
            return True
        return False

    def _receive(self, now_s: float) -> bool:
        """Take what has come; return whether more may come."""
        data = self.peer.recv(READ_BYTES)
        if not data or self.is_told:
            return bool(data)
        if not self.opening:
            self._limit_s = now_s + OPENING_S
        self._heard_s = now_s
        self.opening += data
        verdict = sniff_robot_client(self.opening)
        self.may_enter = verdict is True
        return verdict is not False

    def ends_with_stop(self, now_s: float) -> bool:
        """Return whether a second of silence ends a typed stop now."""
        if self.may_enter or self.is_told or now_s < self._heard_s + SILENCE_MS / 1000:
            return False
        line, self._line = self.opening[self._line :], len(self.opening)
        return is_at_stop(line)

    def tell(self, now_s: float) -> None:
        if self.is_told or now_s < self.came_s + PATIENCE_S:
            return
        self.is_told = True
        self._limit_s = now_s + FAREWELL_S
        with contextlib.suppress(OSError):  # it has gone already
            self.peer.send(PORT_TAKEN)
            self.peer.shutdown(socket.SHUT_WR)


def can_have_terminal() -> bool:
    """Whether this system has pseudo-terminals."""
    return hasattr(os, "openpty")


RADIO_TEXT = b"OK+LOST\r\n"  # what HC-06 and HM-10 modules write into the stream
LONGEST_LOSS = 4  # bytes in a row
LATEST_MS = 300


class BadLine:
    """One direction of a line. Of 1000 bytes about `rate` meet a fault."""

    def __init__(self, rate: float, chance: Random) -> None:
        self.rate = rate
        self.faults = 0  # count of faults so far
        self._chance = chance
        self._late: deque[tuple[int, int]] = deque()  # arrival time and byte
        self._lost = 0  # how many of the next bytes get lost

    def put(self, data: bytes, now_ms: int) -> None:
        """Send bytes."""
        if not self.rate:
            self._late.extend((now_ms, byte) for byte in data)
            return
        for byte in data:
            due_ms = max(now_ms, self._late[-1][0] if self._late else 0)
            if self._lost:
                self._lost -= 1
                continue
            if self._chance.random() * 1000 >= self.rate:
                self._late.append((due_ms, byte))
                continue
            self.faults += 1
            kind = self._chance.randrange(4)
            if kind == 0:
                self._lost = self._chance.randrange(LONGEST_LOSS)  # and this one
            elif kind == 1:
                self._late.append((due_ms, byte ^ 1 << self._chance.randrange(8)))
            elif kind == 2:
                self._late.extend((due_ms, item) for item in (*RADIO_TEXT, byte))
            else:
                self._late.append((due_ms + self._chance.randrange(LATEST_MS), byte))

    def take(self, now_ms: int) -> bytes:
        """Return the bytes that have arrived."""
        result = bytearray()
        while self._late and self._late[0][0] <= now_ms:
            result.append(self._late.popleft()[1])
        return bytes(result)

    @property
    def waiting(self) -> int:
        """Return how many bytes are in transit."""
        return len(self._late)

    def clear(self) -> None:
        """Drop the bytes in transit."""
        self._late.clear()
        self._lost = 0
