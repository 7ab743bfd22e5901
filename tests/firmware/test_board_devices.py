"""The sketch's sensors, buzzer, lamps and servos on a simulated board."""

from __future__ import annotations

import random
from collections.abc import Callable
from itertools import pairwise

import pytest

from tests.machines.board import HERTZ, MS, Board
from tests.support.board_states import START_MS, STEADY_MS, WORKSHOP, on_board, pulses, start_board
from tiniscript import robots
from tiniscript.robots.profile import Robot

# -- sensors


def power_program(reading: str) -> str:
    """A program that shows a reading as the power of a motor: PWM of 2.55 for each percent."""
    return f"SI|M({reading}, 0);W(5)"


@pytest.mark.sampled("echo")
@pytest.mark.parametrize("echo", ["10", "53", "2", "18", "21"])  # changes of port B; INT
def test_an_echo_is_measured_on_other_pins_of_a_mega(echo: str) -> None:
    robot = on_board("tinibot", "mega", ("echo = 3", f"echo = {echo}"), ("= 2 ", "= 4 "),
                     ("trigger = 4", "trigger = 20"),
                     ("right_backward = 10", "right_backward = 40"))  # fmt: skip
    board = start_board(robot, power_program("DISTANCE"))
    pins = robot.board.sensors[2].pins
    board.set_echoes(pins["trigger"], pins["echo"], [50 * 2 / 0.0343])
    board.run_for(START_MS + 80)
    assert board.motors(START_MS + 75)[0] == f"pwm {50 * 653 >> 8}"


@pytest.mark.sampled("echo", "group", "mask")
@pytest.mark.parametrize(
    ("echo", "group", "mask"), [("14", 1, 2), ("15", 1, 1), ("A8", 2, 0), ("A15", 2, 7)]
)
def test_pin_change_interrupts_of_ports_j_and_k_are_enabled(
    echo: str, group: int, mask: int
) -> None:
    """Port J and K of a Mega: the interrupts that are on while the sketch listens."""
    robot = on_board(
        "tinibot", "mega", ("echo = 3", f'echo = "{echo}"' if "A" in echo else f"echo = {echo}")
    )
    board = start_board(robot, power_program("DISTANCE"))
    board.watched |= {PCICR, PCMSK0 + group}
    board.run_for(START_MS + 10)
    assert board.register(PCICR, START_MS + 5) == 1 << group
    assert board.register(PCMSK0 + group, START_MS + 5) == 1 << mask


PCICR, PCMSK0 = 0x68, 0x6B


@pytest.mark.parametrize("width_us", [0, 38_000])
def test_a_missing_echo_reads_as_far_away_after_three_times_25_ms(width_us: int) -> None:
    """A later reading waits until the sensor has lowered its echo."""
    robot = robots.load("tinibot")
    text = "SI|IF(DISTANCE = 400);M(10, 0);ENDIF;W(0.04);IF(DISTANCE < 400);M(20, 0);ENDIF;W(5)"
    board = start_board(robot, text)
    pins = robot.board.sensors[2].pins
    board.set_echoes(pins["trigger"], pins["echo"], [width_us] * 3 + [50 * 2 / 0.0343])
    board.run_for(START_MS + 250)
    level = f"pwm {10 * 653 >> 8}"
    third = 2 * max(30, 0.46 + width_us / 1000)
    assert board.motors(START_MS + third + 24)[0] == "low"
    assert board.motors(START_MS + third + 30)[0] == level
    assert board.motors(START_MS + 249)[0] == f"pwm {20 * 653 >> 8}"


