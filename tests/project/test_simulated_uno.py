"""The simulated Uno: what it tells is exact, and its parts take the time that silicon takes.

For each part that has a time, a firmware that ignores it fails.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import serial

from tests.machines.uno import built, needed
from tests.support.casefile import ROOT
from tests.support.waiting import until
from tools.uno import CYCLES_PER_MS, HERTZ, Uno

BIT = HERTZ / 115_200  # of the computer
CHIP_BIT = 17 * 8  # of a chip at that speed, which can only divide by 17


@pytest.fixture(autouse=True)
def needs_a_chip() -> None:
    needed()


def cycles_of(uno: Uno, pin: str, state: str) -> list[int]:
    return [change.cycle for change in uno.pins.history(pin) if change.state == state]


# -- time -----------------------------------------------------------------------------------------


def test_two_runs_are_the_same() -> None:
    logs = []
    for _ in range(2):
        with Uno(built("echo", Baud=115200, Wait=1)) as uno:
            uno.send(b"one and the same", at=20_000)
            uno.run_ms(5)
        logs.append([event for event in uno.events if event.what != "pty"])
    assert logs[0] == logs[1]


def test_it_runs_to_a_cycle() -> None:
    with Uno(built("echo", Baud=115200, Wait=1)) as uno:
        for cycle in (1000, 1001, 54_321):
            uno.run_to(cycle)
            assert cycle <= uno.cycle <= cycle + 4  # the longest instruction
        uno.send(b"U", at=80_000)
        change = uno.run_until("D7", "high", limit_ms=5)
        assert change.cycle <= uno.cycle <= change.cycle + 4
        with pytest.raises(AssertionError, match="D7 has not become pwm in 1 ms"):
            uno.run_until("D7", "pwm", limit_ms=1)


def test_what_is_done_aside_has_not_happened() -> None:
    with Uno(built("echo", Baud=115200, Wait=1)) as uno:
        uno.run_ms(1)
        before, cycle = list(uno.events), uno.cycle
        told = []
        for _ in range(2):
            with uno.aside():
                uno.send(b"U")
                uno.run_ms(2)
                told.append(uno.events[len(before) + 1 :])
            assert (uno.events, uno.cycle) == (before, cycle)
        uno.send(b"U")
        uno.run_ms(2)
        assert told[0] == told[1] == uno.events[len(before) :]
        assert [byte.value for byte in uno.sent] == list(b"U")
    with pytest.raises(AssertionError), Uno(built("echo", Baud=115200, Wait=1)) as uno, uno.aside():
        raise AssertionError
    assert uno._process.returncode == 0


def test_an_interrupt_takes_its_four_cycles() -> None:
    """Entering, the jump in the table and what g++ saves: from the time-out to the pin."""
    with Uno(built("watchdog", IsOff=0)) as uno:
        uno.run_ms(40)
    (bark,) = [event.cycle for event in uno.events if event.rest.get("does") == "interrupt"]
    (high,) = cycles_of(uno, "D9", "high")
    assert 4 + 3 <= high - bark <= 4 + 3 + 12


def test_it_tells_how_long_interrupts_are_off() -> None:
    """In the program, from the entry of an interrupt on, and where it has let others in."""
    with Uno(built("masked", Program=500, Interrupt=300, Later=200), watches_masked=True) as uno:
        uno.run_ms(20)
        found = uno.masked()
    program = [each.cycles for each in found if each.vector == 0]
    entries = [each for each in found if each.is_entry]
    later = [each.cycles for each in found if each.vector and not each.is_entry]
    assert len(program) == len(entries) == len(later) == 1
    assert program[0] == pytest.approx(500, abs=4)
    assert entries[0].vector == 16  # the overflow of timer 0
    assert 300 + 4 < entries[0].cycles < 300 + 60  # with what g++ saves
    assert 200 < later[0] < 200 + 60


def test_real_time_is_real() -> None:
    with Uno(built("echo", Baud=115200, Wait=1)) as uno:
        begin = time.monotonic()
        uno.go(speed=1.0)
        time.sleep(0.2)
        uno.pause()
        assert uno.cycle / HERTZ < time.monotonic() - begin + 0.1


def test_it_ends_with_who_started_it() -> None:
    program = (
        "import os, sys, time\nfrom pathlib import Path\nfrom tools.uno import Uno\n"
        "uno = Uno(Path(sys.argv[1])); uno.go(0)\n"
        "print(uno._process.pid, flush=True)\ntime.sleep(60)\n"
    )
    parent = subprocess.Popen(
        [sys.executable, "-c", program, str(built("echo", Baud=115200, Wait=1))],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
    )
    assert parent.stdout
    child = Path("/proc") / parent.stdout.readline().decode().strip()
    assert child.exists()
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    parent.stdout.close()
    until(lambda: not child.exists() or "Z" in (child / "stat").read_text().split()[2], "it ends")


def test_what_is_wrong_is_said(tmp_path: Path) -> None:
    with Uno(built("echo", Baud=115200, Wait=1)) as uno:
        uno.reset('by "magic"')
        with pytest.raises(ValueError, match=r"no command: reset by \?magic\?"):
            uno.run_ms(1)
    with pytest.raises(RuntimeError, match=r"cannot read .*none\.elf"):
        Uno(tmp_path / "none.elf")


def test_a_hex_file_runs_as_its_elf_does(tmp_path: Path) -> None:
    elf = built("echo", Baud=115200, Wait=1)
    file = tmp_path / "echo.hex"
    subprocess.run(["avr-objcopy", "-O", "ihex", "-R", ".eeprom", elf, file], check=True)
    sent = []
    for firmware in (elf, file):
        with Uno(firmware) as uno:
            uno.send(b"the same", at=20_000)
            uno.run_ms(3)
        sent.append(uno.sent)
    assert sent[0] == sent[1] != []


# -- the UART -------------------------------------------------------------------------------------


def test_a_byte_has_ten_bits() -> None:
    with Uno(built("echo", Baud=115200, Wait=1)) as uno:
        uno.send(b"ab", at=20_000)
        uno.run_ms(3)
    assert [byte.value for byte in uno.sent] == [*b"ab"]
    first, second = uno.received
    assert first.began == 20_000
    assert second.began - first.began == pytest.approx(10 * BIT, abs=1)
    assert first.cycle - first.began == pytest.approx(9.5 * CHIP_BIT, abs=10)
    assert all(byte.cycle - byte.began == 10 * CHIP_BIT for byte in uno.sent)
    assert uno.pins["D8"].state == uno.pins["D9"].state == "low"


def test_a_burst_overruns_the_buffer() -> None:
    """Two bytes are kept, and the last one; those between are overwritten as they come."""
    with Uno(built("echo", Baud=115200, Wait=5)) as uno:
        uno.send(b"abcde", at=CYCLES_PER_MS)
        uno.run_ms(4.9)
        assert [byte.value for byte in uno.received] == [*b"abcde"]
        uno.run_ms(2)
    assert bytes(byte.value for byte in uno.sent) == b"abe"
    assert uno.lost == b"cd"
    assert cycles_of(uno, "D9", "high")  # the chip knows that something is missing


def test_what_the_chip_fetches_in_time_is_not_lost() -> None:
    with Uno(built("interrupts")) as uno:
        uno.send(bytes(range(200)), at=CYCLES_PER_MS)
        uno.run_ms(20)
    assert bytes(byte.value for byte in uno.sent) == bytes(range(200))
    assert uno.lost == b""
    asleep = [event.what for event in uno.events if event.what in ("sleep", "wake")]
    assert asleep[:3] == ["sleep", "wake", "sleep"]


def test_broken_frames_and_breaks_are_seen() -> None:
    with Uno(built("echo", Baud=115200, Wait=1)) as uno:
        uno.send(b"a", at=2 * CYCLES_PER_MS)
        uno.send(b"b", stop_bits_fail=True, at=2 * CYCLES_PER_MS)
        uno.run_ms(3)
        assert [(byte.value, byte.is_broken) for byte in uno.received] == [(97, False), (98, True)]
        uno.hold(False, bits=40)
        uno.send(b"c")
        uno.run_ms(3)
    assert [(byte.value, byte.is_broken) for byte in uno.received][2:] == [(0, True), (99, False)]
    assert cycles_of(uno, "D8", "high")


@pytest.mark.parametrize("baud", [9600, 19200, 57600])
def test_another_baud_is_garbage(baud: int) -> None:
    with Uno(built("echo", Baud=115200, Wait=1)) as uno:
        uno.baud(baud)
        uno.send(b"hello", at=CYCLES_PER_MS)
        uno.run_ms(10)
    assert bytes(byte.value for byte in uno.received) != b"hello"
    assert cycles_of(uno, "D8", "high")


@pytest.mark.parametrize("baud", [9600, 115200])
def test_pyserial_opens_it(baud: int) -> None:
    with Uno(built("echo", Baud=baud, Wait=0), baud=9600 + 115200 - baud) as uno:
        uno.run_ms(1)
        uno.go(speed=1.0)
        with serial.Serial(uno.pty, baud, timeout=20) as port:
            reset = uno.wait_for(lambda event: event.rest.get("cause") == "external")
            uno.wait_for(lambda event: event.cycle > reset.cycle and event.rest.get("pin") == "D8")
            text = b"over the wire and back again"
            port.write(text)
            assert port.read(len(text)) == text
        closed = uno.wait_for(lambda event: event.rest.get("does") == "closed")
        uno.pause()
    first, last = uno.sent[0], uno.sent[-1]
    bits = (len(text) - 1) * 10
    assert last.cycle - first.cycle == pytest.approx(bits * HERTZ / baud, rel=0.03)
    assert closed.cycle > last.cycle


def test_opening_need_not_reset_it() -> None:
    with Uno(built("echo", Baud=115200, Wait=0), resets_on_open=False) as uno:
        uno.run_ms(1)
        uno.go(speed=1.0)
        with serial.Serial(uno.pty, 115200, timeout=20) as port:
            port.write(b"x")
            assert port.read(1) == b"x"
        uno.pause()
    assert [event["cause"] for event in uno.events if event.what == "reset"] == ["power-on"]


# -- EEPROM ---------------------------------------------------------------------------------------


def test_a_byte_of_the_eeprom_takes_its_time(tmp_path: Path) -> None:
    file = tmp_path / "eeprom"
    with Uno(built("memory", Ignores=0), eeprom=file) as uno:
        uno.run_ms(30)
    (begin,), (end,) = cycles_of(uno, "D8", "high"), cycles_of(uno, "D8", "low")[1:]
    assert (end - begin) / CYCLES_PER_MS == pytest.approx(5 * 3.4, abs=0.02)
    (by_interrupt,) = cycles_of(uno, "D9", "high")
    assert (by_interrupt - end) / CYCLES_PER_MS == pytest.approx(2 * 3.4, abs=0.02)
    assert cycles_of(uno, "D10", "high")
    content = file.read_bytes()
    assert (len(content), content[:6], content[10:12]) == (1024, b"\1\2\3\4\5\xff", b"\x77\x77")


def test_a_firmware_that_does_not_wait_loses_bytes(tmp_path: Path) -> None:
    with Uno(built("memory", Ignores=1), eeprom=tmp_path / "eeprom") as uno:
        uno.run_ms(30)
    assert (tmp_path / "eeprom").read_bytes()[:5] == b"\1\xff\xff\xff\xff"


@pytest.mark.parametrize(
    ("ms", "left"), [(1.0, b"\xff\xff"), (2.0, b"\1\xff"), (4.5, b"\1\xff"), (6.0, b"\1\2")]
)
def test_a_power_cut_leaves_half_a_byte(tmp_path: Path, ms: float, left: bytes) -> None:
    """It is erased first; and what was there before is there after the next power-on."""
    file = tmp_path / "eeprom"
    file.write_bytes(b"\x55" * 1024)
    expected = left if ms > 3.4 else left[:1] + b"\x55"
    with Uno(built("memory", Ignores=0), eeprom=file) as uno:
        uno.run_ms(ms)
        uno.kill()
    assert file.read_bytes()[:3] == expected + b"\x55"
    with Uno(built("memory", Ignores=0), eeprom=file) as uno:
        uno.run_ms(30)
    assert file.read_bytes()[:6] == b"\1\2\3\4\5\x55"


# -- watchdog and resets --------------------------------------------------------------------------


@pytest.mark.parametrize("is_off", [0, 1, 2])
def test_the_second_time_out_resets(is_off: int) -> None:
    """Also where interrupts are off, so that nobody answers the first one, and where it sleeps."""
    with Uno(built("watchdog", IsOff=is_off)) as uno:
        uno.run_ms(100)
    resets = [event for event in uno.events if event.what == "reset"]
    assert [event["cause"] for event in resets] == ["power-on", "watchdog"]
    assert resets[1].ms == pytest.approx(2 * 32, abs=0.1)
    assert bool(cycles_of(uno, "D9", "high")) == (not is_off)
    assert uno.pins["D10"].state == "high"  # the firmware reads the cause
    assert uno.pins["D11"].state == "high"  # and its memory is as it was


def test_causes_of_a_reset() -> None:
    with Uno(built("watchdog", IsOff=1)) as uno:
        uno.run_ms(1)
        assert uno.pins["D11"].state == "low"  # after power-on memory is anything
        uno.reset("external")
        uno.run_ms(1)
        assert uno.pins["D11"].state == "high"
        uno.reset("brown-out")
        uno.run_ms(1)
        uno.reset("power-on", at=uno.cycle + 5000)
        uno.run_ms(1)
        assert uno.pins["D11"].state == "low"
    flags = [(event["cause"], event["flags"]) for event in uno.events if event.what == "reset"]
    assert flags == [("power-on", 1), ("external", 2), ("brown-out", 4), ("power-on", 1)]


# -- pins -----------------------------------------------------------------------------------------


def test_pins_timers_and_adc() -> None:
    with Uno(built("pins"), names={"button": "D2"}) as uno:
        uno.analog("A0", 777)
        uno.run_ms(1)
        assert uno.pins["button"].state == "pullup"
        assert uno.pins["D9"].state == "low"
        toggles = len(uno.pins.history("D7"))
        uno.press("button")
        at = uno.cycle
        uno.run_ms(2)
        waves = {name: uno.pins[name] for name in ("D3", "D5", "D6", "D9")}
        count = uno.sent[0].value | uno.sent[1].value << 8
        uno.analog("A0", 0, at=uno.cycle + 100)
        uno.run_ms(2)
    assert toggles > 100  # writes to the port have left the button alone
    assert {name: (wave.duty, wave.hertz) for name, wave in waves.items()} == {
        "D3": (0.2, 490.196),
        "D5": (0.5, 976.562),
        "D6": (0.25, 976.562),
        "D9": (0.075, 50.0),
    }
    assert 0 < waves["D6"].cycle - at < 40
    assert uno.pins.at("D6", at).state == "low"
    registers = {
        event["register"]: event["value"] for event in uno.events if event.what == "register"
    }
    assert (registers["ICR1"], registers["OCR1A"], registers["OCR2B"]) == (39999, 2999, 51)
    assert count == 777
    assert [byte.value for byte in uno.sent[-2:]] == [0, 0]
    ready = cycles_of(uno, "D7", "low")[-1]
    begun = max(cycle for cycle in cycles_of(uno, "D7", "high") if cycle < ready)
    assert ready - begun == pytest.approx(13 * 128, abs=20)


def test_a_held_button_stays_held() -> None:
    """The chip's writes to other pins of the port do not let go of it."""
    with Uno(built("pins")) as uno:
        uno.drive("D2", True)
        uno.run_ms(1)
        assert uno.pins["D5"].state == "low"
        uno.drive("D2", False)
        uno.run_ms(1)
        assert uno.pins["D5"].state == "pwm"
        uno.reset("external")
        change = uno.run_until("D5", "pwm", limit_ms=1)  # it is down after a reset, too
        assert change.cycle > CYCLES_PER_MS


def test_sonars_answer_their_trigger() -> None:
    with Uno(built("pins")) as uno:
        uno.sonar("D7", "A1", 10)
        uno.sonar("D7", "A2", None)
        uno.run_ms(1)
        assert not [event for event in uno.events if event.rest.get("by") == "high"]  # too short
        uno.press("D2")
        uno.run_ms(45)
    for pin, length_us in (("A1", 2 * 10 / 0.0343), ("A2", 38_000)):
        drives = [event for event in uno.events if event.rest.get("by") and event["pin"] == pin]
        high, low = drives[1:3]
        assert (high["by"], low["by"]) == ("high", "low")
        assert low.ms - high.ms == pytest.approx(length_us / 1000, abs=0.001)
        falls = cycles_of(uno, "D7", "low")
        assert any(0 <= high.cycle - fall - 450 * CYCLES_PER_MS // 1000 < 4 for fall in falls)
