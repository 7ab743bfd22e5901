"""The requests of a client: the message that it writes, and the call that the server then makes.

Each request is here twice, one above the other. This module checks every field of a message
before it reaches the session.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from tiniscript.bytecode.image import HEADER_BYTES, STARTS, Image
from tiniscript.link.connection import PendingRequest, Requester
from tiniscript.link.messages import KEYS, NAME_BYTES, TRIM_BYTES
from tiniscript.link.network_messages import LEAST_PASSWORD, NETWORK_BYTES, PASSWORD_BYTES
from tiniscript.link.payloads import (
    EmptyReply,
    HelloReply,
    PingReply,
    ReceiptReply,
    StatusReply,
    TextReply,
    TrimReply,
    WifiReply,
)
from tiniscript.link.requests import FetchedImage
from tiniscript.link.sharing import protocol
from tiniscript.link.sharing.protocol import BadMessage, JsonMessage
from tiniscript.link.wifi import BrokerSettings, Network, Tls

CODE_BYTES = 0x7FFF  # the most that an image's header can say
LATER_BYTES = 0xFF - HEADER_BYTES  # the most that it can say
NO_TLS = Tls(b"", 0)
T = TypeVar("T")
_PLAIN = ("hello", "ping", "status", "clear", "fetch", "undo", "identify", "hold_back",
          "wifi", "forget_wifi", "broker", "use_no_broker")  # fmt: skip


class ClientRequest(PendingRequest[T]):
    """A request of a client: the values of its reply have the type `kind`."""

    def __init__(self, do: str, kind: type[T], starts: bool = False, **fields: object) -> None:
        super().__init__(starts=starts)
        self.message: JsonMessage = {"do": do, **fields}
        self.kind = kind


class ClientRequests:
    """All requests of a client: the same as those of a session."""

    def hello(self) -> ClientRequest[HelloReply]:
        return ClientRequest("hello", HelloReply)

    def ping(self) -> ClientRequest[PingReply]:
        return ClientRequest("ping", PingReply)

    def status(self) -> ClientRequest[StatusReply]:
        return ClientRequest("status", StatusReply)

    def clear(self) -> ClientRequest[EmptyReply]:
        return ClientRequest("clear", EmptyReply)

    def fetch(self) -> ClientRequest[FetchedImage]:
        return ClientRequest("fetch", FetchedImage)

    def undo(self) -> ClientRequest[ReceiptReply]:
        return ClientRequest("undo", ReceiptReply)

    def identify(self) -> ClientRequest[EmptyReply]:
        return ClientRequest("identify", EmptyReply)

    def hold_back(self) -> ClientRequest[EmptyReply]:
        return ClientRequest("hold_back", EmptyReply)

    def claim(self, which: int) -> ClientRequest[EmptyReply]:
        """The server makes the key, and keeps it: no message between commands has one."""
        return ClientRequest("claim", EmptyReply, which=which)

    def disown(self, which: int) -> ClientRequest[EmptyReply]:
        return ClientRequest("disown", EmptyReply, which=which)

    def allow_text(self, is_allowed: bool) -> ClientRequest[TextReply]:
        return ClientRequest("allow_text", TextReply, is_allowed=is_allowed)

    def wifi(self) -> ClientRequest[WifiReply]:
        return ClientRequest("wifi", WifiReply)

    def join(self, network: Network) -> ClientRequest[WifiReply]:
        """The password goes to another process of this user, and into no file."""
        fields = network._asdict()
        fields.update(name=network.name.hex(), password=network.password.hex())
        return ClientRequest("join", WifiReply, **fields)

    def forget_wifi(self) -> ClientRequest[WifiReply]:
        return ClientRequest("forget_wifi", WifiReply)

    def broker(self) -> ClientRequest[WifiReply]:
        return ClientRequest("broker", WifiReply)

    def use_broker(self, broker: BrokerSettings | None) -> ClientRequest[WifiReply]:
        """The password goes as that of `join`."""
        if broker is None:
            return ClientRequest("use_no_broker", WifiReply)
        fields = {**broker._asdict(), **(broker.tls or NO_TLS)._asdict()}
        del fields["tls"]
        for name in ("address", "user", "password", "name", "trust"):
            fields[name] = fields[name].hex()
        return ClientRequest("use_broker", WifiReply, **fields)

    def name(self, name: bytes) -> ClientRequest[EmptyReply]:
        return ClientRequest("name", EmptyReply, name=name.hex())

    def trim(self, trim: bytes = b"") -> ClientRequest[TrimReply]:
        return ClientRequest("trim", TrimReply, trim=trim.hex())

    def start(self, is_detached: bool = False) -> ClientRequest[ReceiptReply]:
        return ClientRequest("start", ReceiptReply, starts=True, is_detached=is_detached)

    def live(self, code: bytes, kit: int = 0) -> ClientRequest[ReceiptReply]:
        return ClientRequest("live", ReceiptReply, starts=True, code=code.hex(), kit=kit)

    def upload(
        self, image: Image, runs: bool = True, saves: bool = True, is_detached: bool = False,
        kit: int | None = None,
    ) -> ClientRequest[ReceiptReply]:  # fmt: skip
        return ClientRequest(
            "upload",
            ReceiptReply,
            starts=runs and image.start == "SI",
            start=image.start,
            devices=image.devices,
            kit=kit or 0,
            code=image.code.hex(),
            later=image.later.hex(),
            checksum=image.checksum,
            isa=bytes(image.isa).hex(),
            runs=runs,
            saves=saves,
            is_detached=is_detached,
        )


def asked_for(message: JsonMessage, limit_ms: int) -> Callable[[Requester], PendingRequest[Any]]:
    """Return the function that makes a message's request to a session. Raises BadMessage."""
    ask = _asked_for(message)

    def limited(session: Requester) -> PendingRequest[Any]:
        request = ask(session)
        request.limit_ms = limit_ms
        return request

    return limited


