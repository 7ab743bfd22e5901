"""The interface of a connection to a robot, as commands use it; the requests on it.

A `PortConnection` of this process has it, and a `SharedConnection` of another process: a command
works with either.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Generic, TypeVar

from tiniscript.bytecode.image import Image
from tiniscript.link.outcomes import (
    CANCELLED,
    DETAIL_MIDWAY,
    LOST,
    OTHER_ROBOT,
    POLL_INTERVAL_S,
    UNPROVEN,
    Event,
)
from tiniscript.link.payloads import (
    EmptyReply,
    HelloReply,
    PingReply,
    ReadTasksReply,
    ReadVariablesReply,
    ReceiptReply,
    ResumeReply,
    StatusReply,
    TextReply,
    TrimReply,
    WifiReply,
)
from tiniscript.link.requests import DeviceInfo, FetchedImage, Reply
from tiniscript.link.wifi import BrokerSettings, Network

if TYPE_CHECKING:
    from tiniscript.link.foreign import ForeignBoard

STATUS = "status"  # the robot's status contains the reason


FOREIGN = "link_foreign"  # `find_stranger` identifies the other device
EXCHANGE_TIMEOUT_MS = 20_000  # default timeout of a request
MAX_EARLY_BYTES = 2048  # most bytes that are kept before a robot answers
CLAIM_TIMEOUT_MS = 30_000  # the time for which the robot waits for a hand on its button
T = TypeVar("T")


class PendingRequest(Generic[T]):
    """A request in progress: `outcome` is set when it is over.

    `limit_ms` is its timeout, from its first frame on, and anew from each progress unless
    `is_limit_total`; `done_bytes` of a program have arrived; `starts_program`: a program runs when
    the request is done.
    """

    limit_ms = EXCHANGE_TIMEOUT_MS
    is_limit_total = False
    starts_program = False
    done_bytes = 0
    outcome: Reply[T] | None = None


class Requester:
    """The requests that can be made of a robot. A session carries them out, and a client of a
    shared port has its server make them: both have `_ask` alone of their own."""

    def _ask(
        self, name: str, reply_type: type[T], starts_program: bool = False, /, **arguments: object
    ) -> PendingRequest[T]:
        """Make the request of this name; its reply has the type `reply_type`."""
        raise NotImplementedError

    def hello(self) -> PendingRequest[HelloReply]:
        return self._ask("hello", HelloReply)

    def ping(self) -> PendingRequest[PingReply]:
        return self._ask("ping", PingReply)

    def status(self) -> PendingRequest[StatusReply]:
        return self._ask("status", StatusReply)

    def clear(self) -> PendingRequest[EmptyReply]:
        return self._ask("clear", EmptyReply)

    def start(self, is_detached: bool = False) -> PendingRequest[ReceiptReply]:
        return self._ask("start", ReceiptReply, True, is_detached=is_detached)

    def live(self, code: bytes, kit: int = 0, halts: bool = False) -> PendingRequest[ReceiptReply]:
        """`kit` is the kit whose words the code uses, or 0 for none; with `halts`, it halts before
        its first statement."""
        return self._ask("live", ReceiptReply, True, code=code, kit=kit, halts=halts)

    def upload(
        self, image: Image, runs: bool = True, saves: bool = True, is_detached: bool = False,
        kit: int | None = None,
    ) -> PendingRequest[ReceiptReply]:  # fmt: skip
        """`kit` is the kit that the image was verified for; None means the session's kit."""
        options = {"runs": runs, "saves": saves, "is_detached": is_detached, "kit": kit}
        starts_program = runs and image.start == "SI"
        return self._ask("upload", ReceiptReply, starts_program, image=image, **options)

    def undo(self) -> PendingRequest[ReceiptReply]:
        """Restore the robot's previous program; a running program ends."""
        return self._ask("undo", ReceiptReply)

    def name(self, name: bytes) -> PendingRequest[EmptyReply]:
        return self._ask("name", EmptyReply, name=name)

    def trim(self, trim: bytes = b"") -> PendingRequest[TrimReply]:
        """Set the trim of the motors, or only read it if `trim` is empty."""
        return self._ask("trim", TrimReply, trim=trim)

    def fetch(self) -> PendingRequest[FetchedImage]:
        return self._ask("fetch", FetchedImage)

    def press(
        self, keys: int = 0, x: int = 0, y: int = 0, speaker: int = 0
    ) -> PendingRequest[EmptyReply]:
        """Hold these keys of a remote control (a bit for each of REMOTE_KEYS) and its pad in this
        position, and no others. A client that is silent for half a second holds no keys, so repeat
        this before then.
        """
        return self._ask("press", EmptyReply, keys=keys, x=x, y=y, speaker=speaker)

    def break_at(self, places: Sequence[int]) -> PendingRequest[EmptyReply]:
        """Set breakpoints at these offsets of the running program, or of the stored one,
        MAX_BREAKPOINTS at most; an empty list removes them.
        """
        packed_bytes = b"".join(place.to_bytes(2, "little") for place in places)
        return self._ask("break_at", EmptyReply, places=packed_bytes)

    def resume(self, extent: int) -> PendingRequest[ResumeReply]:
        """Resume a halted program: `extent` is one of RESUMES."""
        return self._ask("resume", ResumeReply, how=extent)

    def read_variables(self, first: int = 0) -> PendingRequest[ReadVariablesReply]:
        """Ask for the variables of the running program, from this number on: as many as fit into a
        frame."""
        return self._ask("read_variables", ReadVariablesReply, first=first)

    def read_tasks(self) -> PendingRequest[ReadTasksReply]:
        """Ask for the positions of the running program's tasks."""
        return self._ask("read_tasks", ReadTasksReply)

    def tell_readings(self, is_on: bool) -> PendingRequest[EmptyReply]:
        """Turn READING events for changed readings on or off, in this session."""
        return self._ask("tell_readings", EmptyReply, is_on=is_on)

    def identify(self) -> PendingRequest[EmptyReply]:
        return self._ask("identify", EmptyReply)

    def claim(self, kind: int) -> PendingRequest[EmptyReply]:
        """Claim the robot: `kind` is one of KEYS. Waits until its button is held down.

        The process with the session makes the key and keeps it: no message between commands has
        one.
        """
        pending_request = self._ask("claim", EmptyReply, kind=kind)
        pending_request.limit_ms, pending_request.is_limit_total = CLAIM_TIMEOUT_MS, True
        return pending_request

    def disown(self, kind: int) -> PendingRequest[EmptyReply]:
        return self._ask("disown", EmptyReply, kind=kind)

    def hold_back(self) -> PendingRequest[EmptyReply]:
        return self._ask("hold_back", EmptyReply)

    def allow_text(self, is_allowed: bool) -> PendingRequest[TextReply]:
        return self._ask("allow_text", TextReply, is_allowed=is_allowed)

    def wifi(self) -> PendingRequest[WifiReply]:
        """Ask for the robot's WiFi settings."""
        return self._ask("wifi", WifiReply)

    def join(self, network: Network) -> PendingRequest[WifiReply]:
        """Join a network, or serve as its access point, now and after each reset.

        The password goes to another process of this user at most, and into no file.
        """
        return self._ask("join", WifiReply, network=network)

    def forget_wifi(self) -> PendingRequest[WifiReply]:
        return self._ask("forget_wifi", WifiReply)

    def broker(self) -> PendingRequest[WifiReply]:
        """Ask which MQTT broker the robot uses."""
        return self._ask("broker", WifiReply)

    def use_broker(self, broker: BrokerSettings | None) -> PendingRequest[WifiReply]:
        """Use a broker, or none, now and after each reset."""
        return self._ask("use_broker", WifiReply, broker=broker)


