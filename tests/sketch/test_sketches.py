"""A sketch of `tsc show --arduino` builds, and behaves on a simulated board like the program.

`python -m tests.sketch.test_sketches 200` tries the programs of this many seeds; a quarter of them
have no sketch.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines import MACHINES, Senses
from tests.machines.sketch_board import Ran, SketchBoard, build_sketch
from tests.sketch.agreement import (
    PRESS_MS,
    RELEASE_MS,
    UP_MS,
    check,
    differences,
    example,
    nearness,
    parse_trace,
    shift_signal,
    sketch,
    spans,
    with_wide_kit,
)
from tests.support.board_states import BRIDGE_STATES, DRIVERS, SERVOS, robot_with, robot_with_driver
from tests.support.campaign import each_seed, make_options
from tests.support.casefile import example_robot, sketch_examples
from tiniscript import compile_text, robots
from tiniscript.base.fixed_point import ONE
from tiniscript.codegen.sketch.writing import missing_feature, sketch_of
from tiniscript.lessons import catalogue
from tiniscript.robots.profile import Robot

EXAMPLES = sketch_examples()


def has_sketch(text: str) -> bool:
    """Return whether `tsc show --arduino` supports it on the robot of the lesson's answer."""
    kit = robots.load("tinibot").kit
    compilation = compile_text(text, kit)
    if not compilation.is_right:
        kit = robots.load("liner").kit
        compilation = compile_text(text, kit)
    assert compilation.program is not None and compilation.is_right
    return missing_feature(compilation.program, kit) is None


ANSWERS = [
    (f"{folder.name} {number}", answer.program)
    for folder in catalogue.folders()
    for number, answer in enumerate(catalogue.answers(folder)[0])
    if has_sketch(answer.program)
]
START_MS = 0.5
NO_ECHO_US, NEAR_ECHO_US = 0.0, 8 * 2 / 0.0343  # echoes: none, and one of 8 cm


def run_sketch(text: str, ms: float, robot: Robot | None = None) -> Ran:
    robot = robot or robots.load("tinibot")
    return SketchBoard(robot, sketch(text, robot)).run_for(ms)


def check_agreement(text: str, robot: Robot, echo_us: float, counts: int, seconds: float) -> None:
    """Check that a sketch agrees with the trace, with constant readings."""
    compilation = compile_text(text, robot.kit, "prog.ts")
    assert compilation.program is not None and compilation.is_right
    board = SketchBoard(robot, sketch_of(compilation.source, compilation.program, robot, "es"))
    readings: dict[str, list[int]] = {}
    for device, wiring in zip(robot.kit.sensors, robot.board.sensors, strict=True):
        pins = wiring.pins
        if wiring.driver == "hc_sr04":
            board.set_echoes(pins["trigger"], pins["echo"], [echo_us])
            readings[device.name] = [round(echo_us * 17.15) if echo_us else 400_000]
        elif wiring.driver == "digital":
            board.set_level(0, pins["pin"], bool(wiring.settings["yes_is_low"]) == (counts < 500))
            readings[device.name] = [int(counts >= 500)]
        else:
            count = counts + 40 * (device.name == "LIGHT_L")
            board.set_counts(pins["pin"], [count])
            readings[device.name] = [count * ONE]
    start = START_MS
    if compilation.program.start == "SB":
        start = UP_MS
        board.set_level(PRESS_MS, robot.board.start_button, False)
        board.set_level(RELEASE_MS, robot.board.start_button, True)
    trace = MACHINES["python"](
        compilation.image, robot.kit, Senses(readings, round(seconds * 1000))
    )
    expected = parse_trace(trace)
    run = board.run_for(start + expected.end_ms + (0 if expected.is_cut else 400))
    tolerance_ms = nearness(trace, echo_us)
    found_differences = differences(trace, run, robot, start, tolerance_ms, 0.2 if echo_us else 0)
    assert not found_differences, f"{found_differences[:3]}\n{text}\n{trace[:2000]}"


@pytest.mark.sampled("echo_us", "path", keep=3)
@pytest.mark.parametrize("echo_us", [NO_ECHO_US, NEAR_ECHO_US], ids=["far", "near"])
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_sketches_of_examples_agree(path: Path, echo_us: float) -> None:
    robot = robots.load(example_robot(path))
    check_agreement(path.read_text(encoding="utf-8"), robot, echo_us, 300, 2)


