"""A bad line to a robot on an Uno: STATUS reports the errors that its chip notices.

A line that stays low stops the robot.
"""

from __future__ import annotations

from pathlib import Path

from tests.machines.wired import Wired
from tests.support.robot_on_uno import (
    AWAY_PROGRAM,
    BAUD,
    FORWARD,
    MOTORS,
    NAMES,
    OFF,
    computer,
    read_saved_state,
    send,
    states,
    switched_on,
)
from tests.support.uno_watchdog import build_hanging_firmware
from tiniscript.link.frames import Frame, decode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

PHASES = 160  # the fastest turn of the main loop takes some 110 cycles
BUSY_CODE = "{ cli(); __builtin_avr_delay_cycles(170000); sei(); }"  # over 10 ms


def read_counters(wired_uno: Wired) -> tuple[int, ...]:
    """Return the damaged and dropped messages, framing errors and overruns that the robot
    reports."""
    values = wired_uno.complete(wired_uno.session.status())
    return values.damaged, values.dropped, values.framing, values.overrun


def test_a_byte_without_its_stop_bit_damages_a_message(uno: Uno) -> None:
    wired_uno = computer(uno)
    assert read_counters(wired_uno) == (0, 0, 0, 0)
    ping = wired_uno.session.ping()
    frame = wired_uno.session.poll(wired_uno.now_ms)
    assert len(frame) > 4
    uno.send(frame[:3])
    uno.send(frame[3:4], has_bad_stop_bits=True)
    uno.send(frame[4:])
    wired_uno.run(30)
    assert wired_uno.until(ping) == OK  # sent again
    damaged_count, dropped_count, framing, overrun = read_counters(wired_uno)
    assert damaged_count >= 1
    assert (dropped_count, framing, overrun) == (0, 1, 0)


def test_unread_bytes_damage_a_message(tmp_path: Path) -> None:
    """Interrupts are off for 10 ms, which no part of the firmware does."""
    elf = build_hanging_firmware(tmp_path, BUSY_CODE)
    with Uno(elf, names=NAMES, baud=BAUD) as uno:
        uno.run_ms(300)
        wired_uno = computer(uno)
        assert wired_uno.until(wired_uno.session.hello()) == OK
        assert read_counters(wired_uno) == (0, 0, 0, 0)
        ping = wired_uno.session.ping()
        uno.press("button", at_cycle=uno.cycle + 2 * CYCLES_PER_MS)
        assert wired_uno.until(ping) == OK  # sent again
        assert len(uno.lost_bytes) >= 3
        assert read_counters(wired_uno) == (1, 0, 0, 1)


def driving_uno(uno: Uno) -> Wired:
    """Run a program that needs no computer."""
    wired_uno = computer(uno)
    send(wired_uno, AWAY_PROGRAM, is_detached=True)
    uno.run_ms(1500)
    assert states(uno) == FORWARD
    return wired_uno


def frames_since(uno: Uno, since_cycle: int) -> list[Frame]:
    """Return the frames that the robot has sent since a cycle."""
    sent_bytes = bytes(byte.value for byte in uno.sent_bytes if byte.cycle > since_cycle)
    return [frame for part in sent_bytes.split(b"\0") if (frame := decode_frame(part)) is not None]


def test_a_line_held_low_stops_a_detached_program(uno: Uno) -> None:
    wired_uno = driving_uno(uno)
    start_cycle = uno.cycle
    uno.hold(False, 2 * BAUD)
    uno.run_ms(20)
    assert states(uno) == OFF
    off_cycle = max(uno.pins[name].cycle for name in MOTORS)
    assert off_cycle - start_cycle < 10 * CYCLES_PER_MS
    # The chip has reported it once, and so does the robot.
    uno.run_ms(980)
    assert [byte.cycle > start_cycle for byte in uno.received_bytes].count(True) == 1
    assert [frame.number for frame in frames_since(uno, start_cycle)] == [BY_NAME["STOPPED"].number]
    # a cable that was pulled out stays as it is, and the robot has its button
    uno.press("button", ms=100)
    uno.run_ms(300)
    assert states(uno) == FORWARD
    uno.run_ms(1000)
    wired_uno.run(100)
    uno.press("button", ms=100)
    uno.run_ms(100)
    assert states(uno) == OFF
    wired_uno.run(100)
    send(wired_uno, AWAY_PROGRAM)
    assert states(uno) == FORWARD
    assert read_counters(wired_uno)[2] == 1
    uno.send(bytes(4))
    uno.run_ms(10)
    assert states(uno) == OFF


def test_a_short_disturbance_stops_no_robot(uno: Uno) -> None:
    """Each byte with a framing error becomes a zero, but the level of the line meanwhile does not
    count as zeros."""
    driving_uno(uno)
    uno.hold(False, 25)  # longer than two bytes
    uno.run_ms(50)
    assert states(uno) == FORWARD
    uno.send(b"\x55")  # earlier bytes no longer matter
    for _ in range(3):
        uno.send(b"\0", has_bad_stop_bits=True)
    uno.run_ms(50)
    assert states(uno) == FORWARD
    uno.send(b"\x55")
    for _ in range(4):
        uno.send(b"\0", has_bad_stop_bits=True)
    uno.run_ms(50)
    assert states(uno) == OFF


def test_bytes_after_a_framing_error_do_not_count_as_a_held_line(uno: Uno) -> None:
    driving_uno(uno)
    uno.send(b"\x10", has_bad_stop_bits=True)
    uno.send(b"\x01\x02\x04\x08" * 200)
    uno.run_ms(1000)
    assert states(uno) == FORWARD


def test_a_line_that_was_never_high_does_not_block_the_button(sketch: Path, memory: Path) -> None:
    """A Nano on batteries: its USB chip has no power, and holds the line low from the beginning."""
    with switched_on(sketch, memory) as first:
        wired_uno = computer(first)
        send(wired_uno, "SB|F(60, 80)")
        while read_saved_state(wired_uno) != 3:
            wired_uno.run(50)
    with Uno(sketch, names=NAMES, eeprom=memory, baud=BAUD) as uno:
        uno.hold(False, 60 * BAUD, at_cycle=0)
        uno.run_ms(500)
        uno.press("button", ms=100)
        uno.run_ms(1000)
        assert states(uno) == FORWARD


def test_a_message_is_received_wherever_the_main_loop_is(uno: Uno) -> None:
    wired_uno = computer(uno)
    assert wired_uno.until(wired_uno.session.hello()) == OK
    wired_uno.run(100)
    for turn in range(PHASES):
        uno.run_to(uno.cycle + turn % 2 + 1)
        # A request of another length.
        make_request = wired_uno.session.hello if turn % 2 else wired_uno.session.ping
        assert wired_uno.until(make_request()) == OK
    assert read_counters(wired_uno) == (0, 0, 0, 0)
