"""The connection to a robot through the command that holds its port.

It has no thread: a waiting caller reads the received bytes. While it waits it sends heartbeats; the
server ends a run that it has started when they stay away. Knows sockets and the clock.
"""

from __future__ import annotations

import socket
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from time import monotonic
from typing import Any, TypeVar

from tiniscript.base.version import __version__
from tiniscript.link.connection import LinkConnection, PendingRequest, Requester
from tiniscript.link.outcomes import POLL_INTERVAL_S, ConnectionLost, Event
from tiniscript.link.payloads import HelloReply
from tiniscript.link.requests import OK, DeviceInfo, Reply, device_info_of
from tiniscript.link.sharing import protocol, registry
from tiniscript.link.sharing.protocol import BadMessage, JsonMessage
from tiniscript.link.sharing.registry import Registration
from tiniscript.link.sharing.requests import ClientRequest, ClientRequests

ANSWER_S = 2.0  # timeout for the server's greeting
SEND_S = 2.0  # timeout for a server that accepts no bytes
DEAF_S = 5.0  # timeout for the answer to a heartbeat


T = TypeVar("T")


class OtherVersion(Exception):
    """The server is a tsc of another version."""

    def __init__(self, registration: Registration, version: str) -> None:
        super().__init__(version)
        self.registration = registration
        self.version = version


class SharedConnection(LinkConnection):
    """The connection through a server that has sent its greeting."""

    def __init__(
        self, peer: socket.socket, registration: Registration, reader: protocol.MessageReader
    ) -> None:
        self._robot: DeviceInfo | None = None
        self._boot = 0
        self.holder_verb = registration.verb
        self.baud = registration.baud
        self._peer = peer
        self._reader = reader
        self._requests = ClientRequests()
        self._pending_requests: dict[int, ClientRequest[Any]] = {}
        self._request_count = 0
        self._events: deque[tuple[int, Event]] = deque()
        self._end: ConnectionLost | None = None
        self._heartbeat_s = 0.0  # time of the last heartbeat
        self._unanswered_since_s: float | None = None  # time of the first unanswered heartbeat

    @property
    def robot(self) -> DeviceInfo | None:
        return self._robot

    @property
    def boot(self) -> int:
        return self._boot

    @property
    def has_ended(self) -> bool:
        return self._end is not None

    def begin(self, make_request: Callable[[Requester], PendingRequest[T]]) -> PendingRequest[T]:
        request = make_request(self._requests)
        assert isinstance(request, ClientRequest)
        self._request_count += 1
        self._pending_requests[self._request_count] = request
        self._send({**request.message, "id": self._request_count, "limit_ms": request.limit_ms})
        return request

    def wait(self, request: PendingRequest[T], look: Callable[[], None] | None = None) -> Reply[T]:
        while request.outcome is None:
            if self._end is not None:
                raise self._end
            self._listen(POLL_INTERVAL_S)
            if look is not None:
                look()
        return request.outcome

    def event(self, timeout_s: float = POLL_INTERVAL_S) -> tuple[int, Event] | None:
        if not self._events:
            if self._end is not None:
                raise self._end
            self._listen(timeout_s)
        return self._events.popleft() if self._events else None

    def enable_place_events(self) -> None:
        self._send({"do": "places"})

    def stop(self) -> int:
        began_ms = int(monotonic() * 1000)
        self._send({"do": "stop"})
        return began_ms

    def close(self) -> None:
        self._peer.close()

    def _send(self, message: JsonMessage) -> None:
        try:
            self._peer.settimeout(SEND_S)
            self._peer.sendall(protocol.encode_message(message))
        except OSError as error:
            # messages that arrived earlier may give a better reason
            self._end = self._end or ConnectionLost(str(error), is_server=True)

    def _listen(self, timeout_s: float) -> None:
        """Read and handle messages until some arrive or the time is over."""
        now_s = monotonic()
        if now_s - self._heartbeat_s >= protocol.HEARTBEAT_S:
            self._heartbeat_s = now_s
            if self._unanswered_since_s is None:
                self._unanswered_since_s = now_s
            self._send({"do": "beat"})
        try:
            self._peer.settimeout(max(timeout_s, 0.001))
            data = self._peer.recv(65536)
            if not data:
                raise ConnectionError
            self._unanswered_since_s = None
            for message in self._reader.read_messages(data):
                self._handle_message(message)
        except TimeoutError:
            if self._unanswered_since_s is not None and now_s - self._unanswered_since_s > DEAF_S:
                self._end = ConnectionLost("", is_server=True)
        except (OSError, BadMessage) as error:
            self._end = self._end or ConnectionLost(str(error), is_server=True)

    def _handle_message(self, message: JsonMessage) -> None:
        if "over" in message:
            is_server = message["over"] != "gone"
            self._end = ConnectionLost(protocol.read_field(message, "why", str), is_server)
        elif "event" in message:
            self._events.append(protocol.read_event(message))
        elif "id" in message:
            self._take_outcome(message)

    def _take_outcome(self, message: JsonMessage) -> None:
        number = protocol.read_int(message, "id")
        request = self._pending_requests.get(number)
        if request is None:
            raise BadMessage
        if "done_bytes" in message:
            request.done_bytes = protocol.read_int(message, "done_bytes")
            return
        self.heard_count = protocol.read_int(message, "heard")
        self.early_bytes = protocol.read_bytes(message, "came")
        self.is_echoed = protocol.read_field(message, "is_echoed", bool)
        self._boot = protocol.read_int(message, "boot")
        reply = protocol.read_reply(message, request.reply_type)
        request.outcome = reply
        del self._pending_requests[number]
        if reply.status == OK:
            self._learn(request, reply.values)

    def _learn(self, request: ClientRequest[Any], values: object) -> None:
        """Remember the identity of the robot."""
        if isinstance(values, HelloReply):
            self._robot = device_info_of(values)
        elif request.message["do"] == "name" and self.robot is not None:
            name = bytes.fromhex(str(request.message["name"]))
            self._robot = device_info_of(self.robot.values._replace(name=name))


