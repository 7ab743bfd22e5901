"""The simulated Uno: its output is exact, and its parts take the time of real silicon.

For each part that has a time, a firmware that ignores it fails.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.uno import build_uno, skip_unless_available
from tools.uno import CYCLES_PER_MS, HERTZ, Uno

BIT = HERTZ / 115_200  # a bit at the computer's speed, in cycles
CHIP_BIT = 17 * 8  # a bit of a chip that can only divide by 17


@pytest.fixture(autouse=True)
def needs_a_chip() -> None:
    skip_unless_available()


def cycles_of(uno: Uno, pin: str, state: str) -> list[int]:
    return [change.cycle for change in uno.pins.history(pin) if change.state == state]


# -- time -----------------------------------------------------------------------------------------


def test_a_run_ends_at_the_requested_cycle() -> None:
    with Uno(build_uno("echo", Baud=115200, Wait=1)) as uno:
        for cycle in (1000, 1001, 54_321):
            uno.run_to(cycle)
            assert cycle <= uno.cycle <= cycle + 4  # the longest instruction
        uno.send(b"U", at=80_000)
        change = uno.run_until("D7", "high", limit_ms=5)
        assert change.cycle <= uno.cycle <= change.cycle + 4
        with pytest.raises(AssertionError, match="D7 has not become pwm in 1 ms"):
            uno.run_until("D7", "pwm", limit_ms=1)


def test_masked_interrupt_times_are_measured() -> None:
    """In the program, from an interrupt's entry, and where it allows others."""
    with Uno(
        build_uno("masked", Program=500, Interrupt=300, Later=200), watches_masked=True
    ) as uno:
        uno.run_ms(20)
        spans = uno.longest_masked_spans()
    program = [span.cycle_count for span in spans if span.vector == 0]
    entries = [span for span in spans if span.is_entry]
    later = [span.cycle_count for span in spans if span.vector and not span.is_entry]
    assert len(program) == len(entries) == len(later) == 1
    assert program[0] == pytest.approx(500, abs=4)
    assert entries[0].vector == 16  # the overflow of timer 0
    assert 300 + 4 < entries[0].cycle_count < 300 + 60  # the registers that g++ saves
    assert 200 < later[0] < 200 + 60


# -- the UART -------------------------------------------------------------------------------------


def test_a_byte_has_ten_bits() -> None:
    with Uno(build_uno("echo", Baud=115200, Wait=1)) as uno:
        uno.send(b"ab", at=20_000)
        uno.run_ms(3)
    assert [byte.value for byte in uno.sent_bytes] == [*b"ab"]
    first, second = uno.received_bytes
    assert first.began == 20_000
    assert second.began - first.began == pytest.approx(10 * BIT, abs=1)
    assert first.cycle - first.began == pytest.approx(9.5 * CHIP_BIT, abs=10)
    assert all(byte.cycle - byte.began == 10 * CHIP_BIT for byte in uno.sent_bytes)
    assert uno.pins["D8"].state == uno.pins["D9"].state == "low"


def test_a_burst_overruns_the_buffer() -> None:
    """Two bytes are kept, and the last one; those between are overwritten as they come."""
    with Uno(build_uno("echo", Baud=115200, Wait=5)) as uno:
        uno.send(b"abcde", at=CYCLES_PER_MS)
        uno.run_ms(4.9)
        assert [byte.value for byte in uno.received_bytes] == [*b"abcde"]
        uno.run_ms(2)
    assert bytes(byte.value for byte in uno.sent_bytes) == b"abe"
    assert uno.lost_bytes == b"cd"
    assert cycles_of(uno, "D9", "high")  # the chip knows that something is missing


# -- EEPROM ---------------------------------------------------------------------------------------


def test_writing_an_eeprom_byte_takes_time(tmp_path: Path) -> None:
    file = tmp_path / "eeprom"
    with Uno(build_uno("memory", Ignores=0), eeprom=file) as uno:
        uno.run_ms(30)
    (begin_cycle,), (end_cycle,) = cycles_of(uno, "D8", "high"), cycles_of(uno, "D8", "low")[1:]
    assert (end_cycle - begin_cycle) / CYCLES_PER_MS == pytest.approx(5 * 3.4, abs=0.02)
    (by_interrupt,) = cycles_of(uno, "D9", "high")
    assert (by_interrupt - end_cycle) / CYCLES_PER_MS == pytest.approx(2 * 3.4, abs=0.02)
    assert cycles_of(uno, "D10", "high")
    content = file.read_bytes()
    assert (len(content), content[:6], content[10:12]) == (1024, b"\1\2\3\4\5\xff", b"\x77\x77")


def test_firmware_that_does_not_wait_loses_bytes(tmp_path: Path) -> None:
    with Uno(build_uno("memory", Ignores=1), eeprom=tmp_path / "eeprom") as uno:
        uno.run_ms(30)
    assert (tmp_path / "eeprom").read_bytes()[:5] == b"\1\xff\xff\xff\xff"


@pytest.mark.parametrize(
    ("ms", "bytes_left"), [(1.0, b"\xff\xff"), (2.0, b"\1\xff"), (4.5, b"\1\xff"), (6.0, b"\1\2")]
)
def test_a_power_cut_leaves_a_partial_byte(tmp_path: Path, ms: float, bytes_left: bytes) -> None:
    """The byte is erased first; the previous memory is there after the next power-on."""
    file = tmp_path / "eeprom"
    file.write_bytes(b"\x55" * 1024)
    expected = bytes_left if ms > 3.4 else bytes_left[:1] + b"\x55"
    with Uno(build_uno("memory", Ignores=0), eeprom=file) as uno:
        uno.run_ms(ms)
        uno.kill()
    assert file.read_bytes()[:3] == expected + b"\x55"
    with Uno(build_uno("memory", Ignores=0), eeprom=file) as uno:
        uno.run_ms(30)
    assert file.read_bytes()[:6] == b"\1\2\3\4\5\x55"


# -- watchdog and resets --------------------------------------------------------------------------


@pytest.mark.parametrize("is_off", [0, 1, 2])
def test_the_second_timeout_resets(is_off: int) -> None:
    """This holds with interrupts off, so that the first one is not handled, and during sleep."""
    with Uno(build_uno("watchdog", IsOff=is_off)) as uno:
        uno.run_ms(100)
    resets = [event for event in uno.events if event.kind == "reset"]
    assert [event["cause"] for event in resets] == ["power-on", "watchdog"]
    assert resets[1].ms == pytest.approx(2 * 32, abs=0.1)
    assert bool(cycles_of(uno, "D9", "high")) == (not is_off)
    assert uno.pins["D10"].state == "high"  # the firmware reads the cause
    assert uno.pins["D11"].state == "high"  # its memory is unchanged


# -- pins -----------------------------------------------------------------------------------------
