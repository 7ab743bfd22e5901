"""The trace of a simulated Uno's motors, and how it is compared."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from tests.machines import MACHINES
from tests.support.case_runs import compile_case, robot_and_senses
from tests.support.casefile import Case
from tests.support.robot_on_uno import MOTORS, computer
from tiniscript.bytecode.image import unpack
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

SHORT_MS = 95  # settings that are over sooner: between two instructions, or while a sensor is read
OFF_MS = 5  # tolerance of a change's time in the trace
PING_MS = 25
READING_MS = 55  # extra tolerance for each earlier reading, which may need confirmation
FIRST_READING_MS = 85  # extra tolerance for the first reading of the run
LAST_MESSAGE_MS = 200  # time at the end in which SHOW and DONE may be on the wire


class MotorSetting(NamedTuple):
    """The powers of the motors from a time on, in percent."""

    ms: float
    left: int
    right: int


def program(text: str) -> Case:
    return Case(Path(__file__), 0, text, {"tiniscript": text, "senses": "DISTANCE = 60"})


def motor_settings(uno: Uno, start_cycle: int) -> list[MotorSetting]:
    """Return the settings of the motor pins since a cycle."""
    changes = [
        change
        for name in MOTORS
        for change in uno.pins.history(name)
        if change.cycle > start_cycle
    ]  # fmt: skip
    settings = []
    for cycle in sorted({change.cycle for change in changes}):
        powers = (power(uno, side, cycle) for side in ("left", "right"))
        settings.append(MotorSetting((cycle - start_cycle) / CYCLES_PER_MS, *powers))
    return lasting(settings)


def power(uno: Uno, side: str, cycle: int) -> int:
    strength = uno.pins.at(side, cycle)
    if strength.state == "low":
        return 0
    level = strength.value if strength.state == "pwm" else 255
    is_backward = uno.pins.at(f"{side} backward", cycle).state == "high"
    return round(-level / 2.55 if is_backward else level / 2.55)


def parsed_trace(trace: str) -> tuple[list[MotorSetting], list[float]]:
    """Return the motors and the times of readings that a trace has; its end turns them off."""
    rows = [line.split() for line in trace.splitlines()]
    settings = [
        MotorSetting(float(row[0]), int(row[2]), int(row[3])) for row in rows if row[1] == "MOTORS"
    ]
    end_ms = float(rows[-1][0])
    if rows[-1][1] == "DONE":
        settings.append(MotorSetting(end_ms, 0, 0))
    return lasting(settings), [float(row[0]) for row in rows if row[1] == "READ"]


def lasting(settings: list[MotorSetting]) -> list[MotorSetting]:
    """Return the settings that are different from the one before, and last; the last one does."""
    settings = [
        setting for earlier_setting, setting in pairwise([MotorSetting(-1.0, 101, 0), *settings])
        if earlier_setting[1:] != setting[1:]
    ]  # fmt: skip
    end_times_ms = [setting.ms for setting in settings[1:]] + [float("inf")]
    lasting_settings = [MotorSetting(-1.0, 0, 0)]
    for setting, end_ms in zip(settings, end_times_ms[: len(settings)], strict=True):
        if end_ms - setting.ms >= SHORT_MS and setting[1:] != lasting_settings[-1][1:]:
            lasting_settings.append(setting)
    return lasting_settings[1:]


def simulate_pings(distances: list[float]) -> list[float]:
    """Return the distance that each ping measures: three pings make the first reading, and two one
    that jumps.
    """
    heard_cm = distances[:1] * 3
    for last_distance, distance in pairwise(distances):
        is_far = abs(distance - last_distance) > max(3, last_distance / 5)
        heard_cm += [distance] * (1 + is_far)
    return heard_cm


def check_pins(case: Case, uno: Uno) -> None:
    robot, senses = robot_and_senses(case)
    image = unpack(compile_case(case).image)
    trace = MACHINES["python"](compile_case(case).image, robot.kit, senses)
    expected, reading_times = parsed_trace(trace)
    end_ms = float(trace.splitlines()[-1].split()[0])
    is_over = not trace.endswith("LIMIT\n")
    distances = [value / 1000 for value in senses.readings.get("DISTANCE", [0])]
    for pin, name in (("A0", "LIGHT_R"), ("A1", "LIGHT_L")):
        uno.set_analog(pin, senses.readings.get(name, [0])[0] // 1000)
    uno.set_sonar_distance("trigger", "echo", distances[0])
    wired_uno = computer(uno)
    if image.start == "PING":
        assert wired_uno.until(wired_uno.session.hello()) == OK
        assert motor_settings(uno, 0) == []
        return
    heard_count = len(uno.received_bytes)
    assert wired_uno.until(wired_uno.session.upload(image, is_detached=True)) == OK
    start_count = last_zero(uno, heard_count)
    if image.start == "SB":
        wired_uno.run(300)
        assert motor_settings(uno, start_count) == []
        uno.press("button", 60)
        start_count = uno.run_until("left forward", "high", limit_ms=500).cycle - 1
    triggers = 0
    distances = simulate_pings(distances)
    last_ms = end_ms + FIRST_READING_MS + READING_MS * len(reading_times) + LAST_MESSAGE_MS
    while (uno.cycle - start_count) / CYCLES_PER_MS < last_ms:
        wired_uno.run(2)
        pulses = [
            pin_change for pin_change in uno.pins.history("trigger") if pin_change.state == "high"
        ]
        if len(pulses) > triggers:
            triggers = len(pulses)
            wired_uno.run(PING_MS)
            uno.set_sonar_distance("trigger", "echo", distances[min(triggers, len(distances) - 1)])
    settings = motor_settings(uno, start_count)
    events = wired_uno.session.events()
    if not is_over:
        settings = [setting for setting in settings if setting.ms < end_ms]
        expected = [setting for setting in expected if setting.ms < end_ms]
    assert [setting[1:] for setting in settings] == [setting[1:] for setting in expected]
    for pins, line in zip(settings, expected, strict=True):
        read_count = sum(read_ms <= line.ms for read_ms in reading_times)
        late_ms = (
            OFF_MS + READING_MS * read_count + (FIRST_READING_MS - READING_MS) * bool(read_count)
        )
        assert -OFF_MS <= pins.ms - line.ms <= late_ms, (pins, line)
    if is_over:
        lines = [line.split(" ", 1)[1] for line in trace.splitlines()]
        shown_texts = [line for line in lines if line.startswith("SHOW") or line == "DONE"]
        names = [event.name for event in events]
        assert [name for name in names if name in ("SHOW", "DONE")] == [
            line.split()[0] for line in shown_texts
        ]


def last_zero(uno: Uno, start_count: int) -> int:
    """Return the time of the last frame from which a movement started."""
    heard_bytes = uno.received_bytes[start_count:]
    drive_cycles = [
        change.cycle
        for name in MOTORS
        for change in uno.pins.history(name)
        if change.state in ("high", "pwm") and change.cycle > heard_bytes[0].cycle
    ]
    end = min(drive_cycles, default=heard_bytes[-1].cycle + 1)
    return max(byte.cycle for byte in heard_bytes if byte.cycle < end and byte.value == 0)
