"""The pings and echoes of a distance sensor on a simulated board, with a bad wire."""

from __future__ import annotations

from itertools import pairwise

import pytest

from tests.machines.board import HERTZ, MS, PORTS, Board
from tests.support.board_states import START_MS, on_board, start_board
from tests.support.sonar import (
    US_PER_CM,
    approaching_obstacle,
    driven_ms,
    ping_starts_ms,
    sonar_pins,
)
from tiniscript import robots
from tiniscript.robots.profile import Robot

SPACING_MS, FRESH_MS = 30.0, 60.0
FIRST_SAMPLES = 3  # samples of a run's first value
DELAY_US = 460  # time from the trigger to the echo


def board_with_distances(
    text: str, *distances_cm: float, robot: Robot | None = None, extra_code: str = ""
) -> Board:
    """The distances of its pings, one after the other; the last one stays."""
    robot = robot or robots.load("tinibot")
    trigger, echo = sonar_pins(robot)
    board = start_board(robot, text, extra_code)
    board.watch(trigger)
    board.set_echoes(trigger, echo, [distance_cm * US_PER_CM for distance_cm in distances_cm])
    return board


def read_power_cm(board: Board, ms: float) -> int:
    """Return the whole centimetres that the power of the left motor stands for."""
    level = board.motors(ms)[0]
    return 0 if level == "low" else round(int(level.removeprefix("pwm ")) / 2.55)


@pytest.mark.sampled("distance_cm", keep=2)
@pytest.mark.parametrize("name", ["tinibot", "grabber"])
@pytest.mark.parametrize("distance_cm", [3, 20, 50, 99, 399])
def test_pings_are_30_ms_apart_and_measure_the_distance(name: str, distance_cm: int) -> None:
    """A program that only measures does not measure more often. A sensor wants 10 us, and the loop
    does not wait for it."""
    robot = robots.load(name)
    sonar_index = [sensor.driver for sensor in robot.board.sensors].index("hc_sr04")
    trigger, echo = sonar_pins(robot, sonar_index)
    board = start_board(robot, "SI|LOOP(FOREVER);M(DISTANCE, 0);END_LOOP")
    board.watch(trigger)
    board.set_echoes(trigger, echo, [distance_cm * US_PER_CM])
    board.run_for(START_MS + 400)
    gaps = [b - a for a, b in pairwise(ping_starts_ms(board, trigger))]
    assert len(gaps) >= 10
    assert min(gaps) >= SPACING_MS
    assert max(gaps) < SPACING_MS + 2
    edges = board.edges(trigger)
    for rose, fell in zip(edges[::2], edges[1::2], strict=False):
        assert 10 <= (fell - rose) * 1e6 / HERTZ < 200
    assert board.motors(START_MS + 95)[0] == f"pwm {min(distance_cm, 100) * 653 >> 8}"


def test_a_reading_is_used_again_until_the_next_ping_may_leave() -> None:
    text = "SI|LOOP(FOREVER);M(DISTANCE, 0);W(0.01);END_LOOP"
    board = board_with_distances(text, *[20] * FIRST_SAMPLES, 60).run_for(START_MS + 160)
    first, second, third = ping_starts_ms(board, sonar_pins(board.robot)[0])[
        FIRST_SAMPLES - 1 : FIRST_SAMPLES + 2
    ]
    assert SPACING_MS <= second - first < SPACING_MS + 11  # the program asks every 10 ms
    assert read_power_cm(board, first + 5) == read_power_cm(board, second) == 20
    assert SPACING_MS <= third - second < SPACING_MS + 2, "it waits for what it has asked"
    assert read_power_cm(board, third) == 20
    assert read_power_cm(board, third + 5) == 60


def test_until_checks_again_every_40_ms() -> None:
    """The check runs every 20 ms, with a fresh reading every second time."""
    text = "SI|F(1, 20)UNTIL(DISTANCE < 10)"
    board = board_with_distances(text, *[50] * FIRST_SAMPLES, 50, 8).run_for(START_MS + 250)
    ping_ms = [ms - START_MS for ms in ping_starts_ms(board, sonar_pins(board.robot)[0])]
    assert [round(ms / 10) for ms in ping_ms] == [0, 3, 6, 10, 14, 17]
    assert board.motors(START_MS + 173)[0] == "pwm 51"
    assert board.motors(START_MS + 178)[0] == "low"


