"""The way to a robot through the command that holds its port.

Has no thread: what comes is read where somebody waits for it. While it waits it says that it is
still there; a run that it has started ends when it does not. Knows sockets and the clock.
"""

from __future__ import annotations

import socket
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from time import monotonic

from tiniscript import __version__
from tiniscript.link.connection import Asked, Asks
from tiniscript.link.outcomes import LOOK_S, Event, Gone
from tiniscript.link.requests import OK, Reply, Robot, described
from tiniscript.sharing import protocol, registry
from tiniscript.sharing.protocol import BadNote, Note
from tiniscript.sharing.registry import Holder
from tiniscript.sharing.requests import Wish, Wishes

ANSWER_S = 2.0  # for which a holder may take to greet
SEND_S = 2.0  # for which it may take no bytes
DEAF_S = 5.0  # for which it may answer no beat


class OtherVersion(Exception):
    """The holder is a tsc of another version."""

    def __init__(self, holder: Holder, version: str) -> None:
        super().__init__(version)
        self.holder = holder
        self.version = version


class Guest:
    """The way through a holder that has greeted."""

    def __init__(self, peer: socket.socket, holder: Holder, rest: protocol.Notes) -> None:
        self.robot: Robot | None = None
        self.heard = 0
        self.is_echoed = False
        self.held_by = holder.verb
        self.baud = holder.baud
        self._peer = peer
        self._notes = rest
        self._wishes = Wishes()
        self._tasks: dict[int, Asked] = {}
        self._count = 0
        self._events: deque[tuple[int, Event]] = deque()
        self._over: Gone | None = None
        self._beat_s = 0.0  # when the last one was sent
        self._unanswered_s: float | None = None  # since when one is

    @property
    def has_ended(self) -> bool:
        return self._over is not None

    def do(self, make: Callable[[Asks], Asked]) -> Asked:
        task = make(self._wishes)
        assert isinstance(task, Wish)
        self._count += 1
        self._tasks[self._count] = task
        self._send({**task.note, "id": self._count, "limit_ms": task.limit_ms})
        return task

    def wait(self, task: Asked, look: Callable[[], None] | None = None) -> Reply:
        while task.outcome is None:
            if self._over is not None:
                raise self._over
            self._listen(LOOK_S)
            if look is not None:
                look()
        return task.outcome

    def event(self, limit_s: float = LOOK_S) -> tuple[int, Event] | None:
        if not self._events:
            if self._over is not None:
                raise self._over
            self._listen(limit_s)
        return self._events.popleft() if self._events else None

    def stop(self) -> None:
        self._send({"do": "stop"})

    def close(self) -> None:
        self._peer.close()

    def _send(self, note: Note) -> None:
        try:
            self._peer.settimeout(SEND_S)
            self._peer.sendall(protocol.written(note))
        except OSError as why:
            # what has come before may say more
            self._over = self._over or Gone(str(why), is_holder=True)

    def _listen(self, limit_s: float) -> None:
        """Take what has come, or comes in time."""
        now_s = monotonic()
        if now_s - self._beat_s >= protocol.BEAT_S:
            self._beat_s = now_s
            if self._unanswered_s is None:
                self._unanswered_s = now_s
            self._send({"do": "beat"})
        try:
            self._peer.settimeout(max(limit_s, 0.001))
            data = self._peer.recv(65536)
            if not data:
                raise ConnectionError
            self._unanswered_s = None
            for note in self._notes.put(data):
                self._take(note)
        except TimeoutError:
            if self._unanswered_s is not None and now_s - self._unanswered_s > DEAF_S:
                self._over = Gone("", is_holder=True)
        except (OSError, BadNote) as why:
            self._over = self._over or Gone(str(why), is_holder=True)

    def _take(self, note: Note) -> None:
        if "over" in note:
            is_holder = note["over"] != "gone"
            self._over = Gone(protocol.word(note, "why"), is_holder)
        elif "event" in note:
            self._events.append(protocol.event(note))
        elif "id" in note:
            self._take_outcome(note)

    def _take_outcome(self, note: Note) -> None:
        number = protocol.number(note, "id")
        task = self._tasks.get(number)
        if task is None:
            raise BadNote
        if "done_bytes" in note:
            task.done_bytes = protocol.number(note, "done_bytes")
            return
        values = protocol.values(note)
        self.heard, self.is_echoed = (
            protocol.number(note, "heard"),
            protocol.answer(note, "is_echoed"),
        )
        task.outcome = Reply(
            protocol.number(note, "status"), protocol.number(note, "detail"), values
        )
        del self._tasks[number]
        assert isinstance(task, Wish)
        if task.note["do"] == "hello" and task.outcome.status == OK:
            self.robot = _described(values)
        elif task.outcome.status == OK and task.note["do"] == "name" and self.robot is not None:
            name = bytes.fromhex(str(task.note["name"]))
            self.robot = described({**self.robot.values, "name": name})


def _described(values: dict[str, int | bytes]) -> Robot:
    """Return what a robot has said of itself. Raises BadNote where something is missing."""
    try:
        return described(values)
    except (KeyError, AssertionError):
        raise BadNote from None


def joined(port: str, verb: str) -> Guest | None:
    """Return the way through whoever holds a port, or None where nobody does.

    Raises OtherVersion where the holder is another tsc; `stop` gets through to that, too.
    """
    holder = registry.found(port)
    return None if holder is None else _joined(holder, verb)


def is_alive(holder: Holder) -> bool:
    """Whether a holder is still there."""
    try:
        guest = _joined(holder, protocol.LOOKER)
    except OtherVersion:
        return True
    if guest is not None:
        guest.close()
    return guest is not None


def _joined(holder: Holder, verb: str) -> Guest | None:
    peer = None
    try:
        peer = socket.create_connection((protocol.HOST, holder.number), ANSWER_S)
        peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        peer.sendall(protocol.written({"tsc": __version__, "token": holder.token, "verb": verb}))
        rest = protocol.Notes(protocol.LINE_BYTES)
        found = _first(peer, rest)
        if protocol.word(found[0], "answer") != holder.answer:
            raise BadNote  # somebody else listens there now
        version = protocol.word(found[0], "tsc")
        if version != __version__ and verb != "stop":
            raise OtherVersion(holder, version)
        guest = Guest(peer, holder, rest)
        for note in found[1:]:
            guest._take(note)
        return guest
    except (OSError, BadNote, OtherVersion) as trouble:
        if peer is not None:
            with suppress(OSError):
                peer.close()
        if isinstance(trouble, OtherVersion):
            raise
        return None


def _first(peer: socket.socket, rest: protocol.Notes) -> list[Note]:
    """Return the greeting of a holder and what follows it."""
    end_s = monotonic() + ANSWER_S
    while (left_s := end_s - monotonic()) > 0:
        peer.settimeout(left_s)
        data = peer.recv(65536)
        if not data:
            raise ConnectionError
        found = rest.put(data)
        if found:
            return found
    raise TimeoutError
