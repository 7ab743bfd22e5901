"""A client of a robot on this computer that sends any request, upload, text, zeros and noise."""

from __future__ import annotations

import random

from tests.support.robot_on_host import KIT, switched_on
from tiniscript.bytecode.image import HEADER_BYTES, pack
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    FIRST_ACTING,
    FIRST_EVENT,
    MAJOR,
    MINOR,
    RADIO_MESSAGES,
    RETIRED_NUMBERS,
    SMALL_FRAME,
    STATUSES,
    ZERO_MS,
    payload_bytes,
    sizes,
)

EVENTS = {number for number in BY_NUMBER if number >= FIRST_EVENT}
REQUESTS = tuple(message for message in BY_NUMBER.values() if message.number not in EVENTS)
UNKNOWN_NUMBERS = (*RETIRED_NUMBERS, *range(REQUESTS[-1].number + 1, FIRST_EVENT))
MAX_RETIRED = 20  # bytes of a payload: where the first byte on the wire is small, no line ends
STATUS_OK, STATUS_STALE, STATUS_BUSY = STATUSES["OK"], STATUSES["STALE"], STATUSES["BUSY"]
REJECTING_STATUSES = {STATUSES[name] for name in ("STALE", "BAD_LENGTH", "UNKNOWN_MESSAGE")}
MODES = (0x00, 0x01, 0x10, 0x20, 0x30, 0x50, 0x70, 0x13, 0xFF)
CODES = (b"", b"\x58", b"\x44\xf0\x50", b"\x68\xb1\x39\x6b\x04", b"\x68\x5a\x32\xce\x6b\x05",
         b"\xff", b"\0", b"\x51\x01" * 27)  # fmt: skip
LINES = (b"SI|F(5,50)\n", b"SI|LOOP(FOREVER);SHOW(1);END_LOOP\n", b"SB|F(1,2)\r\n", b"S\n", b"~\n",
         b"SI|LOOP(2)\n", b"(" * 250 + b"\n", b"SI|F(1," + b"9" * 30 + b")\n")  # fmt: skip
ROOM_BYTES = 389


