"""A stand-in for a 74HC595, the shift register of a motor shield, that refuses wrong timing.

It gets each change of its inputs, with the time, and computes its outputs. The times are the
longest that the data sheets of Nexperia (74HC595) and Texas Instruments (SN74HC595) want at 4.5 V,
up to 85 degrees. Two inputs that change at the same time are a change too early.
"""

from __future__ import annotations

SET_UP_NS = 25.0  # data is steady before the clock rises
HOLD_NS = 3.0  # hold time after the edge
PULSE_NS = 24.0  # shortest time for which clock and latch are high, and low
LATCH_NS = 19.0  # time from the clock's rising edge to the latch's

INPUTS = ("data", "clock", "latch", "enable")


class WrongTiming(AssertionError):
    """Raised for an edge that is too early for the part, or missing."""


class ShiftRegister:
    """The register's two rows of bits; the second one is at its outputs.

    Their state at power-on is unknown: None.
    """

    def __init__(self) -> None:
        self.levels: dict[str, bool] = dict.fromkeys(INPUTS, False)
        self.changed_ns: dict[str, float] = dict.fromkeys(INPUTS, -1e9)
        self.clocked_ns = -1e9  # time of the clock's last rising edge
        self._shifted: list[bool | None] = [None] * 8
        self._latched: list[bool | None] = [None] * 8

    def change(self, ns: float, name: str, is_high: bool) -> None:
        """Take a change of an input. Raises WrongTiming."""
        if self.levels[name] == is_high:
            return
        if name in ("clock", "latch"):
            self._require_ns(ns, name, PULSE_NS, f"a pulse of the {name}", self.changed_ns[name])
        if name == "data":
            self._require_ns(ns, name, HOLD_NS, "data after the clock", self.clocked_ns)
        if name == "clock" and is_high:
            self._require_ns(ns, name, SET_UP_NS, "data before the clock", self.changed_ns["data"])
            self._shifted = [self.levels["data"], *self._shifted[:-1]]
            self.clocked_ns = ns
        if name == "latch" and is_high:
            self._require_ns(ns, name, LATCH_NS, "the clock before the latch", self.clocked_ns)
            self._latched = list(self._shifted)
        self.levels[name] = is_high
        self.changed_ns[name] = ns

    @property
    def outputs(self) -> int | None:
        """The bits at its outputs, QA the lowest; None while they are off, or are not known."""
        if self.levels["enable"]:
            return None
        bits = [bit for bit in self._latched if bit is not None]
        return sum(bit << k for k, bit in enumerate(bits)) if len(bits) == 8 else None

    @staticmethod
    def _require_ns(ns: float, name: str, min_ns: float, description: str, start_ns: float) -> None:
        if ns - start_ns < min_ns:
            violation = f"{description}: {ns - start_ns:.1f} ns, not {min_ns:.0f}"
            raise WrongTiming(f"{violation} ({name} at {ns:.0f} ns)")