def is_detached(message: JsonMessage) -> bool:
    """Return whether a message requests a run that goes on without its client."""
    return message.get("is_detached") is True


def _asked_for(message: JsonMessage) -> Callable[[Requester], PendingRequest[Any]]:
    do = protocol.word(message, "do")
    if do in _PLAIN:
        return lambda session: _plain(session, do)
    if do == "name":
        name = protocol.data(message, "name")
        if not 1 <= len(name) <= NAME_BYTES:
            raise BadMessage
        return lambda session: session.name(name)
    if do == "join":
        network = _network(message)
        return lambda session: session.join(network)
    if do == "use_broker":
        broker = _broker(message)
        return lambda session: session.use_broker(broker)
    if do in ("claim", "disown"):
        which = protocol.number(message, "which")
        if not 0 <= which < len(KEYS):
            raise BadMessage
        return lambda session: session.claim(which) if do == "claim" else session.disown(which)
    if do == "allow_text":
        is_allowed = protocol.answer(message, "is_allowed")
        return lambda session: session.allow_text(is_allowed)
    if do == "trim":
        trim = protocol.data(message, "trim")
        if len(trim) not in (0, TRIM_BYTES):
            raise BadMessage
        return lambda session: session.trim(trim)
    if do == "start":
        is_alone = protocol.answer(message, "is_detached")
        return lambda session: session.start(is_alone)
    if do == "live":
        code, kit = protocol.data(message, "code"), _kit(message)
        return lambda session: session.live(code, kit)
    if do == "upload":
        image, kit = _image(message), _kit(message)
        runs, saves, is_alone = (
            protocol.answer(message, name) for name in ("runs", "saves", "is_detached")
        )
        return lambda session: session.upload(image, runs, saves, is_alone, kit)
    raise BadMessage


def _plain(session: Requester, do: str) -> PendingRequest[Any]:
    if do == "use_no_broker":
        return session.use_broker(None)
    asked: PendingRequest[Any] = getattr(session, do)()
    return asked


def _kit(message: JsonMessage) -> int:
    kit = protocol.number(message, "kit")
    if not 0 <= kit < 1 << 16:
        raise BadMessage
    return kit


def _network(message: JsonMessage) -> Network:
    name, password = protocol.data(message, "name"), protocol.data(message, "password")
    if not 1 <= len(name) <= NETWORK_BYTES:
        raise BadMessage
    if not LEAST_PASSWORD <= len(password) <= PASSWORD_BYTES or b"\0" in name + password:
        raise BadMessage
    return Network(name, password, protocol.answer(message, "is_access_point"))


def _broker(message: JsonMessage) -> BrokerSettings:
    tls = Tls(protocol.data(message, "trust"), protocol.number(message, "date"))
    broker = BrokerSettings(
        protocol.data(message, "address"),
        protocol.number(message, "port"),
        protocol.word(message, "group"),
        protocol.data(message, "user"),
        protocol.data(message, "password"),
        protocol.data(message, "name"),
        None if tls == NO_TLS else tls,
    )
    if not broker.is_sound:
        raise BadMessage
    return broker


def _image(message: JsonMessage) -> Image:
    start = protocol.word(message, "start")
    code, isa, later = (protocol.data(message, name) for name in ("code", "isa", "later"))
    devices, checksum = protocol.number(message, "devices"), protocol.number(message, "checksum")
    is_sound = start in STARTS[:2] and len(code) <= CODE_BYTES and len(isa) == 2
    if not is_sound or len(later) > LATER_BYTES:
        raise BadMessage
    if not 0 <= devices < 1 << 16 or not 0 <= checksum < 1 << 32:
        raise BadMessage
    return Image(start, devices, code, checksum, (isa[0], isa[1]), later)
