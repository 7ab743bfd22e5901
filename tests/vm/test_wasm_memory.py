"""Machines and virtual robots that are done with give back their memory and their addresses."""

from __future__ import annotations

import subprocess
import sys

import pytest

LIMIT_BYTES = 1 << 30  # limit of the address space: less than wasmtime needs for one memory
MACHINES = """
from contextlib import closing
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import ImageRefused
from tiniscript.vm.wasm import WasmImage
kit = robots.load("tinibot").kit
image = compile_text("F(1, 50)", kit).image

def loaded(data=image):
    return WasmImage(data, kit)
"""
ROBOTS = """
from tiniscript import robots
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.worlds import load
profile, world = robots.load("tinibot"), load("obstacles")
"""


def run_with_limit(code: str) -> str:
    """Return the output of Python code with an address space of LIMIT_BYTES."""
    limit = f"import resource\nresource.setrlimit(resource.RLIMIT_AS, ({LIMIT_BYTES},) * 2)\n"
    completed = subprocess.run(
        [sys.executable, "-c", limit + code], capture_output=True, text=True, check=False
    )
    assert completed.returncode == 0, completed.stderr[-2000:]
    return completed.stdout


@pytest.mark.sampled("statement", keep=2)
@pytest.mark.parametrize("statement", [
    "loaded()",
    "loaded().machine(image, None)",
    "with closing(loaded()) as one: one.machine(image, None)",
    "try: loaded(image[:-1])\n    except ImageRefused: pass",
    "one = loaded(); one.myself = one; one.close()",
])  # fmt: skip
def test_two_thousand_successive_machines_take_bounded_memory(statement: str) -> None:
    """However one ends: forgotten, refused, or closed while something still knows it."""
    code = f"{MACHINES}\nfor k in range(2000):\n    {statement}\nprint(k + 1)"
    assert run_with_limit(code) == "2000\n"


def test_two_hundred_machines_run_at_once() -> None:
    assert run_with_limit(f"{MACHINES}\nprint(len([loaded() for k in range(200)]))") == "200\n"


def test_repeated_power_cycles_take_bounded_memory() -> None:
    code = f"""{ROBOTS}
robot = VirtualRobot(profile, world)
for k in range(1000):
    robot.power_cycle()
    robot.step(robot.now_ms + 10)
print(k + 1)"""
    assert run_with_limit(code) == "1000\n"


def test_many_successive_virtual_robots_take_bounded_memory() -> None:
    code = (
        f"{ROBOTS}\nfor k in range(1000):\n    VirtualRobot(profile, world).step(10)\nprint(k + 1)"
    )
    assert run_with_limit(code) == "1000\n"
