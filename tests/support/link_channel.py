"""A line that damages, loses and doubles bytes."""

from __future__ import annotations

import random
import re
from collections import Counter, deque
from collections.abc import Callable
from typing import Any

from tests.machines.link import CppLink
from tests.support.link_cases import KIT
from tiniscript.bytecode.image import pack, unpack
from tiniscript.bytecode.opcodes import BY_NAME
from tiniscript.link.connection import PendingRequest
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.session import Session
from tiniscript.link.statuses import name_of

PIECE_BYTES = 20  # piece size of Bluetooth Low Energy
PAUSES_MS = (5, 5, 5, 5, 5, 30, 30, 30, 100, 300, 1500)  # the last is a silence for the receiver
LARGE_COUNTS = (80, 81, 160, 400, 1000, 2700)  # numbers of moves for a large robot
OUTCOMES = {LOST: "lost", CANCELLED: "cancelled"}


def lose_byte(data: bytes, offset: int, rng: random.Random) -> bytes:
    return data[:offset] + data[offset + 1 :]


def change_byte(data: bytes, offset: int, rng: random.Random) -> bytes:
    return data[:offset] + bytes([data[offset] ^ rng.randrange(1, 256)]) + data[offset + 1 :]


def double_byte(data: bytes, offset: int, rng: random.Random) -> bytes:
    return data[: offset + 1] + data[offset:]


def swap_bytes(data: bytes, offset: int, rng: random.Random) -> bytes:
    return data[:offset] + data[offset : offset + 2][::-1] + data[offset + 2 :]


def insert_byte(data: bytes, offset: int, rng: random.Random) -> bytes:
    return data[:offset] + bytes([rng.randrange(256)]) + data[offset:]


def cut(data: bytes, offset: int, rng: random.Random) -> bytes:
    return data[:offset] + data[offset + rng.randrange(1, 20) :]


def with_module_text(data: bytes, offset: int, rng: random.Random) -> bytes:
    """Return the data with text inserted by radio modules."""
    return (
        data[:offset]
        + rng.choice((b"OK+LOST", b"OK+LOST\r\n", b"+DISC:SUCCESS\r\n"))
        + data[offset:]
    )


DAMAGES: tuple[Callable[[bytes, int, random.Random], bytes], ...] = (
    lose_byte, change_byte, double_byte, swap_bytes, insert_byte, cut, with_module_text,
)  # fmt: skip


