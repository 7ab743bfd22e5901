"""An Arduino sketch of `tsc show --arduino` on a simulated Uno, Nano or Mega.

Builds it with avr-g++ and the whole of Debian's Arduino core, and reports the activity of its pins
and its UART: signals that have a value from a time on, in milliseconds.
"""

from __future__ import annotations

import tempfile
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from tests.machines import board as boards
from tests.machines.board import ARDUINO, CONNECTIONS, CONTROLS, CPP, HERTZ, MS, PORTS, run
from tests.machines.host import build_cached
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.driver import Bridge
from tiniscript.robots.drivers import motors_of
from tiniscript.robots.profile import Robot

FLAGS = ("-Os", "-flto", "-ffunction-sections", "-fdata-sections", "-DF_CPU=16000000L",
         "-DARDUINO=10808", "-DDECIMAL_DIG=__DECIMAL_DIG__")  # fmt: skip
TIMER_2 = {"mask": 0x70, "control": 0xB1, "top": 0xB3}
PRESCALERS = (0, 1, 8, 32, 64, 128, 256, 1024)
SERVO_KEYS = ("left_pin", "right_pin")

Signal = list[tuple[float, tuple[int, ...]]]  # values, each from a time on


class Ran(NamedTuple):
    """The observed actions of a sketch."""

    motors: Signal  # left and right, in percent
    tones: Signal  # hertz, or 0
    pins: dict[int, Signal]  # 0 or 1
    text: str
    sent_ms: list[float]  # time at which each byte was sent


@lru_cache(maxsize=4)
def core(board: str) -> Path:
    """Return the library of the whole Arduino core for a board."""
    sources = sorted((ARDUINO / "cores" / "arduino").glob("*.[cS]*"))
    return boards.library(sources, boards.flags_of(board, FLAGS))


def build_sketch(sketch: str, board: str) -> Path:
    """Return the ELF file of a sketch, which must compile without a warning."""
    words = (*boards.flags_of(board, FLAGS), *CPP, "-Wall", "-Wextra", "-Werror",
             "-Wl,--gc-sections")  # fmt: skip

    def make(path: Path) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "sketch.cpp"
            file.write_text(sketch, encoding="utf-8")
            run("avr-g++", *words, file, core(board), "-o", path)

    elf = build_cached("avr-g++", words, [sketch.encode(), bytes(core(board))], make)
    if board != "mega":  # the sketch must fit an Uno, with room for the stack
        text, data, zeros = map(int, run("avr-size", elf).splitlines()[1].split()[:3])
        assert text + data <= 32_256 and data + zeros <= 1_700, (text, data, zeros)
    return elf


class SketchBoard(boards.Simulated):
    """A sketch on the board of a robot; `ran` runs it."""

    def __init__(self, robot: Robot, sketch: str) -> None:
        super().__init__(robot)
        self.elf = build_sketch(sketch, self.board)
        self.script.append("uart")

    def set_counts(self, pin: int, counts: list[int]) -> None:
        """Set the results of a pin's conversions; the last one repeats."""
        channel = pin - (CHIPS[self.board].first_analog or 0)
        self.script += [f"next {channel} {-(-count * 5000 // 1023)}" for count in counts]

    def run_for(self, ms: float) -> Ran:
        board = self.robot.board
        device_pins = [actuator.pins["pin"] for actuator in board.actuators]
        device_pins += [
            pin for key, pin in board.motors.pins.items() if key in ("standby", *SERVO_KEYS)
        ]
        self.watched |= set(TIMER_2.values())
        for pin in {*board.motors.pins.values(), *device_pins}:
            self.watch(pin)
        return self._parse_output(self.simulate(self.elf, ms), device_pins)

    def _parse_output(self, printed_text: str, device_pins: list[int]) -> Ran:
        register_values: dict[int, int] = {}
        run = Ran([], [], {pin: [] for pin in device_pins}, "", [])
        letters = bytearray()
        for line in printed_text.splitlines():
            words = line.split()
            if not words or not words[0].isdigit():
                continue
            if words[1] == "UART":
                letters.append(int(words[2]))
                run.sent_ms.append(int(words[0]) / MS)
            elif words[1] != "END":
                register_values[int(words[1])] = int(words[2])
                ms = int(words[0]) / MS
                _note(run.motors, ms, self._motors(register_values))
                _note(run.tones, ms, (self._hertz(register_values),))
                for pin in device_pins:
                    _note(run.pins[pin], ms, (self._level(register_values, pin),))
        return run._replace(text=letters.decode("ascii"))

    def _level(self, register_values: dict[int, int], pin: int) -> int:
        """Return the average level of a pin, 0 to 255."""
        port, bit = self.bit(pin)
        if pin in self.avr.compare_by_pin:
            timer, channel = self.avr.compare_by_pin[pin]
            if register_values.get(CONTROLS[timer], 0) & CONNECTIONS[channel]:
                return register_values.get(self.compare_address(pin), 0)
        return 255 if register_values.get(PORTS[port], 0) >> bit & 1 else 0

    def _motors(self, register_values: dict[int, int]) -> tuple[int, ...]:
        driver, pins, _ = self.robot.board.motors
        powers = []
        for side in ("left", "right"):
            if driver == "servos":
                powers.append(0)
                continue
            forward = self._level(register_values, pins[f"{side}_forward"])
            backward_pin = pins.get(f"{side}_backward")  # some boards make it of the other
            backward = (
                self._level(register_values, backward_pin)
                if backward_pin is not None
                else 255 - forward
            )
            if isinstance(motors_of(self.robot.board.motors), Bridge):
                level = self._level(register_values, pins[f"{side}_pwm"])
                forward, backward = level * (forward > 0), level * (backward > 0)
            powers.append(round((forward - backward) / 2.55))
        return tuple(powers)

    @staticmethod
    def _hertz(register_values: dict[int, int]) -> int:
        if not register_values.get(TIMER_2["mask"], 0) & 2:
            return 0
        divides = PRESCALERS[register_values.get(TIMER_2["control"], 0) & 7]
        return (
            HERTZ // (2 * divides * (register_values.get(TIMER_2["top"], 0) + 1)) if divides else 0
        )


def _note(signal: Signal, ms: float, value: tuple[int, ...]) -> None:
    if not signal or signal[-1][1] != value:
        signal.append((ms, value))
