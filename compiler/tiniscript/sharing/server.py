"""A line that others may use: other commands come here, and one thread attends to all of them.

What a guest wants done goes to the one session of the line, and everybody hears what the robot
tells. A run belongs to the guest that has started it: when that guest leaves or falls silent, the
robot is stopped, as it stops by itself when a command that holds the port ends. No guest can hold
up the line or another guest: whoever is slow misses events, and whoever is rude is let go.
"""

from __future__ import annotations

import os
import secrets
import selectors
import socket
from collections import deque
from contextlib import suppress
from threading import Thread
from time import monotonic, sleep
from typing import NamedTuple

from tiniscript import __version__
from tiniscript.link.backlog import Told
from tiniscript.link.connection import Asked
from tiniscript.link.line import Line
from tiniscript.link.outcomes import Event
from tiniscript.link.port_names import same_for_all
from tiniscript.link.requests import OK, Reply
from tiniscript.sharing import protocol, registry
from tiniscript.sharing.protocol import BadNote, Note
from tiniscript.sharing.registry import Holder
from tiniscript.sharing.requests import asked_for, is_detached

GREETING_S = 2.0  # in which whoever comes must say who it is
GUESTS = 64  # at a time, and as many who have not said who they are
TASKS = 8  # of one guest, at a time
FULL_BYTES = 200_000  # that wait for a slow guest: from here on it misses values,
TOO_FULL_BYTES = 1_000_000  # and here it is let go
FULL_S = 0.02  # after which there may be room for one more open file
PAUSE_S = 0.1  # between two looks at a run or a task of a guest
REST_S = 1.0  # between two looks at nothing
_ENDS = ("DONE", "FAULT", "STOPPED", "ENDED", "LOST")
_MAY_MISS = ("SHOW", "TEXT")


class Guest:
    """Another command, or somebody who has not yet said who it is: `verb` is empty then."""

    def __init__(self, peer: socket.socket) -> None:
        self.peer = peer
        self.verb = ""
        self.greeting = b""  # as far as it has come
        self.heard_s = monotonic()  # of a stranger: when it came
        self.notes = protocol.Notes(protocol.LINE_BYTES)
        self.tasks: dict[int, Task] = {}
        self.out = bytearray()
        self.missed = 0  # events


class Task(NamedTuple):
    asked: Asked
    is_detached: bool
    told_bytes: int = 0  # of `done_bytes`


