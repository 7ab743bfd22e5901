"""What a computer wants of a robot: each errand is a few requests, one after the other.

An errand is a generator: it yields a request, is sent the reply, and returns its outcome. Knows
which message follows which, and what would be refused before it is sent. Knows no frame, no time
and no retry: `session` does.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from typing import NamedTuple

from tiniscript.bytecode.image import STARTS, Image
from tiniscript.link.messages import (
    BY_NAME,
    DETACHED,
    PAYLOAD_BYTES,
    RUN,
    SAVE,
    STATUSES,
    Malformed,
    read,
)

OK = STATUSES["OK"]
SHORT_BYTES = BY_NAME["PROGRAM"].request[-1].high  # of code, in one frame
DATA_BYTES = BY_NAME["DATA"].request[-1].high
BUSY_TRIES = 200  # while the robot saves another program
KEPT_TRIES = 12  # while it has not kept what it was given,
LOW_TRIES = 4  # and while its voltage is too low for that: it looks every half second
KEPT_PAUSE_MS = 200
# What it was given it has, but not yet over the next power-on.
TAKEN = (STATUSES["SAVING"], STATUSES["LOW_SUPPLY"], STATUSES["NOT_KEPT"])
assert SHORT_BYTES == PAYLOAD_BYTES - 1


class Request(NamedTuple):
    """`pause_ms` is how long to wait before it is sent."""

    name: str
    values: Mapping[str, int | bytes] = {}
    pause_ms: int = 0


class Reply(NamedTuple):
    """`values` are there where the status is OK, a `detail` where it is not."""

    status: int
    detail: int = 0
    values: Mapping[str, int | bytes] = {}


Errand = Generator[Request, Reply, Reply]


class Robot(NamedTuple):
    """What a robot has said of itself in HELLO."""

    name: str
    id: int
    isa: tuple[int, int]
    kit: int
    room: int
    values: Mapping[str, int | bytes]


def reply_of(name: str, payload: bytes) -> Reply | None:
    """Return what a reply says, or None where it has no such payload."""
    if not payload:
        return None
    if payload[0] != OK:
        return Reply(payload[0], int.from_bytes(payload[1:3], "little"))
    try:
        return Reply(OK, 0, read(BY_NAME[name].reply, payload[1:]))
    except Malformed:
        return None


def described(values: Mapping[str, int | bytes]) -> Robot:
    """Return what HELLO's reply says."""
    name = values["name"]
    assert isinstance(name, bytes)
    isa = _number(values, "isa_major"), _number(values, "isa_minor")
    return Robot(
        name.decode("utf-8", "replace"),
        _number(values, "id"),
        isa,
        _number(values, "kit"),
        _number(values, "room"),
        values,
    )


def single(name: str, **values: int | bytes) -> Errand:
    """One request."""
    return (yield Request(name, values))


def live(code: bytes, is_latched: bool, kit: int, robot: Robot) -> Errand:
    """Run code once. Where a stop has latched the robot, this is the new run that may begin."""
    if len(code) > SHORT_BYTES:
        return Reply(STATUSES["TOO_LARGE"], SHORT_BYTES)
    if kit not in (0, robot.kit):
        return Reply(STATUSES["WRONG_KIT"], robot.kit)
    if is_latched:
        reply = yield Request("CLEAR")
        if reply.status != OK:
            return reply
    return (yield from patient(Request("LIVE", {"mode": RUN, "code": code})))


def start(is_detached: bool, is_latched: bool) -> Errand:
    """Start the program that the robot holds."""
    if is_latched:
        reply = yield Request("CLEAR")
        if reply.status != OK:
            return reply
    return (yield from patient(Request("START", {"mode": DETACHED * is_detached})))


def mode_of(image: Image, runs: bool, saves: bool, is_detached: bool) -> int:
    return STARTS.index(image.start) | RUN * runs | SAVE * saves | DETACHED * is_detached


def upload(image: Image, mode: int, robot: Robot, isa: tuple[int, int], is_latched: bool) -> Errand:
    """Bring a program to the robot: in one frame, where it fits.

    `isa` is what HELLO has said of our programs. What the robot would refuse is not sent.
    """
    if image.isa[0] != robot.isa[0] or image.isa[1] > robot.isa[1]:
        return Reply(STATUSES["OTHER_MACHINE"], robot.isa[0] << 8 | robot.isa[1])
    if image.kit not in (0, robot.kit):
        return Reply(STATUSES["WRONG_KIT"], robot.kit)
    if len(image.code) > robot.room:
        return Reply(STATUSES["TOO_LARGE"], robot.room)
    if is_latched:
        reply = yield Request("CLEAR")
        if reply.status != OK:
            return reply
    if len(image.code) <= SHORT_BYTES and image.isa == isa:
        reply = yield from patient(Request("PROGRAM", {"mode": mode, "code": image.code}))
    else:
        reply = yield from _in_pieces(image, mode)
    if reply.status == OK and reply.values["program"] != image.checksum:
        return Reply(STATUSES["INCOMPLETE"])  # the robot says it runs another program
    return reply


def _in_pieces(image: Image, mode: int) -> Errand:
    header = {
        "mode": mode,
        "isa_major": image.isa[0],
        "isa_minor": image.isa[1],
        "start": STARTS.index(image.start),
        "needs": 0,
        "kit": image.kit,
        "length": len(image.code),
    }
    reply = yield from patient(Request("BEGIN", header))
    while reply.status == OK and _number(reply.values, "next") < len(image.code):
        at = _number(reply.values, "next")
        piece = image.code[at : at + DATA_BYTES]
        reply = yield Request("DATA", {"offset": at, "code": piece})
    if reply.status != OK:
        return reply
    return (yield Request("COMMIT", {"checksum": image.checksum}))


def fetch() -> Errand:
    """Read back the image that the robot holds: the `image` of the reply."""
    image = b""
    while True:
        reply = yield from patient(Request("FETCH", {"offset": len(image)}))
        if reply.status != OK:
            return reply
        piece = reply.values["bytes"]
        assert isinstance(piece, bytes)
        image += piece
        if len(image) >= _number(reply.values, "length") or not piece:
            return Reply(OK, 0, {"image": image})


def patient(request: Request) -> Errand:
    """Ask again while the robot is busy saving."""
    reply = yield request
    for _ in range(BUSY_TRIES):
        if reply.status != STATUSES["BUSY"]:
            break
        reply = yield request._replace(pause_ms=100)
    return reply


def kept(request: Request) -> Errand:
    """Have the robot keep something, and wait a while until it says that it has.

    Where it has not, the outcome says what is in the way: a program that drives, a low voltage.
    """
    reply = yield from patient(request)
    tries = low = 0
    while reply.status in TAKEN[:2] and tries < KEPT_TRIES and low < LOW_TRIES:
        tries += 1
        reply = yield from patient(request._replace(pause_ms=KEPT_PAUSE_MS))
        low = low + 1 if reply.status == STATUSES["LOW_SUPPLY"] else 0
    return reply


def _number(values: Mapping[str, int | bytes], name: str) -> int:
    value = values[name]
    assert isinstance(value, int)
    return value
