"""A program of many large frames, and a robot that answers them."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

from tests.support.link_cases import KIT
from tiniscript.bytecode.image import pack, unpack
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, LARGE_FRAME, LARGE_WINDOW, MAJOR, encode_payload
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tools.bench import large_upload

CODE = large_upload.program(1500).code
IMAGE = unpack(pack("SI", 0, CODE))
BAUD = 115_200
HELLO, DATA = (BY_NAME[name].number for name in ("HELLO", "DATA"))


class AnsweringRobot:
    """A robot as a computer sees it: describes itself in HELLO, and accepts DATA as `take_data`
    says.

    `take_data` gets the number, the offset and the bytes of each DATA that is answered. It returns
    the status and the next expected offset, or None if the frame or its answer is lost.
    """

    def __init__(
        self, take_data: Callable[[int, int, bytes], tuple[int, int] | None],
        largest: int = LARGE_FRAME, window: int = LARGE_WINDOW, baud: int = BAUD,
    ) -> None:  # fmt: skip
        self.take_data = take_data
        self.session = Session(3, baud, KIT)
        self.largest, self.window = largest, window
        self.waiting_frames: list[Frame] = []  # frames not answered yet
        self.data: list[tuple[int, int, int]] = []  # numbers, offsets, bytes of DATA that came
        self.most_waiting = self.longest_bytes = 0
        self.has_commit = False
        self.now_ms = 0

    def run(self, request: PendingRequest[Any], limit_ms: int = 25_000, late_ms: int = 30) -> int:
        """Answer the frame that came `late_ms` before; return the status of the request."""
        due: list[tuple[int, Frame]] = []
        while request.outcome is None and self.now_ms < limit_ms:
            for packet in self.session.poll(self.now_ms).split(b"\0"):
                frame = decode_frame(packet) if packet else None
                if frame is not None:
                    self.longest_bytes = max(self.longest_bytes, len(packet))
                    due.append((self.now_ms + late_ms, frame))
            self.most_waiting = max(self.most_waiting, len(due))
            while due and due[0][0] <= self.now_ms:
                self.answer(due.pop(0)[1])
            self.now_ms += 5
        assert request.outcome, "no end"
        return request.outcome.status

    def answer(self, frame: Frame) -> None:
        payload: bytes | None = bytes([OK])
        message = BY_NAME["HELLO"]
        if frame.number == HELLO:
            values = {field.name: 0 if field.kind != "rest" else b"R" for field in message.reply}
            values |= {"major": MAJOR, "isa_major": ISA_MAJOR, "isa_minor": ISA_MINOR, "kit": KIT}
            values |= {"largest": self.largest, "window": self.window, "room": 8192}
            payload = bytes([OK]) + encode_payload(message.reply, values)
        elif frame.number == BY_NAME["BEGIN"].number:
            payload = struct.pack("<BH", OK, 0)
        elif frame.number == DATA:
            (offset,) = struct.unpack("<H", frame.payload[:2])
            self.data.append((frame.seq, offset, len(frame.payload) - 2))
            progress = self.take_data(len(self.data), offset, frame.payload[2:])
            payload = None if progress is None else struct.pack("<BH", *progress)
        elif frame.number == BY_NAME["COMMIT"].number:
            self.has_commit = True
            payload = struct.pack("<BIBBB", OK, IMAGE.checksum, 1, 0, 3)
        if payload is not None:
            reply = frame._replace(payload=payload, is_reply=True)
            self.session.receive(b"\0" + encode_frame(reply), self.now_ms)


class InOrderReceiver:
    """Accepts data that begins at `next`, unless the DATA or its answer is lost."""

    def __init__(
        self, lost_numbers: tuple[int, ...] = (), unanswered_numbers: tuple[int, ...] = ()
    ) -> None:
        self.lost_numbers, self.unanswered_numbers = lost_numbers, unanswered_numbers
        self.received = b""

    def __call__(self, number: int, offset: int, data: bytes) -> tuple[int, int] | None:
        if number in self.lost_numbers:
            return None
        if offset == len(self.received):
            self.received += data
        return None if number in self.unanswered_numbers else (OK, len(self.received))