class LinkConnection:
    """A connection to a robot. All but `close` and `stop` raise ConnectionLost once it has ended.

    `holder_verb` is that of the command that holds the port, if that is another command.
    `heard_count` counts received bytes, `early_bytes` are the last of those that came before a
    robot has answered; `is_echoed`: the line echoes what is sent.
    """

    holder_verb = ""
    heard_count = 0
    early_bytes = b""
    is_echoed = False

    def note_heard(self, data: bytes) -> None:
        """Count received bytes, and keep them while no robot has answered."""
        self.heard_count += len(data)
        if data and self.robot is None:
            self.early_bytes = (self.early_bytes + data)[-MAX_EARLY_BYTES:]

    @property
    def robot(self) -> DeviceInfo | None:
        """The robot's description of itself, once it has answered."""
        raise NotImplementedError

    @property
    def boot(self) -> int:
        """A number of the robot that is another one after each of its resets."""
        return self.robot.values.nonce if self.robot else 0

    @property
    def has_ended(self) -> bool:
        """Whether the connection is gone."""
        return False

    def begin(self, make_request: Callable[[Requester], PendingRequest[T]]) -> PendingRequest[T]:
        """Start a request; return while it is in progress."""
        raise NotImplementedError

    def wait(self, request: PendingRequest[T], look: Callable[[], None] | None = None) -> Reply[T]:
        """Wait for the outcome of a request, and call `look` periodically."""
        raise NotImplementedError

    def event(self, timeout_s: float = POLL_INTERVAL_S) -> tuple[int, Event] | None:
        """Return the next event and its arrival time (ms), or None after the time limit."""
        raise NotImplementedError

    def enable_place_events(self) -> None:
        """Turn on PLACE events from robots that report their program's place."""
        raise NotImplementedError

    def stop(self) -> int:
        """Stop the robot; return the time (ms). A later event STOPPED follows when the robot has
        confirmed."""
        raise NotImplementedError

    def close(self) -> None: ...


def reason_of(connection: LinkConnection, reply: Reply[object]) -> str:
    """Return the reason why a reply is not OK."""
    if reply.status == CANCELLED:
        return "stopped_midway" if reply.detail == DETAIL_MIDWAY else "stopped_elsewhere"
    if reply.status == UNPROVEN:
        return "unproven"
    if reply.status == OTHER_ROBOT:
        return "other_robot"
    if reply.status != LOST:
        return STATUS
    if connection.robot is not None:
        return "link_lost"
    board = find_stranger(connection)
    if board is not None and board.has_row:
        return FOREIGN
    if connection.is_echoed:
        return "link_echo"
    if board is not None and board.is_sure:
        return FOREIGN
    return "link_other" if connection.heard_count else "link_silent"


def find_stranger(connection: LinkConnection) -> ForeignBoard | None:
    """Return the foreign device that answers instead of a robot, as far as its bytes identify
    it.
    """
    if connection.robot is not None or not connection.early_bytes:
        return None
    from tiniscript.link import foreign

    return foreign.identify_stranger(connection.early_bytes)