@pytest.mark.sampled("name", "reading", "channel", "millivolts", "power", keep=3)
@pytest.mark.parametrize(("name", "reading", "channel", "millivolts", "power"), [
    ("tinibot", "LIGHT_R / 20", 0, 2500, 511 / 20),
    ("tinibot", "LIGHT_L / 20", 1, 5000, 1023 / 20),
    ("grabber", "TEMPERATURE", 0, 750, 25),
    ("grabber", "TEMPERATURE", 0, 5000, 100),
    ("liner", "BATTERY * 10", 7, 3700, 74),
    ("elegoo4", "BATTERY * 10", 3, 900, 74.5),
])  # fmt: skip
def test_a_voltage_is_a_reading(
    name: str, reading: str, channel: int, millivolts: int, power: float
) -> None:
    board = start_board(robots.load(name), power_program(reading))
    board.set_analog(channel, millivolts)
    board.run_for(START_MS + 10)
    pwm_value = int(board.motors(START_MS + 9)[0].removeprefix("pwm "))
    assert abs(pwm_value - power * 2.55) < 3


def is_true(robot: Robot, condition: str, set_up: Callable[[Board], object]) -> bool:
    """Return the value of a condition, which a program shows as a power."""
    board = start_board(robot, f"SI|IF({condition});M(20, 0);ELSE;M(10, 0);ENDIF;W(5)")
    set_up(board)
    board.run_for(START_MS + 5)
    level = board.motors(START_MS + 4)[0]
    assert level in (f"pwm {20 * 653 >> 8}", f"pwm {10 * 653 >> 8}")
    return level == f"pwm {20 * 653 >> 8}"


@pytest.mark.parametrize(("name", "sensor", "pin", "is_high", "is_yes"), [
    ("liner", "LINE_L", 15, True, True),
    ("liner", "LINE_R", 16, False, False),
    ("liner", "BUTTON", 12, True, False),
    ("liner", "BUTTON", 12, False, True),
    ("grabber", "BUTTON", 28, False, True),
])  # fmt: skip
def test_a_level_reads_as_yes_or_no(
    name: str, sensor: str, pin: int, is_high: bool, is_yes: bool
) -> None:
    assert (
        is_true(robots.load(name), sensor, lambda board: board.set_level(0, pin, is_high)) == is_yes
    )


def test_thresholds_and_thousandths_are_read() -> None:
    """149 of 1023 are slightly more than 1.4565 of 10 V: the half distinguishes the two."""
    workshop = on_board("tinibot", "uno", *WORKSHOP)
    assert is_true(workshop, "BRIGHT", lambda board: board.set_analog(2, 2910))
    assert not is_true(workshop, "BRIGHT", lambda board: board.set_analog(2, 2950))
    assert is_true(robots.load("liner"), "BATTERY > 1.456", lambda board: board.set_analog(7, 729))


@pytest.mark.parametrize(("sensor", "channel"), [("LINE_L", 2), ("LINE_M", 1), ("LINE_R", 0)])
def test_a_line_sensor_is_over_black_from_250_on(sensor: str, channel: int) -> None:
    """The threshold is that of ELEGOO's own program."""
    car = robots.load("elegoo4")
    for millivolts, expected in ((1180, False), (1260, True)):
        is_black = is_true(car, sensor, lambda board, mv=millivolts: board.set_analog(channel, mv))  # type: ignore[misc]
        assert is_black == expected


DIM_SENSOR = (
    (
        "[[kit.sensors]]",
        '[[kit.sensors]]\nname = "DIM"\nkind = "number"\nunit = "%"\nrange = [0, 1023]\n\n'
        "[[kit.sensors]]",
    ),
    ("[body]\n", '[board.sensors.DIM]\ndriver = "analog"\npin = "A2"\n\n[body]\n'),
)
# The time of every reading, and the number of readings.
READING_CODE = (
    "BEGUN_{0} = TIME;X = {1};LONGEST = MAX(LONGEST, TIME - BEGUN_{0});COUNT = COUNT + 1;"
)
SHOW_RESULTS_CODE = """
WHEN(TIME > 0.5)
M(MIN(100, 10000 * LONGEST), MIN(100, COUNT / 10));W(5)
END_WHEN
"""


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(24))
def test_each_task_gets_its_readings_in_time(seed: int) -> None:
    """Whatever other tasks read, none waits longer than a few conversions and a round of the
    tasks."""
    rng = random.Random(seed)
    tasks = []
    for number in range(rng.randint(2, 4)):
        reading_programs = [READING_CODE.format(number, rng.choice(["LIGHT_R", "LIGHT_L", "DIM"]))
                 for _ in range(rng.randint(1, 3))]  # fmt: skip
        pause = rng.choice(["", "W(0.001)", "W(0.003)", "W(0.01)"])
        tasks.append(f"LOOP(FOREVER)\n{''.join(reading_programs)}{pause}\nEND_LOOP")
    main_task, *other_tasks = tasks[:3]
    text = f"SI|LONGEST = 0;COUNT = 0\n{main_task}\n"
    text += "".join(f"TASK\n{task}\nEND_TASK\n" for task in other_tasks) + SHOW_RESULTS_CODE
    board = start_board(on_board("tinibot", "mega", *DIM_SENSOR), text).run_for(START_MS + 530)
    longest, count = (int(board.motors(START_MS + 529)[pin].removeprefix("pwm ")) for pin in (0, 3))
    assert 0 < longest <= 3 * 26 and count > 20