def damage_frame(data: bytes, rng: random.Random) -> bytes:
    """Return the bytes of a frame with one to three damages."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        if data:
            data = rng.choice(DAMAGES)(data, rng.randrange(len(data)), rng)
    return data


class Radio:
    """One direction of a radio: bytes arrive later, in order, with losses and damage."""

    def __init__(self, rng: random.Random, baud: int, faults: float) -> None:
        self.rng, self.byte_ms, self.faults = rng, 10_000 / baud, faults
        self.shuffle_rate = 0.0  # probability that a frame is doubled or overtakes the previous one
        self.is_split = False  # into pieces of PIECE_BYTES, with a pause before some of them
        self.is_out = False
        self._queue: deque[tuple[float, int]] = deque()
        self._last_ms = 0.0

    def send(self, data: bytes, now_ms: int) -> None:
        if self.is_out:
            return
        if self.shuffle_rate:
            data = self.shuffle(data)
        offset = 0
        while offset < len(data):
            if self.rng.random() < self.faults:
                data = self.rng.choice(DAMAGES)(data, offset, self.rng)
            offset += 1
        late_ms = self.rng.uniform(15, 40) + (self.rng.random() < 0.02) * self.rng.uniform(200, 600)
        self._last_ms = max(self._last_ms, now_ms + late_ms)
        for offset, byte in enumerate(data):
            if self.is_split and offset % PIECE_BYTES == 0 and self.rng.random() < 0.2:
                self._last_ms += self.rng.choice(PAUSES_MS)
            self._last_ms += self.byte_ms
            self._queue.append((self._last_ms, byte))

    def shuffle(self, data: bytes) -> bytes:
        frames = re.findall(rb"\0*[^\0]*\0?", data)
        for index in range(len(frames) - 1, -1, -1):
            if self.rng.random() >= self.shuffle_rate:
                continue
            if self.rng.random() < 0.5:
                frames.insert(index, frames[index])
            else:
                frames[index : index + 2] = frames[index : index + 2][::-1]
        return b"".join(frames)

    def take_arrived(self, now_ms: int) -> bytes:
        data = bytearray()
        while self._queue and self._queue[0][0] <= now_ms:
            data.append(self._queue.popleft()[1])
        return bytes(data)


class World:
    """A computer, a robot and two radios. A disconnect takes both radios out for a while."""

    STEP_MS = 5
    is_split = False

    def __init__(self, cpp: CppLink, rng: random.Random, faults: float, drop_rate: float) -> None:
        self.cpp, self.rng, self.drop_rate = cpp, rng, drop_rate
        baud = rng.choice((9600, 9600, 57600, 115200))
        self.to_robot = Radio(rng, baud, faults)
        self.to_computer = Radio(rng, baud, faults)
        self.now_ms = 0
        self.session = Session(rng.getrandbits(32), baud, KIT)
        self.did: list[str] = []
        self._out_until = 0
        self.line = 240 if cpp.is_large else 54  # bytes of code of a live line
        cpp.begin(room=8192 if cpp.is_large else 389, kit=KIT, epoch=rng.randrange(256))

    def reconnect(self) -> None:
        """Another session with the same robot."""
        self.session = Session(self.rng.getrandbits(32), 9600, KIT)

    def run(self, request: PendingRequest[Any] | None, limit_ms: int = 600_000) -> None:
        """Let time pass until the request is over."""
        end_ms = self.now_ms + limit_ms
        while self.now_ms < end_ms and (request is None or request.outcome is None):
            if self.rng.random() < self.drop_rate:
                self._out_until = self.now_ms + self.rng.randrange(100, 3000)
            self.to_robot.is_out = self.to_computer.is_out = self.now_ms < self._out_until
            self.disturb()
            data = self.session.poll(self.now_ms)
            if data:
                self.overhear(data)
                self.to_robot.send(data, self.now_ms)
            came_bytes = self.to_robot.take_arrived(self.now_ms)
            if came_bytes or self.now_ms % 50 == 0:
                step = self.cpp.step(self.now_ms, came_bytes)
                self.did += step.did
                if step.sent:
                    self.overhear(step.sent)
                    self.to_computer.send(step.sent, self.now_ms)
            self.session.receive(self.to_computer.take_arrived(self.now_ms), self.now_ms)
            self.now_ms += self.STEP_MS

    def disturb(self) -> None:
        """Let others act at this time."""

    def overhear(self, data: bytes) -> None:
        """Let others hear the data."""


def program(rng: random.Random, is_large: bool = False) -> bytes:
    """Return code that no other program of the test has: moves of random times and powers."""
    move = BY_NAME["MOVE8_F"].code
    count = rng.choice((1, 3, 12, 18, 19, 40, 129, *(LARGE_COUNTS if is_large else ())))
    return b"".join(bytes((move, rng.randrange(256), rng.randrange(101))) for _ in range(count))


def run_upload_scenario(cpp: CppLink, seed: int, world_of: type[World] = World) -> str:
    """Upload a program over another one, then send lines and stop; return how the upload went."""
    rng = random.Random(seed)
    faults = rng.choice((0, 0.001, 0.01))
    world = world_of(cpp, rng, faults, drop_rate=rng.choice((0, 0.0002, 0.002)))
    old_image = pack("SI", 0, program(rng, cpp.is_large))
    world.to_robot.faults = world.to_computer.faults = 0
    drop_rate, world.drop_rate = world.drop_rate, 0
    old_upload = world.session.upload(unpack(old_image), runs=False)
    world.run(old_upload)
    assert old_upload.outcome and old_upload.outcome.status == 0 and cpp.fetch_image() == old_image
    world.to_robot.faults = world.to_computer.faults = faults
    world.to_robot.is_split = world.to_computer.is_split = world.is_split
    world.drop_rate = drop_rate
    if cpp.is_large:
        world.to_robot.shuffle_rate = world.to_computer.shuffle_rate = rng.choice((0, 0, 0.02, 0.2))

    new_image = pack("SI", 0, program(rng, cpp.is_large))
    world.reconnect()
    request = world.session.upload(unpack(new_image))
    world.run(request)
    assert request.outcome, f"seed {seed}: an upload has no end"
    status = request.outcome.status
    is_done = status == 0
    if is_done:
        assert cpp.fetch_image() == new_image, (
            f"seed {seed}: the upload says done, the robot has another one"
        )
    assert cpp.fetch_image() in (old_image, new_image), (
        f"seed {seed}: neither the old program nor the new one"
    )
    names = [f"TAKE {unpack(image).checksum:08x}" for image in (new_image, old_image)]
    assert {row for row in world.did if row.startswith("TAKE")} <= set(names)
    start_count = sum(row.startswith("START") for row in world.did)
    assert start_count == 1 if is_done else start_count <= 1, (
        f"seed {seed}: started {start_count} times"
    )

    # Each line runs at most once, and exactly once if the computer confirms it.
    lines = []
    for _ in range(4):
        code = program(rng, cpp.is_large)[: world.line]
        request = world.session.live(code)
        world.run(request)
        assert request.outcome
        lines.append(
            (f"TAKE live {unpack(pack('SI', 0, code)).checksum:08x}", request.outcome.status)
        )
    times = Counter(world.did)
    for row, answer in lines:
        assert times[row] == 1 if answer == 0 else times[row] <= 1, f"seed {seed}: {row}"

    # After a stop, no program starts, whatever is still under way.
    request = world.session.live(program(rng)[: world.line])
    world.run(None, rng.randrange(0, 200))
    count_before = len(world.did)
    world.session.stop(world.now_ms)
    world.run(None, 300)
    new_actions = world.did[count_before:]
    if "PINS OFF" in new_actions:
        last_actions = new_actions[new_actions.index("PINS OFF") :]
        assert not any(row.startswith("START") for row in last_actions), (
            f"seed {seed}: {last_actions}"
        )
    return "done" if is_done else OUTCOMES.get(status) or name_of(status)
