"""The messages between a server and its clients: lines of JSON of a limited length.

    client                                       server
    {"tsc": "0.1.0", "token": "..", "verb": ".."}
                                                 {"tsc": "0.1.0", "answer": ".."}
    {"do": "upload", "id": 1, "limit_ms": 6000, "image": "..", ..}
                                                 {"id": 1, "done_bytes": 54}
                                                 {"id": 1, "status": 0, "detail": 0, "values": {..},
                                                  "heard": 99, "came": "", "is_echoed": false,
                                                  "boot": 7}
                                                 {"event": "SHOW", "ms": 1234, "values": {..}}
    {"do": "places"}                             {"event": "PLACE", "ms": 1234, "values": {..}}
    {"do": "stop"}
    {"do": "beat"}                               {"beat": true}
                                                 {"over": "ended", "why": ""}

The server does not answer a client that begins without the right token, and reads nothing from it
as JSON: a greeting has one form, to the byte. The greeting and `stop` are the same in every
version, so that each tsc can stop a robot that another version holds. Bytes are written in hex.
Knows no socket.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Hashable, Mapping
from functools import cache
from typing import NamedTuple, TypeVar, cast, get_type_hints

from tiniscript.link.messages import Malformed
from tiniscript.link.outcomes import EVENTS, Event
from tiniscript.link.requests import OK, Reply

HOST = "127.0.0.1"
LINE_BYTES = 100_000  # the longest program has 32,781 bytes
GREETING_BYTES = 1000
LOOKING_VERB = "ports"  # the verb of a client that only checks which robot is there
HEARTBEAT_S = 0.2  # between two heartbeats of a waiting client
DEAD_MAN_S = 1.0  # dead-man timer: a run ends when its client is silent for this long

JsonMessage = dict[str, object]
T = TypeVar("T")

_GREETING = re.compile(
    rb'{"tsc":"[0-9A-Za-z.+-]{1,40}","token":"([0-9a-f]{32})",'
    rb'"verb":"([A-Za-z][A-Za-z -]{0,29})"}\n'
)


class BadMessage(Exception):
    """The data is no message, or not the expected one."""


class Greeting(NamedTuple):
    token: bytes
    verb: str
    rest: bytes  # the bytes after the greeting


def read_greeting(data: bytes) -> Greeting | None:
    """Return the greeting that data begins with, or None while it is still incomplete.

    Raises BadMessage if data is no greeting.
    """
    match = _GREETING.match(data)
    if match is not None:
        return Greeting(match[1], match[2].decode("ascii"), data[match.end() :])
    if data[:1] != b"{" or b"\n" in data or len(data) > GREETING_BYTES:
        raise BadMessage
    return None


class MessageReader:
    """Turns bytes into messages. `limit_bytes` is the length of the longest line allowed."""

    def __init__(self, limit_bytes: int) -> None:
        self.limit_bytes = limit_bytes
        self._incomplete_line = b""

    def read_messages(self, data: bytes) -> list[JsonMessage]:
        """Return the messages that are now complete. Raises BadMessage."""
        *lines, self._incomplete_line = (self._incomplete_line + data).split(b"\n")
        if any(len(line) > self.limit_bytes for line in (*lines, self._incomplete_line)):
            raise BadMessage
        return [message_of(line) for line in lines]


def encode_message(message: Mapping[str, object]) -> bytes:
    return json.dumps(message, separators=(",", ":")).encode() + b"\n"


def message_of(line: bytes) -> JsonMessage:
    """Return the object of JSON that these bytes are. Raises BadMessage."""
    try:
        result = json.loads(line)
    except (ValueError, RecursionError):
        raise BadMessage from None
    if not isinstance(result, dict):
        raise BadMessage
    return result


def read_field(message: JsonMessage, name: str, field_type: type[T]) -> T:
    """Return a field of this kind. Raises BadMessage if it is something else."""
    value = message.get(name)
    if type(value) is not field_type:  # True is no whole number
        raise BadMessage
    return value


def read_int(message: JsonMessage, name: str) -> int:
    return read_field(message, name, int)


def read_bytes(message: JsonMessage, name: str) -> bytes:
    """Return a field of bytes in hex. Raises BadMessage if it is something else."""
    try:
        return bytes.fromhex(read_field(message, name, str))
    except ValueError:
        raise BadMessage from None


def to_json_values(values: Mapping[str, int | bytes]) -> JsonMessage:
    """Return the fields of a reply or an event in a form for JSON: bytes become hex."""
    return {
        name: value.hex() if isinstance(value, bytes) else value for name, value in values.items()
    }


def read_values(message: JsonMessage) -> dict[str, int | bytes]:
    """Return the fields of a reply or an event. Raises BadMessage."""
    fields = message.get("values")
    if not isinstance(fields, dict):
        raise BadMessage
    return {
        key: read_int(fields, key) if type(value) is int else read_bytes(fields, key)
        for key, value in fields.items()
    }


def read_reply(message: JsonMessage, reply_type: type[T]) -> Reply[T]:
    """Return the reply in a message, with values of the type `reply_type`. Raises BadMessage."""
    status, detail, payload_values = (
        read_int(message, "status"),
        read_int(message, "detail"),
        read_values(message),
    )
    if status != OK:
        return Reply(status, detail)
    try:
        return Reply(OK, detail, make_payload(reply_type, payload_values))
    except Malformed:
        raise BadMessage from None


def read_event(message: JsonMessage) -> tuple[int, Event]:
    """Return the time (ms) and the event of a message. Raises BadMessage."""
    try:
        return read_int(message, "ms"), event_of(
            read_field(message, "event", str), read_values(message)
        )
    except Malformed:
        raise BadMessage from None


def event_fields(event: Event) -> dict[str, int | bytes]:
    """Return the fields of an event, without its name."""
    fields = event._asdict()
    del fields["name"]
    return fields


def make_payload(payload_type: type[T], values: Mapping[str, int | bytes]) -> T:
    """Return a payload with these values. Raises Malformed if it has other fields."""
    if {name: type(value) for name, value in values.items()} != _field_types(
        cast(Hashable, payload_type)
    ):
        raise Malformed
    make: Callable[..., T] = payload_type
    return make(**values)


def event_of(name: str, values: Mapping[str, int | bytes]) -> Event:
    """Return an event. Raises Malformed if no event has this name and these fields."""
    if name not in EVENTS:
        raise Malformed
    return make_payload(EVENTS[name], values)


@cache
def _field_types(payload_type: Hashable) -> dict[str, object]:
    """Return the type of each field, without an event's name."""
    return {
        name: value for name, value in get_type_hints(payload_type).items() if value in (int, bytes)
    }