# -- additional devices of a robot


def buzzer_of(robot: Robot) -> int:
    assert robot.board.buzzer is not None
    return robot.board.buzzer


@pytest.mark.sampled("hertz", keep=3)
@pytest.mark.parametrize("hertz", [31, 100, 440, 880, 3000, 12345, 19800, 20000])
@pytest.mark.parametrize("name", ["tinibot", "grabber"])
def test_a_beep_has_its_frequency_and_its_length(name: str, hertz: int) -> None:
    robot = robots.load(name)
    board = start_board(robot, f"SI|BEEP(0.3, {hertz})")
    board.watch(buzzer_of(robot))
    board.run_for(START_MS + 290)
    edges = board.edges(buzzer_of(robot))
    periods = (len(edges) - 1) // 2
    measured_hertz = HERTZ * periods / (edges[2 * periods] - edges[0])
    assert abs(measured_hertz / hertz - 1) < 0.01


def test_a_beep_of_zero_length_ends_the_previous_one() -> None:
    robot = on_board("tinibot", "mega")
    board = start_board(robot, "SI|BEEP(0.5, 440)\nTASK\nW(0.1);BEEP(0, 440);W(9)\nEND_TASK")
    board.watch(buzzer_of(robot))
    board.run_for(START_MS + 300)
    edges = [cycle / MS - START_MS for cycle in board.edges(buzzer_of(robot))]
    assert 95 < edges[-1] < 103


def test_an_ended_program_plays_its_tune_and_the_light_shows_readiness() -> None:
    robot = robots.load("tinibot")
    light = robot.board.status_led
    assert light is not None
    board = start_board(robot, "SI|F(0.1, 50)")
    board.watch(buzzer_of(robot))
    board.watch(light)
    board.run_for(START_MS + 500)
    edges = [cycle / MS - START_MS for cycle in board.edges(buzzer_of(robot))]
    assert 99 < edges[0] < 102
    assert 338 < edges[-1] < 342
    halves = [b - a for a, b in pairwise(edges)]
    assert halves[0] > 1.3 * halves[-2]
    assert [board.pin(light, START_MS + ms) for ms in (-50, 50, 250)] == ["high", "low", "high"]


def test_no_note_of_a_tune_follows_a_tone() -> None:
    """The button starts the program again while the first note of its end sounds."""
    robot = robots.load("tinibot")
    board = start_board(robot, "SI|BEEP(0.05, 880);W(0.2)")
    board.watch(buzzer_of(robot))
    board.press(START_MS + 255, START_MS + 345 - STEADY_MS)
    board.run_for(START_MS + 590)
    edges = [cycle / MS - START_MS for cycle in board.edges(buzzer_of(robot))]
    assert any(255 < edge < 340 for edge in edges), "the tune has begun"
    assert any(350 < edge < 390 for edge in edges), "the program runs again"
    assert not any(400 < edge < 585 for edge in edges)


