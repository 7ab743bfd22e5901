"""Damaged frames and the receiver in C++ on this computer, hundreds of thousands a second.

Builds `vm_arduino/extras/damage` with the very receiver of a robot, without sanitizers, which would
take three times as long.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from struct import pack
from typing import NamedTuple

from tests.machines.host import SOURCES, Process, compile_program, first_number, first_text

FLAGS = ("-std=c++11", "-O2")
LARGE = ("-Dtiniscript_like_esp32",)


class DamagedLine(NamedTuple):
    """`data` arrives; `frames` were sent, from the type to the end of the payload."""

    data: bytes
    frames: list[bytes]
    is_damaged: list[bool]
    accepted: list[bytes]


class CppDamage(Process):
    """`sources` is a folder like `vm_arduino`. A line is determined by a seed and its number."""

    def __init__(self, sources: Path = SOURCES, is_large: bool = False) -> None:
        super().__init__([build_damage_tool(sources, is_large)], "the receiver in C++")

    def damage_frames(self, seed: int, line: int, lines: int) -> int:
        """Damage frames of so many lines; return how many. Raise an error on a violation."""
        answer = self.ask(b"J", pack("<III", seed, line, lines))
        wrong_frames = answer[8:].decode()
        assert not wrong_frames, f"{wrong_frames} of seed {seed}"
        return int.from_bytes(answer[:4], "little")

    def typed_stops(
        self, seed: int, line: int, lines: int, is_damaged: bool = False, is_odd: bool = True
    ) -> tuple[int, int]:
        """Send frames of so many lines; return how many, and the typed stops found in them.

        It counts the damaged lines. A quarter of the odd ones is made of five values, LF and S
        among them; others have any bytes.
        """
        answer = self.ask(b"F", pack("<IIBBI", seed, line, is_damaged, is_odd, lines))
        return int.from_bytes(answer[:4], "little"), int.from_bytes(answer[4:], "little")

    def type_after(self, seed: int, prefix: int, prefixes: int) -> None:
        """Type a stop after so many prefixes. Raise an error on a violation."""
        wrong_frames = self.ask(b"T", pack("<III", seed, prefix, prefixes))[4:].decode()
        assert not wrong_frames, f"{wrong_frames} of seed {seed}"

    def line(self, seed: int, line: int) -> DamagedLine:
        data, answer = first_text(self.ask(b"L", pack("<II", seed, line)))
        damaged_line = DamagedLine(data, [], [], [])
        count, answer = first_number(answer)
        for _ in range(count):
            damaged_line.is_damaged.append(bool(answer[0]))
            frame, answer = first_text(answer[1:])
            damaged_line.frames.append(frame)
        count, answer = first_number(answer)
        for _ in range(count):
            frame, answer = first_text(answer)
            damaged_line.accepted.append(frame)
        return damaged_line


def build_damage_tool(sources: Path, is_large: bool) -> Path:
    code = (
        "src/link/receiver.cpp", "src/link/typed_stop.cpp", "src/link/frames.cpp",
        "src/vm/crc32.cpp", "src/vm/find_word.cpp",
    )  # fmt: skip
    inputs = [sources / name for name in (*code, "extras/damage/main.cpp", "extras/host/wire.h")]
    for folder in ("vm", "link", "boards/esp32"):
        inputs += sorted((sources / "src" / folder).glob("*.h"))
    return compile_program(inputs, (*FLAGS, *LARGE * is_large))


@lru_cache(maxsize=2)
def cpp_damage(is_large: bool = False) -> CppDamage:
    """Return the process that all tests of a worker share."""
    return CppDamage(is_large=is_large)