@pytest.mark.sampled("number", keep=len(ANSWERS) // 10)
@pytest.mark.parametrize("number", range(len(ANSWERS)), ids=lambda n: ANSWERS[n][0])
def test_sketches_of_lesson_answers_agree(number: int) -> None:
    text = ANSWERS[number][1]
    liner = robots.load("liner").kit
    robot = robots.load("liner" if not compile_text(text, ROBOT.kit).is_right else "tinibot")
    assert robot.name == "tinibot" or compile_text(text, liner).is_right
    check_agreement(
        text, robot, (NO_ECHO_US, NEAR_ECHO_US)[number % 2], (300, 700)[number // 2 % 2], 2
    )


ROBOT, ROBOT_WIDE = robots.load("tinibot"), with_wide_kit()


@pytest.mark.sampled("seeds")
@pytest.mark.parametrize("seeds", [range(k, k + 4) for k in range(0, 24, 4)], ids=str)
def test_random_programs_agree(seeds: range) -> None:
    for seed in seeds:
        check_seed(seed)


# -- parts of kits

MOVES = "SI|F(0.1, 80);B(0.1, 40);M(50, -100);W(0.1)"
POWERS = [(80, 80), (-40, -40), (50, -100), (0, 0)]


@pytest.mark.parametrize("name", sorted(DRIVERS))
def test_motor_drivers_work_in_a_sketch(name: str) -> None:
    motors = shift_signal(run_sketch(MOVES, 400, robot_with_driver(name)).motors, START_MS, (0, 0))
    lasting = [value for start_ms, end_ms, value in spans(motors, 399) if end_ms - start_ms > 5]
    assert lasting == POWERS


def test_a_tb6612_is_awake_while_it_drives() -> None:
    robot = robots.load("liner")
    board = SketchBoard(robot, sketch("SI|F(0.1, 80)", robot))
    standby = robot.board.motors.pins["standby"]
    levels = shift_signal(board.run_for(150).pins[standby], START_MS, (0,))
    assert [value for start_ms, end_ms, value in spans(levels, 149) if end_ms - start_ms > 2] == [
        (255,),
        (0,),
    ]
    assert BRIDGE_STATES  # the states of the other pins are those of the drivers above


def test_servos_that_turn_get_their_pulses() -> None:
    """They get them for one more second after a stop, then none; the right one turns the other
    way."""
    robot = robot_with(SERVOS)
    board = SketchBoard(robot, sketch("SI|F(0.2, 100);W(2)", robot))
    run = board.run_for(1900)
    for side, driving, still in (("left", 2010, 1500), ("right", 970, 1480)):
        signal = run.pins[robot.board.motors.pins[f"{side}_pin"]]
        pulse_list = [
            (start_ms, 1000 * (gone - start_ms))
            for start_ms, gone, level in spans(signal, 1899)
            if level[0]
        ]
        assert all(abs(us - driving) < 25 for start_ms, us in pulse_list if 25 < start_ms < 190)
        assert all(abs(us - still) < 25 for start_ms, us in pulse_list if start_ms > 230)
        assert 48 <= sum(start_ms > 210 for start_ms, _ in pulse_list) <= 51
        assert sum(start_ms < 200 for start_ms, _ in pulse_list) >= 8


def test_gripper_and_lamp_of_a_mega_are_set() -> None:
    robot = robots.load("grabber")
    check_agreement(
        "SI|GRIPPER(90);LED(TRUE);W(0.2);GRIPPER(0);LED(FALSE);W(0.2)", robot, NO_ECHO_US, 100, 1
    )


def test_a_pwm_actuator_is_set() -> None:
    from tests.support.edited_robots import TEXTS
    from tiniscript.robots.reader import read

    text = TEXTS["grabber"].replace('driver = "servo"            #', 'driver = "pwm" #')
    for line in ("at_stop = ", "low_us = ", "high_us = "):
        text = "\n".join(row for row in text.splitlines() if not row.startswith(line))
    robot = read(text, "test")
    run = run_sketch("SI|GRIPPER(90);W(0.1);X = 180;GRIPPER(X);W(1)", 190, robot)
    signal = shift_signal(run.pins[11], START_MS, (0,))
    assert [value for start_ms, end_ms, value in spans(signal, 189) if end_ms - start_ms > 5] == [
        (128,),
        (255,),
    ]


@pytest.mark.parametrize("distance_cm", [3, 20, 50, 150])
def test_an_echo_is_converted_to_a_distance(distance_cm: int) -> None:
    robot = robots.load("tinibot")
    board = SketchBoard(robot, sketch("SI|DISTANCE;SHOW(DISTANCE)", robot))
    pins = robot.board.sensors[2].pins
    board.set_echoes(pins["trigger"], pins["echo"], [distance_cm * 2 / 0.0343])
    assert abs(float(board.run_for(400).text) - distance_cm) < 0.5


def test_two_pings_are_30_ms_apart() -> None:
    """An earlier request gets the previous reading."""
    robot = robots.load("tinibot")
    text = "SI|DISTANCE;SHOW(ROUND(DISTANCE, 0));DISTANCE;SHOW(ROUND(DISTANCE, 0));W(0.05);"
    board = SketchBoard(robot, sketch(text + "DISTANCE;SHOW(ROUND(DISTANCE, 0))", robot))
    pins = robot.board.sensors[2].pins
    board.set_echoes(pins["trigger"], pins["echo"], [20 * 2 / 0.0343, 40 * 2 / 0.0343])
    assert board.run_for(500).text.split() == ["20", "20", "40"]


@pytest.mark.parametrize("text", [
    "SI|F(DISTANCE, 50)", "SI|F(1, LIGHT_R)", "SI|M(LIGHT_R, 0)", "SI|BEEP(0.1, LIGHT_R)",
    "SI|LOOP(LIGHT_R);END_LOOP", "SI|GRIPPER(DISTANCE)", "SI|SHOW(DISTANCE)", "SI|SHOW(LIGHT_R)",
    "SI|IF(TIME > 1);ENDIF", "SI|F(1, -LIGHT_R)", "SI|IF(DISTANCE < 2147483.647);ENDIF",
    "SI|F(20000.123, 50)", "SI|W(2147483.647) UNTIL(TRUE)", "SI|X = TRUE;IF(X);ENDIF",
    "SI|LOOP(100000);END_LOOP", "SI|F(FOREVER, 50) UNTIL(TOUCH)", "SI|F((-5), (200))",
    "SI|IF(1 < 2 AND 3 > 2.5);ENDIF", "SI|IF(NOT (TOUCH = LINE));ENDIF",
    "SI|IF((RANDOM(1, 2) = 1) = (RANDOM(1, 2) = 2));ENDIF",
    "SI|X = MIN(RANDOM(1, 2), RANDOM(3, 4))",
])  # fmt: skip
def test_numbers_of_every_kind_compile(text: str) -> None:
    build_sketch(sketch(text, with_wide_kit()), "uno")


# -- start, end, stop


def test_a_button_starts_and_stops() -> None:
    robot = with_wide_kit()
    text = "SB|LED(TRUE);GRIPPER(90);F(5, 50);SHOW(1)"
    board = SketchBoard(robot, sketch(text, robot))
    button, pins = (
        robot.board.start_button,
        [actuator.pins["pin"] for actuator in robot.board.actuators],
    )
    for ms, is_high in ((100, False), (200, True), (500, False), (600, True)):
        board.set_level(ms, button, is_high)
    run = board.run_for(900)
    assert [
        value for start_ms, end_ms, value in spans(run.motors, 899) if end_ms - start_ms > 5
    ] == [(0, 0), (50, 50), (0, 0)]
    on, off = (
        start_ms for start_ms, value in run.motors if value in ((50, 50), (0, 0)) and start_ms > 100
    )
    assert 228 < on < 235 and 499 < off < 502
    lamp = run.pins[pins[2]]
    assert lamp[-1][1] == (0,) and 499 < lamp[-1][0] < 502  # a stop turns it off
    assert not any(
        level[0] and start_ms > 505 for start_ms, _, level in spans(run.pins[pins[0]], 899)
    )
    assert run.text == ""


def test_a_spike_starts_nothing() -> None:
    robot = robots.load("tinibot")
    board = SketchBoard(robot, sketch("SB|F(1, 50)", robot))
    board.set_level(100, robot.board.start_button, False)
    board.set_level(110, robot.board.start_button, True)
    assert {value for _, value in board.run_for(300).motors} == {(0, 0)}


def test_a_program_that_has_ended_plays_its_tune() -> None:
    tones = spans(run_sketch("SI|F(0.1, 50)", 500).tones, 499)
    assert [
        (round(end_ms - start_ms, -1), value[0] // 10)
        for start_ms, end_ms, value in tones
        if value[0]
    ] == [(120, 105), (120, 157)]


@pytest.mark.parametrize(("text", "name"), [
    ("SI|M(50, 50);X = 2000000;X = X * X;S", "FAULT OVERFLOW"),
    ("SI|M(50, 50);X = 0;SHOW(1 / X)", "FAULT DIVIDE_BY_ZERO"),
    ("SI|M(50, 50);X = 0;SHOW(1 % X)", "FAULT DIVIDE_BY_ZERO"),
])  # fmt: skip
def test_a_fault_stops_the_motors_and_prints_its_name(text: str, name: str) -> None:
    run = run_sketch(text, 60)
    assert run.text == name + "\r\n"
    assert run.motors[-1][1] == (0, 0) and (50, 50) in [value for _, value in run.motors]


@pytest.mark.parametrize("text", ["PING|check_connection", "", "SI|"])
def test_a_sketch_of_an_empty_program_does_nothing(text: str) -> None:
    run = run_sketch(text, 50)
    assert {value for _, value in run.motors} == {(0, 0)} and run.text == ""


def check_seed(seed: int) -> str:
    drawn_example = example(seed, ROBOT_WIDE)
    if drawn_example is None:
        return "no example"
    check(drawn_example, ROBOT_WIDE, "es" if seed % 2 else "en")
    return "agrees"


if __name__ == "__main__":
    each_seed(check_seed, make_options(200, 0))
