"""The whole sketch on a simulated ATmega: pins and registers with the cycles of their changes.

Builds `boards/` for a robot with avr-g++ and Debian's Arduino core, and around it
`board_main.cpp`, with another program in the place of the one that is built in.
`simulated_board.c` runs it.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import chain, repeat
from pathlib import Path
from typing import NamedTuple

from tests.machines.host import SOURCES, build_cached, contents
from tests.support.needs import need
from tiniscript import compile_text
from tiniscript.robots import firmware
from tiniscript.robots.ports import AVRS, Bit
from tiniscript.robots.profile import Robot

HERTZ = 16_000_000
MS = HERTZ // 1000  # cycles
ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
SIMAVR = Path("/usr/include/simavr/sim_avr.h")
VARIANTS = {"uno": "standard", "nano": "eightanaloginputs", "mega": "mega"}
CHIPS = {"uno": "atmega328p", "nano": "atmega328p", "mega": "atmega2560"}
FLAGS = (
    "-Os", "-flto", "-ffunction-sections", "-fdata-sections", "-mrelax", "-mcall-prologues",
    "-mstrict-X", "-fno-devirtualize", "-fno-partial-inlining",
    "-fno-gcse", "-fno-tree-sink", "-fno-move-loop-invariants",
    "-fira-algorithm=priority",
    "-DF_CPU=16000000L", "-DARDUINO=10808", "-DDECIMAL_DIG=__DECIMAL_DIG__",
)  # fmt: skip
CPP = ("-std=gnu++11", "-fno-exceptions", "-fno-threadsafe-statics")

# The registers of PWM: control, and the connection of a channel.
CONTROLS = {0: 0x44, 1: 0x80, 2: 0xB0, 3: 0x90, 4: 0xA0, 5: 0x120}
CONNECTIONS = {"a": 0x80, "b": 0x20, "c": 0x08}
PORTS = {
    "a": 0x22, "b": 0x25, "c": 0x28, "d": 0x2B, "e": 0x2E, "f": 0x31, "g": 0x34,
    "h": 0x102, "j": 0x105, "k": 0x108, "l": 0x10B,
}  # fmt: skip
FIRMWARE_ONLY_FILES = ("uart.cpp", "eeprom.cpp")  # files that only the firmware needs
BUILT_IN_PROGRAM = "SB|F(1, 60);B(1, 60);BEEP(0.2, 880)"


# Gaps of simavr for the ATmega2560: changes of ports J and K, and the analog inputs of port K.
_UNSIMULATED_PORTS = {"echo": "jk", "analog": "k"}


def simulates(board: str, pin: int, ability: str) -> bool:
    """Return whether a pin of a board behaves on the simulated chip as on a real one."""
    return board != "mega" or AVRS[board].bit_by_pin[pin].port not in _UNSIMULATED_PORTS.get(
        ability, ""
    )


def missing() -> str:
    """Return the reason why there is no simulated board, or ""."""
    names = [name for name in ("avr-g++", "gcc") if not shutil.which(name)]
    names += [str(path) for path in (ARDUINO, SIMAVR) if not path.exists()]
    return f"no {' and no '.join(names)} on this computer: no simulated board" if names else ""


def run(*words: object) -> str:
    completed = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    assert completed.returncode == 0, f"{words[0]}: {completed.stderr[:4000]}"
    return completed.stdout


@lru_cache(maxsize=1)
def simulator() -> Path:
    source = Path(__file__).with_name("simulated_board.c")
    words = ("-O2", str(source), "-lsimavr", "-lelf")
    made_from = [source.read_bytes(), SIMAVR.read_bytes()]
    return build_cached("gcc", words, made_from, lambda path: run("gcc", *words, "-o", path))


@lru_cache(maxsize=8)
def core(board: str) -> Path:
    """Return the library of the Arduino core for a board."""
    folder = ARDUINO / "cores" / "arduino"
    sources = [*sorted(folder.glob("wiring*.c")), folder / "main.cpp", folder / "hooks.c"]
    return library(sources, flags_of(board, FLAGS))


def library(sources: Sequence[Path], flags: Sequence[str]) -> Path:
    """Return the library of sources of an Arduino core."""

    def make(path: Path) -> None:
        with tempfile.TemporaryDirectory() as name:
            for source in sources:
                compiler = {
                    ".cpp": ("avr-g++", *CPP),
                    ".c": ("avr-gcc", "-std=gnu11"),
                    ".S": ("avr-gcc", "-x", "assembler-with-cpp"),  # no body for -flto
                }[source.suffix]
                target = Path(name) / f"{source.name}.o"
                run(*compiler, *flags, "-w", "-c", source, "-o", target)
            run("avr-gcc-ar", "rcs", path, *sorted(Path(name).glob("*.o")))

    return build_cached("avr-g++", (*flags, *map(str, sources)), contents(ARDUINO / "cores"), make)


def flags_of(board: str, flags: Sequence[str]) -> tuple[str, ...]:
    return (
        f"-mmcu={CHIPS[board]}",
        *flags,
        f"-I{ARDUINO / 'cores' / 'arduino'}",
        f"-I{ARDUINO / 'variants' / VARIANTS[board]}",
    )


def flags_for(header: str) -> tuple[str, ...]:
    """Return the definitions in platformio.ini for the robot of a header."""
    has_discs = "tiniscript_discs" in header
    return ("-Dtiniscript_with_tasks", "-Dtiniscript_with_discs") if has_discs else ()


@lru_cache(maxsize=32)
def build_sketch(header: str, board: str, extra_code: str = "") -> bytes:
    """Return the sketch for the robot of a header, an ELF file; `extra_code` is compiled too."""
    main = Path(__file__).with_name("board_main.cpp")
    no_breakpoints_flag = "-Dtiniscript_without_breakpoints"  # no events about halts or readings
    flags = (*flags_of(board, FLAGS), *flags_for(header), no_breakpoints_flag, *CPP, "-Wall",
             "-Wextra", "-Werror", "-Wl,--gc-sections")  # fmt: skip
    made_from = [header.encode(), extra_code.encode(), main.read_bytes(), bytes(core(board))]

    def make(path: Path) -> None:
        _build(header, extra_code, (*flags, main, core(board)), path)

    return build_cached(
        "avr-g++", flags, [*made_from, *contents(SOURCES / "src")], make
    ).read_bytes()


def _build(header: str, extra_code: str, words: Sequence[object], path: Path) -> None:
    with tempfile.TemporaryDirectory() as name:
        source = Path(shutil.copytree(SOURCES / "src", Path(name) / "src"))
        (source / "boards" / "kits" / "own.h").write_text(header, encoding="utf-8")
        (source / "more.cpp").write_text(extra_code, encoding="utf-8")
        source_paths = [
            path
            for path in sorted(
                [
                    source / "more.cpp",
                    source / "firmware" / "trim.cpp",
                    source / "firmware" / "pace.cpp",
                    *source.rglob("boards/**/*"),
                    *source.rglob("vm/*"),
                ]
            )
            if path.suffix in (".cpp", ".S") and path.name not in FIRMWARE_ONLY_FILES
        ]
        run("avr-g++", *source_paths, f"-I{source}", *words, "-o", path)


class Change(NamedTuple):
    cycle: int
    address: int
    value: int


class Simulated:
    """A sketch on the board of a robot: its inputs, and the watched outputs."""

    def __init__(self, robot: Robot) -> None:
        need(missing())
        self.robot = robot
        self.board = robot.board.chip
        self.avr = AVRS[self.board]
        self.script: list[str] = []
        self.watched: set[int] = set()
        self.events: list[tuple[int, int, bool]] = []
        self.set_level(0, robot.board.start_button, True)  # level of its pull-up

    def bit(self, pin: int) -> Bit:
        return self.avr.bit_by_pin[pin]

    def watch(self, pin: int) -> None:
        """Watch the sketch's output on a pin."""
        self.watched.add(PORTS[self.bit(pin).port])
        if pin in self.avr.compare_by_pin:
            self.watched |= {
                CONTROLS[self.avr.compare_by_pin[pin].timer],
                self.compare_address(pin),
            }

    def compare_address(self, pin: int) -> int:
        timer, channel = self.avr.compare_by_pin[pin]
        number = "abc".index(channel)
        return CONTROLS[timer] + (3 + number if timer in (0, 2) else 8 + 2 * number)

    def set_level(self, ms: float, pin: int, is_high: bool) -> None:
        self.events.append((round(ms * MS), pin, is_high))

    def set_echoes(
        self,
        trigger: int,
        echo: int,
        widths_us: Iterable[float],
        glitches_us: Iterable[tuple[float, float]] = (),
    ) -> None:
        """Set a sensor's answers to its pings; glitches are the times after a ping, and their
        lengths.
        """
        trigger_bit, echo_bit = self.bit(trigger), self.bit(echo)
        none = repeat((0.0, 0.0))
        for width_us, (at_us, span_us) in zip(widths_us, chain(glitches_us, none), strict=False):
            times = (460, width_us, at_us, span_us)
            cycles = " ".join(str(round(us * 16)) for us in times)
            self.script.append(
                f"ping {trigger_bit.port.upper()} {trigger_bit.bit}"
                f" {echo_bit.port.upper()} {echo_bit.bit} {cycles}"
            )

    def simulate(self, elf: Path, ms: float) -> str:
        """Run it for so long; return the simulator's output."""
        lines = [f"watch {address}" for address in sorted(self.watched)]
        for cycle, pin, is_high in sorted(self.events, key=lambda event: event[0]):
            port, bit = self.bit(pin)
            lines.append(f"pin {cycle} {port.upper()} {bit} {int(is_high)}")
        completed = subprocess.run(
            [simulator(), elf, CHIPS[self.board], str(round(ms * MS))],
            input="\n".join([*lines, *self.script]) + "\n",
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert completed.returncode == 0, completed.stderr
        return completed.stdout


class Board(Simulated):
    """A robot's firmware with one program; `ran` runs it."""

    def __init__(self, robot: Robot, text: str = BUILT_IN_PROGRAM, extra_code: str = "") -> None:
        super().__init__(robot)
        elf = build_sketch(firmware.header([robot], "the tests."), self.board, extra_code)
        compilation = compile_text(text, robot.kit)
        assert compilation.image, compilation.diagnostics
        image_before = compile_text(BUILT_IN_PROGRAM, robot.kit).image
        start = elf.index(image_before)
        self.elf = (
            elf[:start] + compilation.image + b"\0" * 4 + elf[start + len(compilation.image) + 4 :]
        )
        self.changes: list[Change] = []
        self.copies: list[dict[int, int]] = []  # watched registers at the end of each
        self.quiet_us = 0.0  # longest time with interrupts off
        for pin in self.motor_pins():
            self.watch(pin)

    # -- before the run

    def watch(self, pin: int) -> None:
        """Watch whether a pin is an output, too."""
        super().watch(pin)
        self.watched.add(PORTS[self.bit(pin).port] - 1)

    def press(self, ms: float, release_ms: float) -> None:
        self.set_level(ms, self.robot.board.start_button, False)
        self.set_level(release_ms, self.robot.board.start_button, True)

    def set_analog(self, channel: int, millivolts: int) -> None:
        self.script.append(f"adc {channel} {millivolts}")

    # -- the run, and its results

    def sweep(self, step: int, count: int, span_us: float, pin: int) -> None:
        """After the run a pin goes high: `count` times, each `step` cycles later."""
        port, bit = self.bit(pin)
        span = round(span_us * 16)
        self.script.append(f"sweep {step} {count} {span} {port.upper()} {bit}")

    def run_for(self, ms: float) -> Board:
        with tempfile.TemporaryDirectory() as name:
            program = Path(name) / "firmware.elf"
            program.write_bytes(self.elf)
            trace = self.simulate(program, ms)
        rows = [line.split() for line in trace.splitlines()]
        end_rows = [row for row in rows if row[1:2] == ["END"]]
        assert end_rows and int(end_rows[0][0]) >= round(ms * MS), trace
        self.changes = [
            Change(*map(int, row))
            for row in rows
            if len(row) == 3 and row[0].isdigit() and row[1].isdigit()
        ]
        for row in rows:
            if row[0] == "COPY":
                numbers = [int(word) for word in row[2:]]
                self.copies.append(dict(zip(numbers[::2], numbers[1::2], strict=True)))
        self.quiet_us = int(end_rows[0][2]) * 1e6 / HERTZ
        return self

    def register(self, address: int, ms: float) -> int:
        """Return the value of a watched register at a time."""
        assert address in self.watched
        value = 0
        for change in self.changes:
            if change.cycle > ms * MS:
                break
            if change.address == address:
                value = change.value
        return value

    def pin(self, pin: int, ms: float) -> str:
        """Return `in`, `low`, `high` or the level of its PWM, at a time."""
        port, bit = self.bit(pin)
        if not self.register(PORTS[port] - 1, ms) >> bit & 1:
            return "pull-up" if self.register(PORTS[port], ms) >> bit & 1 else "in"
        if pin in self.avr.compare_by_pin:
            timer, channel = self.avr.compare_by_pin[pin]
            if self.register(CONTROLS[timer], ms) & CONNECTIONS[channel]:
                return f"pwm {self.register(self.compare_address(pin), ms)}"
        return "high" if self.register(PORTS[port], ms) >> bit & 1 else "low"

    def edges(self, pin: int) -> list[int]:
        """Return the cycles in which the sketch wrote another level to a pin."""
        port, bit = self.bit(pin)
        level, times = 0, []
        for change in self.changes:
            if change.address == PORTS[port] and change.value >> bit & 1 != level:
                level ^= 1
                times.append(change.cycle)
        return times

    def is_off(self, registers: Mapping[int, int]) -> bool:
        """Return whether all motor pins are low outputs without PWM."""
        for pin in self.motor_pins():
            port, bit = self.bit(pin)
            compare = self.avr.compare_by_pin.get(pin)
            if registers[PORTS[port]] >> bit & 1 or not registers[PORTS[port] - 1] >> bit & 1:
                return False
            if compare and registers[CONTROLS[compare.timer]] & CONNECTIONS[compare.channel]:
                return False
        return True

    def motor_pins(self) -> Sequence[int]:
        return tuple(self.robot.board.motors.pins.values())

    def motors(self, ms: float) -> tuple[str, ...]:
        return tuple(self.pin(pin, ms) for pin in self.motor_pins())

    def list_motor_changes(self) -> list[int]:
        """Return the cycles in which a motor pin was written high or got PWM."""
        positions = []
        for change in self.changes:
            for pin in self.motor_pins():
                port, bit = self.bit(pin)
                is_written = change.address == PORTS[port] and change.value >> bit & 1
                compare = self.avr.compare_by_pin.get(pin)
                has_pwm = (
                    compare is not None
                    and change.address == CONTROLS[compare.timer]
                    and change.value & CONNECTIONS[compare.channel]
                )
                if is_written or has_pwm:
                    positions.append(change.cycle)
        return positions
