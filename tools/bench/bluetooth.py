"""How long a new `tsc upload` over Bluetooth LE takes until the robot moves, and its bytes.

    python -m tools.bench.bluetooth [runs]

`SI|F(5, 80)`, from the start of the process to the first motor command in the robot: through a new
connection by address and by name, and through that of a `tsc link`. The radio is a BlueZ of the
tests, which takes no time: what a real one adds (the advertisement, the connection, its intervals)
is not in these figures. The UART behind it has 9600 baud.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tests.support.ble_robot import HM10, NAME, NORDIC, PLACE, BleRobot, missing
from tests.support.command import Command
from tests.support.fake_bluez import FakeBluez
from tests.support.pty_robot import PtyRobot
from tiniscript import robots
from tools.bench.compiler import table

RUNS = 9
LIMIT_S = 20.0
UPLOAD = ("upload", "-e", "SI|F(5, 80)", "--detach", "--no-save")
TSC = (sys.executable, "-m", "tiniscript")


class Figures:
    """Medians of some uploads: ms until motion; bytes and writes to the robot and from it."""

    def __init__(self, rows: list[tuple[float, int, int, int, int]]) -> None:
        medians = [statistics.median(each) for each in zip(*rows, strict=True)]
        self.moves_ms = medians[0]
        self.there, self.writes, self.back, self.notifications = map(int, medians[1:])

    @property
    def row(self) -> tuple[str, ...]:
        return (f"{self.moves_ms:.0f} ms", f"{self.there} in {self.writes}",
                f"{self.back} in {self.notifications}")  # fmt: skip


def upload(ble: BleRobot, port: str) -> tuple[float, int, int, int, int]:
    if subprocess.run([*TSC, "stop", "--port", port], stdout=subprocess.DEVNULL).returncode:
        raise RuntimeError("the robot did not stop")
    heard, said = len(ble.written), len(ble.said)
    begin_s = time.perf_counter()
    process = subprocess.Popen([*TSC, *UPLOAD, "--port", port], stdout=subprocess.DEVNULL)
    while not ble.robot.moves:
        time.sleep(0.0003)
        if time.perf_counter() - begin_s > LIMIT_S:
            raise RuntimeError("the robot did not move")
    took_ms = (time.perf_counter() - begin_s) * 1000
    if process.wait():
        raise RuntimeError("the upload failed")
    there = [data for _, data in ble.written[heard:]]
    back = ble.said[said:]
    return took_ms, sum(map(len, there)), len(there), sum(map(len, back)), len(back)


def measured(service: str, port: str, is_held: bool, runs: int) -> Figures:
    with FakeBluez() as bluez, PtyRobot(robots.load("tinibot").kit, bytes_per_ms=1) as pty_robot:
        os.environ["DBUS_SYSTEM_BUS_ADDRESS"] = bluez.address
        ble = BleRobot(pty_robot, service=service, mtu=23 if service == HM10 else 185)
        bluez.add(ble)
        holder = Command("link", "--port", port) if is_held else None
        if holder is not None:
            holder.until("share this port")
        upload(ble, port)  # what is cached is cached now
        figures = Figures([upload(ble, port) for _ in range(runs)])
        if holder is not None:
            holder.process.kill()
            holder.process.communicate()
        return figures


def main() -> int:
    why = missing()
    if why:
        print(why, file=sys.stderr)
        return 1
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else RUNS
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        for name, service in (("HM-10", HM10), ("Nordic UART", NORDIC)):
            for how, port, is_held in (
                ("by address", PLACE, False), ("by name", NAME, False), ("tsc link", PLACE, True),
            ):  # fmt: skip
                rows.append((f"{name}, {how}", *measured(service, port, is_held, runs).row))
    head = ("", "until it moves", "bytes in writes", "bytes back in notifications")
    table("`SI|F(5, 80)` over Bluetooth LE, medians", head, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
