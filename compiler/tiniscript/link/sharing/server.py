"""A line that other commands share: they connect as clients, and one thread serves all of them.

The requests of all clients go to the one session of the line, and all clients get the events of the
robot. A run belongs to the client that has started it: when that client leaves or its heartbeats
stop, the server ends the run, as the robot stops itself when the command that holds the port ends.
A client that leaves does not start what it had not finished, and cancels nothing of other clients.
No client can delay the line or another client: a slow client misses events, and one that breaks the
protocol is disconnected.
"""

from __future__ import annotations

import hmac
import os
import selectors
import socket
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from threading import Thread
from time import monotonic, sleep
from typing import Any, NamedTuple

from tiniscript.base.version import __version__
from tiniscript.link.connection import PendingRequest
from tiniscript.link.outcomes import (
    CANCELLED,
    Event,
    JoinedEvent,
    LeftEvent,
    MissedEvent,
    TimedEvent,
)
from tiniscript.link.payloads import ReceiptReply
from tiniscript.link.port_connection import PortConnection
from tiniscript.link.port_names import canonical_port
from tiniscript.link.requests import OK, Reply
from tiniscript.link.sharing import protocol, registry
from tiniscript.link.sharing.protocol import BadMessage, JsonMessage
from tiniscript.link.sharing.registry import Registration
from tiniscript.link.sharing.requests import is_detached, request_maker

GREETING_S = 2.0  # timeout for a new client's greeting
MAX_CLIENTS = 64  # most clients at a time, and most connections without a greeting
MAX_REQUESTS = 8  # most requests of one client at a time
FULL_BYTES = 200_000  # bytes in the send buffer over which a client misses values
TOO_FULL_BYTES = 1_000_000  # bytes in the send buffer over which a client is disconnected
FULL_S = 0.02  # pause before the next try when the process has too many files open
PAUSE_S = 0.1  # between two checks while a client has a run or a request
REST_S = 1.0  # interval of checks without one
_ENDING_EVENTS = ("DONE", "FAULT", "STOPPED", "RESTARTED", "LOST")
_DROPPABLE_EVENTS = ("SHOW", "TEXT", "READING")
_STARTING_REQUESTS = ("upload", "live", "start")
# Verbs whose runs end with them.
_DRIVING_VERBS = ("upload", "start", "set trim", "doctor --selftest", "python")


class ConnectedClient:
    """Another command. `verb` is empty until its greeting is complete."""

    def __init__(self, peer: socket.socket) -> None:
        self.peer = peer
        self.verb = ""
        self.greeting = b""  # the bytes that have arrived so far
        self.heard_s = monotonic()  # before the greeting, the time of the connection
        self.messages = protocol.MessageReader(protocol.LINE_BYTES)
        self.speaker = 0  # its number, once it presses keys
        self.requests: dict[int, ServedRequest] = {}
        self.output = bytearray()
        self.missed_count = 0  # number of events
        self.takes_places = False


class ServedRequest(NamedTuple):
    pending_request: PendingRequest[Any]
    is_detached: bool
    told_bytes: int = 0  # the `done_bytes` that the client knows


