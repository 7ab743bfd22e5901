"""A refused request changes nothing, whatever it asks and whatever the robot is doing.

Two robots go through the same history. Then one gets a request that it refuses, and the other one a
harmless request. From there on, both do and send the same.
`python -m tests.firmware.test_refused_requests 1000` is a campaign.
"""

from __future__ import annotations

import random

import pytest

from tests.support.campaign import each_seed, make_options
from tests.support.compared_answers import first_difference
from tests.support.hostile_client import (
    CODES,
    EVENTS,
    LINES,
    MODES,
    REQUESTS,
    STATUS_BUSY,
    STATUS_OK,
    Client,
)
from tests.support.images import image_of
from tests.support.robot_on_host import switched_on
from tiniscript.bytecode.image import pack
from tiniscript.bytecode.opcodes import BY_NAME as BY_OP
from tiniscript.link.frames import decode_frame
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    MAX_BREAKPOINTS,
    RUN,
    SMALL_FRAME,
    STATUSES,
    payload_bytes,
    sizes,
)

SEEDS = 40  # seeds of the tests; a campaign runs more
TURN_COUNT = 60
NAMES = [message.name for message in REQUESTS if message.name not in ("HELLO", "PING", "STOP")]
LENGTHS = (1, 200, 388, 389, 390, 700)  # bytes of code: the robot has room for 389
UPLOADED_IMAGE = pack("SI", 0, b"\x51\x01" * 20)
CHECKSUM_START, CHECKSUM_END, PIECE_BYTES = 10, 14, 11
ENDLESS_CODE = image_of("SI|N = 0;LOOP(FOREVER);M(40, 30);W(0.02);N = N + 1;END_LOOP").code
# After these, all is as before.
REFUSALS = {
    STATUSES[name]
    for name in (
        "UNKNOWN_MESSAGE", "BAD_LENGTH", "BAD_VALUE", "STALE", "LATCHED", "NO_PROGRAM", "NOT_BEGUN",
        "INCOMPLETE", "NOT_OWNER", "HOLD_BUTTON", "HELD_BACK", "NO_BREAKPOINTS", "NO_REMOTE",
        "NO_READINGS",
    )
}  # fmt: skip
# A refusal of these leaves the image before intact. BUSY may end a run, so that saving can end.
IMAGE_NUMBERS = {BY_NAME[name].number for name in ("LIVE", "PROGRAM", "BEGIN")}
EARLY_REFUSALS = {STATUSES[name] for name in ("UNKNOWN_MESSAGE", "BAD_LENGTH", "STALE")}


class Twin(Client):
    """A client that notes all that its robot sends, but for the replies to compared requests."""

    # A program with SHOW and no W shows as often as the robot's main loop has time.
    codes = tuple(code for code in CODES if BY_OP["SHOW"].code not in code)
    lines = tuple(line for line in LINES if b"SHOW" not in line)

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        self.robot = switched_on(write_ms=0.0)  # else a longer frame delays the write of a byte
        self.sent: list[tuple[int, bytes]] = []
        self.is_comparing = False
        self.offset: int | None = None  # of the upload that is under way

    def receive(self, sent_bytes: bytes) -> None:
        *packets, _ = (self.heard + sent_bytes).split(b"\0")
        for packet in packets:
            frame = decode_frame(packet)
            if not self.is_comparing or frame is None or frame.number in EVENTS:
                self.sent.append((self.robot.now_ms, packet))
        super().receive(sent_bytes)

    def take_turn(self) -> None:
        choice = self.rng.random()
        if choice < 0.4:  # a program that a request could change
            self.ask_by_name("CLEAR")
            self.ask_by_name("LIVE", bytes([RUN]) + ENDLESS_CODE)
        elif choice < 0.7:
            self.continue_upload()
        else:
            super().take_turn()

    def continue_upload(self) -> None:
        """Begin an upload or send its next part: other requests come in the middle of it."""
        body = UPLOADED_IMAGE[CHECKSUM_END:]
        if self.offset is None:
            reply = self.ask_by_name("BEGIN", b"\0" + UPLOADED_IMAGE[2:CHECKSUM_START])
            self.offset = 0 if reply[0] == STATUS_OK else None
        elif self.offset < len(body):
            piece = body[self.offset :][:PIECE_BYTES]
            reply = self.ask_by_name("DATA", self.offset.to_bytes(2, "little") + piece)
            self.offset = int.from_bytes(reply[1:3], "little") if reply[0] == STATUS_OK else None
        else:
            self.ask_by_name("COMMIT", UPLOADED_IMAGE[CHECKSUM_START:CHECKSUM_END])
            self.offset = None

    def compared_status(self, number: int, payload: bytes, epoch: int) -> int:
        self.is_comparing = True
        status = self.ask(number, payload, epoch)[0]
        self.is_comparing = False
        return status

    def everything(self) -> list[object]:
        return [*self.sent, *self.robot.did, self.epoch, self.robot.is_latched, self.robot.is_lit]


