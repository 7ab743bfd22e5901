"""The exchanges with a robot: each is a sequence of a few requests.

An exchange is a generator: it yields a request, is sent the reply, and returns its outcome. It
knows the order of messages, and does not send requests that the robot would refuse. Knows no frame,
no time and no retry: `session` does.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from tiniscript.base.source import printable
from tiniscript.bytecode.image import HEADER_BYTES, STARTS, Image
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.bytecode.verify import RULES
from tiniscript.link.messages import (
    BY_NAME,
    DETACHED,
    HALTS,
    LARGE_FRAME,
    OWNED,
    PAYLOAD_BYTES,
    RUN,
    SAVE,
    SAVED_NOTHING,
    SAVED_OTHER_VERSION,
    SEALS,
    SMALL_FRAME,
    STATUSES,
    YOURS,
    Malformed,
    decode_payload,
    payload_bytes,
)
from tiniscript.link.payloads import (
    REPLIES,
    EmptyReply,
    FetchReply,
    HelloReply,
    NextReply,
    ReceiptReply,
    SentReply,
)

if TYPE_CHECKING:
    from tiniscript.link.seal import Seal

OK = STATUSES["OK"]
# Bytes before the code in LIVE and PROGRAM, and before the data in DATA.
MODE_BYTES, OFFSET_BYTES = 1, 2
SHORT_BYTES = PAYLOAD_BYTES - MODE_BYTES  # bytes of code that fit in one frame of any robot
BUSY_TRIES = 200  # tries while the robot saves another program
KEPT_TRIES = 12  # tries while it has not written its data to EEPROM
LOW_TRIES = 4  # tries while its voltage is too low for that; it checks every half second
KEPT_PAUSE_MS = 200
EMPTY_STATES = (SAVED_NOTHING, SAVED_OTHER_VERSION)  # the robot holds no program
# The robot has the data, but would lose it at the next power-on.
ACCEPTING_STATUSES = (STATUSES["SAVING"], STATUSES["LOW_SUPPLY"], STATUSES["NOT_KEPT"])


class Pieces(NamedTuple):
    """A transfer: `data` in pieces of `piece_bytes`, `window` of them at once."""

    data: bytes
    piece_bytes: int
    window: int


class Request(NamedTuple):
    """`pause_ms` is the wait before it is sent; `seal` the seal of its reply.

    With `pieces`, it represents many DATA, and its reply is the last of theirs.
    """

    name: str
    values: Mapping[str, int | bytes] = {}
    pause_ms: int = 0
    seal: Seal | None = None
    pieces: Pieces | None = None


T_co = TypeVar("T_co", covariant=True)
T = TypeVar("T")


class Reply(Generic[T_co]):
    """The outcome of a request: a status of the robot, or one that the session produces.

    With the status OK, it has `values`, with any other one a `detail`.
    """

    def __init__(self, status: int, detail: int = 0, values: T_co | None = None) -> None:
        self.status = status
        self.detail = detail
        self._values = values

    def __repr__(self) -> str:
        return f"Reply({self.status}, {self.detail}, {self._values})"

    @property
    def values(self) -> T_co:
        """The values of a reply whose status is OK."""
        assert self._values is not None, self
        return self._values


# Yields requests, is sent the reply to each, and returns the outcome.
Exchange = Generator["Request", Reply[SentReply], Reply[T]]


class DeviceInfo(NamedTuple):
    """A robot's description of itself, from its reply to HELLO."""

    name: str
    id: int
    isa: tuple[int, int]
    kit: int
    room: int
    values: HelloReply


class FetchedImage(NamedTuple):
    """The image of the program that the robot holds."""

    image: bytes


def reply_of(name: str, payload: bytes) -> Reply[SentReply] | None:
    """Return the reply to message `name`, or None if its payload does not fit."""
    if not payload:
        return None
    if payload[0] != OK:
        return Reply(payload[0], int.from_bytes(payload[1:3], "little"))
    try:
        values: Mapping[str, Any] = decode_payload(BY_NAME[name].reply, payload[1:])
    except Malformed:
        return None
    if values.get("saved") in EMPTY_STATES and "length" in values:  # the program has been replaced
        values = {**values, "program": 0, "length": 0}
    return Reply(OK, 0, REPLIES[name](**values))


