"""A robot as the doctor asks it: HELLO, STATUS, PING and TRIM, which change nothing in it.

Two ways: by frames on a wire, where each try is counted, and through the connection of another
tsc that has the port.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any

from tiniscript.bytecode.image import isa_for_needs
from tiniscript.link.connection import LinkConnection, PendingRequest, Requester
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, MAJOR, MINOR, encode_payload
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.payloads import HelloReply, SentReply, StatusReply
from tiniscript.link.requests import OK, Reply, reply_of
from tiniscript.link.wire import Wire

MOST_TRIES = 3
MOST_READS = 4  # of the wire in one try: what the robot tells by itself may come in between
CABLE_MS, RADIO_MS = 300, 700  # for an answer
SHARED_LIMIT_MS = 4000  # for one through another tsc, with its own retries
MOST_UNANSWERED = 3  # of these without an answer, one after another: the robot is asked no more


class Robot(ABC):
    """`missed` is how many requests were not answered at the first try. `has_shown_keys`: those of
    this computer, so that the robot has told whether it is the person's."""

    missed = 0
    has_shown_keys = False

    @abstractmethod
    def ask(self, name: str, try_count: int = MOST_TRIES) -> Reply[SentReply] | None:
        """Return the reply to HELLO, STATUS, PING or TRIM; None where none came."""

    @abstractmethod
    def pause(self, wait_ms: int) -> None: ...

    def hello(self, try_count: int = MOST_TRIES) -> Reply[SentReply] | None:
        return self.ask("HELLO", try_count)

    def status(self) -> StatusReply | None:
        reply = self.ask("STATUS")
        values = reply.values if reply is not None and reply.status == OK else None
        return values if isinstance(values, StatusReply) else None


class WireRobot(Robot):
    """The robot on a wire. `heard` are all bytes that came, `spoken` all that were sent."""

    def __init__(self, wire: Wire, nonce: int, kit: int, answer_ms: int = CABLE_MS) -> None:
        self.wire = wire
        self.answer_ms = answer_ms
        self.heard = self.spoken = b""
        self._seq = 0
        self._epoch = 0
        isa = isa_for_needs(0)
        hello = {"major": MAJOR, "minor": MINOR, "isa_major": isa[0], "isa_minor": isa[1],
                 "kit": kit, "nonce": nonce}  # fmt: skip
        # without a value the robot tells the trim that it has
        self._values: dict[str, Mapping[str, int | bytes]] = {"HELLO": hello, "TRIM": {"trim": b""}}

    def pause(self, wait_ms: int) -> None:
        self.heard += self.wire.receive(wait_ms, wait_ms)

    def ask(self, name: str, try_count: int = MOST_TRIES) -> Reply[SentReply] | None:
        """Ask until an answer comes; 0x00 goes before each try, as `docs/develop/link.md` says."""
        values = self._values.get(name, {})
        self._seq = (self._seq + 1) & 0xFF
        message = BY_NAME[name]
        frame = Frame(
            message.number, self._seq, self._epoch, encode_payload(message.request, values)
        )
        data = b"\0" + encode_frame(frame)
        for number in range(try_count):
            self.wire.send(data)
            self.spoken += data
            reply = self._answer(name, message.number)
            if reply is not None:
                return reply
            self.missed += number == 0
        return None

    def _answer(self, name: str, number: int) -> Reply[SentReply] | None:
        result = b""
        for _ in range(MOST_READS):
            new_bytes = self.wire.receive(self.answer_ms)
            if not new_bytes:
                break
            result += new_bytes
            self.heard += new_bytes
            for packet in result.split(b"\0"):
                frame = decode_frame(packet) if packet else None
                if frame and frame.is_reply and (frame.number, frame.seq) == (number, self._seq):
                    reply = reply_of(name, frame.payload)
                    if reply is not None:
                        self._epoch = frame.epoch
                        return reply
        return None


class SharedRobot(Robot):
    """The robot behind a connection, which does the retries and shows keys.

    `wait` waits for a request, if somebody is to be told that it takes long.
    """

    has_shown_keys = True

    def __init__(
        self, line: LinkConnection, wait: Callable[[PendingRequest[Any]], Reply[Any]] | None = None
    ) -> None:
        self.line = line
        self._wait = wait or line.wait
        self._unanswered = 0

    def pause(self, wait_ms: int) -> None:
        self.line.event(wait_ms / 1000)

    def ask(self, name: str, try_count: int = MOST_TRIES) -> Reply[SentReply] | None:
        def with_limit(session: Requester) -> PendingRequest[Any]:
            request: PendingRequest[Any] = getattr(session, name.lower())()
            request.limit_ms = SHARED_LIMIT_MS
            return request

        if self._unanswered < MOST_UNANSWERED:
            reply: Reply[SentReply] = self._wait(self.line.begin(with_limit))
            if reply.status not in (LOST, CANCELLED):
                self._unanswered = 0
                return reply
        self._unanswered += 1
        self.missed += 1
        return None


def values_of(reply: Reply[SentReply] | None) -> HelloReply | None:
    """Return what a robot says of itself, where its answer to HELLO is OK."""
    if reply is None or reply.status != OK:
        return None
    return reply.values if isinstance(reply.values, HelloReply) else None
