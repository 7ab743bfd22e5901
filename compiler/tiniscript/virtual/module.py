"""The robot's firmware, as a WebAssembly module: one instance is one power-on.

`robot.wasm` has the memory and the link of an Uno, `robot_mega.wasm` and `robot_esp32.wasm` those
of a Mega and of an ESP32. `robot_discs.wasm` is an Uno with discs, which reads no text.

Knows how to call the module (`vm_arduino/extras/wasm/robot.cpp` is the other side). Does not know
what a robot does in its world: a `Board` is told.
"""

from __future__ import annotations

import sys
from pathlib import Path
from struct import pack
from typing import NamedTuple, Protocol
from weakref import WeakMethod

PATH = Path(__file__).with_name("robot.wasm")
PATH_DISCS = Path(__file__).with_name("robot_discs.wasm")
PATH_MEGA = Path(__file__).with_name("robot_mega.wasm")
PATH_ESP32 = Path(__file__).with_name("robot_esp32.wasm")

POWER_ON, RESET_BUTTON = 1, 2  # why it begins
NO_OFFSET = (1 << 32) - 1


class NoWebAssembly(Exception):
    """`wasmtime` is not installed, or cannot run on this computer; the text says why."""


class Board(Protocol):
    """The outputs of the firmware; `now_ms` counts from power-on. Numbers are thousandths."""

    def motors(self, now_ms: int, left: int, right: int) -> None: ...
    def read(self, now_ms: int, sensor: int, remote: int) -> int: ...
    def beep(self, now_ms: int, hertz: int, duration_ms: int) -> None: ...
    def show(self, now_ms: int, value: int, is_yes_no: int, offset: int) -> None: ...
    def set(self, now_ms: int, actuator: int, value: int) -> None: ...
    def stop(self, now_ms: int) -> None: ...
    def release(self, now_ms: int) -> None: ...
    def light(self, now_ms: int, is_on: int) -> None: ...
    def on_finish(self, now_ms: int) -> None: ...
    def on_fault(self, now_ms: int) -> None: ...
    def actuators_off(self, now_ms: int) -> None: ...
    def steer(self, now_ms: int, left: int, right: int) -> None: ...
    def edges(self, now_ms: int) -> int: ...


# Kinds of notes, from 1 on, with their number of values. Like `What` in `robot.cpp`.
_NOTE_KINDS = (("motors", 2), ("read", 2), ("beep", 2), ("show", 3), ("set", 2), ("stop", 0),
         ("release", 0), ("light", 1), ("on_finish", 0), ("on_fault", 0),
         ("actuators_off", 0), ("steer", 2), ("edges", 0))  # fmt: skip
_ASKING_KINDS = (2, 13)  # kinds of questions that expect a number
_CLOCK_MODULUS_MS = 1 << 32
_NOTE_NUMBERS = 5  # numbers of 32 bits


class FirmwareSettings(NamedTuple):
    """The settings with which a firmware is switched on.

    `kit_words` are those of the kit, as its reader of text keeps them, and `hashes` those of its
    devices; `edge_cm` and `edge_degrees` are what the firmware knows of discs, `has_two_channels`
    says whether they have two channels; `byte_us` is how long a byte takes on the line, both ways
    (0: none); `eeprom_us` how long one takes in the memory that keeps programs. `language` is the
    number of that of its answers to text.
    """

    kit_words: bytes
    hashes: tuple[int, ...]
    kit: int
    sensors: int
    actuators: int
    reset: int
    seed: int
    max_run_ms: int
    speed: int
    turn: int
    edge_cm: int
    edge_degrees: int
    has_two_channels: bool
    byte_us: int
    eeprom_us: int
    language: int


