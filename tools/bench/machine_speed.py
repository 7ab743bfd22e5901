"""Times the machines of this computer: C++, C++ as WebAssembly, and Python.

Knows how each is called with as little around it as can be. A time on a busy computer is noisy:
compare machines that were timed in turn.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.util import find_spec
from itertools import cycle
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tiniscript.bytecode.image import HEADER_BYTES
from tiniscript.vm.machine import Machine
from tiniscript.vm.state import DONE, RUNNING
from tiniscript.vm.trace import AnyMachine
from tools.bench.workloads import KIT, Work, check, code_of, image_of

BENCH = ROOT / "vm_arduino" / "extras" / "bench" / "host.cpp"
MACHINE = ROOT / "vm_arduino" / "src" / "vm"
SENSORS = len(KIT.sensors)
BUDGET = 0xFFFF  # instructions in a tick: as many as there can be


class Robot:
    """A robot that costs next to nothing: readings from a list, and what is shown in another."""

    def __init__(self, work: Work) -> None:
        self.readings = cycle(work.thousandths)
        self.shown: list[int] = []

    def read(self, sensor: int) -> int | None:
        return next(self.readings)

    def show(self, value: int, is_yes_no: bool) -> bool:
        self.shown.append(value)
        return True

    def motors(self, left: int, right: int) -> None: ...

    def off(self) -> None: ...

    def beep(self, hertz: int, duration_ms: int) -> None: ...

    def set(self, actuator: int, value: int) -> None: ...


class Timed(NamedTuple):
    """A machine that can run a work and says how many seconds that took."""

    name: str
    missing: str
    seconds: Callable[[Work], float]


def of_host(program: Path) -> Timed:
    """Return the machine built into `program` with -O2."""
    why = "" if shutil.which("g++") else "no g++ on this computer: no C++ machine for it"
    if not why:
        code = [str(BENCH), *map(str, sorted(MACHINE.glob("*.cpp")))]
        subprocess.run(["g++", "-std=c++11", "-O2", *code, "-o", str(program)], check=True)

    def seconds(work: Work) -> float:
        words = [str(program), "200", code_of(work).hex(), *map(str, work.thousandths)]
        said = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
        check("C++ on this computer", work, [int(word) for word in said[2:]], int(said[1]))
        return float(said[0])

    return Timed("C++, g++ -O2", why, seconds)


def of_wasm() -> Timed:
    why = "" if find_spec("wasmtime") else "no wasmtime: the WebAssembly machine does not run"

    def seconds(work: Work) -> float:
        from tiniscript.vm.wasm import WasmImage

        image = image_of(work)
        loaded = WasmImage(image, KIT)
        times = []
        for _ in range(20):
            robot = Robot(work)
            machine = loaded.machine(image[HEADER_BYTES:], robot, SENSORS)
            times.append(_run("WebAssembly", work, robot, machine))
        return sum(times) / len(times)

    return Timed("WebAssembly, wasmtime", why, seconds)


def of_python() -> Timed:
    def seconds(work: Work) -> float:
        robot = Robot(work)
        return _run("Python", work, robot, Machine(code_of(work), robot, SENSORS))

    return Timed("Python", "", seconds)


def _run(name: str, work: Work, robot: Robot, machine: AnyMachine) -> float:
    begun = time.perf_counter()
    while (status := machine.tick(0, BUDGET)) == RUNNING:
        pass
    seconds = time.perf_counter() - begun
    assert status == DONE, status
    check(name, work, robot.shown, machine.steps)
    return seconds