def draw_request(rng: random.Random, name: str, client: Twin) -> tuple[int, bytes, int]:
    """Return a request that is often wrong in one way: its number, payload and epoch."""
    message = BY_NAME[name]
    least, most = sizes(message.request)
    most = min(most, payload_bytes(SMALL_FRAME))
    payload = rng.randbytes(rng.choice((least, most, rng.randint(least, most))))
    if name in ("LIVE", "PROGRAM", "START", "BEGIN"):
        mode = bytes([rng.choice(MODES)])
        code = rng.choice((*client.codes, rng.randbytes(9)))
        header = pack("SI", 0, bytes(rng.choice(LENGTHS)))[2:10]
        header = header[:3] + bytes([rng.choice((14, 14, 13, 15, 255))]) + header[4:]
        rest = {"START": b"", "BEGIN": rng.choice((header, header, rng.randbytes(8)))}
        payload = mode + rest.get(name, code)
    if name == "DATA" and client.offset is not None and rng.random() < 0.8:
        payload = client.offset.to_bytes(2, "little") + rng.randbytes(rng.choice((1, 30, 45)))
    if name == "TRIM" and rng.random() < 0.5:
        payload = bytes(rng.choice((0, 1, 3, 9, 20, 50, 200)) for _ in range(rng.choice((3, 11))))
    if name == "BREAK":
        places = [rng.randrange(12) for _ in range(rng.randint(1, MAX_BREAKPOINTS))]
        payload = b"".join(place.to_bytes(2, "little") for place in places)
    if rng.random() < 0.1:
        payload = payload[:-1] if rng.random() < 0.5 else payload + b"\1"
    is_stale = rng.random() < 0.15
    payload = payload[: payload_bytes(SMALL_FRAME)]
    return message.number, payload, client.epoch ^ (rng.randrange(1, 256) if is_stale else 0)


def is_refusal(number: int, status: int) -> bool:
    refuses_image = number in IMAGE_NUMBERS and status not in (STATUS_OK, STATUS_BUSY)
    return status in REFUSALS or refuses_image


def play(seed: int) -> None:
    rng = random.Random(seed)
    twins = first, second = Twin(seed), Twin(seed)
    for client in twins:
        client.send_hello()
    refused_numbers, name = set(), NAMES[0]
    for _ in range(TURN_COUNT):
        for client in twins:
            client.take_turn()
        name = name if rng.random() < 0.5 else rng.choice(NAMES)  # often again
        if name == "BREAK" and second.offset is not None:
            continue  # its places are those of the stored program, which is loaded over the upload
        number, payload, epoch = draw_request(rng, name, second)
        status = second.compared_status(number, payload, epoch)
        if is_refusal(number, status):
            # A request of the right form takes a half-typed line's memory.
            harmless = "PING" if status in EARLY_REFUSALS else "TRIM"
            assert first.compared_status(BY_NAME[harmless].number, b"", first.epoch) == STATUS_OK
            refused_numbers.add(number)
        else:
            assert first.compared_status(number, payload, epoch) == status
        for client in twins:
            client.put(b"", 50)
        states = [client.everything() for client in (second, first)]
        assert states[0] == states[1], (
            f"{BY_NUMBER[number].name} {status}: {first_difference(*states)}"
        )
    for client in twins:
        client.put(bytes(4), 10_000)  # it saves what it holds
    assert first.everything() == second.everything()
    assert first.robot.memory() == second.robot.memory()
    assert len(refused_numbers) > 5


@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_refused_request_changes_nothing(seed: int) -> None:
    play(seed)


if __name__ == "__main__":
    each_seed(play, make_options(1000, 1000))