class Host:
    """Shares a line until it is closed. Raises OSError where that is impossible."""

    def __init__(self, line: Line, port: str, baud: int, verb: str) -> None:
        self._line = line
        self._server = socket.create_server((protocol.HOST, 0))
        self._server.setblocking(False)
        number = self._server.getsockname()[1]
        token, answer = secrets.token_hex(16), secrets.token_hex(16)
        name = same_for_all(port)
        self.holder = Holder(name, number, token, answer, verb, baud, os.getpid())
        self._bell, self._wire = socket.socketpair()
        self._bell.setblocking(False)
        self._wire.setblocking(False)
        self._told: deque[Told] = deque()
        self._guests: list[Guest] = []
        self._owner: tuple[Guest, int] | None = None  # of the run that goes on
        self._orphans: list[Task] = []  # of guests that have left
        self._is_closing = False
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._server, selectors.EVENT_READ)
        self._selector.register(self._wire, selectors.EVENT_READ)
        try:
            registry.write(self.holder)
        except OSError:
            self._close_all()
            raise
        line.listen(self._hear)
        self._thread = Thread(target=self._run, name="host", daemon=True)
        self._thread.start()

    @property
    def has_run(self) -> bool:
        """Whether a program runs that a guest has started, and that wants a tether."""
        owner = self._owner
        return owner is not None and self._line.runs(owner[1])

    @property
    def may_have_run(self) -> bool:
        """The same, or a guest's run is about to begin: its request may be on its way. To be asked
        when this is closed."""
        tasks = [task for guest in self._guests for task in guest.tasks.values()]
        return self.has_run or any(
            task.asked.outcome is None and task.asked.starts and not task.is_detached
            for task in (*tasks, *self._orphans)
        )

    def close(self) -> None:
        """Let all guests go."""
        self._is_closing = True
        self._ring()
        self._thread.join(2)

    # -- from the thread of the line --------------------------------------------------------------

    def _hear(self, told: list[Told]) -> None:
        self._told += told
        self._ring()

    def _ring(self) -> None:
        with suppress(OSError):  # it rings already
            self._bell.send(b"\0")

    # -- the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            while not self._is_closing and self._line.gone is None:
                self._attend()
            self._pass_on_outcomes()  # a run may have begun in this moment
        except Exception as bug:
            self._line.fail(bug)
        finally:
            registry.remove(self.holder)
            self._part()
            self._close_all()

    def _attend(self) -> None:
        is_busy = self._owner or self._orphans or any(guest.tasks for guest in self._guests)
        for key, mask in self._selector.select(PAUSE_S if is_busy else REST_S):
            if key.fileobj is self._server:
                self._let_in()
            elif key.fileobj is self._wire:
                with suppress(OSError):
                    self._wire.recv(4096)
            elif key.data in self._guests:
                if mask & selectors.EVENT_READ:
                    self._read(key.data)
                if mask & selectors.EVENT_WRITE:
                    self._write(key.data)
        self._pass_on_outcomes()
        self._pass_on_events()
        self._look_after()

    def _let_in(self) -> None:
        try:
            peer, _ = self._server.accept()
        except (BlockingIOError, ConnectionError):  # it has gone already
            return
        except OSError:  # this process has too many files open
            self._drop_oldest_stranger()
            sleep(FULL_S)
            return
        strangers = [guest for guest in self._guests if not guest.verb]
        if len(self._guests) - len(strangers) >= GUESTS:
            peer.close()
            return
        if len(strangers) >= GUESTS:
            self._drop_oldest_stranger()
        peer.setblocking(False)
        with suppress(OSError):  # it has gone already
            peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        guest = Guest(peer)
        self._guests.append(guest)
        self._selector.register(peer, selectors.EVENT_READ, guest)

    def _drop_oldest_stranger(self) -> None:
        stranger = next((guest for guest in self._guests if not guest.verb), None)
        if stranger is not None:
            self._drop(stranger)

    def _read(self, guest: Guest) -> None:
        try:
            data = guest.peer.recv(65536 if guest.verb else protocol.GREETING_BYTES)
            if not data:
                raise ConnectionError
            if not guest.verb:
                data = self._greet(guest, data)
            else:
                guest.heard_s = monotonic()
            for note in guest.notes.put(data) if guest.verb else ():
                self._take(guest, note)
        except BlockingIOError:
            pass
        except (OSError, BadNote):
            self._drop(guest)

    def _take(self, guest: Guest, note: Note) -> None:
        wish = protocol.word(note, "do")
        if wish == "stop":
            self._line.stop()
        elif wish == "beat":
            self._send(guest, {"beat": True})
        else:
            self._begin(guest, note)

    def _greet(self, guest: Guest, data: bytes) -> bytes:
        """Take what somebody says before it is known; return what follows its greeting.

        Until the token was right nothing else of it is looked at. Raises BadNote.
        """
        guest.greeting += data
        greeting = protocol.greeting(guest.greeting)
        if greeting is None:
            return b""
        if not secrets.compare_digest(greeting.token, self.holder.token.encode()):
            raise BadNote
        guest.verb, guest.greeting = greeting.verb, b""
        guest.heard_s = monotonic()
        self._send(guest, {"tsc": __version__, "answer": self.holder.answer})
        self._tell_holder("JOINED", guest)
        return greeting.rest

    def _begin(self, guest: Guest, note: Note) -> None:
        """Have something done for a guest."""
        number = protocol.number(note, "id")
        limit_ms = min(max(1, protocol.number(note, "limit_ms")), 60_000)
        if number in guest.tasks or len(guest.tasks) >= TASKS:
            raise BadNote
        robot = self._line.robot
        if note["do"] == "hello" and robot and self._line.session.is_open:  # it is there
            self._tell_outcome(guest, number, Reply(OK, 0, robot.values))
            return
        make = asked_for(note, limit_ms)
        guest.tasks[number] = Task(self._line.do(make), is_detached(note))

    def _pass_on_outcomes(self) -> None:
        for guest in list(self._guests):
            for number, task in list(guest.tasks.items()):
                outcome = task.asked.outcome
                if outcome is not None:
                    del guest.tasks[number]
                    self._own(task, guest)
                    self._tell_outcome(guest, number, outcome)
                elif task.asked.done_bytes != task.told_bytes:
                    guest.tasks[number] = task._replace(told_bytes=task.asked.done_bytes)
                    self._send(guest, {"id": number, "done_bytes": task.asked.done_bytes})
        for task in self._orphans:
            self._own(task, None)
        self._orphans = [task for task in self._orphans if task.asked.outcome is None]

    def _own(self, task: Task, guest: Guest | None) -> None:
        """Note whose run has begun; stop it where nobody is left whose it is."""
        outcome = task.asked.outcome
        if outcome is None or outcome.status != OK or not task.asked.starts or task.is_detached:
            return
        run = outcome.values["run"]
        assert isinstance(run, int)
        if not self._line.runs(run):
            return
        if guest is None:
            self._line.stop()
        else:
            self._owner = guest, run

    def _tell_outcome(self, guest: Guest, number: int, outcome: Reply) -> None:
        self._send(guest, {
            "id": number,
            "status": outcome.status,
            "detail": outcome.detail,
            "values": protocol.plain(outcome.values),
            "heard": self._line.heard,
            "is_echoed": self._line.is_echoed,
        })  # fmt: skip

    def _pass_on_events(self) -> None:
        while self._told:
            time_ms, event = self._told.popleft()
            # an end that is told late may be that of a run before
            if event.name in _ENDS and self._owner is not None and not self.has_run:
                self._owner = None
            for guest in list(self._guests):
                if guest.verb:
                    self._tell_event(guest, time_ms, event)

    def _tell_event(self, guest: Guest, time_ms: int, event: Event) -> None:
        if len(guest.out) > FULL_BYTES and event.name in _MAY_MISS:
            guest.missed += 1
            return
        if guest.missed:
            missed, guest.missed = guest.missed, 0
            self._tell_event(guest, time_ms, Event("MISSED", {"count": missed}))
        note = {"event": event.name, "ms": time_ms, "values": protocol.plain(event.values)}
        self._send(guest, note)

    def _look_after(self) -> None:
        now_s = monotonic()
        for guest in list(self._guests):
            if not guest.verb and now_s - guest.heard_s > GREETING_S:
                self._drop(guest)
        if self._owner is not None and now_s - self._owner[0].heard_s > protocol.TETHER_S:
            self._end_run()

    def _end_run(self) -> None:
        """Stop the run of a guest that is not there any more."""
        if self.has_run:
            self._line.stop()
        self._owner = None

    def _drop(self, guest: Guest) -> None:
        if guest not in self._guests:
            return
        self._guests.remove(guest)
        self._selector.unregister(guest.peer)
        guest.peer.close()
        self._orphans += guest.tasks.values()
        if self._owner is not None and self._owner[0] is guest:
            self._end_run()
        self._tell_holder("LEFT", guest)

    def _tell_holder(self, name: str, guest: Guest) -> None:
        if guest.verb not in ("", protocol.LOOKER):
            self._line.tell(Event(name, {"verb": guest.verb.encode()}))

    # -- what guests are told ---------------------------------------------------------------------

    def _send(self, guest: Guest, note: Note) -> None:
        guest.out += protocol.written(note)
        if len(guest.out) > TOO_FULL_BYTES:
            self._drop(guest)
        else:
            self._write(guest)

    def _write(self, guest: Guest) -> None:
        try:
            sent = guest.peer.send(guest.out) if guest.out else 0
            del guest.out[:sent]
        except BlockingIOError:
            pass
        except OSError:
            self._drop(guest)
            return
        wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if guest.out else 0)
        if guest in self._guests:
            self._selector.modify(guest.peer, wanted, guest)

    def _part(self) -> None:
        """Tell all guests that it is over."""
        gone = self._line.gone
        over: Note = {"over": "ended" if gone is None else "gone", "why": gone or ""}
        for guest in list(self._guests):
            if guest.verb:
                self._send(guest, over)
            with suppress(OSError):
                guest.peer.shutdown(socket.SHUT_WR)

    def _close_all(self) -> None:
        for guest in self._guests:
            guest.peer.close()
        for each in (self._server, self._bell, self._wire, self._selector):
            each.close()
