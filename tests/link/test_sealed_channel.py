"""A bad line with a stranger on it: sealed requests are executed at most once, and a stop always.

The stranger hears all, and says what it likes to both ends: what it has heard, again, later, in
another order or to the other end, frames without a seal or with a wrong one, and HELLO; it answers
HELLO and what was asked last, as a robot that seals nothing does.
`python -m tests.link.test_sealed_channel 10000` plays more uploads.
"""

from __future__ import annotations

import random
from collections import Counter

import pytest

from tests.machines.link import CppLink, cpp_link, link_library
from tests.support.campaign import each_seed, make_options
from tests.support.link_cases import KIT
from tests.support.link_channel import World, damage_frame, program, run_upload_scenario
from tests.support.owners import Keys
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    AUTHORITY_MS,
    BY_NAME,
    KEY_OWNER,
    LARGE_FRAME,
    MESSAGES,
    OWNED,
    OWNERS,
    SEALS,
    SMALL_FRAME,
    STATUSES,
    decode_payload,
    encode_payload,
    payload_bytes,
)
from tiniscript.link.session import Session

UPLOAD_COUNT = 40
KEPT_FRAMES = 400  # frames that the stranger keeps


class SealedWorld(World):
    """A robot with an owner, whose session is sealed. `forgery_rate` is the part of the turns in
    which a stranger speaks.
    """

    has_hello = True

    def __init__(self, cpp: CppLink, rng: random.Random, faults: float, drop_rate: float) -> None:
        self.keys = Keys()
        self.forgery_rate = 0.0
        self.frames: list[bytes] = []
        self.last_request: Frame | None = None  # the last request
        self.greeting = b""  # the robot's answer to HELLO
        super().__init__(cpp, rng, 0, 0)
        largest = LARGE_FRAME if cpp.is_large else SMALL_FRAME
        self.line = (payload_bytes(largest, is_sealed=True) - 1) // 3 * 3
        cpp.let_happen("o", OWNERS | SEALS)
        self.reconnect()
        claim = self.session.claim(KEY_OWNER)
        self.run(None, 1000)
        while not cpp.let_happen("h"):  # until the claim arrives
            self.run(None, 200)
        self.run(claim)
        assert claim.outcome and claim.outcome.status == 0

    def reconnect(self) -> None:
        """The stranger comes when a program is on the robot."""
        self.forgery_rate = self.rng.choice((0, 0.02, 0.1)) if self.keys.stored_keys else 0
        self.session = Session(self.rng.getrandbits(32), 9600, KIT, keys=self.keys)

    def overhear(self, data: bytes) -> None:
        self.frames += [part + b"\0" for part in data.split(b"\0") if part]
        del self.frames[:-KEPT_FRAMES]
        for frame in filter(None, map(decode_frame, filter(None, data.split(b"\0")))):
            if not frame.is_reply:
                self.last_request = frame
            elif frame.number == BY_NAME["HELLO"].number and frame.payload[0] == 0:
                self.greeting = frame.payload

    def disturb(self) -> None:
        if self.forgery_rate == 0 or self.rng.random() >= self.forgery_rate or not self.frames:
            return
        data = self.forge_frame()
        (self.to_computer if self.rng.random() < 0.4 else self.to_robot).send(
            b"\0" + data, self.now_ms
        )

    def forge_frame(self) -> bytes:
        rng = self.rng
        forgery_kind = rng.randrange(7)
        old_frame = rng.choice(self.frames)
        if forgery_kind == 6 and self.last_request is not None:
            return self.answer_unsealed(self.last_request)
        if forgery_kind == 0:
            return damage_frame(old_frame, rng)
        frame = decode_frame(old_frame.rstrip(b"\0"))
        if forgery_kind < 3 or frame is None:
            return old_frame
        if forgery_kind == 3:  # a seal is removed, added, or moved to an expected frame
            number = rng.choice((frame.number, BY_NAME["LIVE"].number))
            frame = frame._replace(number=number, seq=(frame.seq + rng.randrange(3)) & 0xFF)
            return encode_frame(frame._replace(is_sealed=rng.random() < 0.5))
        if forgery_kind == 4:  # the attacker claims that the robot has no seal, or has done it
            status = rng.choice((0, 0, STATUSES["NOT_OWNER"], STATUSES["STALE"]))
            payload = bytes([status]) + rng.randbytes(rng.choice((0, 2, 8)))
            return encode_frame(frame._replace(payload=payload, is_reply=True, is_sealed=False))
        requests = [message for message in MESSAGES if message.number < 32]
        message = rng.choice(requests if self.has_hello else requests[1:])
        max_bytes = sum(field.most_bytes for field in message.request)
        min_bytes = sum(field.least_bytes for field in message.request)
        payload = rng.randbytes(rng.randint(min_bytes, max_bytes))
        seq, epoch = rng.randrange(256), frame.epoch
        return encode_frame(Frame(message.number, seq, epoch, payload))

    def answer_unsealed(self, request_frame: Frame) -> bytes:
        """Return an unsealed answer: HELLO as from a robot without seals, or success."""
        message = next(message for message in MESSAGES if message.number == request_frame.number)
        payload = b"\0" + self.rng.randbytes(sum(field.least_bytes for field in message.reply))
        if message.name == "HELLO" and self.greeting:
            values = decode_payload(message.reply, self.greeting[1:])
            cleared = self.rng.choice((OWNED, SEALS, OWNED | SEALS))
            values["features"] = int(values["features"]) & ~cleared
            payload = b"\0" + encode_payload(message.reply, values)
        return encode_frame(request_frame._replace(payload=payload, is_reply=True, is_sealed=False))