RESTART_CODE = """
#include <avr/io.h>
#include "boards/board.h"
// When A5 goes high this does what the start of a program does with readings; in the main loop, as
// that does: an interrupt would come into the middle of a measurement's steps.
extern "C" void test_turn() {
  static bool was_high;
  const bool is_high = (PINC & 1 << 5) != 0;
  if (is_high && !was_high) tiniscript::board_forget();
  was_high = is_high;
}
"""


@pytest.mark.sampled("after_ms")
@pytest.mark.parametrize("after_ms", [0.0, 0.02, 0.04, 0.06, 0.3, 1.0, 5.0, 20.0])
def test_a_start_forgets_readings_but_not_the_spacing(after_ms: float) -> None:
    """At any time of a measurement, the next reading is from a new ping 30 ms later."""
    robot = robots.load("tinibot")
    trigger, _ = sonar_pins(robot)
    text = "SI|LOOP(FOREVER);M(DISTANCE, 0);W(0.002);S;END_LOOP"
    plain_board = board_with_distances(text, 20, 70).run_for(START_MS + 40)
    first_ping_ms = plain_board.edges(trigger)[0] / MS
    board = board_with_distances(text, 20, 70, robot=robot, extra_code=RESTART_CODE)
    board.set_level(first_ping_ms + after_ms, 19, True)
    board.run_for(START_MS + 160)
    first, second, *others = ping_starts_ms(board, trigger)
    assert SPACING_MS <= second - first < SPACING_MS + 2
    drive_starts_ms = driven_ms(board, 1)
    assert not [ms for ms in drive_starts_ms if first_ping_ms + after_ms + 0.5 < ms < others[1] + 3]
    assert {read_power_cm(board, ms) for ms in drive_starts_ms if ms > second} == {70}


SECOND_SONAR = (
    (
        "[[kit.sensors]]",
        '[[kit.sensors]]\nname = "BEHIND"\nkind = "number"\nunit = "cm"\nrange = [0, 400]\n\n'
        "[[kit.sensors]]",
    ),
    ("bluetooth_state = 12", ""),
    (
        "[body]\n",
        '[board.sensors.BEHIND]\ndriver = "hc_sr04"\ntrigger = 12\necho = "A2"\n\n[body]\n',
    ),
)


@pytest.mark.sampled("text")
@pytest.mark.parametrize("text", [
    "SI|LOOP(FOREVER);M(DISTANCE, BEHIND);W(0.005);S;END_LOOP",
    "SI|LOOP(FOREVER);M(DISTANCE, BEHIND);W(0.005);S;W(0.02);END_LOOP",
])  # fmt: skip
def test_two_sensors_never_hear_each_other(text: str) -> None:
    """The pings of both are far enough apart, none is forgotten, and no reading is older than 60
    ms."""
    robot = on_board("tinibot", "uno", *SECOND_SONAR)
    board = start_board(robot, text)
    rows = [(3, range(20, 60)), (0, range(60, 100))]  # obstacles that come nearer with each ping
    for number, distances in rows:
        trigger, echo = sonar_pins(robot, number)
        board.watch(trigger)
        board.set_echoes(trigger, echo, [distance * US_PER_CM for distance in distances])
    board.run_for(START_MS + 600)
    starts_ms = [ping_starts_ms(board, sonar_pins(robot, number)[0]) for number, _ in rows]
    all_starts_ms = sorted(ms for times in starts_ms for ms in times)
    assert min(b - a for a, b in pairwise(all_starts_ms)) >= SPACING_MS
    assert min(len(times) for times in starts_ms) >= 4
    drive_starts_ms = driven_ms(board, 2)
    assert len(drive_starts_ms) > 10
    for motor, (times, (_, distances)) in enumerate(zip(starts_ms, rows, strict=True)):
        for ms in drive_starts_ms:
            level = board.motors(ms)[3 * motor]
            cm = round(int(level.removeprefix("pwm ")) / 2.55)
            if cm != distances[1]:  # the median of the first three, each of which takes time
                assert 0 < ms - times[cm - distances[0]] <= FRESH_MS


# -- a bad wire