class Firmware:
    """A running firmware, the one of the module `path`.

    `memory` is the content of its EEPROM; None: the EEPROM is empty.
    """

    def __init__(
        self,
        board: Board,
        settings: FirmwareSettings,
        memory: bytes | None = None,
        path: Path = PATH,
    ) -> None:
        """Raises NoWebAssembly."""
        try:
            if sys.platform == "emscripten":  # inside a page
                from tiniscript.vm.page_wasm import Instance
            else:
                from tiniscript.vm.wasm_store import Instance
        except (ImportError, OSError, RuntimeError) as error:
            raise NoWebAssembly(str(error)) from None
        weak_handler = WeakMethod(self._handle_notes)  # see `wasm_store` for the reason

        def on_look() -> None:
            handler = weak_handler()
            assert handler is not None, "switched off"
            handler()

        self._instance = Instance(path, {"look": on_look})
        self.call = self._instance.call
        self._numbers = self._instance.numbers
        self._inbox, self._outbox = self.call("inbox"), self.call("outbox")
        self._box_bytes = self.call("box_bytes")
        self._eeprom, size = self.call("memory_at"), self.call("memory_bytes")
        self.memory_bytes = size
        self._waiting_bytes = bytearray()  # bytes after those in the inbox
        self._notes_index, self._note_count_index = self.call("notes") // 4, self.call("noted") // 4
        self._reading_index = self.call("reading") // 4
        self.is_watched = False  # whether its program may be paused
        self._handlers = [(getattr(board, name), count) for name, count in _NOTE_KINDS]
        full_memory = ((memory or b"") + bytes(size).replace(b"\0", b"\xff"))[:size]
        self._instance.write(full_memory, self._eeprom)
        hashes = pack(f"<{len(settings.hashes)}H", *settings.hashes)
        self._instance.write(hashes, self.call("hashes"))
        # Otherwise it knows none of the words.
        if len(settings.kit_words) <= self.call("word_bytes"):
            self._instance.write(settings.kit_words, self.call("words"))
        self.call("begin", *map(int, settings[2:]))
        self._handle_notes()

    def run(self, until_us: int, data: bytes = b"") -> bytes:
        """Run until `until_us`, with `data` as received bytes. Return the bytes sent meanwhile.

        Returns earlier where the program is held.
        """
        self._waiting_bytes += data
        sent_bytes = bytearray()
        while True:
            if self._waiting_bytes and not self.call("unheard"):
                chunk = bytes(self._waiting_bytes[: self._box_bytes])
                del self._waiting_bytes[: self._box_bytes]
                self._instance.write(chunk, self._inbox)
                self.call("put", len(chunk))
            has_more = bool(self._waiting_bytes)
            count = self.call("run", until_us, int(has_more))
            self._handle_notes()
            if count:
                sent_bytes += self._instance.read(self._outbox, self._outbox + count)
            # The program may have ended earlier.
            if self.is_watched or has_more or count == self._box_bytes:
                if self.call("now_us") < until_us and self.held_at is None:
                    continue
            return bytes(sent_bytes)

    # -- to look at its program -------------------------------------------------------------------

    def mark(self, marks: bytes) -> None:
        """Set the marks of the offsets of a program's code from 0 on: bits for each."""
        size = self.call("marks_bytes")
        all_marks = marks[:size] + bytes(size - len(marks[:size]))
        self._instance.write(all_marks, self.call("marks"))

    def hold_before(self, bits: int) -> None:
        """Hold a program from now on in front of what has a mark with one of these bits."""
        self.is_watched = self.is_watched or bits != 0
        self.call("want", bits)

    @property
    def held_at(self) -> int | None:
        """Return the offset before which the program is paused, or None."""
        if not self.is_watched:
            return None
        offset = self.call("held_at") % _CLOCK_MODULUS_MS
        return None if offset == NO_OFFSET else offset

    @property
    def now_us(self) -> int:
        return self.call("now_us")

    def go_on(self) -> None:
        """Resume the paused program, in the tick in which it paused."""
        self.call("go_on")
        self._handle_notes()

    def tasks(self) -> list[int]:
        """Return the places of the program's running tasks; empty without tasks."""
        start = self.call("tasks") // 4
        count = int(self._numbers[start])
        return [int(number) for number in self._numbers[start + 1 : start + 1 + count]]

    def variables(self, count: int) -> list[int]:
        """Return the first variables of the program that runs or has run, in thousandths."""
        start = self.call("variables") // 4
        return [int(number) for number in self._numbers[start : start + count]]

    @property
    def unread_bytes(self) -> int:
        return len(self._waiting_bytes) + self.call("unheard")

    def memory(self) -> bytes:
        """Return the content of the EEPROM."""
        return self._instance.read(self._eeprom, self._eeprom + self.memory_bytes)

    def close(self) -> None:
        """Switch it off, and free its memory. It cannot run again."""
        self._handlers = []
        self._instance.close()

    def press(self) -> None:
        """The start button goes down."""
        self.call("press")
        self._handle_notes()

    def let_go(self) -> None:
        """The start button comes up."""
        self.call("let_go")
        self._handle_notes()

    def _handle_notes(self) -> None:
        """Pass the firmware's notes to the board."""
        numbers = self._numbers
        count = numbers[self._note_count_index]
        numbers[self._note_count_index] = 0
        for k in range(self._notes_index, self._notes_index + count * _NOTE_NUMBERS, _NOTE_NUMBERS):
            now_ms, kind, *values = numbers[k : k + _NOTE_NUMBERS]
            handler, value_count = self._handlers[kind - 1]
            result = handler(now_ms % _CLOCK_MODULUS_MS, *values[:value_count])
            if kind in _ASKING_KINDS:
                numbers[self._reading_index] = result
