"""A robot as the doctor asks it: HELLO, STATUS, PING and TRIM, which change nothing in it.

Two ways: by frames on a wire, where each try is counted, and through the connection of another
tsc that has the port.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any

from tiniscript.bytecode.image import MIN_ISA
from tiniscript.link.connection import LinkConnection, PendingRequest, Requester
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, MAJOR, MINOR, encode_payload
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.payloads import HelloReply, SentReply, StatusReply
from tiniscript.link.requests import OK, Reply, reply_of
from tiniscript.link.wire import Wire

MAX_TRIES = 3
MAX_READS = 4  # most reads of the wire in one try, because events may come in between
CABLE_TIMEOUT_MS, RADIO_TIMEOUT_MS = 300, 700  # time for an answer
SHARED_TIMEOUT_MS = 4000  # time for an answer through another tsc, which retries itself
MAX_UNANSWERED = 3  # unanswered questions in a row after which the check ends


class Robot(ABC):
    """`missed_count` is how many requests were not answered at the first try. `has_tried_keys`:
    those of this computer, so that the robot has reported whether it is the person's."""

    missed_count = 0
    has_tried_keys = False

    @abstractmethod
    def ask(self, name: str, try_count: int = MAX_TRIES) -> Reply[SentReply] | None:
        """Return the reply to HELLO, STATUS, PING or TRIM; None if none came."""

    @abstractmethod
    def pause(self, wait_ms: int) -> None: ...

    def hello(self, try_count: int = MAX_TRIES) -> Reply[SentReply] | None:
        return self.ask("HELLO", try_count)

    def status(self) -> StatusReply | None:
        reply = self.ask("STATUS")
        values = reply.values if reply is not None and reply.status == OK else None
        return values if isinstance(values, StatusReply) else None


class WireRobot(Robot):
    """The robot on a wire. `received` are all bytes that came, `sent` all that were sent."""

    def __init__(
        self, wire: Wire, nonce: int, kit: int, answer_timeout_ms: int = CABLE_TIMEOUT_MS
    ) -> None:
        self.wire = wire
        self.answer_timeout_ms = answer_timeout_ms
        self.received = self.sent = b""
        self._seq = 0
        self._epoch = 0
        isa = MIN_ISA
        hello = {"major": MAJOR, "minor": MINOR, "isa_major": isa[0], "isa_minor": isa[1],
                 "kit": kit, "nonce": nonce}  # fmt: skip
        # TRIM without a value returns the stored trim.
        self._values: dict[str, Mapping[str, int | bytes]] = {"HELLO": hello, "TRIM": {"trim": b""}}

    def pause(self, wait_ms: int) -> None:
        self.received += self.wire.receive(wait_ms, wait_ms)

    def ask(self, name: str, try_count: int = MAX_TRIES) -> Reply[SentReply] | None:
        """Ask until an answer arrives; each try begins with 0x00, as in `docs/develop/link.md`."""
        values = self._values.get(name, {})
        self._seq = (self._seq + 1) & 0xFF
        message = BY_NAME[name]
        frame = Frame(
            message.number, self._seq, self._epoch, encode_payload(message.request, values)
        )
        data = b"\0" + encode_frame(frame)
        for try_index in range(try_count):
            self.wire.send(data)
            self.sent += data
            reply = self._read_reply(name, message.number)
            if reply is not None:
                return reply
            self.missed_count += try_index == 0
        return None

    def _read_reply(self, name: str, number: int) -> Reply[SentReply] | None:
        buffer = b""
        for _ in range(MAX_READS):
            new_bytes = self.wire.receive(self.answer_timeout_ms)
            if not new_bytes:
                break
            buffer += new_bytes
            self.received += new_bytes
            for packet in buffer.split(b"\0"):
                frame = decode_frame(packet) if packet else None
                if frame and frame.is_reply and (frame.number, frame.seq) == (number, self._seq):
                    reply = reply_of(name, frame.payload)
                    if reply is not None:
                        self._epoch = frame.epoch
                        return reply
        return None


class SharedRobot(Robot):
    """A robot on a shared connection, which does the retries and authenticates.

    `wait` waits for a request, and may show the user that it takes long.
    """

    has_tried_keys = True

    def __init__(
        self,
        connection: LinkConnection,
        wait: Callable[[PendingRequest[Any]], Reply[Any]] | None = None,
    ) -> None:
        self.connection = connection
        self._wait = wait or connection.wait
        self._unanswered_count = 0

    def pause(self, wait_ms: int) -> None:
        self.connection.event(wait_ms / 1000)

    def ask(self, name: str, try_count: int = MAX_TRIES) -> Reply[SentReply] | None:
        def with_limit(session: Requester) -> PendingRequest[Any]:
            request: PendingRequest[Any] = getattr(session, name.lower())()
            request.limit_ms = SHARED_TIMEOUT_MS
            return request

        if self._unanswered_count < MAX_UNANSWERED:
            reply: Reply[SentReply] = self._wait(self.connection.begin(with_limit))
            if reply.status not in (LOST, CANCELLED):
                self._unanswered_count = 0
                return reply
        self._unanswered_count += 1
        self.missed_count += 1
        return None


def hello_values(reply: Reply[SentReply] | None) -> HelloReply | None:
    """Return a robot's answer to HELLO, if it is OK."""
    if reply is None or reply.status != OK:
        return None
    return reply.values if isinstance(reply.values, HelloReply) else None
