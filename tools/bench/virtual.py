"""How much faster than a real robot the virtual one is: `python -m tools.bench.virtual`.

Each program drives for a minute of the robot's time: in this process, with nobody at its port,
in seconds of the processor; and as a whole `tsc upload --virtual --hurry max`, with the start of
the process, the upload and the heartbeat, in seconds on the wall.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from time import perf_counter, process_time

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tests.support.virtual_robot import Talk
from tiniscript import robots
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import VirtualRobot

SECONDS = 60
RUNS = 3
PROGRAMS = (
    # program, robot, world
    ("obstacle.ts", "tinibot", "obstacles"),
    ("obstacle_until.ts", "tinibot", "obstacles"),
    ("light.ts", "tinibot", "light"),
    ("line.ts", "liner", "line"),
)


def main() -> None:
    print(f"{'program':20} {'world':10} {'robot alone':>12} {'tsc upload':>12}   times real time")
    for name, robot, world in PROGRAMS:
        alone = max(SECONDS / _alone_s(name, robot, world) for _ in range(RUNS))
        whole = max(SECONDS / _whole_s(name, robot, world) for _ in range(RUNS))
        print(f"{name:20} {world:10} {alone:12.0f} {whole:12.0f}")


def _alone_s(name: str, robot: str, world: str) -> float:
    virtual = VirtualRobot(robots.load(robot), worlds.load(world))
    text = (ROOT / "examples" / name).read_text(encoding="utf-8")
    Talk(virtual).upload(text, is_detached=True)
    began_s = process_time()
    virtual.step(virtual.now_ms + SECONDS * 1000)
    return process_time() - began_s


def _whole_s(name: str, robot: str, world: str) -> float:
    command = [sys.executable, "-m", "tiniscript", "upload", str(ROOT / "examples" / name),
               "--virtual", "--robot", robot, "--world", world, "--hurry", "max",
               "--for", str(SECONDS)]  # fmt: skip
    began_s = perf_counter()
    subprocess.run(command, check=True, capture_output=True, cwd=ROOT / "compiler")
    return perf_counter() - began_s


if __name__ == "__main__":
    main()