class Client:
    codes: tuple[bytes, ...] = CODES
    lines: tuple[bytes, ...] = LINES

    def __init__(self, seed: int) -> None:
        self.rng = random.Random(seed)
        self.robot = switched_on()
        self.heard = b""
        self.frames_ms: int | None = None  # time of the last 0x00, if no byte was sent since
        self.seq, self.epoch = self.rng.randrange(256), 0
        self.replies: list[Frame] = []

    def put(self, data: bytes, milliseconds: int = 3) -> None:
        """Send bytes, and receive the robot's output during this time."""
        if data:
            self.frames_ms = self.robot.now_ms if data.endswith(b"\0") else None
        self.receive(self.robot.wait(milliseconds, data))

    def zero(self) -> bytes:
        """Return the 0x00 that a sender sends before a frame."""
        is_silent = self.frames_ms is None or self.robot.now_ms - self.frames_ms >= ZERO_MS
        return b"\0" * is_silent

    def receive(self, sent_bytes: bytes) -> None:
        *packets, self.heard = (self.heard + sent_bytes).split(b"\0")
        for packet in packets:
            frame = decode_frame(packet)
            if frame is not None:  # otherwise it is text
                self.epoch = frame.epoch
                self.replies += [frame] if frame.number not in EVENTS else []

    def ask(self, number: int, payload: bytes = b"", epoch: int | None = None) -> bytes:
        """Return the reply to a request, from its status on."""
        self.seq = (self.seq + 1) % 256
        self.replies.clear()
        sent_epoch = self.epoch if epoch is None else epoch
        self.put(self.zero() + encode_frame(Frame(number, self.seq, sent_epoch, payload)))
        [reply] = [frame for frame in self.replies if frame.seq == self.seq]
        assert reply.number == number and reply.is_reply
        assert reply.payload[0] == STATUS_OK or len(reply.payload) == 3, reply
        return reply.payload

    def ask_by_name(self, name: str, payload: bytes = b"") -> bytes:
        return self.ask(BY_NAME[name].number, payload)

    def send_hello(self) -> None:
        kit = self.rng.choice((KIT.fingerprint, 7)).to_bytes(2, "little")
        nonce = self.rng.choice((5, self.rng.getrandbits(32))).to_bytes(4, "little")
        assert self.ask_by_name("HELLO", bytes((MAJOR, MINOR, 2, 0)) + kit + nonce)[0] == STATUS_OK

    # -- its actions ------------------------------------------------------------------------------

    def request(self) -> None:
        """Any message, of a right or a wrong length, in any epoch."""
        rng = self.rng
        number = rng.choice(
            (*(message.number for message in REQUESTS[1:]), rng.choice(UNKNOWN_NUMBERS), 0)
        )
        fields = BY_NUMBER[number].request if number in BY_NUMBER else ()
        min_bytes, max_bytes = sizes(fields)
        max_bytes = min(max_bytes, payload_bytes(SMALL_FRAME))
        payload = rng.randbytes(
            rng.choice((min_bytes, max_bytes, rng.randrange(max_bytes + 1), rng.randrange(57)))
        )
        payload = payload[: MAX_RETIRED if number in RETIRED_NUMBERS else None]
        if fields and fields[0].name == "mode" and payload:
            payload = bytes([rng.choice(MODES)]) + payload[1:]
        if number in (BY_NAME["LIVE"].number, BY_NAME["PROGRAM"].number):
            payload = payload[:1] + rng.choice(self.codes)
        epoch = rng.choice((self.epoch, self.epoch, self.epoch ^ rng.randrange(1, 256)))
        is_stale = epoch != self.epoch
        self.robot.did.clear()
        was_latched = self.robot.is_latched
        status = self.ask(number, payload, epoch)[0]
        is_known = number in BY_NUMBER and BY_NUMBER[number].name not in RADIO_MESSAGES
        if not is_known:
            assert status == STATUSES["UNKNOWN_MESSAGE"]
        elif not min_bytes <= len(payload) <= max_bytes:
            assert status == STATUSES["BAD_LENGTH"]
        elif is_stale and number >= FIRST_ACTING:
            assert status == STATUS_STALE
        if status in REJECTING_STATUSES and was_latched:
            assert not [line for line in self.robot.did if " MOTORS " in line]

    def repeat_frame(self) -> None:
        """Repeat a frame: the answer and the run stay the same."""
        name = self.rng.choice(("START", "CLEAR", "IDENTIFY", "ABORT"))
        mode = b"\x40" if name == "START" else b""
        first = self.ask_by_name(name, mode)
        self.replies.clear()
        epoch = self.epoch
        self.put(b"\0" + encode_frame(Frame(BY_NAME[name].number, self.seq, epoch, mode)))
        if self.epoch == epoch and first[0] != STATUS_STALE:
            assert [reply.payload for reply in self.replies] == [first]

    def upload(self) -> None:
        """A program in pieces; something comes between. The confirmed bytes are those that were
        sent."""
        rng = self.rng
        code = rng.choice((b"", b"\x58" * 388, b"\x58" * 389, b"\x58" * 390, b"\xff" * 9,
                           b"\x51\x01" * rng.randrange(1, 190)))  # fmt: skip
        image = pack("SI", 0, code)
        mode = bytes([rng.choice((0x00, 0x20, 0x30))])
        reply = self.ask_by_name("BEGIN", mode + image[2:10])
        body, offset = image[14:], 0
        if len(code) > ROOM_BYTES and reply[0] != STATUS_STALE:
            assert reply[0] != STATUS_OK
        while reply[0] == STATUS_OK and offset < len(body):
            if rng.random() < 0.1:
                rng.choice((self.send_hello, self.send_zeros, self.send_line, self.request))()
            piece = body[offset : offset + rng.choice((1, 20, 53))]
            reply = self.ask_by_name("DATA", offset.to_bytes(2, "little") + piece)
            if reply[0] == STATUS_OK:
                offset = int.from_bytes(reply[1:3], "little")
                assert offset <= len(body)
        if self.ask_by_name("COMMIT", image[10:14])[0] == STATUS_OK:
            assert self.fetch_image() == image
            assert code != b"\xff" * 9

    def fetch_image(self) -> bytes:
        """Return the image that the robot holds."""
        image, total_bytes = b"", HEADER_BYTES
        while len(image) < total_bytes:
            reply = self.ask_by_name("FETCH", len(image).to_bytes(2, "little"))
            if reply[0] == STATUS_BUSY:
                self.put(b"", 50)
                continue
            assert reply[0] == STATUS_OK
            total_bytes = int.from_bytes(reply[1:3], "little")
            image += reply[3:]
        return image

    def send_zeros(self) -> None:
        self.put(bytes(self.rng.choice((4, 8, 9, 31))))
        assert self.robot.is_latched

    def send_line(self) -> None:
        self.put(self.rng.choice(self.lines), 5)

    def send_noise(self) -> None:
        self.put(self.rng.randbytes(self.rng.randrange(1, 90)) + b"\0")

    def keep_silent(self) -> None:
        self.put(b"", self.rng.choice((30, 999, 1001, 2500)))

    def press_button(self) -> None:
        self.receive(self.robot.step(flags=1))
        self.put(b"", self.rng.choice((40, 2100)))
        self.receive(self.robot.step(flags=2))

    def take_turn(self) -> None:
        self.rng.choice((
            self.request, self.request, self.request, self.repeat_frame, self.upload,
            self.send_hello, self.send_zeros, self.send_line, self.send_noise, self.keep_silent,
            self.press_button,
        ))()  # fmt: skip

    def check_obeys(self) -> None:
        """A stop stops it; after a second of silence the next line is done."""
        self.put(bytes(4), 1200)
        assert self.robot.is_latched
        self.robot.did.clear()
        self.put(b"SI|M(13,17);W(1)\n", 40)
        assert self.robot.did[0].endswith(" MOTORS 13 17")
        self.put(bytes(4))
        assert self.robot.did[-1].endswith(" MOTORS 0 0")
