"""Readings of a program are reported to a computer, without a change of its pins' times.

A whole robot on this computer, with the byte time of a line of 9600 baud.
"""

from __future__ import annotations

import random
from math import inf

import pytest

from tests.support.debugging import DebuggedRobot
from tests.support.images import image_of
from tests.support.robot_on_host import KIT
from tests.support.sensed_runs import (
    BYTE_TICKS,
    LARGEST_DELAY_MS,
    is_steady,
    run_with_sensors,
    sensed_run,
)
from tests.support.shown_in_loops import largest_difference_ms, program
from tiniscript.link import handshake
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import AFTER_GAP, BY_NAME, READINGS, STATUSES, encode_payload
from tiniscript.link.payloads import ReadingEvent
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

MAX_BYTES = 17  # bytes of READING on the line, as for SHOW
FAST_TICKS = 0  # a line without delay
READING = BY_NAME["READING"]
TOO_MANY_READINGS = "SI|LOOP(FOREVER);X = LIGHT_L + LIGHT_R + DISTANCE;W(0.005);END_LOOP"


@pytest.mark.sampled("seed", keep=10)
@pytest.mark.parametrize("seed", range(100))
def test_reporting_readings_does_not_change_the_timing_of_pins(seed: int) -> None:
    """The programs' times do not depend on a line that is 5 % slower or faster: in others, a
    waiting SHOW changes everything after it.
    """
    text = program(random.Random(seed))
    silent_run, reporting_run = (
        sensed_run(text, seed, is_told, BYTE_TICKS) for is_told in (False, True)
    )
    apart = largest_difference_ms(silent_run.did, reporting_run.did)
    assert apart < inf, f"all do the same in the same order: {text}"
    assert apart <= LARGEST_DELAY_MS or not is_steady(text, seed), text
    shown_events = [
        [event for event in run.events if event.name == "SHOW"]
        for run in (silent_run, reporting_run)
    ]
    assert abs(len(shown_events[0]) - len(shown_events[1])) <= max(2, len(shown_events[0]) // 20)
    assert not silent_run.readings


@pytest.mark.parametrize("seed", range(8))
def test_missing_readings_are_reported_for_their_sensor(seed: int) -> None:
    """A line without delay reports all readings; a slow one the same, or that some are missing."""
    text = program(random.Random(seed)).replace("SHOW(", "W(0.001) // ")
    max_change_interval_ms = 5 if seed % 2 else 30
    full_run, limited_run = (
        sensed_run(text, seed, True, ticks, max_change_interval_ms)
        for ticks in (FAST_TICKS, BYTE_TICKS)
    )
    assert not [event for event in full_run.readings if event.sensor & AFTER_GAP]
    for sensor in range(len(KIT.sensors)):
        all_of_it = [event for event in full_run.readings if event.sensor == sensor]
        position = 0
        for event in limited_run.readings:
            if event.sensor & ~AFTER_GAP != sensor:
                continue
            if not event.sensor & AFTER_GAP:
                assert event == all_of_it[position], "nothing is left out before it"
                position += 1
            else:  # the value is the last reading
                earlier_indices = [
                    k for k, reading in enumerate(all_of_it) if reading.ms <= event.ms
                ]
                assert (
                    earlier_indices
                    and earlier_indices[-1] >= position
                    and all_of_it[earlier_indices[-1]].value == event.value
                )
                position = earlier_indices[-1] + 1


def test_a_too_slow_line_is_reported() -> None:
    run = sensed_run(TOO_MANY_READINGS, 1, True, BYTE_TICKS, max_change_interval_ms=5)
    assert [event for event in run.readings if event.sensor & AFTER_GAP]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("wait_s", [0.001, 0.005, 0.01])
def test_the_end_of_a_run_is_reported_after_its_readings(seed: int, wait_s: float) -> None:
    """However many of them the line had no room for."""
    text = f"SI|LOOP(40);X = LIGHT_L + LIGHT_R + DISTANCE;W({wait_s});END_LOOP"
    names = [
        event.name
        for event in sensed_run(text, seed, True, BYTE_TICKS, max_change_interval_ms=5).events
    ]
    assert names.count("DONE") == 1 and names[-1] == "DONE" and "READING" in names


def test_a_reading_message_is_no_longer_than_a_value_message() -> None:
    rng = random.Random(1)
    for _ in range(2000):
        value, ms = rng.randrange(-1 << 31, 1 << 31), rng.randrange(1 << 16)
        values = {"run": rng.randrange(256), "sensor": rng.randrange(256), "value": value, "ms": ms}
        payload = encode_payload(READING.reply, values)
        seq, epoch = rng.randrange(256), rng.randrange(256)
        wire = encode_frame(Frame(READING.number, seq, epoch, payload, is_reply=True))
        assert len(wire) <= MAX_BYTES


def drawn_program(rng: random.Random) -> str:
    """Return a program that reads each sensor at once, and whose values leave readings room."""
    text = program(rng).replace("X = 1", "X = DISTANCE + LIGHT_L + LIGHT_R", 1)
    return text.replace("SHOW(", "W(0.01)\nSHOW(")


@pytest.mark.sampled("seed", keep=4)
@pytest.mark.parametrize("seed", range(40))
def test_a_run_reports_the_readings_that_a_fresh_robot_reports(seed: int) -> None:
    """Whatever has run before on whatever line, and whenever that was stopped."""
    rng = random.Random(seed)
    text = rng.choice((drawn_program(rng), TOO_MANY_READINGS))
    first_text = rng.choice((text, drawn_program(rng)))

    values = [rng.choice((0, 100)) for _ in KIT.sensors]  # 0 is what a robot assumes at first

    def readings_of(robot: DebuggedRobot) -> list[tuple[int, int, int]]:
        if text != first_text:  # the same program starts anew, with its readings still to come
            upload = robot.session.upload(image_of(text), runs=False, saves=False)
            assert robot.robot.until(robot.session, upload) == OK
        robot.robot.set_byte_ticks(FAST_TICKS)
        robot.robot.set_readings(*values)
        robot.start()
        events = [event for event in robot.talk(300) if isinstance(event, ReadingEvent)]
        return [(event.sensor, event.value, event.ms) for event in events
                if event.run == robot.session.run and event.ms < 250]  # fmt: skip

    robots = [DebuggedRobot(first_text) for _ in range(2)]
    for robot in robots:
        assert robot.robot.until(robot.session, robot.session.tell_readings(True)) == OK
    line_ticks, run_ms = rng.choice((FAST_TICKS, BYTE_TICKS)), rng.choice((5, 60, 300))
    run_with_sensors(robots[0], rng, line_ticks, max_change_interval_ms=5, run_ms=run_ms)
    used_told, fresh_told = (readings_of(robot) for robot in robots)
    assert fresh_told and used_told == fresh_told, f"{first_text}\nthen {text}"


def test_other_sessions_get_no_readings() -> None:
    robot = DebuggedRobot("SI|LOOP(FOREVER);X = DISTANCE;W(0.05);END_LOOP")
    assert robot.robot.until(robot.session, robot.session.tell_readings(True)) == OK
    robot.session = Session(2, 9600, KIT.fingerprint)
    assert robot.robot.until(robot.session, robot.session.hello()) == OK
    robot.start()
    assert not [event for event in robot.talk(500) if isinstance(event, ReadingEvent)]


def test_robots_without_reading_reports_are_not_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = DebuggedRobot("SI|SHOW(1)")
    assert robot.session.robot is not None
    assert robot.session.robot.values.features & READINGS
    monkeypatch.setattr(handshake, "READINGS", 0)
    request = robot.session.tell_readings(True)
    assert robot.robot.until(robot.session, request) == STATUSES["NO_READINGS"]
