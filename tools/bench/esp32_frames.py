"""Prints what an ESP32's link takes: bytes over Bluetooth LE, and a frame's last byte to a pin.

The robot is its sketch on a simulated chip (`tests/machines/esp32.py`). Bytes are those of GATT's
values: what the radio adds to each is not in them. Turns of the main loop are the firmware's own;
their microseconds are this computer's, in a build with sanitizers, and no chip's.
"""

from __future__ import annotations

import statistics
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tests.machines.esp32 import Esp32Robot, missing
from tests.support.esp32_radio import LowEnergy, session, talk
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import Image, unpack
from tools.bench.compiler import table
from tools.bench.large_upload import program

MTUS = (23, 247)
RUNS = 30
FIRST = "SI|F(2, 80)"


class Carried(NamedTuple):
    """Bytes and pieces of an upload in both directions."""

    there: int
    writes: int
    back: int
    notifications: int


class Counted(LowEnergy):
    """Counts what it sends."""

    writes = sent = 0

    def send(self, data: bytes) -> None:
        self.sent += len(data)
        self.writes += -(-len(data) // (self.mtu - 3))
        super().send(data)


def carried(image: Image, mtu: int) -> Carried:
    """Upload a program over a new connection."""
    robot = booted()
    end, client = Counted(robot, mtu), session(1, robot)
    request = client.upload(image, saves=False)
    while request.outcome is None:
        talk(robot, [(end, client)], 1)
    if request.outcome.status:
        raise RuntimeError(f"status {request.outcome.status}")
    found = Carried(end.sent, end.writes, sum(end.lengths), len(end.lengths))
    robot.close()
    return found


def to_pin(is_stop: bool) -> tuple[int, float]:
    """Return the turns and microseconds from a frame's last byte until a motor pin changes."""
    robot = booted()
    client = session(1, robot)
    client.live(image_of("F(9, 80)").code)
    said = b""
    while not any("MOTORS" in line for line in robot.did):
        said = client.poll(robot.now_ms) or said
        if said and said[-1:] == b"\0":
            robot.step(said[:-1])
            client.receive(robot.step(said[-1:]), robot.now_ms)
            said = b""
        else:
            client.receive(robot.step(said), robot.now_ms)
    if is_stop:
        robot.step(bytes(8))
    found = robot.moved()
    robot.close()
    return found


def booted() -> Esp32Robot:
    robot = Esp32Robot(robots.load("tinibot32"))
    robot.wait(300)
    return robot


def image_of(text: str) -> Image:
    compiled = compile_text(text, robots.load("tinibot32").kit)
    assert compiled.image
    return unpack(compiled.image)


def main() -> int:
    why = missing()
    if why:
        print(why, file=sys.stderr)
        return 1
    rows: list[tuple[object, ...]] = []
    for name, image in ((f"`{FIRST}`", image_of(FIRST)), ("8,192 bytes of code", program(8192))):
        for mtu in MTUS:
            found = carried(image, mtu)
            rows.append((name, mtu, f"{found.there:,}", f"{found.writes:,}", f"{found.back:,}",
                         f"{found.notifications:,}"))  # fmt: skip
    head = ("uploaded over Bluetooth LE", "MTU", "bytes", "writes", "bytes back", "notifications")
    table("Bytes on an ESP32's Bluetooth LE, from connecting to the receipt", head, rows)
    pins: list[tuple[object, ...]] = []
    for what, is_stop in (("a live line that drives", False), ("eight zeros: a stop", True)):
        all_of = [to_pin(is_stop) for _ in range(RUNS)]
        turns = [turn for turn, _ in all_of]
        us = statistics.median(us for _, us in all_of)
        pins.append((what, f"{min(turns)} to {max(turns)}", f"{us:.0f}"))
    words = ("last byte to motor pin", "turns of the main loop", "us here, median")
    table(f"The host build of an ESP32, {RUNS} times", words, pins)
    return 0


if __name__ == "__main__":
    sys.exit(main())
