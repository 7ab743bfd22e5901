"""The requests of a client: the message that it writes, and the call that the server then makes.

The server checks every field of a message before it reaches the session.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from struct import iter_unpack
from typing import Any, TypeVar

from tiniscript.bytecode.image import HEADER_BYTES, STARTS, Image
from tiniscript.link.connection import PendingRequest, Requester
from tiniscript.link.messages import (
    BY_NAME,
    KEYS,
    MAX_BREAKPOINTS,
    MIN_PASSWORD,
    NETWORK_BYTES,
    PACE_BYTES,
    PASSWORD_BYTES,
    SEALED_PAYLOAD_BYTES,
    TRIM_BYTES,
    Field,
)
from tiniscript.link.remote import RemoteState
from tiniscript.link.sharing import protocol
from tiniscript.link.sharing.protocol import BadMessage, JsonMessage
from tiniscript.link.wifi import BrokerSettings, Network, Tls

MAX_CODE_BYTES = 0x7FFF  # the largest value in an image's header
MAX_LATER_BYTES = 0xFF - HEADER_BYTES  # the largest value of the field
T = TypeVar("T")


class ClientRequest(PendingRequest[T]):
    """A request of a client: the values of its reply have the type `reply_type`."""

    def __init__(
        self, name: str, reply_type: type[T], starts_program: bool = False, /, **fields: object
    ) -> None:
        self.starts_program = starts_program
        self.message: JsonMessage = {"do": name, **fields}
        self.reply_type = reply_type


class ClientRequests(Requester):
    """All requests of a client: the same as those of a session."""

    def _ask(
        self, name: str, reply_type: type[T], starts_program: bool = False, /, **arguments: object
    ) -> ClientRequest[T]:
        return ClientRequest(name, reply_type, starts_program, **_message_fields(arguments))


def _message_fields(arguments: Mapping[str, object]) -> JsonMessage:
    """Return the fields of a message: bytes are hex, and the fields of a tuple are on the same
    level as the others."""
    fields: JsonMessage = {}
    for name, value in arguments.items():
        if hasattr(value, "_asdict"):
            fields |= _message_fields(value._asdict())
        elif isinstance(value, (bytes, tuple)):
            fields[name] = bytes(value).hex()
        elif value is not None:
            fields[name] = value
    return fields


def request_maker(
    message: JsonMessage, limit_ms: int, speaker: int = 0
) -> Callable[[Requester], PendingRequest[Any]]:
    """Return the function that makes a message's request to a session. Raises BadMessage.

    `speaker` is the client that presses keys.
    """
    name = protocol.read_field(message, "do", str)
    arguments = (
        _ARGUMENT_READERS[name](message)
        if name in _ARGUMENT_READERS
        else _message_arguments(name, message)
    )
    if name == "press":
        arguments += (speaker,)

    def make_request(session: Requester) -> PendingRequest[Any]:
        request: PendingRequest[Any] = getattr(session, name)(*arguments)
        request.limit_ms = limit_ms
        return request

    return make_request


def is_detached(message: JsonMessage) -> bool:
    """Return whether a message requests a run that continues without its client."""
    return message.get("is_detached") is True


def _message_arguments(name: str, message: JsonMessage) -> tuple[object, ...]:
    """Return the fields of the link's message of that name, which such a request is given."""
    if name not in vars(Requester) or name.upper() not in BY_NAME:
        raise BadMessage
    return tuple(_field(message, field) for field in BY_NAME[name.upper()].request)


def _field(message: JsonMessage, field: Field) -> int | bytes:
    """Return the value of a link field in a message. Raises BadMessage."""
    if field.kind == "rest":
        return _bytes(
            message, field.name, field.least_bytes, min(field.most_bytes, SEALED_PAYLOAD_BYTES)
        )
    bits = 8 * field.most_bytes
    lowest = -(1 << bits - 1) if field.kind.startswith("i") else 0
    number = protocol.read_int(message, field.name)
    if not 0 <= number - lowest < 1 << bits:
        raise BadMessage
    return number


def _bounded_number(message: JsonMessage, name: str, limit: int, default: int | None = None) -> int:
    """Return a number from 0 on, below the limit. Raises BadMessage."""
    number = protocol.read_int(message if default is None else {name: default, **message}, name)
    if not 0 <= number < limit:
        raise BadMessage
    return number


