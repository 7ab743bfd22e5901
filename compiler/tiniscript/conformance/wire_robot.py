"""A robot on a wire, asked frame by frame: also with frames that a session would never send.

Knows frames, retries and the heartbeat. It does not know what an answer should be.
"""

from __future__ import annotations

from collections.abc import Mapping
from time import monotonic
from typing import NamedTuple

from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    FIRST_EVENT,
    MAJOR,
    MINOR,
    STATUSES,
    Malformed,
    decode_payload,
    encode_payload,
)
from tiniscript.link.wire import Wire

MAX_TRIES = 6
HEARTBEAT_INTERVAL_S = 0.2
POLL_INTERVAL_MS = 20
HELLO_TRIES = 8  # HELLOs: a board may have been reset, or be in its bootloader


class Silent(Exception):
    """The robot does not answer. `message` is the one that it was sent."""

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.message = message


class Answer(NamedTuple):
    """`values` are those of the reply if the status is OK, and empty otherwise."""

    status: int
    detail: int
    values: Mapping[str, int | bytes]
    payload: bytes

    def number(self, name: str) -> int:
        """Return a field; -1 where the answer is not OK."""
        return _number(self.values, name)


class Event(NamedTuple):
    name: str
    values: Mapping[str, int | bytes]

    def number(self, name: str) -> int:
        return _number(self.values, name)


def _number(values: Mapping[str, int | bytes], name: str) -> int:
    value = values.get(name)
    return value if isinstance(value, int) else -1


class WireRobot:
    """`answer_timeout_ms` is how long one try waits. Methods raise Silent, and OSError without a
    port."""

    def __init__(self, wire: Wire, nonce: int, answer_timeout_ms: int) -> None:
        self.wire = wire
        self.nonce = nonce
        self.answer_timeout_ms = answer_timeout_ms
        self.epoch = 0
        self.events: list[Event] = []
        self._seq = 0
        self._unread = b""
        self._heartbeat_s = 0.0

    def hello(self, try_count: int = MAX_TRIES) -> Answer:
        values = {"major": MAJOR, "minor": MINOR, "isa_major": ISA_MAJOR,
                  "isa_minor": ISA_MINOR, "kit": 0, "nonce": self.nonce}  # fmt: skip
        return self.ask("HELLO", values, try_count)

    def ask(
        self,
        name: str,
        values: Mapping[str, int | bytes] | None = None,
        try_count: int = MAX_TRIES,
    ) -> Answer:
        """Return the answer to a request with a new number; send it again if none arrives."""
        message = BY_NAME[name]
        payload = encode_payload(message.request, values or {})
        return self.ask_frame(message.number, payload, try_count, message=name)

    def ask_frame(
        self, number: int, payload: bytes, try_count: int = MAX_TRIES, message: str = "",
        epoch: int | None = None,
    ) -> Answer:  # fmt: skip
        """Send any message as a frame and return its reply; `epoch` replaces the robot's."""
        self._seq = (self._seq + 1) & 0xFF
        return self.repeat(number, payload, try_count, message, epoch)

    def repeat(
        self, number: int, payload: bytes, try_count: int = MAX_TRIES, message: str = "",
        epoch: int | None = None,
    ) -> Answer:  # fmt: skip
        """Send a request with the number of the previous one."""
        frame = Frame(number, self._seq, self.epoch if epoch is None else epoch, payload)
        for _ in range(try_count):
            self.send(b"\0" + encode_frame(frame))
            end_s = monotonic() + self.answer_timeout_ms / 1000
            while monotonic() < end_s:
                for reply in self._replies():
                    if (reply.number, reply.seq) == (number, self._seq) and reply.payload:
                        return _answer(number, reply.payload)
        raise Silent(message or str(number))

    def send(self, data: bytes) -> None:
        self._heartbeat_s = monotonic()
        self.wire.send(data)

    def wait(self, seconds: float, name: str = "", sends_heartbeats: bool = True) -> Event | None:
        """Return the first event of this name; `sends_heartbeats`: it hears PINGs."""
        end_s = monotonic() + seconds
        while True:
            for event in self.events:
                if event.name == name:
                    return event
            if monotonic() >= end_s:
                return None
            if sends_heartbeats and monotonic() - self._heartbeat_s > HEARTBEAT_INTERVAL_S:
                self.ask("PING")
            else:
                self._replies()

    def receive(self, seconds: float) -> list[Frame]:
        """Return the replies of so long a time."""
        end_s = monotonic() + seconds
        frames: list[Frame] = []
        while monotonic() < end_s:
            frames += self._replies()
        return frames

    def _replies(self) -> list[Frame]:
        """Process the received frames: keep events and the epoch, and return the replies."""
        *packets, self._unread = (self._unread + self.wire.receive(POLL_INTERVAL_MS, 1)).split(
            b"\0"
        )
        self._unread = self._unread[-1024:]
        frames = [frame for frame in map(decode_frame, filter(None, packets)) if frame]
        replies = []
        for frame in frames:
            if not frame.is_reply:
                continue  # an echo of ours
            self.epoch = frame.epoch
            if frame.number >= FIRST_EVENT:
                self._add_event(frame)
            else:
                replies.append(frame)
        return replies

    def _add_event(self, frame: Frame) -> None:
        message = BY_NUMBER.get(frame.number)
        if message is not None:
            try:
                self.events.append(
                    Event(message.name, decode_payload(message.reply, frame.payload))
                )
            except Malformed:
                self.events.append(Event(f"{message.name} with other fields", {}))


def _answer(number: int, payload: bytes) -> Answer:
    status, rest = payload[0], payload[1:]
    if status != STATUSES["OK"]:
        return Answer(status, int.from_bytes(rest[:2], "little"), {}, payload)
    try:
        values = decode_payload(BY_NUMBER[number].reply, rest)
    except (KeyError, Malformed):
        return Answer(-1, 0, {}, payload)
    return Answer(status, 0, values, payload)