GLITCH_US = 30.0
ECHO_US = 50 * US_PER_CM
EDGE_US = 100.0  # distance from an edge within which a glitch may count as the edge
PHASES = [
    *range(5, 440, 29),  # before the echo
    *(DELAY_US + offset_us for offset_us in (-60, -31, -20, -5, 5, 20, 40, 71, 95, 130)),
    *range(DELAY_US + 150, DELAY_US + 2900, 149),
    *(
        DELAY_US + round(ECHO_US) + offset_us
        for offset_us in (-120, -95, -60, -31, -15, -5, 5, 20, 69, 90, 120)
    ),
    *range(DELAY_US + 3100, 24_000, 1501),
]


def find_glitches(width_us: float) -> list[tuple[int, int]]:
    """Return each phase of a short glitch on the wire, and the reading.

    The sensor itself does it, so phases are to the cycle: a glitch moves the pings after it by
    some us, and its end must not be taken for a line that stays high after the echo.
    """
    robot = robots.load("tinibot")
    trigger, echo = sonar_pins(robot)
    board = start_board(robot, "SI|LOOP(FOREVER);M(DISTANCE, 0);W(0.032);END_LOOP")
    board.watch(trigger)
    rows = [(0.0, 0.0)] * FIRST_SAMPLES + [(phase, width_us) for phase in PHASES]
    board.set_echoes(trigger, echo, [ECHO_US] * (len(rows) + 1), rows)
    times = ping_starts_ms(board.run_for(START_MS + 33 * len(rows)), trigger)[FIRST_SAMPLES:]
    gaps = [b - a for a, b in pairwise(times)]
    assert max(gaps) < 33  # no reading came late
    return [
        (phase, read_power_cm(board, ms + 31)) for ms, phase in zip(times, PHASES, strict=False)
    ]


@pytest.mark.sampled("width_us")
@pytest.mark.parametrize("width_us", [2.0, 10.0, GLITCH_US, 80.0])
def test_a_glitch_at_any_phase_is_not_an_echo(width_us: float) -> None:
    measurements = find_glitches(width_us)
    assert len(measurements) == len(PHASES)
    for phase, cm in measurements:
        nearest = min(
            abs(phase + part - edge)
            for part in (0, width_us)
            for edge in (DELAY_US, DELAY_US + ECHO_US)
        )
        assert abs(cm - 50) <= (0 if nearest > EDGE_US else 3), (phase, cm)


def test_a_glitch_without_an_echo_is_far_away() -> None:
    robot = robots.load("tinibot")
    _, echo = sonar_pins(robot)
    text = "SI|IF(DISTANCE = 400);M(10, 0);ELSE;M(90, 0);ENDIF;W(5)"
    board = board_with_distances(text, 0)
    for ms in (1.0, 3.0, 10.0, 20.0):
        board.set_level(START_MS + ms, echo, True)
        board.set_level(START_MS + ms + 0.06, echo, False)
    board.run_for(START_MS + 110)
    assert read_power_cm(board, START_MS + 100) == 10


# -- an echo that stays high

HANG_END_MS = 300.0  # time from the ping


@pytest.mark.sampled("high_ms")
@pytest.mark.parametrize("high_ms", [38.0, 70.0, 200.0])
def test_a_healthy_sensor_that_hears_nothing_is_far_away(high_ms: float) -> None:
    """The echo line stays high for this time, and the next ping follows its fall: never 0."""
    text = "SI|LOOP(FOREVER);IF(DISTANCE = 400);M(10, 0);ELSE;M(90, 0);ENDIF;END_LOOP"
    robot = robots.load("tinibot")
    board = board_with_distances(text, high_ms * 1000 / US_PER_CM, robot=robot).run_for(
        START_MS + 1000
    )
    assert read_power_cm(board, START_MS + 3 * high_ms) == 10
    assert {read_power_cm(board, ms) for ms in driven_ms(board, 1)} == {10}
    assert len(ping_starts_ms(board, sonar_pins(robot)[0])) >= 5