def _bytes(message: JsonMessage, name: str, least_bytes: int, most_bytes: int) -> bytes:
    """Return the bytes of a field. Raises BadMessage."""
    data = protocol.read_bytes(message, name)
    if not least_bytes <= len(data) <= most_bytes:
        raise BadMessage
    return data


def _pressed_keys(message: JsonMessage) -> tuple[object, ...]:
    pressed_state = RemoteState(*(protocol.read_int(message, name) for name in RemoteState._fields))
    if not pressed_state.is_sound:
        raise BadMessage
    return pressed_state


def _places(message: JsonMessage) -> tuple[int, ...]:
    data = _bytes(message, "places", 0, 2 * MAX_BREAKPOINTS)
    if len(data) % 2:
        raise BadMessage
    return tuple(place for (place,) in iter_unpack("<H", data))


def _trim(message: JsonMessage) -> bytes:
    trim = protocol.read_bytes(message, "trim")
    if len(trim) not in (0, TRIM_BYTES, TRIM_BYTES + PACE_BYTES):
        raise BadMessage
    return trim


def _kit(message: JsonMessage) -> int:
    return _bounded_number(message, "kit", 1 << 16, 0)


def _network(message: JsonMessage) -> Network:
    name = _bytes(message, "name", 1, NETWORK_BYTES)
    password = _bytes(message, "password", MIN_PASSWORD, PASSWORD_BYTES)
    if b"\0" in name + password:
        raise BadMessage
    return Network(name, password, protocol.read_field(message, "is_access_point", bool))


def _broker(message: JsonMessage) -> BrokerSettings | None:
    if "address" not in message:
        return None
    tls = None
    if "trust" in message:
        tls = Tls(protocol.read_bytes(message, "trust"), protocol.read_int(message, "date"))
    broker = BrokerSettings(
        protocol.read_bytes(message, "address"),
        protocol.read_int(message, "port"),
        protocol.read_field(message, "group", str),
        protocol.read_bytes(message, "user"),
        protocol.read_bytes(message, "password"),
        protocol.read_bytes(message, "name"),
        tls,
    )
    if not broker.is_sound:
        raise BadMessage
    return broker


def _image(message: JsonMessage) -> Image:
    start = protocol.read_field(message, "start", str)
    if start not in STARTS[:2]:
        raise BadMessage
    major, minor = _bytes(message, "isa", 2, 2)
    return Image(
        start,
        _bounded_number(message, "devices", 1 << 16),
        _bytes(message, "code", 0, MAX_CODE_BYTES),
        _bounded_number(message, "checksum", 1 << 32),
        (major, minor),
        _bytes(message, "later_fields", 0, MAX_LATER_BYTES),
        # Without this field, the image is of version 2.0.
        _bounded_number(message, "needs", 1 << 8, 0),
    )


def _upload(message: JsonMessage) -> tuple[object, ...]:
    flags = (protocol.read_field(message, name, bool) for name in ("runs", "saves", "is_detached"))
    return (_image(message), *flags, _kit(message))


# Arguments of requests, read from a message, if they differ from the link's message of that name.
_ARGUMENT_READERS: dict[str, Callable[[JsonMessage], tuple[object, ...]]] = {
    **dict.fromkeys(
        ("hello", "ping", "fetch", "hold_back", "wifi", "forget_wifi", "broker"),
        lambda message: (),
    ),
    "press": _pressed_keys,
    "trim": lambda message: (_trim(message),),
    "break_at": lambda message: (_places(message),),
    "claim": lambda message: (_bounded_number(message, "kind", len(KEYS)),),
    "disown": lambda message: (_bounded_number(message, "kind", len(KEYS)),),
    "allow_text": lambda message: (protocol.read_field(message, "is_allowed", bool),),
    "tell_readings": lambda message: (protocol.read_field(message, "is_on", bool),),
    "start": lambda message: (protocol.read_field(message, "is_detached", bool),),
    "live": lambda message: (
        protocol.read_bytes(message, "code"), _kit(message),
        protocol.read_field({"halts": False, **message}, "halts", bool),
    ),
    "upload": _upload,
    "join": lambda message: (_network(message),),
    "use_broker": lambda message: (_broker(message),),
}  # fmt: skip
