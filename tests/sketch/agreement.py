"""Compares a sketch on a simulated board with a trace: the same actions at the same times.

A trace lists the outputs to motors, buzzer, actuators and SHOW, with their times. Both are signals;
a change shorter than the tolerance may be missing in the other.
"""

from __future__ import annotations

import random
import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from tests.machines.sketch_board import Ran, Signal, SketchBoard
from tests.oracle import interpreter, programs
from tests.oracle.interpreter import Kit as OracleKit
from tests.support.edited_robots import TEXTS
from tests.support.kits import KITS
from tiniscript import compile_text
from tiniscript.base.fixed_point import ONE
from tiniscript.codegen.sketch.writing import sketch_of
from tiniscript.robots.profile import Robot
from tiniscript.robots.reader import read

PRESS_MS, RELEASE_MS, UP_MS = 20.0, 60.0, 90.0  # the button of a program that begins with SB
NEAR_MS = 6.0  # tolerance in time
MAX_MS, MAX_STEPS = 3_000, 3_000
PLAIN_MS = 250  # time at the end in which a SHOW may be under way
WIDE = """
[[kit.sensors]]
name = "TEMPERATURE"
kind = "number"
range = [-40, 125]

[[kit.sensors]]
name = "TOUCH"
kind = "yes/no"

[[kit.sensors]]
name = "LINE"
kind = "yes/no"

[[kit.actuators]]
name = "GRIPPER"
kind = "number"
range = [0, 180]

[[kit.actuators]]
name = "LIFT"
kind = "number"
range = [-90, 90]

[[kit.actuators]]
name = "LED"
kind = "yes/no"

[board.sensors.TEMPERATURE]
driver = "analog"
pin = "A2"
zero = -50
full = 450

[board.sensors.TOUCH]
driver = "digital"
pin = "A3"
pull_up = true
yes_is_low = true

[board.sensors.LINE]
driver = "threshold"
pin = "A4"
threshold = 600

[board.actuators.GRIPPER]
driver = "servo"
pin = 12
low_us = 600
high_us = 2400

[board.actuators.LIFT]
driver = "servo"
pin = 13

[board.actuators.LED]
driver = "digital"
pin = "A5"
"""


def with_wide_kit() -> Robot:
    """The robot tinibot with all devices of the random programs, and a quick line for SHOW."""
    text = TEXTS["tinibot"].replace("baud = 9600", "baud = 115200")
    for line in ("status_led = 13", "bluetooth_state = 12"):
        assert line in text
        text = text.replace(line, "")
    head, _, body = text.partition("[body]")
    labels = "".join(f'{name} = "{name}"\n' for name in WIDE_NAMES)
    body = body.replace("[labels.es]", labels + "[labels.es]") + labels
    kit, _, board = WIDE.partition("[board.")
    first, _, rest = head.partition("[board]")
    return read(f"{first}{kit}[board]{rest}[board.{board}[body]{body}", "wide")


WIDE_NAMES = ("TEMPERATURE", "TOUCH", "LINE", "GRIPPER", "LIFT", "LED")


class ExpectedRun(NamedTuple):
    """The content of a trace, as signals."""

    motors: Signal
    tones: Signal
    settings: dict[str, Signal]
    lines: list[tuple[float, str]]
    end_ms: float
    is_cut: bool


def parse_trace(trace: str) -> ExpectedRun:
    parsed_run = ExpectedRun([(0.0, (0, 0))], [(0.0, (0,))], {}, [], 0.0, False)
    for line in trace.splitlines():
        ms, action, *words = line.split()
        start_ms = float(ms)
        if action == "MOTORS":
            parsed_run.motors.append((start_ms, (int(words[0]), int(words[1]))))
        elif action == "BEEP" and int(words[1]):
            parsed_run.tones.append((start_ms, (int(words[0]),)))
            parsed_run.tones.append((start_ms + int(words[1]), (0,)))
        elif action == "SET":
            value = {"TRUE": 1, "FALSE": 0}.get(words[1]) if words[1].isalpha() else int(words[1])
            assert value is not None
            parsed_run.settings.setdefault(words[0], [(0.0, (0,))]).append((start_ms, (value,)))
        elif action == "SHOW":
            parsed_run.lines.append((start_ms, words[0]))
        elif action == "FAULT":
            parsed_run.lines.append((start_ms, line.split(" ", 1)[1]))
        parsed_run = parsed_run._replace(end_ms=start_ms, is_cut=action == "LIMIT")
    if not parsed_run.is_cut:
        parsed_run.motors.append((parsed_run.end_ms, (0, 0)))
    return parsed_run


