"""A robot with an ESP32 in C++ on this computer: the sketch that ships, on a simulated chip.

Builds `vm_arduino/src` with the stand-ins of `vm_arduino/extras/esp32` for Espressif's core. One
process is one robot from a reset to the next; the contents of NVS, and of the memory that survives
a reset, pass to the next one.
"""

from __future__ import annotations

import os
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from struct import pack, unpack
from typing import NamedTuple

from tests.machines.host import (
    BUILD_CACHE,
    FLAGS,
    SOURCES,
    WARNINGS,
    Process,
    compile_once,
    first_number,
    first_text,
    objects_of,
    texts,
)
from tests.machines.host_firmware import TICKS, HostFirmware
from tiniscript import robots
from tiniscript.robots import firmware
from tiniscript.robots.ports import ESP32S
from tiniscript.robots.profile import Robot

STAND_INS_FOLDER = SOURCES / "extras" / "esp32"
SIMULATED_FILES = (
    "main.cpp",
    "simulated_chip.cpp",
    "simulated_counter.cpp",
    "simulated_radio.cpp",
    "simulated_tls.cpp",
    "tasks_in_turn.cpp",
    "wires.cpp",
)  # extras that are not programs of their own
HAS_TLS = Path("/usr/include/mbedtls/ssl.h").exists()
TLS = ("-lmbedtls", "-lmbedx509", "-lmbedcrypto") if HAS_TLS else ()
POWER_ON, EXTERNAL, PANIC, TASK_WATCHDOG, BROWN_OUT = 1, 2, 4, 6, 9  # esp_reset_reason_t
# faults of NVS: NvsFault in `simulated_chip.h`
NVS_CLOSED, NVS_NUMBERS_FAIL, NVS_BLOBS_FAIL = 1, 2, 3
US_PER_CM = 58.309  # echo time per centimetre


class Kept(NamedTuple):
    """The data that survives a reset: entries of NVS, and uninitialized memory."""

    noinit: bytes
    entries: dict[bytes, bytes]
    writes: int  # writes to NVS since the reset


EMPTY_MEMORY = Kept(b"", {}, 0)


class Esp32Robot(HostFirmware):
    """A robot after a reset. It has the pins of a profile for an ESP32."""

    def __init__(
        self, robot: Robot | None = None, kept_memory: Kept = EMPTY_MEMORY, reset: int = POWER_ON,
        seed: int = 0x12345678, major: int = 2, nvs_fault: int = 0,
        mac: bytes = bytes(6),
    ) -> None:  # fmt: skip
        self.robot = robot or robots.load("tinibot32")
        program = build_esp32(
            firmware.header([self.robot], "a test."), self.robot.board.chip, major
        )
        Process.__init__(self, [program], "the C++ robot with an ESP32")
        self.now_ms = 0
        self.did: list[str] = []
        self.is_lit, self.is_latched = False, True
        entries = texts(*(data for item in kept_memory.entries.items() for data in item))
        head = pack("<BI", reset, seed) + texts(kept_memory.noinit)
        rest = bytes([nvs_fault]) + mac
        self.ask(b"B", head + pack("<I", len(kept_memory.entries)) + entries + rest)

    def read_kept(self) -> Kept:
        noinit, answer = first_text(self.ask(b"E", b""))
        count, answer = first_number(answer)
        entries = {}
        for _ in range(count):
            key, answer = first_text(answer)
            entries[key], answer = first_text(answer)
        return Kept(noinit, entries, first_number(answer)[0])

    def hang(self, milliseconds: int) -> None:
        """Stop the main loop for a while."""
        self.ask(b"H", pack("<I", milliseconds))
        self.now_ms += milliseconds

    def set_analog(self, pin: int, value: int) -> None:
        """Set the analog value of a pin, 0 to 4095."""
        self.ask(b"A", pack("<BH", pin, value))

    def set_level(self, pin: int, is_high: bool) -> None:
        self.ask(b"D", pack("<BB", pin, is_high))

    def edges(self, *changes: tuple[int, int, bool]) -> tuple[int, int]:
        """Change pins in sequence: the microseconds since the previous change, the pin and its
        level.

        Return how many edges of the left and right disc the board has counted, modulo 2**16.
        """
        rows = b"".join(pack("<IBB", *change) for change in changes)
        counts: tuple[int, int] = unpack("<HH", self.ask(b"K", pack("<I", len(changes)) + rows))
        return counts

    def hold_line(self, is_low: bool = True) -> None:
        """Hold the cable's line low for longer than a byte, or release it."""
        self.ask(b"C", pack("<B", is_low))

    def spoil_byte(self) -> None:
        """Give the next byte of the cable a framing error."""
        self.ask(b"C", b"\2")

    def set_sonar_distance(self, trigger: int, echo: int, distance_cm: float) -> None:
        """Set the distance of a sensor's obstacle, or none with 0."""
        self.ask(b"U", pack("<BBI", trigger, echo, round(distance_cm * US_PER_CM)))

    def output(self, pin: int) -> int:
        """Return the output of a pin: 0 to 255, PWM as its share."""
        return self.ask(b"O", pack("<B", pin))[0]

    def panic(self) -> None:
        """Start a panic of the chip, after which only its pins count."""
        self.ask(b"X", b"")

    def stick_ledc(self) -> None:
        """Make LEDC ignore all further commands."""
        self.ask(b"L", b"")

    def radio(self, command: str, data: bytes = b"") -> bytes:
        """Cause an event on the other side of a radio: `answer_radio` of `main.cpp`."""
        return self.ask(b"R", command.encode() + data)

    def measure_motor_delay(self) -> tuple[int, float]:
        """Return the turns of the main loop, and the microseconds of this computer, before a motor
        pin changed in the last step.
        """
        turns, ns, _ = unpack("<III", self.ask(b"M", b""))
        return turns, ns / 1000

    def rests(self) -> int:
        """Return how many times the main loop has yielded to the idle task."""
        return int.from_bytes(self.ask(b"M", b"")[8:12], "little")

    def erase(self, milliseconds: int) -> None:
        """Make each write of NVS stop the chip for so long."""
        self.ask(b"Z", pack("<I", milliseconds))

    def fill_nvs(self, room: int = 0) -> None:
        """Leave room for so many entries: a number takes one, a blob three and more."""
        self.ask(b"F", bytes([room]))


