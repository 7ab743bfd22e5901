"""The virtual robot's speed compared with a real one: `python -m tools.bench.virtual`.

Each program drives for a minute of the robot's time in this process, without a client, in seconds
of processor time.
"""

from __future__ import annotations

from time import process_time

from tests.support.virtual_robot import Talk
from tiniscript import robots
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import VirtualRobot
from tools import ROOT
from tools.bench import page

RUN_SECONDS = 60
RUN_COUNT = 3
PROGRAMS = (
    # program, robot, world
    ("obstacle.ts", "tinibot", "obstacles"),
    ("obstacle_until.ts", "tinibot", "obstacles"),
    ("light.ts", "tinibot", "light"),
    ("line.ts", "liner", "line"),
)
ROWS = tuple(f"`{name}`" for name, _, _ in PROGRAMS)


def main() -> None:
    figure_rows = []
    for name, robot_name, world_name in PROGRAMS:
        speedup = max(
            RUN_SECONDS / _run_alone_s(name, robot_name, world_name) for _ in range(RUN_COUNT)
        )
        figure_rows.append((f"`{name}`", f"`{world_name}`", f"{speedup:,.0f}"))
    page.show("virtual", figure_rows)


def _run_alone_s(name: str, robot_name: str, world_name: str) -> float:
    virtual_robot = VirtualRobot(robots.load(robot_name), worlds.load(world_name))
    text = (ROOT / "examples" / name).read_text(encoding="utf-8")
    Talk(virtual_robot).upload(text, is_detached=True)
    began_s = process_time()
    virtual_robot.step(virtual_robot.now_ms + RUN_SECONDS * 1000)
    return process_time() - began_s


if __name__ == "__main__":
    main()
