"""A whole robot in C++ on this computer: its firmware, with the sanitizers of the compiler.

Builds `vm_arduino/extras/host_firmware` with g++. One process is one robot, from power-on to
power-off; what its memory holds goes on to the next one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from struct import iter_unpack, pack, unpack
from typing import Any, TypeVar

from tests.machines.host import FLAGS, SOURCES, Process, compiled, files_in, first_text, texts
from tiniscript.base.kit import Kit
from tiniscript.link.connection import PendingRequest
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.robots.kit_words import kit_words
from tiniscript.robots.profile import language_number

EMPTY = bytes(1024).replace(b"\0", b"\xff")  # what a new EEPROM holds
TICKS = 20  # in a millisecond
POWER_ON, RESET_BUTTON = 1, 2
SPREAD, UNTIL_SENT = 1, 2  # how time passes
# What it says of itself is wrong whatever it was told.
WRONG = ("MARK", "MEASURED", "UNVERIFIED", "CHANGED", "SOUND", "LIGHT", "PROGRAM")
T = TypeVar("T")


class HostFirmware(Process):
    """A robot that is switched on. `write_ms` is how long its memory takes for a byte, `clock_ms`
    what its clock of 32 bits says at 0 ms.

    One that has no draft reads text where the program is that it holds, as an Uno does.
    """

    has_draft = True
    clock_ms = 0

    def __init__(
        self,
        kit: Kit,
        memory: bytes = EMPTY,
        reset: int = POWER_ON,
        seed: int = 0x12345678,
        max_run_ms: int = 600_000,
        write_ms: float = 3.4,
        sources: Path = SOURCES,
        language: str = "en",
        defines: tuple[str, ...] = (),
        clock_ms: int = 0,
    ) -> None:
        if not self.has_draft:
            defines += ("tiniscript_no_draft",)
        super().__init__([built(sources, defines)], "the C++ robot")
        self.now_ms, self.clock_ms = 0, clock_ms % 2**32
        self.did: list[str] = []
        self.is_lit, self.is_latched = False, True
        head = pack("<HBBB", kit.fingerprint, len(kit.sensors), len(kit.actuators), reset)
        times = pack("<IIB", seed, max_run_ms, int(write_ms * TICKS))
        hashes = pack(f"<{len(kit.hashes)}H", *kit.hashes)
        begin = head + times + hashes + texts(memory, kit_words(kit))
        self.ask(b"B", begin + pack("<H", language_number(language)))

    def step(self, data: bytes = b"", flags: int = 0, ticks: int = TICKS) -> bytes:
        """Let a millisecond pass in which bytes arrive; return what is sent."""
        self.now_ms += 1
        head = pack("<IBHI", self._clock(self.now_ms), flags, ticks, len(data))
        answer = self.ask(b"S", head + data)
        sent, rest = first_text(answer)
        did, rest = first_text(rest)
        self._note([f"{self.now_ms} {line}" for line in did.decode().splitlines()])
        self.is_lit, self.is_latched = bool(rest[0]), bool(rest[1])
        return sent

    def wait(self, milliseconds: int, data: bytes = b"") -> bytes:
        """Let time pass, at least a millisecond; the bytes arrive at its beginning."""
        return self.latched_while(max(1, milliseconds), data)[0]

    def latched_while(
        self, milliseconds: int, data: bytes = b"", is_spread: bool = False
    ) -> tuple[bytes, list[bool]]:
        """The same, in one request; return also whether it was latched after each millisecond.

        Bytes that are spread arrive one in each.
        """
        return self._pass(milliseconds, data, SPREAD if is_spread else 0)

    def until_sent(self, milliseconds: int) -> bytes:
        """Let time pass, at most until the robot sends something; return that."""
        return self._pass(milliseconds, b"", UNTIL_SENT)[0]

    def _pass(self, milliseconds: int, data: bytes, how: int) -> tuple[bytes, list[bool]]:
        head = pack("<IIHBI", self._clock(self.now_ms + 1), milliseconds, TICKS, how, len(data))
        sent, rest = first_text(self.ask(b"W", head + data))
        did, rest = first_text(rest)
        rows = (line.split(" ", 1) for line in did.decode().splitlines())
        self._note([f"{(int(ms) - self.clock_ms) % 2**32} {what}" for ms, what in rows])
        self.is_lit = bool(rest[0])
        latched = [bool(flag) for flag in first_text(rest[1:])[0]]
        self.now_ms += len(latched)
        self.is_latched = latched[-1]
        return sent, latched

    def _clock(self, now_ms: int) -> int:
        return (now_ms + self.clock_ms) % 2**32

    def _note(self, lines: list[str]) -> None:
        """Note what the robot has done."""
        self.did += lines
        wrong = [line for line in lines if line.split()[1] in WRONG]
        assert not wrong, f"{wrong} after {self.did[-9:]}"

    def push(self, milliseconds: int = 100) -> None:
        """Push the start button, and let it go."""
        self.step(flags=1)
        self.wait(milliseconds)
        self.step(flags=2)

    def sense(self, *readings: int) -> None:
        """Let the sensors say so many thousandths."""
        self.ask(b"V", pack(f"<{len(readings)}i", *readings))

    def remote(self) -> tuple[int, ...]:
        """Return what a program would read: KEY_UP to KEY_B, PAD_X and PAD_Y."""
        return unpack("<8i", self.ask(b"K", b""))

    def discs(self, cm: int, degrees: int, left: int = 0, right: int = 0) -> None:
        """Put discs on both wheels; what they go between two edges is as a robot's header says it.

        They stand so many thousandths of the way after an edge.
        """
        self.ask(b"G", pack("<IIHH", cm, degrees, left, right))

    def hold(self, wheels: int) -> None:
        """Hold the left wheel (1) and the right one (2), and let go of the others."""
        self.ask(b"H", bytes((wheels,)))

    def wheel_edges(self) -> tuple[float, float]:
        """Return how many edges both wheels have gone, less those that they went back."""
        left, right = unpack("<ii", self.ask(b"O", b""))
        return left / 1000, right / 1000

    def pace(self, ticks: int) -> None:
        """Let each byte that the robot sends take so many ticks, as on a slow line."""
        self.ask(b"P", bytes((ticks,)))

    def supply(self, is_low: bool) -> None:
        """Let the voltage be too low to save anything, or enough."""
        self.ask(b"L", pack("<B", is_low))

    def wear_out(self, place: int) -> None:
        """Let a byte of the memory keep what it is."""
        self.ask(b"D", pack("<H", place))

    def mend(self) -> None:
        """Let each byte of the memory change again."""
        self.ask(b"M", b"")

    def levels(self, trim: bytes) -> tuple[bool, list[tuple[int, int]]]:
        """Return whether a trim is sound, and its levels of both wheels for -128 to 127 percent."""
        answer = self.ask(b"T", trim)
        return bool(answer[0]), list(iter_unpack("<hh", answer[1:]))

    def codes(self) -> list[bytes]:
        """Return the codes that were started since this was asked last."""
        codes, rest = [], self.ask(b"C", b"")
        while rest:
            code, rest = first_text(rest)
            codes.append(code)
        return codes

    def memory(self) -> bytes:
        return first_text(self.ask(b"E", b""))[0]

    def talk(self, session: Session, milliseconds: int, flags: int = 0) -> None:
        """Let a computer talk with the robot for a while."""
        end_ms = self.now_ms + milliseconds
        while self.now_ms < end_ms:
            data = session.poll(self.now_ms)
            self._turn(session, data, end_ms - self.now_ms, flags)

    def pass_time(self, session: Session | None, milliseconds: int, flags: int = 0) -> None:
        """Let time pass, at whose beginning something happens, while a computer talks or none."""
        if session is not None:
            self.talk(session, min(1, milliseconds), flags)
            self.talk(session, milliseconds - 1)
        elif milliseconds > 0:
            self.step(flags=flags)
            if milliseconds > 1:
                self.wait(milliseconds - 1)

    def _turn(self, session: Session, data: bytes, most_ms: int, flags: int = 0) -> None:
        """Let a millisecond pass, or more while neither has anything to say."""
        wakes_ms = session.wakes_at()
        quiet_ms = most_ms if wakes_ms is None else min(most_ms, wakes_ms - self.now_ms)
        if data or flags or quiet_ms < 2:
            sent = self.step(data, flags)
        else:
            sent = self.until_sent(quiet_ms)
        session.receive(sent, self.now_ms)

    def until(self, session: Session, request: PendingRequest[Any], limit_ms: int = 30_000) -> int:
        """Let a computer talk until its request is over; return how that ended."""
        end_ms = self.now_ms + limit_ms
        while self.now_ms < end_ms:
            if request.outcome is not None:
                return request.outcome.status
            data = session.poll(self.now_ms)  # which can end it
            self._turn(session, data, 1 if request.outcome else end_ms - self.now_ms)
        raise AssertionError(f"the request is not over after {limit_ms} ms: {self.did[-5:]}")

    def complete(self, session: Session, request: PendingRequest[T]) -> T:
        """Let a computer talk until the robot has done a request; return what it answers."""
        status = self.until(session, request)
        assert status == OK and request.outcome, status
        return request.outcome.values


@lru_cache
def built(sources: Path, defines: tuple[str, ...] = ()) -> Path:
    """Return the program made from `sources`; what was made before from the same is used again."""
    parts = ("vm", "link", "text", "store", "firmware")
    folders = ("src", *(f"src/{part}" for part in parts), "extras/host_firmware")
    inputs = files_in(sources, *folders)
    flags = (*FLAGS, *(f"-D{define}" for define in defines))
    return compiled([*inputs, sources / "extras/host" / "wire.h"], flags)


def drives(did: Sequence[str]) -> list[str]:
    return [line for line in did if " MOTORS " in line]