def test_servo_and_lamp_are_set() -> None:
    robot = robots.load("grabber")
    board = start_board(
        robot, "SI|GRIPPER(0);LED(TRUE);W(0.1);GRIPPER(90);W(0.1);GRIPPER(9 * 9 * 9);W(0.1)"
    )
    for pin in (11, 30):
        board.watch(pin)
    board.run_for(START_MS + 320)
    pulse_list = pulses(board, 11)
    assert pulse_list[0][0] > START_MS
    for after_ms, us in ((25, 600), (125, 1500), (225, 2400)):
        lengths = [
            length
            for ms, length in pulse_list
            if START_MS + after_ms < ms < START_MS + after_ms + 70
        ]
        assert lengths and all(abs(length - us) < 3 for length in lengths)
    assert board.pin(30, START_MS + 50) == "high"


def test_fan_and_active_low_lamp_are_set() -> None:
    robot = on_board("tinibot", "uno", *WORKSHOP)
    board = start_board(
        robot, "SI|FAN(-30000);LAMP(TRUE);W(0.1);FAN(0);LAMP(FALSE);W(0.1);FAN(999 * 99)"
    )
    for pin in (9, 19):
        board.watch(pin)
    board.run_for(START_MS + 250)
    assert [board.pin(9, START_MS + ms) for ms in (-1, 50, 150, 240)] == [
        "low", "pwm 0", "pwm 128", "pwm 255",
    ]  # fmt: skip
    assert [board.pin(19, START_MS + ms) for ms in (-1, 50, 150)] == ["high", "low", "high"]


def test_a_reading_of_the_previous_program_is_not_reused() -> None:
    """A program is stopped while it measures; the next one measures again."""
    robot = robots.load("tinibot")
    pins = robot.board.sensors[2].pins
    board = start_board(robot, "SI|W(0.05);M(DISTANCE, 0);W(5)")
    board.set_echoes(pins["trigger"], pins["echo"], [2000, 80 * 2 / 0.0343])
    board.press(START_MS + 51, START_MS + 100)
    board.press(START_MS + 150, START_MS + 200)
    board.run_for(START_MS + 400)
    assert board.motors(START_MS + 390)[0] == f"pwm {80 * 653 >> 8}"


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", ["tinibot", "liner", "grabber"])
def test_a_remote_control_is_read_after_the_sensors_of_the_kit(name: str) -> None:
    robot = on_board(name, "mega")
    board = start_board(robot, "SI|IF(KEY_DOWN AND NOT KEY_A);M(PAD_X, PAD_Y);ENDIF;W(5)")
    board.run_for(START_MS + 50)
    motors = [motor for motor in board.motors(START_MS + 40) if motor.startswith("pwm")]
    assert motors == [f"pwm {60 * 653 >> 8}", f"pwm {70 * 653 >> 8}"]


def test_a_board_without_room_for_a_remote_control_refuses_a_program_that_reads_it() -> None:
    for text, moves in (("SI|M(60, PAD_Y);W(5)", False), ("SI|M(60, 70);W(5)", True)):
        board = start_board(robots.load("tinibot"), text)  # an Uno without tasks
        board.run_for(START_MS + 50)
        assert (f"pwm {60 * 653 >> 8}" in board.motors(START_MS + 40)) == moves


@pytest.mark.parametrize("name", ["tinibot", "grabber"])
def test_interrupts_are_never_off_for_long(name: str) -> None:
    """The link must not lose a byte: at 115,200 baud two of them take 174 us."""
    robot = robots.load(name)
    text = "SI|LOOP(30);M(80, 80);BEEP(0.001, 20000);A = DISTANCE;END_LOOP"
    if name == "grabber":
        text = text.replace("A = DIS", "GRIPPER(90);A = DIS")
    sonar_index = [sensor.driver for sensor in robot.board.sensors].index("hc_sr04")
    pins = robot.board.sensors[sonar_index].pins
    board = start_board(robot, text)
    board.set_echoes(pins["trigger"], pins["echo"], [1000])
    board.run_for(START_MS + 200)
    assert 0 < board.quiet_us < 25
