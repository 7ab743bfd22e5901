"""The C++ machine, as the WebAssembly module `machine.wasm`.

Knows how to call the module (`vm_arduino/extras/wasm/main.cpp` is the other side) and what its
numbers mean. Does not know what instructions do, nor what a robot is. Importing this fails where
`wasmtime` is not installed, or cannot run on this computer.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from struct import pack
from types import TracebackType
from typing import Any
from weakref import ref

from wasmtime import Func, FuncType, Instance, Memory

from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import REFUSALS, ImageRefused
from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.bytecode.verify import RULES, Refused
from tiniscript.vm import wasm_store
from tiniscript.vm.state import CLOCK_MS, DONE, FAULT, RUNNING, WAITING, Robot

MODULE = Path(__file__).with_name("machine.wasm")

_STATUSES = (RUNNING, WAITING, DONE, FAULT)
_FAULT_NAMES = {number: name for number, name, _ in FAULTS} | {0: ""}
_RULE_NAMES = {number: name for name, (number, _) in RULES.items()}
_REFUSAL_NAMES = {number: name for name, (number, _) in REFUSALS.items()}

_HALF = CLOCK_MS // 2
_BUDGET = 65_535  # instructions, the most of one tick

# Where numbers are in `Exchange` of `main.cpp`
_NOW_MS, _LEFT, _WAKE_MS, _STATUS, _FIRST, _SECOND, _ANSWER, _IS_ANSWERED = range(8)
_NUMBERS = 8


class WasmImage:
    """An image in the memory of a C++ machine of its own, which has read and verified it.

    `close`, the end of a `with`, or the loss of the last reference frees the memory.
    """

    def __init__(self, data: bytes, kit: Kit) -> None:
        """`kit` is that of the robot that shall run it.

        Raises ImageRefused or Refused with the name of the reason.
        """
        self.robot: Robot | None = None
        self.exchange: memoryview[int] | None = None
        self._store = wasm_store.store()
        try:
            self._load(data, kit)
        except BaseException:
            self.close()
            raise

    def _load(self, data: bytes, kit: Kit) -> None:
        module = wasm_store.module(MODULE)
        functions = self._robot_functions()
        imports = [functions[each.name or ""] for each in module.imports]
        self._exports = Instance(self._store, module, imports).exports(self._store)
        if len(data) > self.call("room_bytes"):
            raise ImageRefused("TRAILING")  # longer than any image
        memory = self._exports["memory"]
        assert isinstance(memory, Memory)
        memory.write(self._store, data, self.call("room"))
        first = self.call("exchange") // 4
        numbers = wasm_store.numbers(self._store, memory)
        self.exchange = numbers[first : first + _NUMBERS]
        hashes = kit.hashes
        memory.write(self._store, pack(f"<{len(hashes)}H", *hashes), self.call("hashes"))
        speeds = pack("<II", kit.speed, kit.turn)
        memory.write(self._store, speeds, self.call("speeds"))
        refusal = self.call("unpack", len(data))
        if refusal:
            raise ImageRefused(_REFUSAL_NAMES[refusal])
        rule = self.call("verify", len(kit.sensors), len(kit.actuators))
        if rule:
            raise Refused(_RULE_NAMES[rule], self.call("refused_at"))
        refusal = self.call("compare")
        if refusal:
            raise ImageRefused(_REFUSAL_NAMES[refusal])

    def machine(
        self, code: bytes, robot: Robot, sensors: int = 0, seed: int = 1, now_ms: int = 0
    ) -> WasmMachine:
        """Return the machine, at the beginning of the program. The image already holds `code`.

        An image has one machine: a new one ends the previous one.
        """
        self.robot = robot
        self.call("start", sensors, seed, now_ms % CLOCK_MS)
        assert self.exchange is not None, "the image is closed"
        return WasmMachine(self, self.exchange, now_ms)

    def close(self) -> None:
        """Free its memory. It cannot be used again."""
        if self.exchange is not None:
            self.exchange.release()  # its memory is about to be freed
            self.exchange = None
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
        return wasm_store.called(self._store, function)

    def _robot_functions(self) -> dict[str, Func]:
        """Return what the module imports: `robot.h`, under the names of `state.Robot`."""
        owner = ref(self)  # no more: else it would live for ever, `wasm_store` says why

        def asked() -> tuple[Robot, memoryview[int]]:
            image = owner()
            assert image is not None and image.robot is not None, "nothing runs yet"
            assert image.exchange is not None
            return image.robot, image.exchange

        def motors() -> None:
            robot, numbers = asked()
            robot.motors(numbers[_FIRST], numbers[_SECOND])

        def off() -> None:
            asked()[0].off()

        def read() -> None:
            robot, numbers = asked()
            value = robot.read(numbers[_FIRST])
            numbers[_IS_ANSWERED] = value is not None
            numbers[_ANSWER] = value or 0

        def beep() -> None:
            robot, numbers = asked()
            robot.beep(numbers[_FIRST], numbers[_SECOND])

        def show() -> None:
            robot, numbers = asked()
            numbers[_IS_ANSWERED] = robot.show(numbers[_FIRST], bool(numbers[_SECOND]))

        def set_actuator() -> None:
            robot, numbers = asked()
            robot.set(numbers[_FIRST], numbers[_SECOND])

        table: dict[str, Callable[[], None]] = {
            "motors": motors, "off": off, "read": read, "beep": beep, "show": show,
            "set": set_actuator,
        }  # fmt: skip
        return {
            name: Func(self._store, FuncType([], []), function) for name, function in table.items()
        }


class WasmMachine:
    """The same as `vm.Machine` from outside."""

    def __init__(self, image: WasmImage, exchange: memoryview[int], now_ms: int) -> None:
        self.status = RUNNING
        self.wake_ms = now_ms
        self.steps = 0  # instructions that have run
        self._image = image
        self._exchange = exchange
        self._tick = image.function("tick")

    def tick(self, now_ms: int, budget: int) -> str:
        """Run at most `budget` instructions at the time `now_ms`; return the status."""
        budget = min(budget, _BUDGET)
        numbers = self._exchange
        numbers[_NOW_MS] = (now_ms + _HALF) % CLOCK_MS - _HALF
        numbers[_LEFT] = budget
        self._tick()
        self.wake_ms = now_ms + ((numbers[_WAKE_MS] - now_ms + _HALF) % CLOCK_MS - _HALF)
        self.steps += budget - numbers[_LEFT]
        self.status = _STATUSES[numbers[_STATUS]]
        return self.status

    @property
    def fault(self) -> str:
        return _FAULT_NAMES[self._image.call("fault")]

    @property
    def at(self) -> int:
        """Where the instruction that runs, or has faulted, begins."""
        return self._image.call("at")
