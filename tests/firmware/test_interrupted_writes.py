"""An interrupt at any cycle of a write loses no byte: the chip ignores a write that comes late."""

from __future__ import annotations

from tests.machines.uno import build_uno
from tools.uno import Uno

DELAYS = 60  # cycles; a write begins within


def test_no_byte_is_lost_by_an_interrupt() -> None:
    with Uno(build_uno("interrupted_writes", Delays=DELAYS)) as uno:
        uno.run_until("D7", "high", limit_ms=10 * DELAYS)
        assert {uno.pins[f"D{number}"].state for number in range(8, 14)} == {"low"}
