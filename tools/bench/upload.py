"""The time from a new `tsc upload` until the robot moves.

    python -m tools.bench.upload [runs]

The paper's obstacle program, from the start of the process to the first motor command in the robot:
with the port opened by the command itself, and with the port held by `tsc monitor --hold`; compared
in turn with a process that does nothing. The robot is the whole firmware on this computer, on a
pseudo-terminal.

Then thirty robots: until the last of them moves, and until the last has stopped.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time

from tests.machines.host import missing
from tests.support.pty_robot import PtyRobot
from tests.support.robot_fleet import RobotFleet
from tiniscript import robots
from tools import ROOT
from tools.bench import page

RUN_COUNT = 21
UPLOAD_TIMEOUT_S = 20.0
CROWD_SIZE = 30
UPLOAD_COMMAND = ("upload", str(ROOT / "examples" / "obstacle.ts"), "--detach", "--no-save")
BYTES_PER_MS = 12  # about 115200 baud
ROWS = (
    "with `tsc monitor --hold` on the port",
    "opening the port itself (this resets an Uno, which takes 1.4 s more)",
    "for comparison: a Python process that does nothing",
    "`upload` to thirty robots, until the last one moves",
    "`stop` of thirty robots, until the last one has stopped",
)


def environment(folder: str) -> dict[str, str]:
    """Return the variables of a command that uses a folder as its cache."""
    return {"PYTHONPATH": str(ROOT / "compiler"), "XDG_CACHE_HOME": folder, "LC_ALL": "C.UTF-8"}


class Bench:
    """A robot on a port, and processes that are timed."""

    def __init__(self, pty_robot: PtyRobot, folder: str) -> None:
        self.pty_robot = pty_robot
        self.environ = environment(folder)

    def start(self, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "tiniscript", *arguments, "--port", self.pty_robot.port]
        return subprocess.Popen(
            command, env=self.environ, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )

    def measure_nothing_ms(self) -> float:
        begin_s = time.perf_counter()
        subprocess.run([sys.executable, "-c", "pass"], env=self.environ, check=True)
        return (time.perf_counter() - begin_s) * 1000

    def measure_move_ms(self) -> float:
        """Return the time from the start of an upload to motion."""
        if self.start("stop").wait():
            raise RuntimeError("the robot did not stop")
        begin_s = time.perf_counter()
        upload = self.start(*UPLOAD_COMMAND)
        while not self.pty_robot.moves:
            time.sleep(0.0003)
            if time.perf_counter() - begin_s > UPLOAD_TIMEOUT_S:
                raise RuntimeError("the robot did not move")
        took_ms = (time.perf_counter() - begin_s) * 1000
        if upload.wait():
            raise RuntimeError("the upload failed")
        return took_ms


def measure(bench: Bench, run_count: int) -> tuple[float, float]:
    """Return the medians (ms) of an upload and of a process that does nothing, taken in turn."""
    bench.measure_move_ms()  # fills the caches
    pairs = [(bench.measure_move_ms(), bench.measure_nothing_ms()) for _ in range(run_count)]
    moves_ms, nothing_ms = (statistics.median(times_ms) for times_ms in zip(*pairs, strict=True))
    return moves_ms, nothing_ms


def measure_crowd_ms(count: int, run_count: int, folder: str) -> tuple[float, float]:
    """Return the median times (ms) until all of some robots move, and until all have stopped."""
    environ = environment(folder)
    moving_ms, stopping_ms = [], []
    with RobotFleet([robots.load("tinibot").kit] * count) as fleet:
        ports = [word for pupil in fleet.pupils for word in ("--port", pupil.port)]

        def measure_ms(verb: tuple[str, ...], is_moving: bool) -> float:
            begin_s = time.perf_counter()
            command = subprocess.Popen(
                [sys.executable, "-m", "tiniscript", *verb, *ports], env=environ,
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            )  # fmt: skip
            fleet.until(
                lambda: all(pupil.moves is is_moving for pupil in fleet.pupils), "all do it"
            )
            took_s = time.perf_counter() - begin_s
            if command.wait():
                raise RuntimeError(f"tsc {verb[0]} failed")
            return took_s * 1000

        for _ in range(run_count):
            moving_ms.append(measure_ms(UPLOAD_COMMAND, True))
            stopping_ms.append(measure_ms(("stop",), False))
    return statistics.median(moving_ms), statistics.median(stopping_ms)


def main() -> int:
    if missing():
        print(missing(), file=sys.stderr)
        return 2
    run_count = int(sys.argv[1]) if len(sys.argv) > 1 else RUN_COUNT
    kit = robots.load("tinibot").kit
    with (
        tempfile.TemporaryDirectory() as folder,
        PtyRobot(kit, bytes_per_ms=BYTES_PER_MS) as pty_robot,
    ):
        bench = Bench(pty_robot, folder)
        holder = bench.start("monitor", "--hold")
        assert holder.stdout
        holder.stdout.readline()
        held_ms, _ = measure(bench, run_count)
        holder.terminate()
        holder.wait()
        opening_ms, nothing_ms = measure(bench, run_count)
        figures_ms = (
            held_ms,
            opening_ms,
            nothing_ms,
            *measure_crowd_ms(CROWD_SIZE, max(1, run_count // 3), folder),
        )
    page.show("upload", [(row, f"{ms:.0f} ms") for row, ms in zip(ROWS, figures_ms, strict=True)])
    return 0


if __name__ == "__main__":
    sys.exit(main())
