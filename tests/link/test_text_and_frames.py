"""Everything is text until a 0x00: the data received from a sender that keeps the rule, and from
one that does not.

The properties are functions that raise. Each law holds for the computer's sender, and fails for a
sender that omits the zeros that it is about.
"""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from tests.support.large_frames import IMAGE, AnsweringRobot, InOrderReceiver
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    FIRST_EVENT,
    LARGE_FRAME,
    MESSAGES,
    SILENCE_MS,
    SMALL_FRAME,
    STOP_BYTES,
    TEXT_MS,
    payload_bytes,
)
from tiniscript.link.receiver import Receiver
from tiniscript.link.sender import Sender

SEEDS = 20
FRAMES = 300  # of a seed
PAUSES_MS = (0, 1, 5, 100, 200, 399, 400, 401, 700, 999, 1000, 1001, 1099, 1100, 1101, 5000)
LINES = (b"SI|F(1,60)", b"// OK", b"OK+LOST", b"a\xc3\xb1o = 5", b"F(2,80)", b"1", b";")
REQUESTS = [message.number for message in MESSAGES if message.number < FIRST_EVENT]
EVENTS = [message.number for message in MESSAGES if message.number >= FIRST_EVENT]


class TextSender(Sender):
    """Sends text, too, as a robot does."""

    text_ms = TEXT_MS

    def text(self, line: bytes, now_ms: int) -> bytes:
        """Return a line of text, or nothing if it has to wait for a frame."""
        if self._sent_ms is not None and now_ms - self._sent_ms < self.text_ms:
            return b""
        self._sent_ms = None  # the next frame needs a 0x00
        return line + b"\r\n"


class Line:
    """A way from a sender to a receiver, which takes a millisecond for each byte."""

    def __init__(self) -> None:
        self.receiver = Receiver()
        self.now_ms = 0

    def put(self, data: bytes) -> tuple[list[Frame | None], list[bytes]]:
        """Return the frames, None for a damaged one, and the lines that arrive."""
        frames: list[Frame | None] = []
        lines: list[bytes] = []
        for byte in data:
            self.now_ms += 1
            self.receiver.put(byte, self.now_ms)
            packet = self.receiver.take()
            if packet is None:
                continue
            if packet.is_text:
                lines.append(packet.data)
            else:
                frames.append(decode_frame(packet.data))
        return frames, lines


def random_frame(rng: random.Random) -> Frame:
    """Return a frame of a computer or of a robot, of any length."""
    is_reply, is_sealed = rng.random() < 0.5, rng.random() < 0.4
    max_bytes = payload_bytes(rng.choice((SMALL_FRAME, SMALL_FRAME, LARGE_FRAME)))
    payload = rng.randbytes(rng.randint(0, max_bytes))
    if rng.random() < 0.3:
        payload = bytes(rng.choice(b"\0\0\r\n S~") for _ in payload)
    if is_sealed:
        payload = b"\0" + payload[: max_bytes - 1]
    number = rng.choice(REQUESTS + EVENTS * is_reply)
    return Frame(number, rng.randrange(256), rng.randrange(256), payload, is_reply, is_sealed)


def check_all_arrive(sender: TextSender, rng: random.Random) -> None:
    """Frames and lines, whatever the pauses between them."""
    line = Line()
    for _ in range(FRAMES):
        line.now_ms += rng.choice(PAUSES_MS)
        if rng.random() < 0.3:
            typed_line = rng.choice(LINES)
            data = sender.text(typed_line, line.now_ms)
            assert not data or line.put(data) == ([], [typed_line])
        else:
            frame = random_frame(rng)
            data = sender.prepare_frames(encode_frame(frame), line.now_ms)
            assert line.put(data) == ([frame], [])
    assert line.receiver.damaged_count == line.receiver.dropped_count == 0


def check_torn_lines_arrive_when_repeated(sender: TextSender, rng: random.Random) -> None:
    """Check lines with a pause between any two bytes, which ends the text before it, or with lost
    bytes.
    """
    line = Line()
    for _ in range(FRAMES):
        frame = random_frame(rng)
        data = sender.prepare_frames(encode_frame(frame), line.now_ms)
        offset = rng.randrange(len(data))
        line.receiver.put(data[0], line.now_ms)  # no client looks
        for byte in data[1:offset]:
            line.now_ms += 1
            line.receiver.put(byte, line.now_ms)
        line.now_ms += rng.choice((0, 20, 150, 900, SILENCE_MS, 1500))
        for byte in data[offset:] if rng.random() < 0.5 else b"":
            line.receiver.put(byte, line.now_ms)
        line.receiver.take()
        line.now_ms += rng.choice((0, 30, 200))
        data = sender.prepare_frames(encode_frame(frame), line.now_ms, is_repeated=True)
        assert line.put(data)[0][-1:] == [frame]