def device_info_of(values: HelloReply) -> DeviceInfo:
    """Return the device info in the reply to HELLO. Its name has no control characters."""
    name = printable(values.name.decode("utf-8", "replace"))
    isa = values.isa_major, values.isa_minor
    return DeviceInfo(name, values.id, isa, values.kit, values.room, values)


def as_refusal(reply: Reply[object]) -> Reply[Any]:
    """Return a reply that is not OK as the outcome of a whole exchange."""
    assert reply.status != OK
    return Reply(reply.status, reply.detail)


def send_single(request: Request, reply_type: type[T]) -> Exchange[T]:
    """Send one request; its reply has this type."""
    reply = yield request
    if reply.status != OK:
        return as_refusal(reply)
    values = reply.values
    assert isinstance(values, reply_type), (request, values)
    return Reply(OK, 0, values)


def _payload_bytes(robot: DeviceInfo) -> int:
    """Return the longest payload, which is shorter for sealed frames or before a key is used."""
    features = robot.values.features
    is_sealed = bool(features & SEALS and features & (OWNED | YOURS))
    # The largest frame that both ends accept.
    frame_bytes = min(max(robot.values.largest, SMALL_FRAME), LARGE_FRAME)
    return payload_bytes(frame_bytes, is_sealed)


def short_bytes(robot: DeviceInfo) -> int:
    """Return the most bytes of code that a frame to this robot has."""
    return _payload_bytes(robot) - MODE_BYTES


def live(
    code: bytes, is_latched: bool, kit: int, robot: DeviceInfo, halts: bool
) -> Exchange[ReceiptReply]:
    """Run code once, or let it halt before its first statement. If a stop has latched the robot,
    the latch is released for this run."""
    if len(code) > short_bytes(robot):
        return Reply(STATUSES["TOO_LARGE"], short_bytes(robot))
    if kit not in (0, robot.kit):
        return Reply(STATUSES["WRONG_KIT"], robot.kit)
    request = Request("LIVE", {"mode": RUN | HALTS * halts, "code": code})
    reply = yield from _clear_then(is_latched, retry_while_busy(request, ReceiptReply))
    is_older = robot.isa < (ISA_MAJOR, ISA_MINOR)
    if is_older and reply.status == RULES["UNKNOWN_OPCODE"][0]:  # LIVE names no version
        return _other_machine_reply(robot)
    return reply


def _other_machine_reply(robot: DeviceInfo) -> Reply[Any]:
    return Reply(STATUSES["OTHER_MACHINE"], robot.isa[0] << 8 | robot.isa[1])


def clear() -> Exchange[EmptyReply]:
    """Release the latch."""
    return send_single(Request("CLEAR"), EmptyReply)


def start(is_detached: bool, is_latched: bool) -> Exchange[ReceiptReply]:
    """Start the program that the robot holds."""
    request = Request("START", {"mode": DETACHED * is_detached})
    return _clear_then(is_latched, retry_while_busy(request, ReceiptReply))


def _clear_then(is_latched: bool, exchange: Exchange[T]) -> Exchange[T]:
    """Release the latch, if a stop has set it, before an exchange."""
    if is_latched:
        clear_reply = yield from clear()
        if clear_reply.status != OK:
            return as_refusal(clear_reply)
    return (yield from exchange)


def mode_of(image: Image, runs: bool, saves: bool, is_detached: bool) -> int:
    return STARTS.index(image.start) | RUN * runs | SAVE * saves | DETACHED * is_detached