def spans(signal: Signal, end: float) -> list[tuple[float, float, tuple[int, ...]]]:
    end_times_ms = [start_ms for start_ms, _ in signal[1:]] + [end]
    return [
        (start_ms, end_ms, value)
        for (start_ms, value), end_ms in zip(signal, end_times_ms, strict=True)
        if start_ms < end_ms and start_ms < end
    ]


def signal_differences(
    expected: Signal, actual: Signal, end: float, tolerance_ms: float, tolerance: float = 0
) -> list[str]:
    """Return the difference of two signals; pulses below twice `tolerance_ms` may be missing."""

    def agree(a: tuple[int, ...], b: tuple[int, ...]) -> bool:
        return all(abs(x - y) <= tolerance * max(abs(x), abs(y)) for x, y in zip(a, b, strict=True))

    found_differences = []
    expected_spans, actual_spans = spans(expected, end), spans(actual, end)
    for start_ms, end_ms, value in expected_spans:
        inner = [
            v
            for a, u, v in actual_spans
            if a < end_ms - tolerance_ms and u > start_ms + tolerance_ms
        ]
        if end_ms - start_ms > 2 * tolerance_ms and not all(agree(value, v) for v in inner):
            found_differences.append(f"{value} from {start_ms} to {end_ms}, but {inner[:4]}")
    for start_ms, end_ms, value in actual_spans:
        values_around = [
            v
            for a, u, v in expected_spans
            if a < end_ms + tolerance_ms and u > start_ms - tolerance_ms
        ]
        if start_ms > end - tolerance_ms:  # events after the end
            continue
        if end_ms - start_ms > 2 * tolerance_ms and not any(agree(value, v) for v in values_around):
            found_differences.append(
                f"{value} from {start_ms:.1f} to {end_ms:.1f} is not in the trace"
            )
    return found_differences


def nearness(trace: str, echo_us: float = 0) -> float:
    """Return the time tolerance of a sketch, which may wait 25 ms for an echo."""
    return NEAR_MS + (2 if echo_us else min(160, 27 * trace.count(" READ DISTANCE ")))


def shift_signal(signal: Signal, by: float, first: tuple[int, ...]) -> Signal:
    """Return a signal from the start of the program on."""
    return [(0.0, first), *((max(0.0, start_ms - by), value) for start_ms, value in signal)]


def differences(
    trace: str,
    run: Ran,
    robot: Robot,
    start_ms: float,
    tolerance_ms: float = NEAR_MS,
    tolerance: float = 0,
) -> list[str]:
    """Return the differences between a sketch's run and the trace, with a tolerance for numbers."""
    expected = parse_trace(trace)
    end = expected.end_ms
    motors = [*expected.motors]
    found_differences = signal_differences(
        motors, shift_signal(run.motors, start_ms, (0, 0)), end, tolerance_ms
    )
    found_differences += signal_differences(
        expected.tones, shift_signal(run.tones, start_ms, (0,)), end, tolerance_ms, 0.02
    )
    for device, wiring in zip(robot.kit.actuators, robot.board.actuators, strict=True):
        signal = shift_signal(run.pins[wiring.pins["pin"]], start_ms, (0,))
        settings_signal = expected.settings.get(device.name, [(0.0, (0,))])
        if wiring.driver == "digital":
            low = wiring.settings["yes_is_low"]
            levels: Signal = [
                (start_ms, ((value[0] ^ low) * 255,)) for start_ms, value in settings_signal
            ]
            found_differences += signal_differences(levels, signal, end, tolerance_ms)
        elif wiring.driver == "servo":
            found_differences += pulses(
                device.low, device.high, wiring.settings, settings_signal, signal, end
            )
    return found_differences + compare_shows(expected, run, tolerance, tolerance_ms)


def pulses(
    low: int,
    high: int,
    settings: Mapping[str, int],
    settings_signal: Signal,
    signal: Signal,
    end: float,
) -> list[str]:
    """Return the pulses of a servo that do not match its settings."""
    found_differences, low_us, high_us = [], settings["low_us"], settings["high_us"]
    for k, (start_ms, end_ms, value) in enumerate(spans(settings_signal, end)):
        lengths_us = [
            1000 * (fall_ms - rise_ms)
            for rise_ms, fall_ms, level in spans(signal, end)
            if level[0] and rise_ms > start_ms + 30 and fall_ms < end_ms - 2
        ]
        if k == 0 and (len(settings_signal) == 1 or settings_signal[1][0] > 0):
            if lengths_us:
                found_differences.append(f"pulses before a SET: {lengths_us[:3]}")
            continue
        us = low_us + (value[0] - low / ONE) * (high_us - low_us) / ((high - low) / ONE)
        if end_ms - start_ms > 60 and (
            not lengths_us or any(abs(length_us - us) > 20 for length_us in lengths_us)
        ):
            found_differences.append(f"{value} is {us} us, but {lengths_us[:4]}")
    return found_differences


