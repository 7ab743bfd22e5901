"""A bad line to a robot on an Uno: what its chip notices is in the counts that STATUS tells."""

from __future__ import annotations

from pathlib import Path

from tests.machines.wired import Wired
from tests.test_uno_guard import built
from tests.test_uno_robot import BAUD, NAMES, computer, memory, sketch, uno
from tiniscript.link.errands import OK
from tools.uno import CYCLES_PER_MS, Uno

__all__ = ("memory", "sketch", "uno")  # fixtures
BUSY = "{ cli(); for (uint16_t k = 0; k < 2000; k++) delayMicroseconds(5); sei(); }"  # over 10 ms


def counted(wired: Wired) -> tuple[int, int]:
    """Return how many messages were damaged, and how many dropped, as the robot says."""
    task = wired.session.status()
    assert wired.until(task) == OK
    assert task.outcome
    damaged, dropped = (task.outcome.values[name] for name in ("damaged", "dropped"))
    assert isinstance(damaged, int) and isinstance(dropped, int)
    return damaged, dropped


def test_a_byte_without_its_stop_bit_damages_a_message(uno: Uno) -> None:
    wired = computer(uno)
    assert counted(wired) == (0, 0)
    ping = wired.session.ping()
    frame = wired.session.poll(wired.now_ms)
    assert len(frame) > 4
    uno.send(frame[:3])
    uno.send(frame[3:4], stop_bits_fail=True)
    uno.send(frame[4:])
    wired.run(30)
    assert wired.until(ping) == OK  # sent again
    damaged, dropped = counted(wired)
    assert damaged >= 1 and dropped == 0


def test_bytes_that_nobody_fetches_damage_a_message(tmp_path: Path) -> None:
    """Interrupts are off for 10 ms: nothing in the firmware does that."""
    elf = built(tmp_path, BUSY)
    with Uno(elf, names=NAMES, baud=BAUD) as uno:
        uno.run_ms(300)
        wired = computer(uno)
        assert wired.until(wired.session.hello()) == OK
        assert counted(wired) == (0, 0)
        ping = wired.session.ping()
        uno.press("button", at=uno.cycle + 2 * CYCLES_PER_MS)
        assert wired.until(ping) == OK  # sent again
        assert len(uno.lost) >= 3
        assert counted(wired) == (1, 0)
