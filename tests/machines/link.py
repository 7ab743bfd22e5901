"""The robot's half of the link in C++ on this computer, with the sanitizers of the compiler.

Builds `vm_arduino/extras/link` with g++ and talks to one process of it, as `host` does for the
machine. Long conversations use a library: without sanitizers, and many times as fast.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from struct import pack
from typing import NamedTuple

from tests.machines.host import (
    FLAGS,
    SOURCES,
    Process,
    compile_program,
    files_in,
    first_text,
    texts,
)
from tiniscript import robots
from tiniscript.robots.kit_words import kit_words

# Results of the machine.
VERIFIER = ("bytecode", "crc32", "decode_form", "find_word", "image", "verify")
LIBRARY = ("-std=c++11", "-O1", "-shared", "-fPIC")


class Step(NamedTuple):
    """The bytes that the robot has sent, and its actions, one per line."""

    sent: bytes
    did: list[str]


class CppLink:
    """A robot with the C++ link. One that is large has the frames and the window of an ESP32."""

    is_large: bool

    def ask(self, letter: bytes, request: bytes) -> bytes:
        raise NotImplementedError

    def begin(
        self,
        room: int = 389,
        kit: int = 0x231B,
        sensors: int = 3,
        actuators: int = 0,
        epoch: int = 9,
    ) -> None:
        """Switch a robot on: its devices are those of tinibot, as far as it has them."""
        numbers = pack("<HHBBB", room, kit, sensors, actuators, epoch)
        hashes = (*robots.load("tinibot").kit.hashes, *range(510))[: sensors + actuators]
        begin_data = numbers + pack(f"<{len(hashes)}H", *hashes)
        self.ask(b"B", begin_data + texts(kit_words(robots.load("tinibot").kit)))

    def step(
        self, now_ms: int, data: bytes = b"", is_late: bool = False, is_slow: bool = False
    ) -> Step:
        """Bytes arrive; a late robot processes none of them before the last.

        If the line back is slow, no byte leaves the robot before all have arrived.
        """
        delay_code = 2 if is_slow else is_late
        answer = self.ask(b"S", pack("<IBI", now_ms, delay_code, len(data)) + data)
        sent_bytes, rest = first_text(answer)
        action_text, _ = first_text(rest)
        return Step(sent_bytes, action_text.decode().splitlines())

    def let_happen(self, letter: str, value: int = 0) -> bool:
        """Let something happen to the robot: done, fault, show, button, run by the button, wait."""
        return bool(self.ask(b"R", letter.encode() + pack("<I", value & 0xFFFFFFFF))[0])

    def packets(self, stream: Sequence[tuple[int, int]], held_ms: int = 0) -> list[str]:
        """Return the packets that a receiver finds in times and bytes, in the form of
        `packets_of`.
        """
        parts = b"".join(pack("<HB", now_ms & 0xFFFF, byte) for now_ms, byte in stream)
        packets, _ = first_text(self.ask(b"I", pack("<BI", held_ms, len(stream)) + parts))
        return packets.decode().splitlines()

    def siphash(self, key: bytes, message: bytes) -> bytes:
        return self.ask(b"H", key + texts(message))

    def seal(
        self, key: bytes, origin: bytes, heard_counter: int, sent_counter: int, frame: bytes
    ) -> bytes:
        """Return a frame of the robot, from its type to its MAC; or no bytes if no counter is
        left."""
        body = b"\0" + frame[:3] + bytes(5) + frame[3:]
        answer = self._seal(key, origin, heard_counter, sent_counter, body, b"")
        return first_text(answer)[0][1:]

    def opens(self, key: bytes, origin: bytes, heard_counter: int, frame: bytes) -> bool:
        """Return whether the robot takes a frame, from its type to its MAC."""
        return bool(self._seal(key, origin, heard_counter, 0, bytes(9), b"\0" + frame)[-1])

    def _seal(
        self,
        key: bytes,
        origin: bytes,
        heard_counter: int,
        sent_counter: int,
        own: bytes,
        payload: bytes,
    ) -> bytes:
        return self.ask(
            b"X", key + origin + pack("<II", heard_counter, sent_counter) + texts(own, payload)
        )

    def fetch_image(self) -> bytes:
        """Return the image that the robot holds."""
        return first_text(self.ask(b"M", b""))[0]


class LinkProcess(Process, CppLink):
    """A link process with sanitizers. `sources` is a folder like `vm_arduino`."""

    def __init__(self, sources: Path = SOURCES, is_large: bool = False) -> None:
        super().__init__([build_link(sources, is_large)], "the C++ link")
        self.is_large = is_large


class LinkLibrary(CppLink):
    """It runs within this process, so it waits for no other one. An abort ends this process."""

    def __init__(self, is_large: bool = False) -> None:
        self.is_large = is_large
        library = ctypes.CDLL(str(build_link(SOURCES, is_large, LIBRARY)))
        self._answer = library.link_answer
        self._answer.restype = ctypes.c_void_p

    def ask(self, letter: bytes, request: bytes) -> bytes:
        full_request, length = letter + request, ctypes.c_uint32()
        answer = self._answer(full_request, len(full_request), ctypes.byref(length))
        return ctypes.string_at(answer, length.value)


@lru_cache
def build_link(sources: Path, is_large: bool = False, flags: tuple[str, ...] = FLAGS) -> Path:
    """Return the program or the library made from `sources`, or an earlier build from the same."""
    inputs = files_in(sources, "src/vm", "src/link", "src/text", "extras/link")
    inputs.append(sources / "extras/host" / "wire.h")
    # the machine is not asked here, only its verifier and its checksum
    flags = (*flags, "-Dtiniscript_like_esp32") if is_large else flags
    paths = [path for path in inputs if path.parent.name != "vm" or is_needed(path)]
    return compile_program(paths, flags)


def is_needed(path: Path) -> bool:
    return path.suffix == ".h" or path.stem in VERIFIER


@lru_cache(maxsize=2)
def cpp_link(is_large: bool = False) -> CppLink:
    """Return the process that all tests of a worker share."""
    return LinkProcess(is_large=is_large)


@lru_cache(maxsize=2)
def link_library(is_large: bool = False) -> LinkLibrary:
    """Return the one of this process: a library has one robot."""
    return LinkLibrary(is_large)