def flags_of(chip: str, major: int) -> tuple[str, ...]:
    """Return the compiler flags of Espressif's core for a chip."""
    return (
        "-DARDUINO=10805", "-DARDUINO_ARCH_ESP32", f"-DESP_ARDUINO_VERSION_MAJOR={major}",
        f"-D{ESP32S[chip]}=1", f"-isystem{STAND_INS_FOLDER / 'core'}",
    )  # fmt: skip


@lru_cache
def build_esp32(header: str, chip: str, major: int) -> Path:
    """Return the program for the robot of a header; an earlier build is reused.

    Only files that depend on the robot's pins are compiled for each robot.
    """
    header_path = BUILD_CACHE / f"own-{sha256(header.encode()).hexdigest()[:16]}.h"
    if not header_path.exists():  # another worker may look for the file too
        draft = header_path.with_suffix(f".{os.getpid()}")
        draft.write_text(header, encoding="utf-8")
        draft.replace(header_path)
    files = {
        path: path.name.encode() + path.read_bytes()
        for part in ("src", "extras/esp32", "extras/host")
        for path in sorted((SOURCES / part).rglob("*"))
        if path.suffix in (".h", ".cpp") and path.name != "own.h"
    }
    usual = (*FLAGS, *flags_of(chip, major), *WARNINGS)
    of_boards = ("-Wno-shadow", "-Wno-conversion", f'-Dtiniscript_own="{header_path}"')

    def is_extra_source(path: Path) -> bool:
        is_stand_in = path.parent == STAND_INS_FOLDER and path.name in SIMULATED_FILES
        return path.suffix == ".cpp" and "extras" in path.parts and not is_stand_in

    def flags(path: Path) -> tuple[str, ...]:
        is_own = path.parent.name in ("boards", "esp32", "src")
        return (*usual, *of_boards) if is_own else usual

    used_files = {path: text for path, text in files.items() if not is_extra_source(path)}
    objects = objects_of("g++", BUILD_CACHE, used_files, flags)
    return compile_once(
        "g++", BUILD_CACHE, "", usual, [name.encode() for name in objects], [*objects, *TLS]
    )


assert TICKS == 20  # turns in a millisecond, as `main.cpp` has them
