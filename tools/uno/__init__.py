"""An Arduino Uno or Mega that is a process, for tests and benchmarks: the real firmware, at work.

    with Uno(Path("firmware.elf"), names={"button": "D2"}) as uno:
        uno.run_ms(5)
        uno.press("button")
        first = uno.run_until("D7", "high", limit_ms=5)
        print(first.cycle, uno.pins.history("D5"))

The chip stands still until it is told to run: `run_ms` and its sisters run it as fast as they can
and return at an exact cycle, so a test sees the same each time. `go` lets it run in real time, for
programs that open its pty. Cycle 0 is the first power-on; 16,000 are a millisecond.

The C sources next to this file are built on first use. `tools/uno/README.md` lists what the
simulator does not model.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from tools.uno.build import build, missing
from tools.uno.log import CYCLES_PER_MS, HERTZ, Byte, Event, MaskedSpan, PinChange, Pins, Stack

__all__ = [
    "CYCLES_PER_MS",
    "HERTZ",
    "Byte",
    "Event",
    "MaskedSpan",
    "PinChange",
    "Pins",
    "Stack",
    "Uno",
    "missing",
]

TIMEOUT_S = 120.0  # timeout of a simulator command


class Uno:
    """A board with a firmware, an `uno` or a `mega`.

    `names` are other words for pins, as `{"button": "D2"}`. Without an `eeprom` file, the EEPROM is
    that of a new chip, and is lost afterwards. With a `bootloader`, a reset begins there.
    """

    def __init__(
        self,
        firmware: Path,
        *,
        names: Mapping[str, str] | None = None,
        eeprom: Path | None = None,
        bootloader: Path | None = None,
        board: str = "uno",
        baud: int = 115_200,
        resets_on_open: bool = True,
        tells_sleep: bool = True,
        watches_stack: bool = False,
        watches_masked: bool = False,
    ) -> None:
        self.board = board
        self.events: list[Event] = []
        self.pins = Pins(self.events, names or {}, board)
        self.cycle = 0  # cycle at which it is paused
        self._keeps_eeprom = eeprom is not None
        self._news = threading.Condition()
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115
        options = ["--board", board, "--baud", str(baud)]
        options += ["--eeprom", str(eeprom)] if eeprom else []
        options += ["--bootloader", str(bootloader)] if bootloader else []
        options += ["--reset-on-open"] if resets_on_open else []
        options += [] if tells_sleep else ["--no-sleep"]
        options += ["--watch-stack"] if watches_stack else []
        options += ["--watch-masked"] if watches_masked else []
        self._process = subprocess.Popen(
            [build(), *options, firmware],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
        )
        self._has_ended = False
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self.pty = str(self.wait_for(lambda event: event.kind == "pty")["name"])

    def __enter__(self) -> Uno:
        return self

    def __exit__(self, *signal_arguments: object) -> None:
        self.close()

    def close(self) -> None:
        """End the simulator; its output stays."""
        if not self._has_ended:
            self._send_lines("quit")
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._reader.join()
        for pipe in (self._process.stdin, self._process.stdout, self._errors):
            if pipe:
                pipe.close()

    def kill(self) -> None:
        """Cut the power for good, wherever the chip is. A new Uno may take the EEPROM's file."""
        self._process.kill()
        self._process.wait()
        self._reader.join()

    # -- running ------------------------------------------------------------------------------

    def run_ms(self, milliseconds: float) -> None:
        self.run_to(self.cycle + round(milliseconds * CYCLES_PER_MS))

    def run_to(self, cycle: int) -> None:
        """Run until a cycle, within the instruction that is at work then."""
        mark = len(self.events)
        self._send_lines(f"run {cycle} 0")
        self._wait_for_pause(mark)

    def run_until(self, pin: str, state: str, limit_ms: float) -> PinChange:
        """Run until a pin becomes `low`, `high`, `pwm`, `input` or `pullup`, and return when."""
        number = self.pins.number(pin)
        mark = len(self.events)
        end = self.cycle + round(limit_ms * CYCLES_PER_MS)
        self._send_lines(f"watch {number} {state}", f"run {end} 0")
        reason = self._wait_for_pause(mark)["why"]
        assert reason == "pin", f"{pin} has not become {state} in {limit_ms} ms"
        return self.pins[pin]

    def go(self, speed: float = 1.0) -> None:
        """Run until `pause`; speed 1 is real time, 0 as fast as it goes."""
        self._send_lines(f"run forever {speed}")

    @contextmanager
    def try_out(self) -> Iterator[None]:
        """Try something on a copy: the chip itself does not change.

        The chip has paused before. It has no `eeprom` file, which would keep what was written.
        """
        assert not self._keeps_eeprom
        mark = len(self.events)
        self._send_lines("aside")
        self._wait_for_pause(mark)
        try:
            yield
        finally:
            event_count = len(self.events)
            self._send_lines("back")
            self._wait_for_pause(event_count)
            del self.events[mark:]

    def pause(self) -> None:
        mark = len(self.events)
        self._send_lines("pause")
        self._wait_for_pause(mark)

    def wait_for(
        self,
        is_wanted: Callable[[Event], bool],
        timeout_s: float = TIMEOUT_S,
        first_number: int = 0,
    ) -> Event:
        """Return the first wanted event from `first_number` on; wait for it if need be."""
        end = time.monotonic() + timeout_s
        number = first_number
        while True:
            with self._news:
                while number >= len(self.events) and not self._has_ended:
                    if not self._news.wait(max(0.0, end - time.monotonic())):
                        raise TimeoutError(f"the Uno has not told it in {timeout_s} s")
                if number >= len(self.events):
                    raise RuntimeError(f"the Uno has ended: {self._serial_output()}")
                event = self.events[number]
            number += 1
            if event.kind == "mistake":
                raise ValueError(event["text"])
            if is_wanted(event):
                return event

    # -- its surroundings -------------------------------------------------------------------------

    def drive(self, pin: str, level: bool | None, at_cycle: int | None = None) -> None:
        """Drive a pin from outside, or release it; at a cycle, or at once."""
        word = {None: "none", False: "low", True: "high"}[level]
        self._send_lines(_at_cycle(at_cycle) + f"pin {self.pins.number(pin)} {word}")

    def press(self, pin: str, ms: float = 50.0, at_cycle: int | None = None) -> None:
        """Connect a pin to ground for a while, as a button does; it stays so while time passes."""
        self.drive(pin, False, at_cycle)
        cycle_count = round(ms * CYCLES_PER_MS)
        time_words = (
            f"after {cycle_count} " if at_cycle is None else f"at {at_cycle + cycle_count} "
        )
        self._send_lines(time_words + f"pin {self.pins.number(pin)} none")

    def set_analog(self, pin: str, count: int) -> None:
        """Put as much voltage to an analog pin as is read as `count`, 0 to 1023."""
        assert 0 <= count <= 1023, count
        self._send_lines(f"analog {self.pins.number(pin)} {count}")

    def set_supply(self, volts: float) -> None:
        """Set a voltage other than 5 V, which only affects the analog converter."""
        assert 2 <= volts <= 6, volts
        self._send_lines(f"supply {round(volts * 1000)}")

    def set_sonar_distance(
        self, trigger: str, echo: str, distance_cm: float | None, at_cycle: int | None = None
    ) -> None:
        """Put an HC-SR04 at two pins, or move its obstacle; None: no obstacle."""
        numbers = f"{self.pins.number(trigger)} {self.pins.number(echo)}"
        self._send_lines(_at_cycle(at_cycle) + f"sonar {numbers} {round((distance_cm or 0) * 10)}")

    # -- its serial port ----------------------------------------------------------------------

    def send(
        self, data: bytes, at_cycle: int | None = None, *, has_bad_stop_bits: bool = False
    ) -> None:
        """Send bytes to the chip one after the other; the first start bit at a cycle, or now."""
        if data:
            self._send_lines(
                _at_cycle(at_cycle) + f"send{'_bad' if has_bad_stop_bits else ''} {data.hex()}"
            )

    def hold(self, is_high: bool, bits: int, at_cycle: int | None = None) -> None:
        """Hold the wire low (a break) or idle for so many bits, after the bytes sent."""
        self._send_lines(_at_cycle(at_cycle) + f"hold {'high' if is_high else 'low'} {bits}")

    @property
    def sent_bytes(self) -> list[Byte]:
        """The bytes that the chip has sent."""
        return [Byte.of(event) for event in list(self.events) if event.kind == "sent"]

    @property
    def received_bytes(self) -> list[Byte]:
        """The bytes in the chip's buffer or shift register."""
        return [Byte.of(event) for event in list(self.events) if event.kind == "received"]

    @property
    def lost_bytes(self) -> bytes:
        """The bytes that were received and then overwritten, because the previous one was not
        read.
        """
        return bytes(int(event["byte"]) for event in list(self.events) if event.kind == "lost")

    # -- resets -------------------------------------------------------------------------------

    def reset(self, cause: str = "external", at_cycle: int | None = None) -> None:
        """Reset it: `external` (button, DTR), `power-on` (a cut: RAM is lost), `brown-out`."""
        self._send_lines(_at_cycle(at_cycle) + f"reset {cause}")

    # -- memory -------------------------------------------------------------------------------

    def stack(self, from_address: int) -> Stack:
        """Say how deep the stack went, in RAM that is free from an address on.

        Needs `watches_stack`, which makes it about half as fast.
        """
        mark = len(self.events)
        self._send_lines(f"stack {from_address}")
        return Stack.of(self.wait_for(lambda event: event.kind == "stack", first_number=mark))

    # -- interrupts ---------------------------------------------------------------------------

    def longest_masked_spans(self) -> list[MaskedSpan]:
        """Say for how long each place has kept interrupts off, at most.

        Needs `watches_masked`, which makes it about half as fast.
        """
        mark = len(self.events)
        self._send_lines("masked")
        self.wait_for(
            lambda event: event.kind == "masked" and "places" in event.values, first_number=mark
        )
        events = [event for event in self.events[mark:] if event.kind == "masked"]
        return [MaskedSpan.of(event) for event in events if "vector" in event.values]

    # -- inside -------------------------------------------------------------------------------

    def _send_lines(self, *lines: str) -> None:
        pipe = self._process.stdin
        assert pipe
        try:
            pipe.write("".join(f"{line}\n" for line in lines).encode())
            pipe.flush()
        except BrokenPipeError:
            raise RuntimeError(f"the Uno has ended: {self._serial_output()}") from None

    def _wait_for_pause(self, first_number: int) -> Event:
        event = self.wait_for(lambda event: event.kind == "paused", first_number=first_number)
        self.cycle = event.cycle
        return event

    def _read(self) -> None:
        pipe = self._process.stdout
        assert pipe
        for line in pipe:
            event = Event.of(json.loads(line))
            with self._news:
                self.events.append(event)
                self._news.notify_all()
        with self._news:
            self._has_ended = True
            self._news.notify_all()

    def _serial_output(self) -> str:
        self._errors.seek(0)
        return self._errors.read().decode(errors="replace")[-2000:]


def _at_cycle(cycle: int | None) -> str:
    return "" if cycle is None else f"at {cycle} "
