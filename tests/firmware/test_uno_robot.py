"""The firmware as it goes onto an Uno, seen from its pins, its wire and its EEPROM."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.wired import Wired
from tests.support.images import image_of
from tests.support.owners import Keys
from tests.support.robot_on_uno import (
    AWAY_PROGRAM,
    BAUD,
    FORWARD,
    KIT,
    MOTORS,
    OFF,
    computer,
    read_saved_state,
    send,
    states,
    switched_on,
)
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import checksum, unpack
from tiniscript.library import source_map
from tiniscript.library.shows import ShowFinder
from tiniscript.link.authority import OWNED_BY_OTHER, OWNED_BY_YOU, ownership_of
from tiniscript.link.messages import KEY_OWNER, SAVED_STORED
from tiniscript.link.outcomes import Event, ShownEvent
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.link.trim import Pace, Trim, trim_from_reply
from tools.uno import CYCLES_PER_MS, Uno

SHOWS = """SI|ONE = 1; TWO = 2; THREE = 3; LOOP(8); SHOW(THREE); END_LOOP
TASK; LOOP(8); SHOW(ONE); END_LOOP; END_TASK
TASK; LOOP(8); W(0.001); SHOW(TWO); END_LOOP; END_TASK"""
CABLE = 4  # a cause in docs/develop/link.md
LIVE_CYCLES = 2160  # cycles from the last byte of a frame to the pins: 135 us in three of four
HASH_MS = 12  # time from a tag to its answer, without the bytes; stops use the interrupt
LATE_CYCLES = 2640  # 165 us: the work for a millisecond has just begun


def test_a_program_drives(uno: Uno) -> None:
    wired_uno = computer(uno)
    began_ms = wired_uno.now_ms
    send(wired_uno, "SI|F(1, 80)")
    assert states(uno) == FORWARD
    assert wired_uno.now_ms - began_ms < 500
    assert uno.pins["left"].duty == pytest.approx(0.8, abs=0.02)
    wired_uno.run(1100)
    assert states(uno) == OFF
    assert [event.name for event in wired_uno.session.events()] == ["DONE"]
    assert not uno.lost_bytes


def test_an_undo_writes_eight_bytes(uno: Uno) -> None:
    """Five of them are erased first."""
    wired_uno = computer(uno)
    for text in ("SB|F(0.2, 80); " + "SHOW(1); " * 20, "SB|B(0.2, 60); " + "SHOW(2); " * 30):
        send(wired_uno, text)
        wired_uno.run(2500)
        assert read_saved_state(wired_uno) == SAVED_STORED
    start_cycle = uno.cycle
    assert wired_uno.until(wired_uno.session.undo()) == OK
    wired_uno.run(500)
    write_cycles = [
        event.cycle for event in uno.events if event.kind == "eeprom" and event.cycle > start_cycle
    ]
    assert len(write_cycles) == 13
    assert write_cycles[-1] - write_cycles[0] < 60 * CYCLES_PER_MS
    uno.press("button")
    uno.run_ms(130)
    assert states(uno) == FORWARD


def test_a_measured_robot_keeps_its_speed(sketch: Path, memory: Path) -> None:
    uno = switched_on(sketch, memory)
    assert drive_ms(uno, "SI|F(20 CM, 60)") == pytest.approx(741, abs=2)
    wired_uno = computer(uno)  # current ones: this session ignores answers to the earlier one
    pace = Pace(16.5, 33.25, 144, 288)  # 24.875 cm in a second at 60 %
    assert wired_uno.until(wired_uno.session.trim(Trim(pace=pace).data())) == OK
    assert drive_ms(uno, "SI|F(20 CM, 60)") == pytest.approx(804, abs=2)
    uno.kill()
    with switched_on(sketch, memory) as restarted_robot:
        wired_uno = computer(restarted_robot, 2)
        assert trim_from_reply(wired_uno.complete(wired_uno.session.trim())) == Trim(pace=pace)
        assert drive_ms(restarted_robot, "SI|F(20 CM, 60)") == pytest.approx(804, abs=2)
        assert drive_ms(restarted_robot, "SI|R(90 DEG, 60)") == pytest.approx(417, abs=2)


def drive_ms(uno: Uno, text: str) -> float:
    """Return the time that a program drives."""
    wired_uno = computer(uno, uno.cycle)
    send(wired_uno, text, saves=False)
    assert states(uno) != OFF
    start_cycle = uno.pins["left"].cycle
    while states(uno) != OFF:
        wired_uno.run(1)
    return (uno.pins["left"].cycle - start_cycle) / CYCLES_PER_MS


def test_a_stop_silences_the_buzzer(uno: Uno) -> None:
    wired_uno = computer(uno)
    buzzer = f"D{robots.load('tinibot').board.buzzer}"
    send(wired_uno, "SI|BEEP(10, 440); W(20)")
    wired_uno.run(300)
    start_cycle = uno.cycle
    wired_uno.run(100)
    assert sum(change.cycle > start_cycle for change in uno.pins.history(buzzer)) > 20, "it sounds"
    uno.send(bytes(8))
    uno.run_ms(50)
    silent = uno.cycle
    uno.run_ms(500)
    assert not [change for change in uno.pins.history(buzzer) if change.cycle > silent]


def test_a_live_line_reaches_the_motors_at_once(uno: Uno) -> None:
    """This holds wherever the main loop is when the frame ends, and no frame is mistaken for a
    damaged one."""
    wired_uno = computer(uno)
    assert wired_uno.until(wired_uno.session.hello()) == OK
    wired_uno.run(1000)  # a new robot stores its identity
    code = image_of("SI|F(0.1, 80)").code
    delays = []
    for turn in range(25):
        uno.run_to(uno.cycle + 7 * turn)
        assert wired_uno.until(wired_uno.session.live(code)) == OK
        on = max(
            next(
                pin_change.cycle
                for pin_change in reversed(uno.pins.history(name))
                if pin_change.state == "pwm"
            )
            for name in ("left", "right")
        )
        zero = max(byte.cycle for byte in uno.received_bytes if byte.cycle < on)
        delays.append(on - zero)
        wired_uno.run(140)
    assert sorted(delays)[len(delays) * 3 // 4] <= LIVE_CYCLES
    assert max(delays) <= LATE_CYCLES
    assert wired_uno.complete(wired_uno.session.status()).damaged == 0


def disconnect_for(uno: Uno, ms: float) -> None:
    """Disconnect for so long, according to the HC-05's STATE pin."""
    cycle = uno.cycle + CYCLES_PER_MS
    uno.drive("radio", False, at_cycle=cycle)
    uno.drive("radio", True, at_cycle=cycle + round(ms * CYCLES_PER_MS))