def join(port: str, verb: str) -> SharedConnection | None:
    """Return the connection through the command that holds a port; None if no command does.

    Raises OtherVersion if the server is another version of tsc; `stop` works there, too.
    """
    registration = registry.find_registration(port)
    return None if registration is None else _connect_to(registration, verb)


def is_alive(registration: Registration) -> bool:
    """Return whether a server is still running."""
    try:
        client = _connect_to(registration, protocol.LOOKING_VERB)
    except OtherVersion:
        return True
    if client is not None:
        client.close()
    return client is not None


def _connect_to(registration: Registration, verb: str) -> SharedConnection | None:
    peer = None
    try:
        peer = socket.create_connection((protocol.HOST, registration.number), ANSWER_S)
        peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        peer.sendall(
            protocol.encode_message({"tsc": __version__, "token": registration.token, "verb": verb})
        )
        reader = protocol.MessageReader(protocol.LINE_BYTES)
        messages = _read_greeting(peer, reader)
        if protocol.read_field(messages[0], "answer", str) != registration.answer:
            raise BadMessage  # another program is listening on that port
        version = protocol.read_field(messages[0], "tsc", str)
        if version != __version__ and verb != "stop":
            raise OtherVersion(registration, version)
        client = SharedConnection(peer, registration, reader)
        for message in messages[1:]:
            client._handle_message(message)
        return client
    except (OSError, BadMessage, OtherVersion) as failure:
        if peer is not None:
            with suppress(OSError):
                peer.close()
        if isinstance(failure, OtherVersion):
            raise
        return None


def _read_greeting(peer: socket.socket, reader: protocol.MessageReader) -> list[JsonMessage]:
    """Return the greeting of a server and the data after it."""
    end_s = monotonic() + ANSWER_S
    while (left_s := end_s - monotonic()) > 0:
        peer.settimeout(left_s)
        data = peer.recv(65536)
        if not data:
            raise ConnectionError
        messages = reader.read_messages(data)
        if messages:
            return messages
    raise TimeoutError
