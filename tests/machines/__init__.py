"""The machines that must agree: each runs an image with given senses and returns the trace."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from tests.machines import host, wasm
from tests.machines.python import run_python
from tiniscript.base.kit import Kit
from tiniscript.vm.runner import MAX_STEPS


class Senses(NamedTuple):
    """The input of a run: readings in thousandths by sensor name, and its limits."""

    readings: Mapping[str, Sequence[int]] = {}
    max_ms: int = 60_000
    max_steps: int = MAX_STEPS
    seed: int = 1


Machine = Callable[[bytes, Kit, Senses], str]

# Those that are quick enough for every case; `test_cpp_chips` runs the chips.
MACHINES: dict[str, Machine] = {"python": run_python, "wasm": wasm.run_wasm}
if not host.missing():
    MACHINES["host"] = host.run_host

# Slow machines run one in so many of the random programs.
ONE_IN = {"wasm": 5}
