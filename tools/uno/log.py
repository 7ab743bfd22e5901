"""The output of the simulated Uno: events with their cycles, and views of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

HERTZ = 16_000_000
CYCLES_PER_MS = HERTZ // 1000
PINS = {"uno": (14, 6), "mega": (54, 16)}  # digital and analog pins of each board


@dataclass(frozen=True)
class Event:
    """One event. Its `kind` determines the other fields (`tools/uno/README.md`)."""

    cycle: int
    kind: str
    values: Mapping[str, Any]

    @classmethod
    def of(cls, fields: dict[str, Any]) -> Event:
        return cls(fields.pop("cycle"), fields.pop("what"), fields)

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    @property
    def ms(self) -> float:
        return self.cycle / CYCLES_PER_MS


@dataclass(frozen=True)
class PinChange:
    """The state of a pin from a cycle on: `low`, `high`, `input`, `pullup` or `pwm`.

    `duty` (0 to 1), `hertz` and the timer's `value` are those of `pwm`.
    """

    cycle: int
    pin: str
    state: str
    duty: float = 0.0
    hertz: float = 0.0
    value: int = 0

    @property
    def ms(self) -> float:
        return self.cycle / CYCLES_PER_MS


@dataclass(frozen=True)
class Byte:
    """A byte on a wire: `began` is the cycle of its start bit, `cycle` that of its arrival."""

    cycle: int
    began: int
    value: int

    @classmethod
    def of(cls, event: Event) -> Byte:
        return cls(event.cycle, event["began"], event["byte"])


@dataclass(frozen=True)
class Stack:
    """The RAM after static data, and the part that the stack has used.

    `untouched_bytes` are as power-on has left them. `program` and `interrupt` are the deepest that
    each of the two went by itself.
    """

    untouched_bytes: int
    room: int
    program: int
    interrupt: int

    @classmethod
    def of(cls, event: Event) -> Stack:
        return cls(event["untouched"], event["room"], event["program"], event["interrupt"])

    @property
    def least_free(self) -> int:
        """Return the bytes left when the deepest interrupt hits the deepest place of the
        program.
        """
        return self.room - self.program - self.interrupt


@dataclass(frozen=True)
class MaskedSpan:
    """The longest time, in cycles, for which a place has kept interrupts off.

    `vector` is that of the interrupt at work, 0 in the program. `is_entry`: from its entry on;
    otherwise from the instruction at `pc` (bytes) on.
    """

    vector: int
    is_entry: bool
    pc: int
    cycle_count: int

    @classmethod
    def of(cls, event: Event) -> MaskedSpan:
        return cls(event["vector"], event["is_entry"], event["pc"], event["cycles"])


class Pins:
    """The pins of a board by their names there, or by those that the test gives them."""

    def __init__(
        self, events: Sequence[Event], names: Mapping[str, str], board: str = "uno"
    ) -> None:
        self._events = events
        self._names = names
        digital, analog = PINS[board]
        self._board = {f"D{pin}" for pin in range(digital)} | {f"A{pin}" for pin in range(analog)}

    def number(self, pin: str) -> str:
        """Return the name on the board."""
        name = self._names.get(pin, pin)
        assert name in self._board, f"there is no pin {pin}"
        return name

    def history(self, pin: str) -> tuple[PinChange, ...]:
        """Return all that the chip has done with a pin."""
        name = self.number(pin)
        return tuple(
            PinChange(event.cycle, name, event["is"], **_wave(event))
            for event in list(self._events)
            if event.kind == "pin" and event["pin"] == name
        )

    def __getitem__(self, pin: str) -> PinChange:
        """Return the current state of a pin."""
        return self.history(pin)[-1]

    def at(self, pin: str, cycle: int) -> PinChange:
        """Return the state of a pin at a cycle."""
        return [change for change in self.history(pin) if change.cycle <= cycle][-1]


def _wave(event: Event) -> dict[str, Any]:
    if event["is"] != "pwm":
        return {}
    return {"duty": event["duty"], "hertz": event["hz"], "value": event["value"]}
