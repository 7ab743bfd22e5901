"""Times other interpreters of this computer with the same works, in their own languages.

Knows the works as Python, Lua and WebAssembly, with whole numbers in place of thousandths and
local variables, as each has it best. What a work is told comes as arguments: no compiler can fold
it. Each loop is checked against the same one in this process.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.bench.machine_speed import Timed
from tools.bench.workloads import Work, WrongResult

RUNS = 5  # of a loop, one after the other
NPM_PACKAGE = "@micropython/micropython-webassembly-pyscript"

PYTHON = {
    "A": """
def work(times, k):
    x = 0
    for _ in range(times):
        x += k
    return [x]
""",
    "B": """
def work(times):
    d = e = 0
    for _ in range(times):
        d += 1
        if d > 500:
            e += 1
    return [d, e]
""",
    "C": """
def work(times, p, q, n):
    a = y = 0
    for _ in range(times):
        y += a * p
        y //= q
        y %= n
        a += 1
    return [y, a]
""",
}
PYTHON_TIMED = """
try:
    from time import perf_counter as now
    unit = 1
except ImportError:
    from time import ticks_us as now
    unit = 1e6
begun = now()
for _ in range({runs}):
    shown = work({values})
print((now() - begun) / unit / {runs}, *shown)
"""

LUA = {
    "A": """
local function work(times, k)
  local x = 0
  for _ = 1, times do x = x + k end
  return x
end
""",
    "B": """
local function work(times)
  local d, e = 0, 0
  for _ = 1, times do
    d = d + 1
    if d > 500 then e = e + 1 end
  end
  return d, e
end
""",
    "C": """
local function work(times, p, q, n)
  local a, y = 0, 0
  for _ = 1, times do
    y = y + a * p
    y = y // q
    y = y % n
    a = a + 1
  end
  return y, a