def compare_shows(
    expected: ExpectedRun, run: Ran, tolerance: float, tolerance_ms: float
) -> list[str]:
    """Return the superfluous and missing values of SHOW."""
    lines = run.text.split("\r\n")[:-1]
    questions = [line for _, line in expected.lines]
    common = min(len(lines), len(questions))
    min_count = len(questions)
    if expected.is_cut:
        min_count = sum(start_ms < expected.end_ms - tolerance_ms for start_ms, _ in expected.lines)
    is_same = all(map(_is_line, lines[:common], questions[:common], [tolerance] * common))
    if is_same and len(lines) >= min_count and (expected.is_cut or len(lines) == min_count):
        return []
    return [f"shown {lines[:20]}, not {questions[:20]}"]


def _is_line(line: str, question: str, tolerance: float) -> bool:
    if line == question or not tolerance:
        return line == question
    return not question[-1:].isalpha() and abs(float(line) - float(question)) <= tolerance


def sketch(text: str, robot: Robot, language: str = "en") -> str:
    compilation = compile_text(text, robot.kit, "prog.ts")
    assert compilation.program is not None and compilation.is_right, compilation.diagnostics
    return sketch_of(compilation.source, compilation.program, robot, language)


# -- random programs


class Example(NamedTuple):
    seed: int
    text: str
    trace: str
    counts: Mapping[str, int]  # converter values, and levels of digital pins


def example(seed: int, robot: Robot) -> Example | None:
    """Return a random program and the oracle's result.

    None if it calculates endlessly, which takes no time for the oracle, or if TIME could show how
    long it waited for an echo.
    """
    rng = random.Random(seed)
    kit: OracleKit = KITS[1][0]._replace(has_remote=False)
    text = programs.program(rng, kit)
    counts = {"LIGHT_R": rng.randint(0, 1023), "LIGHT_L": rng.randint(0, 1023),
              "TEMPERATURE": rng.randint(20, 360), "LINE": rng.choice((100, 900)),
              "TOUCH": rng.randint(0, 1)}  # fmt: skip
    millicelsius = (
        -50_000 + counts["TEMPERATURE"] * 488 + (counts["TEMPERATURE"] * 776 + 511) // 1023
    )
    senses: dict[str, Sequence[int]] = {
        "LIGHT_R": [counts["LIGHT_R"] * ONE],
        "LIGHT_L": [counts["LIGHT_L"] * ONE],
        "TEMPERATURE": [max(-40_000, min(125_000, millicelsius))],
        "DISTANCE": [400_000],
        "TOUCH": [counts["TOUCH"]],
        "LINE": [int(counts["LINE"] > 600)],
    }
    trace = interpreter.run(text, kit, senses, MAX_MS, MAX_STEPS, 1)
    if trace.endswith(" LIMIT\n") and not trace.endswith(f"\n{MAX_MS} LIMIT\n"):
        return None
    if " READ DISTANCE " in trace and re.search(r"\bTIME\b", text.upper()):
        return None
    return Example(seed, text, trace, counts)


def check(example: Example, robot: Robot, language: str = "en") -> None:
    """Check that the sketch of a random program agrees with the oracle."""
    compilation = compile_text(example.text, robot.kit, "prog.ts")
    assert compilation.program is not None and compilation.is_right
    board = SketchBoard(robot, sketch_of(compilation.source, compilation.program, robot, language))
    pins = {
        device.name: wiring.pins
        for device, wiring in zip(robot.kit.sensors, robot.board.sensors, strict=True)
    }
    for name in ("LIGHT_R", "LIGHT_L", "TEMPERATURE", "LINE"):
        board.set_counts(pins[name]["pin"], [example.counts[name]])
    board.set_level(0, pins["TOUCH"]["pin"], not example.counts["TOUCH"])
    board.set_echoes(pins["DISTANCE"]["trigger"], pins["DISTANCE"]["echo"], [0])
    start = 0.5
    if compilation.program.start == "SB":
        start = UP_MS
        board.set_level(PRESS_MS, robot.board.start_button, False)
        board.set_level(RELEASE_MS, robot.board.start_button, True)
    expected = parse_trace(example.trace)
    reads = example.trace.count(" READ DISTANCE ")
    run = board.run_for(start + expected.end_ms + (0 if expected.is_cut else PLAIN_MS + 30 * reads))
    tolerance_ms = nearness(example.trace)
    found_differences = differences(example.trace, run, robot, start, tolerance_ms)
    assert not found_differences, (
        f"seed {example.seed}: {found_differences[:3]}\n{example.text}\n{example.trace[:3000]}"
    )