def test_a_radio_that_loses_its_client_ends_an_attached_run(uno: Uno) -> None:
    """Glitches, single or repeated, do not count: the level must last for 50 ms."""
    uno.drive("radio", True)
    wired_uno = computer(uno)
    send(wired_uno, AWAY_PROGRAM)
    disconnect_for(uno, 49)
    wired_uno.run(150)
    assert states(uno) == FORWARD
    for pause_ms in (1, 5, 30, 49, 60):
        for _ in range(4):
            disconnect_for(uno, 0.3)
            wired_uno.run(pause_ms)
    assert states(uno) == FORWARD
    uno.drive("radio", False)
    wired_uno.run(40)
    uno.drive("radio", True)
    wired_uno.run(1)
    uno.drive("radio", False)
    wired_uno.run(40)
    assert states(uno) == FORWARD
    uno.drive("radio", True)
    wired_uno.run(60)
    left_cycle = uno.cycle + CYCLES_PER_MS
    disconnect_for(uno, 51)
    wired_uno.run(100)
    assert states(uno) == OFF
    off_cycle = max(uno.pins[name].cycle for name in MOTORS)
    assert 49.5 * CYCLES_PER_MS <= off_cycle - left_cycle < 53 * CYCLES_PER_MS
    wired_uno.run(300)
    stops = [event.cause for event in wired_uno.session.events() if event.name == "STOPPED"]
    assert stops == [CABLE]
    assert states(uno) == OFF