class Server:
    """Shares a line until `close`. Raises OSError if the line cannot be shared."""

    def __init__(
        self, connection: PortConnection, port: str, baud: int, verb: str,
        is_latched: Callable[[], bool] = lambda: False,
    ) -> None:  # fmt: skip
        """`is_latched`: somebody has just stopped the robot, and no client starts anything."""
        self._connection = connection
        self._is_latched = is_latched
        self._listening_socket = socket.create_server((protocol.HOST, 0))
        self._listening_socket.setblocking(False)
        number = self._listening_socket.getsockname()[1]
        token, answer = os.urandom(16).hex(), os.urandom(16).hex()
        name = canonical_port(port)
        self.registration = Registration(name, number, token, answer, verb, baud, os.getpid())
        self._registrations = [self.registration]
        address = canonical_port(connection.address or port)
        if address != name:
            self._registrations.append(self.registration._replace(port=address, is_alias=True))
        self._wake_sender, self._wake_receiver = socket.socketpair()
        self._wake_sender.setblocking(False)
        self._wake_receiver.setblocking(False)
        self._told_events: deque[TimedEvent] = deque()
        self._clients: list[ConnectedClient] = []
        self._speaker_count = 0
        self._owner: tuple[ConnectedClient, int] | None = None  # owner of the current run
        self._orphaned_requests: list[ServedRequest] = []  # requests of clients that have left
        self._is_closing = False
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listening_socket, selectors.EVENT_READ)
        self._selector.register(self._wake_receiver, selectors.EVENT_READ)
        try:
            for registration in self._registrations:
                registry.write(registration)
        except OSError:
            self._close_all()
            raise
        connection.listen(self._on_events)
        self._thread = Thread(target=self._run, name="server", daemon=True)
        self._thread.start()

    @property
    def has_owned_run(self) -> bool:
        """Return whether a client owns the current run, which ends with that client."""
        owner = self._owner
        return owner is not None and self._connection.runs(owner[1])

    @property
    def is_needed(self) -> bool:
        """Return whether a client drives the robot or is about to, and its command ends with the
        run.
        """
        return self.may_have_owned_run or any(
            client.verb in _DRIVING_VERBS for client in list(self._clients)
        )

    @property
    def may_have_owned_run(self) -> bool:
        """Return whether `has_owned_run`, or a request for such a run is under way. `close` freezes
        the answer.
        """
        clients = list(self._clients)
        requests = [request for client in clients for request in list(client.requests.values())]
        return self.has_owned_run or any(
            request.pending_request.outcome is None
            and request.pending_request.starts_program
            and not request.is_detached
            for request in (*requests, *list(self._orphaned_requests))
        )

    def close(self) -> None:
        """Disconnect all clients."""
        self._is_closing = True
        self._ring()
        self._thread.join(2)

    # -- from the thread of the line --------------------------------------------------------------

    def _on_events(self, timed_events: list[TimedEvent]) -> None:
        self._told_events += timed_events
        self._ring()

    def _ring(self) -> None:
        with suppress(OSError):  # the buffer is full: the thread wakes anyway
            self._wake_sender.send(b"\0")

    # -- the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            while not self._is_closing and self._connection.end_reason is None:
                self._attend()
            self._pass_on_outcomes()  # a run may have begun in this moment
        except Exception as bug:
            self._connection.fail(bug)
        finally:
            for registration in self._registrations:
                registry.remove(registration)
            self._announce_end()
            self._close_all()

    def _attend(self) -> None:
        has_requests = any(client.requests for client in self._clients)
        is_busy = self._owner or self._orphaned_requests or has_requests
        for key, mask in self._selector.select(PAUSE_S if is_busy else REST_S):
            if key.fileobj is self._listening_socket:
                self._accept_client()
            elif key.fileobj is self._wake_receiver:
                with suppress(OSError):
                    self._wake_receiver.recv(4096)
            elif key.data in self._clients:
                if mask & selectors.EVENT_READ:
                    self._read(key.data)
                if mask & selectors.EVENT_WRITE:
                    self._write(key.data)
        self._pass_on_outcomes()
        self._pass_on_events()
        self._check_timeouts()

    def _accept_client(self) -> None:
        try:
            peer, _ = self._listening_socket.accept()
        except (BlockingIOError, ConnectionError):  # the client has left already
            return
        except OSError:  # this process has too many files open
            self._drop_oldest_stranger()
            sleep(FULL_S)
            return
        strangers = [client for client in self._clients if not client.verb]
        if len(self._clients) - len(strangers) >= MAX_CLIENTS:
            peer.close()
            return
        if len(strangers) >= MAX_CLIENTS:
            self._drop_oldest_stranger()
        peer.setblocking(False)
        with suppress(OSError):  # the client has left already
            peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client = ConnectedClient(peer)
        self._clients.append(client)
        self._selector.register(peer, selectors.EVENT_READ, client)

    def _drop_oldest_stranger(self) -> None:
        stranger = next((client for client in self._clients if not client.verb), None)
        if stranger is not None:
            self._drop(stranger)

    def _read(self, client: ConnectedClient) -> None:
        try:
            data = client.peer.recv(65536 if client.verb else protocol.GREETING_BYTES)
            if not data:
                raise ConnectionError
            if not client.verb:
                data = self._greet(client, data)
            else:
                client.heard_s = monotonic()
            for message in client.messages.read_messages(data) if client.verb else ():
                self._handle_message(client, message)
        except BlockingIOError:
            pass
        except (OSError, BadMessage):
            self._drop(client)

    def _handle_message(self, client: ConnectedClient, message: JsonMessage) -> None:
        action = protocol.read_field(message, "do", str)
        if action == "stop":
            self._connection.stop()
        elif action == "beat":
            self._send(client, {"beat": True})
        elif action == "places":
            client.takes_places = self._connection.session.tells_places = True
        else:
            self._begin(client, message)

    def _greet(self, client: ConnectedClient, data: bytes) -> bytes:
        """Read a new client's greeting; return the bytes after it.

        Until the token is right, no other message is read. Raises BadMessage.
        """
        client.greeting += data
        greeting = protocol.read_greeting(client.greeting)
        if greeting is None:
            return b""
        if not hmac.compare_digest(greeting.token, self.registration.token.encode()):
            raise BadMessage
        client.verb, client.greeting = greeting.verb, b""
        client.heard_s = monotonic()
        self._send(client, {"tsc": __version__, "answer": self.registration.answer})
        self._tell_own_command(client, JoinedEvent)
        return greeting.rest

    def _begin(self, client: ConnectedClient, message: JsonMessage) -> None:
        """Begin a client's request."""
        number = protocol.read_int(message, "id")
        limit_ms = min(max(1, protocol.read_int(message, "limit_ms")), 60_000)
        if number in client.requests or len(client.requests) >= MAX_REQUESTS:
            raise BadMessage
        robot = self._connection.robot
        if message["do"] == "hello" and robot and self._connection.session.is_open:  # already known
            self._tell_outcome(client, number, Reply(OK, 0, robot.values))
            return
        if message["do"] == "press" and not client.speaker:
            self._speaker_count += 1
            client.speaker = self._speaker_count
        make_request = request_maker(message, limit_ms, client.speaker)
        if self._is_latched() and message["do"] in _STARTING_REQUESTS:
            self._tell_outcome(client, number, Reply(CANCELLED))
            return
        client.requests[number] = ServedRequest(
            self._connection.begin(make_request), is_detached(message)
        )

    def _pass_on_outcomes(self) -> None:
        for client in list(self._clients):
            for number, request in list(client.requests.items()):
                outcome = request.pending_request.outcome
                if outcome is not None:
                    del client.requests[number]
                    self._note_owner(request, client)
                    self._tell_outcome(client, number, outcome)
                elif request.pending_request.done_bytes != request.told_bytes:
                    done_bytes = request.pending_request.done_bytes
                    client.requests[number] = request._replace(told_bytes=done_bytes)
                    self._send(client, {"id": number, "done_bytes": done_bytes})
        for request in self._orphaned_requests:
            self._note_owner(request, None)
        self._orphaned_requests = [
            request
            for request in self._orphaned_requests
            if request.pending_request.outcome is None
        ]

    def _note_owner(self, request: ServedRequest, client: ConnectedClient | None) -> None:
        """Note which client's run has begun; stop the run where that client has left."""
        outcome = request.pending_request.outcome
        if outcome is None or outcome.status != OK:
            return
        if not request.pending_request.starts_program or request.is_detached:
            return
        receipt: ReceiptReply = outcome.values
        run = receipt.run
        if not self._connection.runs(run):
            return
        if client is None:
            self._connection.end_run(run)
        else:
            self._owner = client, run

    def _tell_outcome(self, client: ConnectedClient, number: int, outcome: Reply[Any]) -> None:
        values = outcome.values._asdict() if outcome.status == OK else {}
        self._send(client, {
            "id": number,
            "status": outcome.status,
            "detail": outcome.detail,
            "values": protocol.to_json_values(values),
            "heard": self._connection.heard_count,
            "came": self._connection.early_bytes.hex(),
            "is_echoed": self._connection.is_echoed,
            "boot": self._connection.boot,
        })  # fmt: skip

    def _pass_on_events(self) -> None:
        while self._told_events:
            time_ms, event = self._told_events.popleft()
            # a late end may belong to the previous run
            if event.name in _ENDING_EVENTS and self._owner is not None and not self.has_owned_run:
                self._owner = None
            for client in list(self._clients):
                if client.verb:
                    self._tell_event(client, time_ms, event)

    def _tell_event(self, client: ConnectedClient, time_ms: int, event: Event) -> None:
        if event.name == "PLACE" and not (client.takes_places and len(client.output) <= FULL_BYTES):
            return
        if len(client.output) > FULL_BYTES and event.name in _DROPPABLE_EVENTS:
            client.missed_count += 1
            return
        if client.missed_count:
            missed_count, client.missed_count = client.missed_count, 0
            self._tell_event(client, time_ms, MissedEvent(missed_count))
        values = protocol.to_json_values(protocol.event_fields(event))
        message: JsonMessage = {"event": event.name, "ms": time_ms, "values": values}
        self._send(client, message)

    def _check_timeouts(self) -> None:
        now_s = monotonic()
        for client in list(self._clients):
            if not client.verb and now_s - client.heard_s > GREETING_S:
                self._drop(client)
        if self._owner is not None and now_s - self._owner[0].heard_s > protocol.DEAD_MAN_S:
            self._end_run()

    def _end_run(self) -> None:
        """End the run of a client that has left."""
        if self._owner is not None:
            self._connection.end_run(self._owner[1])
        self._owner = None

    def _drop(self, client: ConnectedClient) -> None:
        if client not in self._clients:
            return
        self._clients.remove(client)
        self._selector.unregister(client.peer)
        client.peer.close()
        for request in client.requests.values():
            self._connection.withdraw(request.pending_request)
            self._orphaned_requests.append(request)
        if client.speaker:
            self._connection.begin(lambda session: session.press(speaker=client.speaker))
        if self._owner is not None and self._owner[0] is client:
            self._end_run()
        self._tell_own_command(client, LeftEvent)

    def _tell_own_command(
        self, client: ConnectedClient, event: type[JoinedEvent] | type[LeftEvent]
    ) -> None:
        if client.verb not in ("", protocol.LOOKING_VERB):
            self._connection.post_event(event(client.verb.encode()))

    # -- messages to clients ----------------------------------------------------------------------

    def _send(self, client: ConnectedClient, message: JsonMessage) -> None:
        client.output += protocol.encode_message(message)
        if len(client.output) > TOO_FULL_BYTES:
            self._drop(client)
        else:
            self._write(client)

    def _write(self, client: ConnectedClient) -> None:
        try:
            sent_count = client.peer.send(client.output) if client.output else 0
            del client.output[:sent_count]
        except BlockingIOError:
            pass
        except OSError:
            self._drop(client)
            return
        event_mask = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.output else 0)
        if client in self._clients:
            self._selector.modify(client.peer, event_mask, client)

    def _announce_end(self) -> None:
        """Tell all clients that the connection has ended, and why."""
        reason = self._connection.end_reason
        end_message: JsonMessage = {
            "over": "ended" if reason is None else "gone",
            "why": reason or "",
        }
        for client in list(self._clients):
            if client.verb:
                self._send(client, end_message)
            with suppress(OSError):
                client.peer.shutdown(socket.SHUT_WR)

    def _close_all(self) -> None:
        for client in self._clients:
            client.peer.close()
        for resource in (
            self._listening_socket,
            self._wake_sender,
            self._wake_receiver,
            self._selector,
        ):
            resource.close()
