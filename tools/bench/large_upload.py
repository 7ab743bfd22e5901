"""Prints how long the largest program takes to an ESP32 over a line with a round trip of 40 ms.

The robot is its sketch on a simulated chip (`tests/machines/esp32.py`), at 115200 baud; time is
simulated, so every run prints the same. The wire's time is that of the code alone.
"""

from __future__ import annotations

import sys
from collections import deque
from typing import NamedTuple

from tests.machines.esp32 import Esp32Robot
from tests.machines.host import missing
from tests.machines.host_firmware import HostFirmware
from tiniscript import robots
from tiniscript.bytecode.image import Image, pack, unpack
from tiniscript.bytecode.opcodes import BY_NAME
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

BAUD = 115_200
ROUND_TRIP_MS = 40
MAX_TIMES = 3.0  # times the wire's time
LONGEST_UPLOAD_MS = 60_000
MOVE = BY_NAME["MOVE8_F"].code


class UploadTimes(NamedTuple):
    """Times of an upload: its code, ms until its receipt, ms on the wire, frames and bytes."""

    code_bytes: int
    duration_ms: int
    wire_ms: float
    frame_count: int
    sent_bytes: int

    @property
    def times_of_wire(self) -> float:
        return self.duration_ms / self.wire_ms


class Wire:
    """One direction of a line: bytes take their time at the baud rate, and arrive half a round trip
    later.
    """

    def __init__(self, baud: int, delay_ms: float) -> None:
        self._byte_ms, self._delay_ms = 10_000 / baud, delay_ms
        self._free_ms = 0.0
        self._queue: deque[tuple[float, int]] = deque()

    def send(self, data: bytes, now_ms: int) -> None:
        self._free_ms = max(self._free_ms, now_ms)
        for byte in data:
            self._free_ms += self._byte_ms
            self._queue.append((self._free_ms + self._delay_ms, byte))

    def receive(self, now_ms: int) -> bytes:
        arrived_bytes = bytearray()
        while self._queue and self._queue[0][0] <= now_ms:
            arrived_bytes.append(self._queue.popleft()[1])
        return bytes(arrived_bytes)


def program(code_bytes: int) -> Image:
    """Return a program of so many bytes: moves, and single instructions for the rest."""
    move_count, stop_count = divmod(code_bytes, 3)
    moves = b"".join(bytes((MOVE, k % 256, k % 101)) for k in range(move_count))
    return unpack(pack("SI", 0, moves + bytes([BY_NAME["STOP"].code]) * stop_count))


def upload(
    robot: HostFirmware, kit: int, code_bytes: int, baud: int = BAUD,
) -> UploadTimes:  # fmt: skip
    """Upload a program to a robot that has just begun. Raises RuntimeError if it is not done."""
    to_robot, from_robot = (Wire(baud, ROUND_TRIP_MS / 2) for _ in range(2))
    session = Session(7, baud, kit)
    image = program(code_bytes)
    hello = session.hello()
    request = None
    now_ms = began_ms = frame_count = sent_bytes = 0
    while request is None or request.outcome is None:
        if hello.outcome and request is None:
            began_ms = now_ms
            request = session.upload(image, runs=False)
        data = session.poll(now_ms)
        if request is not None:
            frame_count += len([part for part in data.split(b"\0") if part])
            sent_bytes += len(data)
        to_robot.send(data, now_ms)
        now_ms += 1
        from_robot.send(robot.step(to_robot.receive(now_ms)), now_ms)
        session.receive(from_robot.receive(now_ms), now_ms)
        if now_ms > LONGEST_UPLOAD_MS:
            raise RuntimeError("the upload has no end")
    if request.outcome.status != OK:
        raise RuntimeError(f"the robot has not taken it: {request.outcome}")
    wire_ms = code_bytes * 10_000 / baud
    return UploadTimes(code_bytes, now_ms - began_ms, wire_ms, frame_count, sent_bytes)


def main() -> int:
    if missing():
        print(missing(), file=sys.stderr)
        return 2
    profile = robots.load("tinibot32")
    print(f"tinibot32 at {BAUD} baud, round trip {ROUND_TRIP_MS} ms, simulated time:\n")
    print("| code | frames | bytes sent | until the receipt | times the wire's time |")
    print("|---:|---:|---:|---:|---:|")
    is_quick_enough = True
    for code_bytes in (240, 1900, profile.board.program_bytes):
        robot = Esp32Robot(profile)
        robot.wait(300)
        upload_times = upload(robot, profile.kit.fingerprint, code_bytes)
        robot.close()
        print(
            f"| {upload_times.code_bytes} | {upload_times.frame_count} | {upload_times.sent_bytes} "
            f"| {upload_times.duration_ms} ms | {upload_times.times_of_wire:.2f} |"
        )
        is_quick_enough = (
            code_bytes < profile.board.program_bytes or upload_times.times_of_wire <= MAX_TIMES
        )
    print(f"\nThe last one must take {MAX_TIMES:.0f} times the wire's time at most.")
    return 0 if is_quick_enough else 1


if __name__ == "__main__":
    sys.exit(main())