def test_a_missing_radio_ends_nothing_but_a_second_of_silence_does(uno: Uno) -> None:
    """The pin is unconnected, or belongs to a radio without a client."""
    assert uno.pins["radio"].state == "pullup"
    wired_uno = computer(uno)
    send(wired_uno, AWAY_PROGRAM)
    wired_uno.run(300)
    assert states(uno) == FORWARD
    uno.press("button")
    wired_uno.run(100)
    uno.drive("radio", False)
    wired_uno.run(100)
    assert wired_uno.until(wired_uno.session.clear()) == OK
    send(wired_uno, AWAY_PROGRAM)
    wired_uno.run(300)
    assert states(uno) == FORWARD
    last_cycle = max(byte.cycle for byte in uno.received_bytes)
    uno.run_ms(1500)
    assert states(uno) == OFF
    assert max(uno.pins[name].cycle for name in MOTORS) - last_cycle <= 1050 * CYCLES_PER_MS


@pytest.mark.parametrize("starts", ["detached", "button"])
def test_a_run_without_a_dead_man_timer_needs_no_client(uno: Uno, starts: str) -> None:
    uno.drive("radio", True)
    wired_uno = computer(uno)
    if starts == "detached":
        send(wired_uno, AWAY_PROGRAM, is_detached=True)
    else:
        send(wired_uno, AWAY_PROGRAM.replace("SI", "SB"))
        wired_uno.run(100)
        uno.press("button")
        uno.run_ms(150)
    assert states(uno) == FORWARD
    uno.drive("radio", False)
    uno.run_ms(1500)
    assert states(uno) == FORWARD
    uno.drive("radio", True)
    uno.run_ms(200)
    assert states(uno) == FORWARD


def test_a_tag_takes_milliseconds_and_a_claim_survives_a_reset(uno: Uno) -> None:
    """A key that is shown takes the main loop some milliseconds, and no more."""
    keys = Keys()

    def read_ownership(session_keys: Keys | None, nonce: int) -> str:
        wired_uno.session = Session(nonce, BAUD, KIT.fingerprint, keys=session_keys)
        assert wired_uno.until(wired_uno.session.hello()) == OK
        assert wired_uno.session.robot
        return ownership_of(wired_uno.session.robot)

    wired_uno = Wired(uno, Session(1, BAUD, KIT.fingerprint, keys=keys))
    request = wired_uno.session.claim(KEY_OWNER)
    wired_uno.run(300)
    uno.press("button", 2100)
    assert wired_uno.until(request) == OK
    began_ms = wired_uno.now_ms
    assert read_ownership(keys, 2) == OWNED_BY_YOU
    # HELLO and its answer, a challenge, a tag: about 150 bytes on the line
    assert wired_uno.now_ms - began_ms <= 150 * 10 * 1000 / BAUD + 2 * HASH_MS + 8
    uno.reset("external")
    uno.run_ms(300)
    assert read_ownership(keys, 3) == OWNED_BY_YOU
    assert read_ownership(None, 4) == OWNED_BY_OTHER


def test_values_of_tasks_belong_to_their_own_shows(uno: Uno) -> None:
    """All of them wait for the wire, which takes 18 ms for each value."""
    compilation = compile_text(SHOWS, KIT)
    places, wired_uno = source_map.map_of_compiled(compilation), computer(uno)
    finder = ShowFinder({checksum(compilation.image): places})
    assert wired_uno.until(wired_uno.session.upload(unpack(compilation.image))) == OK
    events: list[Event] = []
    while not any(event.name == "DONE" for event in events):
        wired_uno.run(20)
        events += wired_uno.session.events()
    shown_events = [shown_event for shown_event in events if isinstance(shown_event, ShownEvent)]
    names = {1: "ONE", 2: "TWO", 3: "THREE"}
    for event in shown_events:
        show = finder.show_of(event)
        assert show and show.text == names[event.value // 1000], event
    assert [sum(shown_event.value == 1000 * k for shown_event in shown_events) for k in names] == [
        8,
        8,
        8,
    ]
