"""A whole robot in C++ on this computer: its firmware, with the sanitizers of the compiler.

Builds `vm_arduino/extras/host_firmware` with g++. One process is one robot, from power-on to
power-off; the content of its memory passes to the next one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from struct import iter_unpack, pack, unpack
from typing import Any, TypeVar

from tests.machines.host import (
    FLAGS,
    SOURCES,
    Process,
    compile_program,
    files_in,
    first_text,
    texts,
)
from tiniscript.base.kit import Kit
from tiniscript.link.connection import PendingRequest
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.robots.kit_words import kit_words
from tiniscript.robots.profile import language_number

EMPTY_EEPROM = bytes(1024).replace(b"\0", b"\xff")  # contents of a new EEPROM
TICKS = 20  # ticks in a millisecond
POWER_ON, RESET_BUTTON = 1, 2
PASS_SPREAD, PASS_UNTIL_SENT = 1, 2  # ways for time to pass
# The robot's description of itself is wrong after any history.
WRONG_DESCRIPTIONS = ("MARK", "MEASURED", "UNVERIFIED", "CHANGED", "SOUND", "LIGHT", "PROGRAM")
T = TypeVar("T")


class HostFirmware(Process):
    """A robot that is switched on. `write_ms` is the time that its memory takes for a byte,
    `clock_ms` the value of its 32-bit clock at 0 ms.

    One that has no draft reads text where the program is that it holds, as an Uno does.
    """

    has_draft = True
    clock_ms = 0

    def __init__(
        self,
        kit: Kit,
        memory: bytes = EMPTY_EEPROM,
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
        super().__init__([build_host_firmware(sources, defines)], "the C++ robot")
        self.now_ms, self.clock_ms = 0, clock_ms % 2**32
        self.did: list[str] = []
        self.is_lit, self.is_latched = False, True
        head = pack("<HBBB", kit.fingerprint, len(kit.sensors), len(kit.actuators), reset)
        times = pack("<IIB", seed, max_run_ms, int(write_ms * TICKS))
        hashes = pack(f"<{len(kit.hashes)}H", *kit.hashes)
        begin_data = head + times + hashes + texts(memory, kit_words(kit))
        self.ask(b"B", begin_data + pack("<H", language_number(language)))

    def step(self, data: bytes = b"", flags: int = 0, ticks: int = TICKS) -> bytes:
        """Step one millisecond with received bytes; return the bytes sent."""
        self.now_ms += 1
        head = pack("<IBHI", self._clock(self.now_ms), flags, ticks, len(data))
        answer = self.ask(b"S", head + data)
        sent_bytes, rest = first_text(answer)
        action_text, rest = first_text(rest)
        self._note([f"{self.now_ms} {line}" for line in action_text.decode().splitlines()])
        self.is_lit, self.is_latched = bool(rest[0]), bool(rest[1])
        return sent_bytes

    def wait(self, milliseconds: int, data: bytes = b"") -> bytes:
        """Let time pass, at least a millisecond; the bytes arrive at its beginning."""
        return self.latched_while(max(1, milliseconds), data)[0]

    def latched_while(
        self, milliseconds: int, data: bytes = b"", is_spread: bool = False
    ) -> tuple[bytes, list[bool]]:
        """Let time pass in one request; also return whether it was latched after each millisecond.

        Bytes that are spread arrive one in each.
        """
        return self._pass(milliseconds, data, PASS_SPREAD if is_spread else 0)

    def until_sent(self, milliseconds: int) -> bytes:
        """Let time pass, at most until the robot sends something, which is returned."""
        return self._pass(milliseconds, b"", PASS_UNTIL_SENT)[0]

    def _pass(self, milliseconds: int, data: bytes, flags: int) -> tuple[bytes, list[bool]]:
        head = pack("<IIHBI", self._clock(self.now_ms + 1), milliseconds, TICKS, flags, len(data))
        sent_bytes, rest = first_text(self.ask(b"W", head + data))
        action_text, rest = first_text(rest)
        rows = (line.split(" ", 1) for line in action_text.decode().splitlines())
        self._note([f"{(int(ms) - self.clock_ms) % 2**32} {action}" for ms, action in rows])
        self.is_lit = bool(rest[0])
        latch_states = [bool(flag) for flag in first_text(rest[1:])[0]]
        self.now_ms += len(latch_states)
        self.is_latched = latch_states[-1]
        return sent_bytes, latch_states

    def _clock(self, now_ms: int) -> int:
        return (now_ms + self.clock_ms) % 2**32

    def _note(self, lines: list[str]) -> None:
        """Record the robot's actions."""
        self.did += lines
        wrong_lines = [line for line in lines if line.split()[1] in WRONG_DESCRIPTIONS]
        assert not wrong_lines, f"{wrong_lines} after {self.did[-9:]}"

    def push(self, milliseconds: int = 100) -> None:
        """Push the start button, and let it go."""
        self.step(flags=1)
        self.wait(milliseconds)
        self.step(flags=2)

    def set_readings(self, *readings: int) -> None:
        """Set the readings of the sensors, in thousandths."""
        self.ask(b"V", pack(f"<{len(readings)}i", *readings))

    def remote(self) -> tuple[int, ...]:
        """Return the remote control as a program reads it: KEY_UP to KEY_B, PAD_X and PAD_Y."""
        return unpack("<8i", self.ask(b"K", b""))

    def mount_discs(self, cm: int, degrees: int, left: int = 0, right: int = 0) -> None:
        """Put discs on both wheels; the distance between two edges is given as in a robot's header.

        They are this many thousandths of the way after an edge.
        """
        self.ask(b"G", pack("<IIHH", cm, degrees, left, right))

    def hold(self, wheels: int) -> None:
        """Hold the left wheel (1) and the right one (2), and let go of the others."""
        self.ask(b"H", bytes((wheels,)))

    def wheel_edges(self) -> tuple[float, float]:
        """Return the edges passed by both wheels, less those backward."""
        left, right = unpack("<ii", self.ask(b"O", b""))
        return left / 1000, right / 1000

    def set_byte_ticks(self, ticks: int) -> None:
        """Set the ticks that each sent byte takes, as on a slow line."""
        self.ask(b"P", bytes((ticks,)))

    def set_supply(self, is_low: bool) -> None:
        """Lower the voltage below the limit for saving, or restore it."""
        self.ask(b"L", pack("<B", is_low))

    def wear_out(self, place: int) -> None:
        """Make a byte of the memory unchangeable."""
        self.ask(b"D", pack("<H", place))

    def mend(self) -> None:
        """Make all bytes of the memory changeable again."""
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

    def advance_time(self, session: Session | None, milliseconds: int, flags: int = 0) -> None:
        """Let time pass, with an event at its beginning, with or without a computer."""
        if session is not None:
            self.talk(session, min(1, milliseconds), flags)
            self.talk(session, milliseconds - 1)
        elif milliseconds > 0:
            self.step(flags=flags)
            if milliseconds > 1:
                self.wait(milliseconds - 1)

    def _turn(self, session: Session, data: bytes, limit_ms: int, flags: int = 0) -> None:
        """Let a millisecond pass, or more while neither side sends."""
        wake_ms = session.next_wake_ms()
        quiet_ms = limit_ms if wake_ms is None else min(limit_ms, wake_ms - self.now_ms)
        if data or flags or quiet_ms < 2:
            sent_bytes = self.step(data, flags)
        else:
            sent_bytes = self.until_sent(quiet_ms)
        session.receive(sent_bytes, self.now_ms)

    def until(self, session: Session, request: PendingRequest[Any], limit_ms: int = 30_000) -> int:
        """Let a computer talk until its request is over; return its result."""
        end_ms = self.now_ms + limit_ms
        while self.now_ms < end_ms:
            if request.outcome is not None:
                return request.outcome.status
            data = session.poll(self.now_ms)  # polling may end the session
            self._turn(session, data, 1 if request.outcome else end_ms - self.now_ms)
        raise AssertionError(f"the request is not over after {limit_ms} ms: {self.did[-5:]}")

    def complete(self, session: Session, request: PendingRequest[T]) -> T:
        """Let a computer talk until the robot has done a request; return the answer."""
        status = self.until(session, request)
        assert status == OK and request.outcome, status
        return request.outcome.values


@lru_cache
def build_host_firmware(sources: Path, defines: tuple[str, ...] = ()) -> Path:
    """Return the program made from `sources`; an earlier build from the same sources is reused."""
    parts = ("vm", "link", "text", "store", "firmware")
    folders = ("src", *(f"src/{part}" for part in parts), "extras/host_firmware")
    inputs = files_in(sources, *folders)
    flags = (*FLAGS, *(f"-D{define}" for define in defines))
    return compile_program([*inputs, sources / "extras/host" / "wire.h"], flags)


def drives(actions: Sequence[str]) -> list[str]:
    return [line for line in actions if " MOTORS " in line]
