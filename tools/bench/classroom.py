"""Prints how long a stop of a class takes at an MQTT broker, until the last of 100 robots stands.

The broker is Mosquitto on this computer. The first row is measured in real time: one message, and
as many plain sockets that wait for it. For the second one, the robots are the sketch of an ESP32
on simulated chips. This computer cannot simulate so many in real time, so what a robot takes is in
the time of its chip: from the step in which the message is there to the motor pins. Needs
mosquitto. No radio is in any of it.
"""

from __future__ import annotations

import argparse
import selectors
import socket
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from time import monotonic, sleep

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tests.firmware.test_esp32_broker import at
from tests.machines import esp32
from tests.machines.esp32 import Esp32Robot, Kept
from tests.machines.host_firmware import TICKS
from tests.support.esp32_radio import in_reach
from tests.support.mosquitto import Mosquitto, missing
from tests.support.owners import Keys
from tiniscript.link.transports.broker import Broker

GROUP = "aula"
BOOT_MS, STEP_MS, LIMIT_MS = 6000, 10, 200
NETWORK = ("Aula 3 ñ", "correct horse battery staple, and forty more")
DRIVES, STANDS = "MOTORS 80 80", "MOTORS 0 0"
WAITED_S = 10.0


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Measure the stop of a class at a broker.")
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--times", type=int, default=20, help="of the first row")
    options = parser.parse_args(arguments)
    why = missing() or esp32.missing()
    if why:
        sys.exit(why)
    with tempfile.TemporaryDirectory() as folder:
        broker = Mosquitto(Path(folder))
        try:
            teacher = broker.connected()
            report(options.robots, options.times, broker, teacher)
        finally:
            broker.kill()
    return 0


def report(count: int, times: int, broker: Mosquitto, teacher: Broker) -> None:
    delivered = deliveries(count, times, broker, teacher)
    print(f"{count} robots of a class, one stop for all")
    print(f"to the last of them, in ms: {median(delivered):.1f}, slowest of {times} "
          f"{max(delivered):.1f}")  # fmt: skip
    stood = stops(count, broker, teacher)
    print(f"there, in ms of the chip: {median(stood)}, slowest of {count} {max(stood)}")


def deliveries(count: int, times: int, broker: Mosquitto, teacher: Broker) -> list[float]:
    """Return how many ms one message takes until the last of so many sockets has it, each time."""
    ends = [_subscriber(broker.port, f"bench-{k}") for k in range(count)]
    found = []
    with selectors.DefaultSelector() as ready:
        for end in ends:
            ready.register(end, selectors.EVENT_READ)
        for _ in range(times):
            left = set(ends)
            begun_s = monotonic()
            teacher.stop(GROUP)
            while left and monotonic() - begun_s < WAITED_S:
                for key, _ in ready.select(WAITED_S):
                    key.fileobj.recv(4096)  # type: ignore[union-attr]
                    left.discard(key.fileobj)
            assert not left, "the broker has lost a message"
            found.append((monotonic() - begun_s) * 1000)
            sleep(0.05)
    for end in ends:
        end.close()
    return found


def stops(count: int, broker: Mosquitto, teacher: Broker) -> list[int]:
    """Return how many ms of its chip each robot takes from the message to its pins."""
    robots = [_robot(k, _entries(broker)) for k in range(count)]
    for _ in range(BOOT_MS // STEP_MS):
        _pass(robots, STEP_MS)
        if len(teacher.present(GROUP)) >= count:
            break
    for robot in robots:
        robot.step(b"SI|F(600, 80)\n", 0, TICKS * STEP_MS)
    _pass(robots, STEP_MS)
    assert all(_last(robot) == DRIVES for robot in robots), "not all of them drive"
    teacher.stop(GROUP)
    sleep(1)  # it is in the socket of each by now
    took = []
    for robot in robots:
        begun_ms = robot.now_ms
        while _last(robot) != STANDS and robot.now_ms < begun_ms + LIMIT_MS:
            robot.step(b"", 0, TICKS)
        assert _last(robot) == STANDS, "a robot drives on"
        took.append(robot.now_ms - begun_ms)
    for robot in robots:
        robot.close()
    return took


def _entries(broker: Mosquitto) -> dict[bytes, bytes]:
    """Return what NVS has of a network and of this broker."""
    robot, _ = at(broker, Keys())
    kept = robot.kept().entries
    robot.close()
    return {key: kept[key] for key in (b"wifi", b"broker")}


def _robot(number: int, entries: dict[bytes, bytes]) -> Esp32Robot:
    robot = Esp32Robot(kept=Kept(b"", entries, 0), seed=0x10000000 + number * 0x9E3779)
    in_reach(robot, *NETWORK)
    return robot


def _pass(robots: Sequence[Esp32Robot], milliseconds: int) -> None:
    for robot in robots:
        robot.step(b"", 0, TICKS * milliseconds)


def _last(robot: Esp32Robot) -> str:
    moves = [line.split(" ", 1)[1] for line in robot.did if "MOTORS" in line]
    return moves[-1] if moves else ""


def _subscriber(port: int, name: str) -> socket.socket:
    """Return a socket that waits for the stop of the class."""
    end = socket.create_connection(("127.0.0.1", port))
    client, topic = name.encode(), f"tiniscript/{GROUP}/stop".encode()
    hello = b"\0\4MQTT\4\2\0\0" + len(client).to_bytes(2, "big") + client
    wants = b"\0\1" + len(topic).to_bytes(2, "big") + topic + b"\0"
    end.sendall(bytes((0x10, len(hello))) + hello + bytes((0x82, len(wants))) + wants)
    heard = b""
    while len(heard) < 4 + 5:  # CONNACK and SUBACK
        heard += end.recv(64)
    return end


if __name__ == "__main__":
    sys.exit(main())