def check_no_two_zeros_before_frame(sender: TextSender, rng: random.Random) -> None:
    """Check a session that sends a program over a lossy line, stops and sends HELLO."""
    lost_numbers = tuple(rng.randrange(12) for _ in range(rng.randrange(6)))
    robot = AnsweringRobot(InOrderReceiver(lost_numbers), baud=rng.choice((9600, 115_200)))
    session = robot.session
    session._sender = sender
    sent_chunks: list[bytes] = []
    poll = session.poll

    def poll_and_record(now_ms: int) -> bytes:
        data = poll(now_ms)
        sent_chunks.append(data)
        return data

    session.poll = poll_and_record  # type: ignore[method-assign]
    robot.run(session.upload(IMAGE))
    robot.now_ms += rng.choice((0, 300, 500))
    session.stop(robot.now_ms)
    for _ in range(rng.randrange(1, 20)):
        session.poll(robot.now_ms)
        robot.now_ms += 10
    session._stop.end()
    session.is_attached = False
    request = session.hello()
    robot.run(request, robot.now_ms + 3000)
    assert any(data == bytes(STOP_BYTES) for data in sent_chunks)
    sent_before = b""
    for data in sent_chunks:
        zeros = len(data) - len(data.lstrip(b"\0"))
        assert zeros <= 1 or data == bytes(STOP_BYTES), data.hex()
        assert b"\0\0" not in data.strip(b"\0"), data.hex()
        if data and data != bytes(STOP_BYTES):
            is_begun = sent_before[-1:] == b"\0"
            assert zeros or is_begun, "the first frame has no 0x00 before it"
        sent_before = data or sent_before


Property = Callable[[TextSender, random.Random], None]


@pytest.mark.parametrize("seed", range(SEEDS))
@pytest.mark.parametrize("law", [
    check_all_arrive, check_torn_lines_arrive_when_repeated, check_no_two_zeros_before_frame
])  # fmt: skip
def test_a_sender_that_keeps_the_rule_is_accepted(law: Property, seed: int) -> None:
    law(TextSender(), random.Random(seed))


class LateZeroSender(TextSender):
    """A sender that sends a 0x00 only if the receiver already treats the bytes as text."""

    def prepare_frames(self, frames: bytes, now_ms: int, is_repeated: bool = False) -> bytes:
        if self._sent_ms is not None and not is_repeated:
            self._sent_ms = max(self._sent_ms, now_ms - 399) if now_ms < self._sent_ms + 3000 else 0
        return super().prepare_frames(frames, now_ms, is_repeated)


class NoFirstZeroSender(TextSender):
    """Sends no zero before the first frame, and none after text."""

    def prepare_frames(self, frames: bytes, now_ms: int, is_repeated: bool = False) -> bytes:
        self._sent_ms = now_ms if self._sent_ms is None else self._sent_ms
        return super().prepare_frames(frames, now_ms, is_repeated)


class NoRepeatedZeroSender(TextSender):
    """Sends no zero before a repeated frame."""

    def prepare_frames(self, frames: bytes, now_ms: int, is_repeated: bool = False) -> bytes:
        return super().prepare_frames(frames, now_ms, False)


class TwiceSender(TextSender):
    """Sends one for each reason."""

    def prepare_frames(self, frames: bytes, now_ms: int, is_repeated: bool = False) -> bytes:
        return b"\0" * is_repeated + super().prepare_frames(frames, now_ms, False)


class HastySender(TextSender):
    """Sends text right after a frame."""

    text_ms = 100


@pytest.mark.parametrize(("law", "sender"), [
    (check_all_arrive, LateZeroSender), (check_all_arrive, NoFirstZeroSender),
    (check_all_arrive, HastySender),
    (check_torn_lines_arrive_when_repeated, NoRepeatedZeroSender),
    (check_no_two_zeros_before_frame, TwiceSender),
])  # fmt: skip
def test_a_sender_that_breaks_the_rule_is_noticed(law: Property, sender: type[TextSender]) -> None:
    def violates_law(seed: int) -> bool:
        try:
            law(sender(), random.Random(seed))
        except AssertionError:
            return True
        return False

    assert any(map(violates_law, range(SEEDS)))


def test_heartbeats_need_no_zero_and_the_rule_covers_sent_bytes() -> None:
    sender = Sender()
    assert sender.prepare_frames(b"a\0", 0) == b"\0a\0"  # no byte was sent before
    for now_ms in range(200, 2000, 200):
        assert sender.prepare_frames(b"a\0", now_ms) == b"a\0"
    assert sender.prepare_frames(b"a\0", 2199) == b"a\0"
    assert sender.prepare_frames(b"a\0", 2599) == b"\0a\0"
    assert sender.prepare_frames(b"a\0", 2600, is_repeated=True) == b"\0a\0"
    assert (
        sender.prepare_frames(b"a\0", 3000, is_repeated=True) == b"\0a\0"
    )  # two reasons, one 0x00
    assert sender.prepare_stop(bytes(8), 3001) == bytes(8)
    assert sender.prepare_frames(b"a\0", 3400, is_repeated=True) == b"a\0"  # one was sent last
    assert sender.prepare_stop(bytes(8), 3401) == bytes(8)
    assert sender.prepare_frames(b"a\0", 3801) == b"\0a\0"
