"""The C++ machine, as the WebAssembly module `machine.wasm`.

Knows how to call the module (`vm_arduino/extras/wasm/main.cpp` is the other side) and what its
numbers mean. Does not know what instructions do, nor what a robot is. Importing this fails where
`wasmtime` is not installed, or cannot run on this computer.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from struct import pack
from weakref import ref

from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import REFUSALS, ImageRefused
from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.bytecode.verify import RULES, Refused
from tiniscript.vm.state import CLOCK_MS, DONE, FAULT, RUNNING, WAITING, Robot
from tiniscript.vm.wasm_store import Instance

MODULE = Path(__file__).with_name("machine.wasm")

_STATUSES = (RUNNING, WAITING, DONE, FAULT)
_FAULT_NAMES = {number: name for number, name, _ in FAULTS} | {0: ""}
_RULE_NAMES = {number: name for name, (number, _) in RULES.items()}
_REFUSAL_NAMES = {number: name for name, (number, _) in REFUSALS.items()}

_HALF_CLOCK_MS = CLOCK_MS // 2
_MAX_STEPS = 65_535  # instructions, the most of one tick

# Positions of numbers in `Exchange` of `main.cpp`
_NOW_MS, _LEFT, _WAKE_MS, _STATUS, _FIRST, _SECOND, _ANSWER, _IS_ANSWERED = range(8)
_NUMBERS = 8


class WasmImage:
    """An image in the memory of a C++ machine of its own, which has read and verified it.

    `close`, or the loss of the last reference, frees the memory.
    """

    def __init__(self, data: bytes, kit: Kit) -> None:
        """`kit` is that of the robot that shall run it.

        Raises ImageRefused or Refused with the name of the reason.
        """
        self.robot: Robot | None = None
        self._instance = Instance(MODULE, self._robot_functions())
        self.call, self.tick = self._instance.call, self._instance.functions["tick"]
        start = self.call("exchange") // 4
        self.exchange = self._instance.numbers[start : start + _NUMBERS]
        try:
            self._load(data, kit)
        except BaseException:
            self.close()
            raise

    def _load(self, data: bytes, kit: Kit) -> None:
        if len(data) > self.call("room_bytes"):
            raise ImageRefused("TRAILING")  # longer than any image
        write = self._instance.write
        write(data, self.call("room"))
        write(pack(f"<{len(kit.hashes)}H", *kit.hashes), self.call("hashes"))
        write(pack("<II", kit.speed, kit.turn), self.call("speeds"))
        refusal_number = self.call("unpack", len(data))
        if refusal_number:
            raise ImageRefused(_REFUSAL_NAMES[refusal_number])
        rule_number = self.call("verify", len(kit.readings), len(kit.actuators))
        if rule_number:
            raise Refused(_RULE_NAMES[rule_number], self.call("refused_at"))
        refusal_number = self.call("compare")
        if refusal_number:
            raise ImageRefused(_REFUSAL_NAMES[refusal_number])

    def machine(
        self, code: bytes, robot: Robot, sensor_count: int = 0, seed: int = 1, now_ms: int = 0
    ) -> WasmMachine:
        """Return the machine, at the beginning of the program. The image already holds `code`.

        An image has one machine: a new one ends the previous one.
        """
        self.robot = robot
        self.call("start", sensor_count, seed, now_ms % CLOCK_MS)
        return WasmMachine(self, now_ms)

    def close(self) -> None:
        """Free its memory. It cannot be used again."""
        self.exchange.release()  # the memory is about to be freed
        self._instance.close()

    def _robot_functions(self) -> dict[str, Callable[[], None]]:
        """Return the module's imports: `robot.h`, under the names of `state.Robot`."""
        image_of = ref(self)  # released, because otherwise it would live forever: see `wasm_store`

        def robot_function(call: Callable[[Robot, memoryview[int]], object]) -> Callable[[], None]:
            def function() -> None:
                image = image_of()
                assert image is not None and image.robot is not None, "nothing runs yet"
                call(image.robot, image.exchange)

            return function

        def read(robot: Robot, numbers: memoryview[int]) -> None:
            value = robot.read(numbers[_FIRST])
            numbers[_IS_ANSWERED] = value is not None
            numbers[_ANSWER] = value or 0

        def show(robot: Robot, numbers: memoryview[int]) -> None:
            numbers[_IS_ANSWERED] = robot.show(numbers[_FIRST], bool(numbers[_SECOND]))

        return {
            "motors": robot_function(
                lambda robot, numbers: robot.motors(numbers[_FIRST], numbers[_SECOND])
            ),
            "off": robot_function(lambda robot, numbers: robot.off()),
            "read": robot_function(read),
            "beep": robot_function(
                lambda robot, numbers: robot.beep(numbers[_FIRST], numbers[_SECOND])
            ),
            "show": robot_function(show),
            "set": robot_function(
                lambda robot, numbers: robot.set(numbers[_FIRST], numbers[_SECOND])
            ),
        }


class WasmMachine:
    """A machine with the interface of `vm.Machine`."""

    def __init__(self, image: WasmImage, now_ms: int) -> None:
        self.status = RUNNING
        self.wake_ms = now_ms
        self.steps = 0  # instructions that have run
        self._image = image

    def tick(self, now_ms: int, most_steps: int) -> str:
        """Run at most `most_steps` instructions at the time `now_ms`; return the status."""
        most_steps = min(most_steps, _MAX_STEPS)
        numbers = self._image.exchange
        numbers[_NOW_MS] = (now_ms + _HALF_CLOCK_MS) % CLOCK_MS - _HALF_CLOCK_MS
        numbers[_LEFT] = most_steps
        self._image.tick()
        self.wake_ms = now_ms + (
            (numbers[_WAKE_MS] - now_ms + _HALF_CLOCK_MS) % CLOCK_MS - _HALF_CLOCK_MS
        )
        self.steps += most_steps - numbers[_LEFT]
        self.status = _STATUSES[numbers[_STATUS]]
        return self.status

    @property
    def fault(self) -> str:
        return _FAULT_NAMES[self._image.call("fault")]

    @property
    def offset(self) -> int:
        """Return the start of the current or faulty instruction."""
        return self._image.call("at")

    @property
    def shown_at(self) -> int:
        """Return the place of the SHOW whose value the robot gets."""
        return self._image.call("shown_at")