class QuietWorld(SealedWorld):
    """No other client is connected."""

    def disturb(self) -> None: ...


@pytest.mark.sampled("world", "is_large", "min_share")
@pytest.mark.parametrize(
    ("world", "is_large", "min_share"),
    [
        (QuietWorld, False, 0.9),
        (QuietWorld, True, 0.85),
        (SealedWorld, False, 0.4),
        (SealedWorld, True, 0.3),
    ],
)
def test_sealed_uploads_survive_a_bad_radio(
    world: type[World], is_large: bool, min_share: float
) -> None:
    """A stranger may end sessions; no forged frame is obeyed or trusted, and many requests still
    succeed."""
    counts = Counter(
        run_upload_scenario(cpp_link(is_large), seed, world) for seed in range(UPLOAD_COUNT)
    )
    assert counts["done"] > UPLOAD_COUNT * min_share, counts


def test_the_frames_of_a_session_are_sealed() -> None:
    world = QuietWorld(cpp_link(), random.Random(1), 0, 0)
    request = world.session.live(program(world.rng)[: world.line])
    world.run(request)
    assert request.outcome and request.outcome.status == 0
    frames = [decode_frame(frame.rstrip(b"\0")) for frame in world.frames[-2:]]
    assert [(frame.number, frame.is_sealed) for frame in frames if frame] == [(8, True), (8, True)]


@pytest.mark.parametrize("seed", range(3))
def test_an_unsealed_event_is_trusted_only_if_the_robot_may_have_lost_its_seal(
    seed: int,
) -> None:
    """It keeps ours while it hears it, however long that is ago first."""
    world = QuietWorld(cpp_link(), random.Random(seed), 0, 0)
    world.run(world.session.status())
    forged_data = encode_payload(BY_NAME["DONE"].reply, {"run": 9})

    def hears_forged() -> bool:
        world.session.events()
        frame = Frame(BY_NAME["DONE"].number, 9, world.session._epoch, forged_data, is_reply=True)
        world.session.receive(b"\0" + encode_frame(frame), world.now_ms)
        return bool(world.session.events())

    for _ in range(10):
        world.run(None, world.rng.choice((1, 100, 1000, 3000)))
        assert not hears_forged()
    world.now_ms += AUTHORITY_MS  # in which nobody talks
    assert hears_forged()


def test_a_stop_works_despite_any_error_in_its_seal() -> None:
    world = QuietWorld(cpp_link(), random.Random(2), 0, 0)
    stop = BY_NAME["STOP"].number
    for payload, is_sealed in ((b"", False), (b"", True), (bytes(13), True), (bytes(30), True)):
        assert world.session.robot
        request = world.session.live(program(world.rng)[: world.line])
        world.run(request)
        assert request.outcome and request.outcome.status == 0
        frame = Frame(stop, 1, 0, payload, is_sealed=is_sealed)
        step = world.cpp.step(world.now_ms, b"\0" + encode_frame(frame))
        assert "STOP" in step.did
        world.session.receive(step.sent, world.now_ms)
        world.run(None, 300)


if __name__ == "__main__":
    options = make_options(10_000, 1, "large")
    robot = link_library(options.large)
    each_seed(lambda seed: run_upload_scenario(robot, seed, SealedWorld), options)
