"""Devices at the other end of a port in simulated time, for the doctor.

The firmware here answers only HELLO, STATUS and PING, as the test wants; the real firmware is in
`tests/support/pty_robot.py`.
"""

from __future__ import annotations

from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    MAJOR,
    MINOR,
    RESETS,
    STATES,
    STATUSES,
    encode_payload,
)
from tiniscript.link.requests import OK
from tiniscript.robots import load

KIT = load("tinibot").kit.fingerprint


def reset(name: str) -> int:
    return [reset_name for reset_name, _ in RESETS].index(name)


def state(name: str) -> int:
    return [state_name for state_name, _ in STATES].index(name)


class UnpoweredEnd:
    """An end without a device: a board without power."""

    def __init__(self, baud: int = 9600) -> None:
        self.baud = baud
        self.now_ms = 0
        self.received: list[bytes] = []  # bytes received

    def step(self, data: bytes) -> bytes:
        self.now_ms += 1
        if data:
            self.received.append(data)
        return self.answer(data)

    def answer(self, data: bytes) -> bytes:
        return b""

    def restart(self) -> None:
        pass


class Echo(UnpoweredEnd):
    def answer(self, data: bytes) -> bytes:
        return data


class Sketch(UnpoweredEnd):
    """Another sketch, which prints a line in each 200 ms."""

    line = b"Distance: 34 cm\r\n"

    def answer(self, data: bytes) -> bytes:
        return self.line if self.now_ms % 200 == 0 else b""


class BabblingEnd(UnpoweredEnd):
    """Bytes that are meaningless at any speed."""

    def answer(self, data: bytes) -> bytes:
        return bytes((0x81, 0xFF, 0x9D, 0x80, 0xC3)) if self.now_ms % 20 == 0 else b""


class Board(UnpoweredEnd):
    """A board with a bootloader: it answers for `open_ms` after a restart, or always.

    The device on it is silent. A bootloader has its own speed.
    """

    def __init__(
        self, baud: int = 115_200, greeting: bytes = b"0 ", reply: bytes = b"\x14\x10",
        open_ms: int | None = 1000,
    ) -> None:  # fmt: skip
        super().__init__(baud)
        self.greeting, self.reply, self.open_ms = greeting, reply, open_ms
        self._elapsed_ms = 10**9

    def step(self, data: bytes) -> bytes:
        self._elapsed_ms += 1
        return super().step(data)

    def answer(self, data: bytes) -> bytes:
        is_open = self.open_ms is None or self._elapsed_ms < self.open_ms
        return self.reply if is_open and self.greeting in data else b""

    def restart(self) -> None:
        self._elapsed_ms = 0


class Firmware(UnpoweredEnd):
    """The robot's half of the link, as far as the doctor asks; `values` are fields of its replies.

    `restarts_ms`: it restarts so often, with the cause `resets`. It does not answer requests whose
    number is a multiple of `deaf`. `dies_after` requests it is silent. It reports its `trim` to a
    session in its `epoch`.
    """

    def __init__(self, baud: int = 9600, **values: int | bytes) -> None:
        super().__init__(baud)
        self.hello: dict[str, int | bytes] = {
            "major": MAJOR, "minor": MINOR, "isa_major": 2, "isa_minor": 1, "largest": 63,
            "window": 1, "kit": KIT, "id": 0x12347F3A, "nonce": 100, "features": 0,
            "reset": reset("POWER"), "room": 389, "state": state("IDLE"), "run": 0, "program": 0,
            "length": 0, "slot": 0, "saved": 0, "fault": 0, "fault_at": 0, "fault_program": 0,
            "name": b"ANA",
        }  # fmt: skip
        self.counts = {"damaged": 0, "dropped": 0, "framing": 0, "overrun": 0}
        for key, value in values.items():
            if key in self.counts:
                assert isinstance(value, int)
                self.counts[key] = value
            else:
                self.hello[key] = value
        self.restarts_ms: int | None = None
        self.resets = "BROWN_OUT"
        self.deaf = 0
        self.hears_badly = False
        self.dies_after: int | None = None
        self.hello_refusal: tuple[int, int] | None = None  # HELLO: a status and its detail
        self.epoch = 7
        self.trim: dict[str, int | bytes] | None = None  # an older robot has none
        self.requests: list[int] = []
        self._line = b""

    def answer(self, data: bytes) -> bytes:
        if self.restarts_ms and self.now_ms % self.restarts_ms == 0:
            nonce = self.hello["nonce"]
            assert isinstance(nonce, int)
            self.hello |= {"nonce": nonce + 1, "reset": reset(self.resets)}
            self.hello["state"] = state("IDLE")
        self._line += data
        replies = b""
        while b"\0" in self._line:
            packet, _, self._line = self._line.partition(b"\0")
            frame = decode_frame(packet) if packet else None
            if frame is not None and not frame.is_reply:
                replies += self._reply(frame)
        return replies

    def _reply(self, frame: Frame) -> bytes:
        self.requests.append(frame.number)
        count = len(self.requests)
        if self.dies_after is not None and count > self.dies_after:
            return b""
        if self.deaf and count % self.deaf == 0:
            if self.hears_badly:
                self.counts["damaged"] = (self.counts["damaged"] + 1) & 0xFF
            return b""
        message = BY_NUMBER[frame.number]
        payload = bytes([OK])
        if message.name == "HELLO" and self.hello_refusal is not None:
            payload = bytes([self.hello_refusal[0]]) + self.hello_refusal[1].to_bytes(2, "little")
        elif message.name in ("HELLO", "STATUS", "PING"):
            known_values = {**self.hello, **self.counts}
            payload += encode_payload(
                message.reply,
                {
                    field.name: known_values[field.name]
                    for field in message.reply
                    if field.name in known_values
                },
            )
        elif message.name != "TRIM" or self.trim is None:
            payload = bytes([STATUSES["UNKNOWN_MESSAGE"], 0, 0])
        elif frame.epoch != self.epoch:
            payload = bytes([STATUSES["STALE"], 0, 0])
        else:
            payload += encode_payload(message.reply, self.trim)
        reply = Frame(frame.number, frame.seq, self.epoch, payload, is_reply=True)
        return b"\0" + encode_frame(reply)


QUESTIONS = {BY_NAME[name].number for name in ("HELLO", "STATUS", "PING", "TRIM")}