end
""",
}
LUA_TIMED = """
local begun, first, second = os.clock(), 0, nil
for _ = 1, {runs} do first, second = work({values}) end
print(string.format("%.9f", (os.clock() - begun) / {runs}), first, second or "")
"""

# what it shows is in globals; $i counts the times that are left
WEBASSEMBLY = {
    "A": """(module
  (global $x (export "first") (mut i32) (i32.const 0))
  (func (export "work") (param $i i32) (param $k i32) (local $sum i32)
    (loop $again
      (local.set $sum (i32.add (local.get $sum) (local.get $k)))
      (br_if $again (local.tee $i (i32.sub (local.get $i) (i32.const 1)))))
    (global.set $x (local.get $sum))))""",
    "B": """(module
  (global $first (export "first") (mut i32) (i32.const 0))
  (global $second (export "second") (mut i32) (i32.const 0))
  (func (export "work") (param $i i32) (local $d i32) (local $e i32)
    (loop $again
      (local.set $d (i32.add (local.get $d) (i32.const 1)))
      (if (i32.gt_s (local.get $d) (i32.const 500))
        (then (local.set $e (i32.add (local.get $e) (i32.const 1)))))
      (br_if $again (local.tee $i (i32.sub (local.get $i) (i32.const 1)))))
    (global.set $first (local.get $d))
    (global.set $second (local.get $e))))""",
    "C": """(module
  (global $first (export "first") (mut i32) (i32.const 0))
  (global $second (export "second") (mut i32) (i32.const 0))
  (func (export "work") (param $i i32) (param $p i32) (param $q i32) (param $n i32)
      (local $a i32) (local $y i32)
    (loop $again
      (local.set $y (i32.add (local.get $y) (i32.mul (local.get $a) (local.get $p))))
      (local.set $y (i32.div_s (local.get $y) (local.get $q)))
      (local.set $y (i32.rem_s (local.get $y) (local.get $n)))
      (local.set $a (i32.add (local.get $a) (i32.const 1)))
      (br_if $again (local.tee $i (i32.sub (local.get $i) (i32.const 1)))))
    (global.set $first (local.get $y))
    (global.set $second (local.get $a))))""",
}


def all_of_them() -> list[Timed]:
    return [of_wasm3(), of_lua(), of_micropython(), of_python()]


def of_python() -> Timed:
    """Return the Python that runs this."""
    name = f"Python {sys.version_info[0]}.{sys.version_info[1]}"
    return Timed(name, "", lambda work: _by_text(name, work, PYTHON, PYTHON_TIMED, sys.executable))


def of_micropython() -> Timed:
    """Return MicroPython: the program of that name, or the package of npm, which node runs."""
    name = "MicroPython"
    command = [shutil.which("micropython") or ""]
    if not command[0] and (node := shutil.which("node")):
        name = "MicroPython, WebAssembly in node"
        look = f"require.resolve('{NPM_PACKAGE}')"
        done = subprocess.run([node, "-p", look], capture_output=True, text=True, check=False)
        command = [node, done.stdout.strip()] if done.returncode == 0 else [""]
    missing = (
        "no micropython on this computer, and node finds no package "
        f"{NPM_PACKAGE} of npm (NODE_PATH says where)"
    )
    return Timed(
        name,
        "" if command[0] else missing,
        lambda work: _by_text(name, work, PYTHON, PYTHON_TIMED, *command),
    )


def of_lua() -> Timed:
    program = shutil.which("lua5.4") or ""
    missing = "" if program else "no lua5.4 on this computer"
    return Timed("Lua 5.4", missing, lambda work: _by_text("Lua", work, LUA, LUA_TIMED, program))


def of_wasm3() -> Timed:
    """Return the interpreter of WebAssembly; wasmtime makes its modules from text."""
    needed = {"wasm3": "pywasm3", "wasmtime": "wasmtime"}
    lacking = [package for module, package in needed.items() if find_spec(module) is None]

    def seconds(work: Work) -> float:
        import wasm3  # type: ignore[import-not-found,unused-ignore]
        from wasmtime import wat2wasm

        environment = wasm3.Environment()
        runtime = environment.new_runtime(4096)
        module = environment.parse_module(bytes(wat2wasm(WEBASSEMBLY[work.name])))
        runtime.load(module)
        run: Callable[..., Any] = runtime.find_function("work")
        run(*_values(work))  # it is compiled now
        begun = time.perf_counter()
        for _ in range(RUNS):
            run(*_values(work))
        took = (time.perf_counter() - begun) / RUNS
        names = ("first", "second")[: len(expected(work))]
        _check("wasm3", work, [module.get_global(name) for name in names])
        return took

    missing = f"no {' and no '.join(lacking)} of PyPI: wasm3 does not run" if lacking else ""
    return Timed("wasm3", missing, seconds)


def expected(work: Work) -> list[int]:
    """Return what the loop shows in this process."""
    names: dict[str, Any] = {}
    exec(PYTHON[work.name], names)
    shown: list[int] = names["work"](*_values(work))
    return shown


def _values(work: Work) -> list[int]:
    return [work.times, *work.readings]


def _by_text(name: str, work: Work, texts: dict[str, str], timed: str, *command: str) -> float:
    """Return what a program says that an interpreter reads from a file: seconds, and its values."""
    values = ", ".join(map(str, _values(work)))
    handle, path = tempfile.mkstemp(text=True)
    try:
        with os.fdopen(handle, "w") as file:
            file.write(texts[work.name] + timed.format(runs=RUNS, values=values))
        done = subprocess.run([*command, path], check=True, capture_output=True, text=True)
    finally:
        Path(path).unlink()
    seconds, *shown = done.stdout.split()
    _check(name, work, [int(word) for word in shown])
    return float(seconds)


def _check(name: str, work: Work, shown: Sequence[int]) -> None:
    if list(shown) != expected(work):
        raise WrongResult(f"{name}, work {work.name}: {shown}, not {expected(work)}")
