"""The interface of a connection to a robot, as commands use it.

Two classes implement it: a `Line` of this process, and a `Client` of another process's line. A
command works with either.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

from tiniscript.bytecode.image import Image
from tiniscript.link.outcomes import Event
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
from tiniscript.link.reasons import Heard
from tiniscript.link.requests import FetchedImage, Reply
from tiniscript.link.wifi import BrokerSettings, Network

DEADLINE_MS = 20_000  # of a request, unless another is given
T = TypeVar("T")


class PendingRequest(Generic[T]):
    """A request in progress: `outcome` is set when it is over.

    `limit_ms` is its timeout, from its first frame on; `done_bytes` of a program have arrived;
    `starts`: a program runs when the request is done.
    """

    def __init__(self, limit_ms: int = DEADLINE_MS, starts: bool = False) -> None:
        self.limit_ms = limit_ms
        self.starts = starts
        self.done_bytes = 0
        self.outcome: Reply[T] | None = None


class Requester(Protocol):
    """The requests that can be made; `link.session` carries them out."""

    def hello(self) -> PendingRequest[HelloReply]: ...

    def ping(self) -> PendingRequest[PingReply]: ...

    def status(self) -> PendingRequest[StatusReply]: ...

    def clear(self) -> PendingRequest[EmptyReply]: ...

    def start(self, is_detached: bool = False) -> PendingRequest[ReceiptReply]: ...

    def live(self, code: bytes, kit: int = 0) -> PendingRequest[ReceiptReply]: ...

    def upload(
        self, image: Image, runs: bool = True, saves: bool = True, is_detached: bool = False,
        kit: int | None = None,
    ) -> PendingRequest[ReceiptReply]: ...  # fmt: skip

    def undo(self) -> PendingRequest[ReceiptReply]: ...

    def name(self, name: bytes) -> PendingRequest[EmptyReply]: ...

    def trim(self, trim: bytes = b"") -> PendingRequest[TrimReply]: ...

    def fetch(self) -> PendingRequest[FetchedImage]: ...

    def identify(self) -> PendingRequest[EmptyReply]: ...

    def claim(self, which: int) -> PendingRequest[EmptyReply]: ...

    def disown(self, which: int) -> PendingRequest[EmptyReply]: ...

    def hold_back(self) -> PendingRequest[EmptyReply]: ...

    def allow_text(self, is_allowed: bool) -> PendingRequest[TextReply]: ...

    def wifi(self) -> PendingRequest[WifiReply]: ...

    def join(self, network: Network) -> PendingRequest[WifiReply]: ...

    def forget_wifi(self) -> PendingRequest[WifiReply]: ...

    def broker(self) -> PendingRequest[WifiReply]: ...

    def use_broker(self, broker: BrokerSettings | None) -> PendingRequest[WifiReply]: ...


class LinkConnection(Heard, Protocol):
    """A connection to a robot. All methods but `close` and `stop` raise Gone once it has ended.

    `held_by` is the verb of the command that holds the port, if that is another command;
    `has_ended`: the connection is gone; `boot` is another number after each reset of the robot.
    """

    @property
    def held_by(self) -> str: ...

    @property
    def has_ended(self) -> bool: ...

    @property
    def boot(self) -> int: ...

    def do(self, make: Callable[[Requester], PendingRequest[T]]) -> PendingRequest[T]:
        """Start a request; return while it is in progress."""
        ...

    def wait(self, request: PendingRequest[T], look: Callable[[], None] | None = None) -> Reply[T]:
        """Wait for the outcome of a request, and call `look` periodically."""
        ...

    def event(self, limit_s: float = ...) -> tuple[int, Event] | None:
        """Return the next event and its arrival time (ms), or None after the time limit."""
        ...

    def tell_places(self) -> None:
        """Have PLACE events come from now on, from a robot that tells where its program is."""
        ...

    def stop(self) -> int:
        """Stop the robot; return the time (ms). A later event STOPPED follows when the robot has
        confirmed."""
        ...

    def close(self) -> None: ...
