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
MAX_UNSENT_BYTES = (
    65_536  # buffer for a client that does not read; more is lost, as on a serial line
)
PORT_TAKEN = b"Port already in use: another program is talking to this robot.\r\n"
REFUSAL_DELAY_S = 0.3  # time before a second caller gets a message
FAREWELL_S = 2.5  # time to read the farewell message
MAX_CALLERS = 64  # most clients at a time; macOS allows 256 open files
PROTECTION_S = 0.25  # a caller is not dropped for a newer one within this time
SILENCE_TIMEOUT_S = 60.0  # timeout of a caller that sends nothing,
OPENING_TIMEOUT_S = 10.0  # timeout of a client whose first bytes or line are incomplete
IDLE_TIMEOUT_S = 10.0  # a client that is silent for this time is replaced by a caller that sends
BACKLOG = 128


class Transports:
    """A port on this computer. Raises OSError if it cannot be had."""

    def __init__(self, port: int = 0, has_terminal: bool = False) -> None:
        self._server = socket.create_server((LOCAL_HOST, port), backlog=BACKLOG)
        self._server.setblocking(False)
        self.port: int = self._server.getsockname()[1]
        self.address = f"socket://{LOCAL_HOST}:{self.port}"
        self.terminal = ""  # the path of the pseudo-terminal
        self.visit_count = 0  # number of clients that stayed
        self._own_end, self._other_end = -1, -1
        if has_terminal:
            try:
                self._open_terminal()
            except BaseException:
                self._server.close()
                raise
        self._client: socket.socket | None = None
        self._received_s = 0.0  # time of the client's last data
        self._callers: list[_Caller] = []  # the oldest first
        self._full_s = 0.0  # time when no more files could be opened
        self._unsent = bytearray()

    @property
    def is_connected(self) -> bool:
        """Return whether a client is connected; unknown for a pseudo-terminal."""
        return self._client is not None

    def wait(self, timeout_s: float, is_full: bool = False) -> None:
        """Wait until something comes, at most for so long. `is_full`: nothing more is wanted."""
        watched_files: list[socket.socket | int] = [self._server] if self._has_room() else []
        watched_files += [
            caller.peer for caller in self._callers if caller.is_refused or not caller.may_enter
        ]
        timeout_s = min(timeout_s, REFUSAL_DELAY_S) if self._callers else timeout_s
        if not watched_files:
            timeout_s = min(timeout_s, PROTECTION_S / 4)
        if not is_full:
            if self._client is not None:
                watched_files.append(self._client)
            elif self._own_end >= 0:
                watched_files.append(self._own_end)
        if watched_files or sys.platform != "win32":
            select.select(watched_files, [], [], timeout_s)
        else:  # Windows does not wait for nothing
            sleep(timeout_s)

    def receive(self) -> bytes:
        """Return received bytes. Also accepts and removes clients."""
        data = self._receive_from_port()
        first_bytes = self._admit_caller()
        return data if first_bytes is None else first_bytes

    def take_stop(self) -> bool:
        """Return whether silence has ended a typed stop of a caller: it stops what runs."""
        now_s = monotonic()
        return any(caller.take_stop(now_s) for caller in self._callers)

    def _receive_from_port(self) -> bytes:
        if self._client is not None:
            try:
                data = self._client.recv(READ_BYTES)
            except BlockingIOError:
                return b""
            except OSError:
                data = b""
            if not data:
                self._drop_client()
            self._received_s = monotonic()
            return data
        if self._own_end >= 0:
            with contextlib.suppress(OSError):  # the file may not exist
                return os.read(self._own_end, READ_BYTES)
        return b""

    def send(self, data: bytes) -> None:
        """Send bytes to the client; without one they are lost."""
        if self._client is None:
            if self._own_end >= 0 and data:
                with contextlib.suppress(OSError):  # nobody reads, and the buffer is full
                    os.write(self._own_end, data)
            return
        self._unsent += data[: MAX_UNSENT_BYTES - len(self._unsent)]
        if not self._unsent:
            return
        try:
            sent_count = self._client.send(self._unsent)
            del self._unsent[:sent_count]
        except BlockingIOError:
            pass
        except OSError:
            self._drop_client()

    def close(self) -> None:
        self._drop_client()
        for caller in self._callers:
            caller.peer.close()
        self._server.close()
        for descriptor in (self._own_end, self._other_end):
            if descriptor >= 0:
                os.close(descriptor)

    def _open_terminal(self) -> None:
        if sys.platform == "win32":
            raise OSError("Windows has no such terminals")
        import pty
        import tty

        self._own_end, self._other_end = pty.openpty()  # ours to keep, both: or it would hang up
        tty.setraw(self._other_end)
        os.fchmod(self._other_end, 0o600)  # systems let a group write to terminals
        os.set_blocking(self._own_end, False)
        self.terminal = os.ttyname(self._other_end)

    def _admit_caller(self) -> bytes | None:
        """Make the next caller the client if there is none, and refuse the other callers.

        Return the first bytes of a new client, or None if there is no new client.
        """
        self._accept()
        now_s = monotonic()
        self._callers = [caller for caller in self._callers if not caller.check_left(now_s)]
        first_bytes = None
        next_caller = next((caller for caller in self._callers if caller.is_next), None)
        if (
            next_caller is not None
            and self._client is not None
            and now_s > self._received_s + IDLE_TIMEOUT_S
        ):
            self._drop_client()
        if next_caller is not None and self._client is None:
            self._callers.remove(next_caller)
            self._client, first_bytes = next_caller.peer, next_caller.first_bytes
            self._unsent.clear()
            self._received_s = now_s
            self.visit_count += 1
        if self._client is not None:
            for caller in self._callers:
                caller.refuse(now_s)
        return first_bytes

    def _accept(self) -> None:
        """Accept new callers; if there are too many, drop the oldest."""
        for _ in range(MAX_CALLERS):
            if not self._has_room():
                return
            try:
                peer = self._server.accept()[0]
            except BlockingIOError:
                return
            except ConnectionError:  # the client has left
                continue
            except OSError:  # this process has too many files open
                self._drop_oldest()
                self._full_s = monotonic()
                return
            if not is_of_this_user(peer):
                peer.close()
                continue
            if len(self._callers) >= MAX_CALLERS:
                self._drop_oldest()
            self._callers.append(_Caller(peer, monotonic()))

    def _has_room(self) -> bool:
        """Return whether one more caller may be accepted: each has PROTECTED_S to send."""
        protected_since_s = monotonic() - PROTECTION_S
        is_few = len(self._callers) < MAX_CALLERS or self._callers[0].arrival_s < protected_since_s
        return is_few and self._full_s < protected_since_s

    def _drop_oldest(self) -> None:
        if self._callers:
            self._callers.pop(0).peer.close()

    def _drop_client(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client = None
        self._unsent.clear()


class _Caller:
    """A connection that is not the client yet. After PATIENCE_S it is told that there is another.

    Not at once: the client may be about to leave, and pyserial discards the first bytes. It stays
    open for FAREWELL_S, because closing at once would lose the message.
    """

    def __init__(self, peer: socket.socket, arrival_s: float) -> None:
        peer.setblocking(False)
        with contextlib.suppress(OSError):  # the client has left
            peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.peer = peer
        self.arrival_s = arrival_s
        self.first_bytes = b""  # first bytes of the client
        self.may_enter = False
        self.is_refused = False
        self._limit_s = arrival_s + SILENCE_TIMEOUT_S
        self._received_s = arrival_s
        self._line_start = 0  # start of the bytes received since the last second of silence

    @property
    def is_next(self) -> bool:
        return self.may_enter and not self.is_refused

    def check_left(self, now_s: float) -> bool:
        """Read from it; return whether it has left, or must be disconnected."""
        try:
            if self.may_enter and not self.is_refused:
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
        """Receive waiting bytes; return whether more may come."""
        data = self.peer.recv(READ_BYTES)
        if not data or self.is_refused:
            return bool(data)
        if not self.first_bytes:
            self._limit_s = now_s + OPENING_TIMEOUT_S
        self._received_s = now_s
        self.first_bytes += data
        verdict = sniff_robot_client(self.first_bytes)
        self.may_enter = verdict is True
        return verdict is not False

    def take_stop(self, now_s: float) -> bool:
        """Return whether a second of silence ends a typed stop now."""
        if self.may_enter or self.is_refused or now_s < self._received_s + SILENCE_MS / 1000:
            return False
        line, self._line_start = self.first_bytes[self._line_start :], len(self.first_bytes)
        return is_at_stop(line)

    def refuse(self, now_s: float) -> None:
        if self.is_refused or now_s < self.arrival_s + REFUSAL_DELAY_S:
            return
        self.is_refused = True
        self._limit_s = now_s + FAREWELL_S
        with contextlib.suppress(OSError):  # the client has left
            self.peer.send(PORT_TAKEN)
            self.peer.shutdown(socket.SHUT_WR)


def can_have_terminal() -> bool:
    """Return whether this system has pseudo-terminals."""
    return hasattr(os, "openpty")


RADIO_TEXT = b"OK+LOST\r\n"  # text that HC-06 and HM-10 modules insert into the stream
MAX_LOST_BYTES = 4  # bytes in a row
MAX_DELAY_MS = 300


class BadLine:
    """One direction of a line. About `rate` of 1000 bytes are faulty."""

    def __init__(self, rate: float, random_source: Random) -> None:
        self.rate = rate
        self.fault_count = 0  # count of faults so far
        self._random_source = random_source
        self._in_transit: deque[tuple[int, int]] = deque()  # arrival time and byte
        self._loss_count = 0  # number of further bytes to lose

    def send_bytes(self, data: bytes, now_ms: int) -> None:
        """Send bytes."""
        if not self.rate:
            self._in_transit.extend((now_ms, byte) for byte in data)
            return
        for byte in data:
            due_ms = max(now_ms, self._in_transit[-1][0] if self._in_transit else 0)
            if self._loss_count:
                self._loss_count -= 1
                continue
            if self._random_source.random() * 1000 >= self.rate:
                self._in_transit.append((due_ms, byte))
                continue
            self.fault_count += 1
            kind = self._random_source.randrange(4)
            if kind == 0:
                # This byte is lost as well.
                self._loss_count = self._random_source.randrange(MAX_LOST_BYTES)
            elif kind == 1:
                self._in_transit.append((due_ms, byte ^ 1 << self._random_source.randrange(8)))
            elif kind == 2:
                self._in_transit.extend((due_ms, radio_byte) for radio_byte in (*RADIO_TEXT, byte))
            else:
                self._in_transit.append(
                    (due_ms + self._random_source.randrange(MAX_DELAY_MS), byte)
                )

    def take_arrived(self, now_ms: int) -> bytes:
        """Return the bytes that have arrived."""
        arrived_bytes = bytearray()
        while self._in_transit and self._in_transit[0][0] <= now_ms:
            arrived_bytes.append(self._in_transit.popleft()[1])
        return bytes(arrived_bytes)

    @property
    def byte_count(self) -> int:
        """Return the number of bytes in transit."""
        return len(self._in_transit)

    def clear(self) -> None:
        """Drop the bytes in transit."""
        self._in_transit.clear()
        self._loss_count = 0
