"""The C++ machine, as the WebAssembly module `machine.wasm`.

Knows how to call the module (`vm_arduino/extras/wasm/main.cpp` is the other side) and what its
numbers mean. Does not know what instructions do, nor what a robot is. Importing this fails where
`wasmtime` is not installed, or cannot run on this computer.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any
from weakref import ref

from wasmtime import Func, FuncType, Instance, Memory, ValType

from tiniscript.bytecode.image import REFUSALS, ImageRefused
from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.bytecode.verify import RULES, Refused
from tiniscript.vm import wasm_store
from tiniscript.vm.state import DONE, FAULT, RUNNING, WAITING, Robot

MODULE = Path(__file__).with_name("machine.wasm")

_STATUSES = (RUNNING, WAITING, DONE, FAULT)
_FAULT_NAMES = {number: name for number, name, _ in FAULTS} | {0: ""}
_RULE_NAMES = {number: name for name, (number, _) in RULES.items()}
_REFUSAL_NAMES = {number: name for name, (number, _) in REFUSALS.items()}

_CLOCK = 1 << 32  # where the clock of the machine wraps around
_BUDGET = 65_535  # instructions, the most of one tick
_NOT_THERE = 1 << 32  # what is no reading


class WasmImage:
    """An image in the memory of a C++ machine of its own, which has read and verified it.

    `close`, the end of a `with`, or the last reference to it ends that, and frees the memory.
    """

    def __init__(self, data: bytes, kit: int, sensors: int, actuators: int) -> None:
        """`kit` is the fingerprint of the robot that shall run it.

        Raises ImageRefused or Refused with the name of the reason.
        """
        self.robot: Robot | None = None
        self._store = wasm_store.store()
        try:
            self._load(data, kit, sensors, actuators)
        except BaseException:
            self.close()
            raise

    def _load(self, data: bytes, kit: int, sensors: int, actuators: int) -> None:
        module = wasm_store.module(MODULE)
        functions = self._robot_functions()
        imports = [functions[each.name or ""] for each in module.imports]
        self._exports = Instance(self._store, module, imports).exports(self._store)
        if len(data) > self.call("room_bytes"):
            raise ImageRefused("TRAILING")  # longer than any image
        memory = self._exports["memory"]
        assert isinstance(memory, Memory)
        memory.write(self._store, data, self.call("room"))
        refusal = self.call("unpack", len(data), kit)
        if refusal:
            raise ImageRefused(_REFUSAL_NAMES[refusal])
        rule = self.call("verify", sensors, actuators)
        if rule:
            raise Refused(_RULE_NAMES[rule], self.call("refused_at"))

    def machine(
        self, code: bytes, robot: Robot, sensors: int = 0, seed: int = 1, now_ms: int = 0
    ) -> WasmMachine:
        """Return the machine, at the beginning of the program. `code` is what it has already.

        It has one machine: another one ends the one before.
        """
        self.robot = robot
        self.call("start", sensors, seed, now_ms % _CLOCK)
        return WasmMachine(self, now_ms)

    def close(self) -> None:
        """Free its memory. It does nothing more then."""
        self._store.close()

    def __enter__(self) -> WasmImage:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        raised: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        self.close()

    def call(self, name: str, *values: int) -> int:
        return int(self.function(name)(*values) or 0)

    def function(self, name: str) -> Callable[..., Any]:
        """Return an exported function, ready to call."""
        function = self._exports[name]
        assert isinstance(function, Func)
        return lambda *values: function(self._store, *values)

    def _robot_functions(self) -> dict[str, Func]:
        """Return what the module imports: `robot.h`, under the names of `task.Robot`."""
        i32, i64 = ValType.i32(), ValType.i64()
        owner = ref(self)  # no more: else it would live for ever, `wasm_store` says why

        def there() -> Robot:
            image = owner()
            assert image is not None and image.robot is not None, "nothing runs yet"
            return image.robot

        def read(sensor: int) -> int:
            value = there().read(sensor)
            return _NOT_THERE if value is None else value

        table: dict[str, tuple[list[ValType], list[ValType], Callable[..., Any]]] = {
            "motors": ([i32, i32], [], lambda left, right: there().motors(left, right)),
            "off": ([], [], lambda: there().off()),
            "read": ([i32], [i64], read),
            "beep": ([i32, i32], [], lambda hertz, ms: there().beep(hertz, ms)),
            "show": ([i32, i32], [i32], lambda value, yes: int(there().show(value, bool(yes)))),
            "set": ([i32, i32], [], lambda actuator, value: there().set(actuator, value)),
        }
        return {
            name: Func(self._store, FuncType(takes, gives), function)
            for name, (takes, gives, function) in table.items()
        }


class WasmMachine:
    """The same as `vm.Machine` from outside, for 2^32 milliseconds: then its clock wraps around."""

    def __init__(self, image: WasmImage, now_ms: int) -> None:
        self.status = RUNNING
        self.wake_ms = now_ms
        self.steps = 0  # instructions that have run
        self._image = image
        self._tick = image.function("tick")

    def tick(self, now_ms: int, budget: int) -> str:
        """Run at most `budget` instructions at the time `now_ms`; return the status."""
        budget = min(budget, _BUDGET)
        said = self._tick(now_ms % _CLOCK, budget)
        half = _CLOCK // 2
        self.wake_ms = now_ms + ((said - now_ms + half) % _CLOCK - half)
        self.steps += budget - (said >> 32 & 0xFFFF)
        self.status = _STATUSES[said >> 48]
        return self.status

    @property
    def fault(self) -> str:
        return _FAULT_NAMES[self._image.call("fault")]

    @property
    def at(self) -> int:
        """Where the instruction that runs, or has faulted, begins."""
        return self._image.call("at")
