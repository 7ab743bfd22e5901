"""A bad line to a robot on an Uno: what its chip notices is in the counts that STATUS tells.

A line that stays low stops the robot.
"""

from __future__ import annotations

from pathlib import Path

from tests.machines.wired import Wired
from tests.support.robot_on_uno import (
    AWAY,
    BAUD,
    FORWARD,
    MOTORS,
    NAMES,
    OFF,
    computer,
    saved,
    send,
    states,
    switched_on,
)
from tests.support.uno_watchdog import built
from tiniscript.link.frames import Frame, decode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

PHASES = 160  # the quickest turn of the main loop takes some 110 cycles
BUSY = "{ cli(); __builtin_avr_delay_cycles(170000); sei(); }"  # over 10 ms


def counted(wired: Wired) -> tuple[int, ...]:
    """Return the damaged and dropped messages, framing errors and overruns that the robot tells."""
    values = wired.complete(wired.session.status())
    return values.damaged, values.dropped, values.framing, values.overrun


def test_a_byte_without_its_stop_bit_damages_a_message(uno: Uno) -> None:
    wired = computer(uno)
    assert counted(wired) == (0, 0, 0, 0)
    ping = wired.session.ping()
    frame = wired.session.poll(wired.now_ms)
    assert len(frame) > 4
    uno.send(frame[:3])
    uno.send(frame[3:4], stop_bits_fail=True)
    uno.send(frame[4:])
    wired.run(30)
    assert wired.until(ping) == OK  # sent again
    damaged, dropped, framing, overrun = counted(wired)
    assert damaged >= 1
    assert (dropped, framing, overrun) == (0, 1, 0)


def test_bytes_that_nobody_fetches_damage_a_message(tmp_path: Path) -> None:
    """Interrupts are off for 10 ms: nothing in the firmware does that."""
    elf = built(tmp_path, BUSY)
    with Uno(elf, names=NAMES, baud=BAUD) as uno:
        uno.run_ms(300)
        wired = computer(uno)
        assert wired.until(wired.session.hello()) == OK
        assert counted(wired) == (0, 0, 0, 0)
        ping = wired.session.ping()
        uno.press("button", at=uno.cycle + 2 * CYCLES_PER_MS)
        assert wired.until(ping) == OK  # sent again
        assert len(uno.lost_bytes) >= 3
        assert counted(wired) == (1, 0, 0, 1)


def driving(uno: Uno) -> Wired:
    """Let a program run that needs no computer."""
    wired = computer(uno)
    send(wired, AWAY, is_detached=True)
    uno.run_ms(1500)
    assert states(uno) == FORWARD
    return wired


def frames_since(uno: Uno, since: int) -> list[Frame]:
    """Return the frames that the robot has sent since a cycle."""
    sent = bytes(byte.value for byte in uno.sent_bytes if byte.cycle > since)
    return [frame for part in sent.split(b"\0") if (frame := decode_frame(part)) is not None]


def test_a_line_that_is_held_low_stops_a_robot_that_needs_no_computer(uno: Uno) -> None:
    wired = driving(uno)
    began = uno.cycle
    uno.hold(False, 2 * BAUD)
    uno.run_ms(20)
    assert states(uno) == OFF
    off = max(uno.pins[name].cycle for name in MOTORS)
    assert off - began < 10 * CYCLES_PER_MS
    # the chip has told it once, and so does the robot
    uno.run_ms(980)
    assert [byte.cycle > began for byte in uno.received_bytes].count(True) == 1
    assert [frame.number for frame in frames_since(uno, began)] == [BY_NAME["STOPPED"].number]
    # a cable that was pulled out stays as it is, and the robot has its button
    uno.press("button", ms=100)
    uno.run_ms(300)
    assert states(uno) == FORWARD
    uno.run_ms(1000)
    wired.run(100)
    uno.press("button", ms=100)
    uno.run_ms(100)
    assert states(uno) == OFF
    wired.run(100)
    send(wired, AWAY)
    assert states(uno) == FORWARD
    assert counted(wired)[2] == 1
    uno.send(bytes(4))
    uno.run_ms(10)
    assert states(uno) == OFF


def test_a_short_disturbance_stops_no_robot(uno: Uno) -> None:
    """Each byte with a framing error is a zero, and what the line does meanwhile is none."""
    driving(uno)
    uno.hold(False, 25)  # longer than two bytes
    uno.run_ms(50)
    assert states(uno) == FORWARD
    uno.send(b"\x55")  # what came before does not count any more
    for _ in range(3):
        uno.send(b"\0", stop_bits_fail=True)
    uno.run_ms(50)
    assert states(uno) == FORWARD
    uno.send(b"\x55")
    for _ in range(4):
        uno.send(b"\0", stop_bits_fail=True)
    uno.run_ms(50)
    assert states(uno) == OFF


def test_bytes_after_a_framing_error_are_no_line_that_is_held(uno: Uno) -> None:
    driving(uno)
    uno.send(b"\x10", stop_bits_fail=True)
    uno.send(b"\x01\x02\x04\x08" * 200)
    uno.run_ms(1000)
    assert states(uno) == FORWARD


def test_a_line_that_nobody_has_ever_pulled_up_keeps_no_button_from_starting(
    sketch: Path, memory: Path
) -> None:
    """A Nano on batteries: its USB chip has no power, and holds the line low from the beginning."""
    with switched_on(sketch, memory) as first:
        wired = computer(first)
        send(wired, "SB|F(60, 80)")
        while saved(wired) != 3:
            wired.run(50)
    with Uno(sketch, names=NAMES, eeprom=memory, baud=BAUD) as uno:
        uno.hold(False, 60 * BAUD, at=0)
        uno.run_ms(500)
        uno.press("button", ms=100)
        uno.run_ms(1000)
        assert states(uno) == FORWARD


def test_a_message_is_heard_wherever_the_main_loop_is(uno: Uno) -> None:
    wired = computer(uno)
    assert wired.until(wired.session.hello()) == OK
    wired.run(100)
    for turn in range(PHASES):
        uno.run_to(uno.cycle + turn % 2 + 1)
        other = wired.session.hello if turn % 2 else wired.session.ping  # of another length
        assert wired.until(other()) == OK
    assert counted(wired) == (0, 0, 0, 0)