def upload(
    image: Image, mode: int, robot: DeviceInfo, isa: tuple[int, int], is_latched: bool, kit: int
) -> Exchange[ReceiptReply]:
    """Upload a program to the robot: in one frame, if it fits into one that any robot takes.

    A longer frame hardly gets through a line that loses a byte now and then; pieces become smaller
    there. `isa` is the one that HELLO has announced for our programs. A single frame does not name
    the devices: an image that uses some, and is for another `kit` than the robot's, is sent with
    its header. A program that the robot would refuse is not sent.
    """
    is_its_kit = kit == robot.kit or not image.devices
    if image.isa[0] != robot.isa[0] or image.isa[1] > robot.isa[1]:
        return _other_machine_reply(robot)
    if len(image.later_fields) + len(image.code) > robot.room:
        return Reply(STATUSES["TOO_LARGE"], robot.room)
    room = min(short_bytes(robot), SHORT_BYTES)
    is_short = len(image.code) <= room and image.isa == isa and not image.later_fields
    if is_short and is_its_kit:
        request = Request("PROGRAM", {"mode": mode, "code": image.code})
        reply = yield from _clear_then(is_latched, retry_while_busy(request, ReceiptReply))
    else:
        reply = yield from _clear_then(is_latched, _upload_in_pieces(image, mode, robot))
        if not is_its_kit and reply.status == RULES["NO_SUCH_DEVICE"][0]:
            return Reply(STATUSES["WRONG_KIT"], robot.kit)
    if reply.status == OK and reply.values.program != image.checksum:
        return Reply(STATUSES["INCOMPLETE"])  # the robot reports that it runs another program
    return reply


def _upload_in_pieces(image: Image, mode: int, robot: DeviceInfo) -> Exchange[ReceiptReply]:
    piece_bytes = _payload_bytes(robot) - OFFSET_BYTES
    header = {
        "mode": mode,
        "isa_major": image.isa[0],
        "isa_minor": image.isa[1],
        "start": STARTS.index(image.start),
        "header_length": HEADER_BYTES + len(image.later_fields),
        "devices": image.devices,
        "code_length": len(image.code),
    }
    reply = yield from retry_while_busy(Request("BEGIN", header), NextReply)
    data = bytes([image.needs]) + image.later_fields + image.code  # the bytes after the checksum
    if reply.status == OK:
        pieces = Pieces(data, piece_bytes, robot.values.window)
        reply = yield from send_single(Request("DATA", pieces=pieces), NextReply)
    if reply.status != OK:
        return as_refusal(reply)
    return (yield from send_single(Request("COMMIT", {"checksum": image.checksum}), ReceiptReply))


def fetch() -> Exchange[FetchedImage]:
    """Read back the image that the robot holds."""
    image = b""
    while True:
        reply = yield from retry_while_busy(Request("FETCH", {"offset": len(image)}), FetchReply)
        if reply.status != OK:
            return as_refusal(reply)
        piece = reply.values.bytes
        image += piece
        if len(image) >= reply.values.length or not piece:
            return Reply(OK, 0, FetchedImage(image))


def retry_while_busy(request: Request, reply_type: type[T]) -> Exchange[T]:
    """Repeat a request while the robot is busy saving."""
    reply = yield from send_single(request, reply_type)
    for _ in range(BUSY_TRIES):
        if reply.status != STATUSES["BUSY"]:
            break
        reply = yield from send_single(request._replace(pause_ms=100), reply_type)
    return reply


def save_and_confirm(request: Request, reply_type: type[T]) -> Exchange[T]:
    """Save data on the robot, repeating the request until it confirms or the tries are over.

    If it has not saved, the outcome gives the reason: a program that drives, a low voltage.
    """
    reply = yield from retry_while_busy(request, reply_type)
    tries = low_tries = 0
    while reply.status in ACCEPTING_STATUSES[:2] and tries < KEPT_TRIES and low_tries < LOW_TRIES:
        tries += 1
        reply = yield from retry_while_busy(request._replace(pause_ms=KEPT_PAUSE_MS), reply_type)
        low_tries = low_tries + 1 if reply.status == STATUSES["LOW_SUPPLY"] else 0
    return reply