@pytest.mark.sampled("chip")
@pytest.mark.parametrize("chip", ["uno", "mega"])
def test_an_echo_that_stays_high_is_read_as_0_until_it_answers(chip: str) -> None:
    """Therefore `DISTANCE < 15` stops. The board pulls the echo low repeatedly."""
    text = "SI|LOOP(FOREVER);IF(DISTANCE < 15);M(90, 0);ELSE;M(10, 0);ENDIF;END_LOOP"
    robot = on_board("tinibot", chip)
    echo = sonar_pins(robot)[1]
    board = board_with_distances(
        text, *[50] * FIRST_SAMPLES, 1_000_000 / US_PER_CM, 50, robot=robot
    )
    board.watch(echo)
    board.run_for(START_MS + 1300)
    hangs = ping_starts_ms(board, sonar_pins(robot)[0])[FIRST_SAMPLES]
    assert read_power_cm(board, hangs) == 10
    assert read_power_cm(board, hangs + HANG_END_MS - 1) == 10, "it may be one that hears nothing"
    assert read_power_cm(board, hangs + HANG_END_MS + 35) == 90
    assert read_power_cm(board, hangs + 990) == 90
    assert read_power_cm(board, hangs + 1100) == 10, "it answers again"
    port, bit = board.bit(echo)
    pulled = [change.cycle / MS for change in board.changes
              if change.address == PORTS[port] - 1 and change.value >> bit & 1]  # fmt: skip
    assert pulled and hangs + HANG_END_MS - 1 < min(pulled) and max(pulled) < hangs + 1010
    assert board.pin(echo, hangs + 1100) == "in"


def test_a_briefly_high_line_is_not_a_hung_sensor() -> None:
    """This holds after any pause: a glitch at the moment of a query is not read as 0."""
    text = "SI|LOOP(FOREVER);IF(DISTANCE < 15);M(90, 0);ELSE;M(10, 0);ENDIF;W(0.5);END_LOOP"
    robot = robots.load("tinibot")
    board = board_with_distances(text, 50, robot=robot)
    for number in range(200):
        board.set_level(START_MS + 400 + 3 * number, sonar_pins(robot)[1], True)
        board.set_level(START_MS + 401.5 + 3 * number, sonar_pins(robot)[1], False)
    board.run_for(START_MS + 1200)
    assert {read_power_cm(board, ms) for ms in driven_ms(board, 1)} == {10}


# -- a wrong sample


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(12))
def test_one_wrong_sample_in_fifty_never_becomes_a_reading(seed: int) -> None:
    """Whenever it comes, at the first ping of a run too: a reading is off by 20 % at most."""
    true, heard_cm = approaching_obstacle(seed, 100)
    board = board_with_distances("SI|LOOP(FOREVER);M(DISTANCE / 2, 0);END_LOOP", *heard_cm)
    times = ping_starts_ms(board.run_for(START_MS + 2900), sonar_pins(board.robot)[0])
    assert len(times) > 90
    readings = driven_ms(board, 1)
    assert len(readings) > 60
    for ms in readings:
        number = sum(sent < ms for sent in times) - 1
        cm = 2 * int(board.motors(ms)[0].removeprefix("pwm ")) / 2.55
        max_error_cm = max(4, 0.2 * true[number] + 3)
        assert abs(cm - true[number]) < max_error_cm, (number, heard_cm[number - 2 : number + 1])


@pytest.mark.sampled("number", keep=2)
@pytest.mark.parametrize("wrong_cm", [3, 400])
@pytest.mark.parametrize("number", range(FIRST_SAMPLES))
def test_a_first_value_is_the_median_of_three(number: int, wrong_cm: float) -> None:
    heard_cm: list[float] = [50] * (FIRST_SAMPLES + 1)
    heard_cm[number] = wrong_cm
    board = board_with_distances(
        "SI|LOOP(FOREVER);M(DISTANCE / 10, 0);END_LOOP", *heard_cm
    ).run_for(START_MS + 200)
    assert {read_power_cm(board, ms) for ms in driven_ms(board, 1)} == {5}


@pytest.mark.parametrize("before_cm", [400, 100])
def test_a_sudden_obstacle_needs_a_second_ping(before_cm: float) -> None:
    text = "SI|LOOP(FOREVER);IF(DISTANCE < 15);M(90, 0);ELSE;M(10, 0);ENDIF;END_LOOP"
    board = board_with_distances(text, *[before_cm] * 10, 8).run_for(START_MS + 500)
    comes, confirmed = ping_starts_ms(board, sonar_pins(board.robot)[0])[10:12]
    assert read_power_cm(board, confirmed) == 10
    assert read_power_cm(board, confirmed + 2) == 90
    assert confirmed - comes < SPACING_MS + 2
