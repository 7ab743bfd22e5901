"""Prints the benefit and the cost of a second ping: `python -m tools.bench.sonar`.

The firmware of tinibot on a simulated Uno, with an obstacle that comes at 50 cm/s and one wrong
sample in fifty, at places that the seed draws; and the same firmware where it trusts each sample,
as on a Nano. A reading is wrong that is off by more than 20 % and 3 cm. The delay is counted from
the moment at which the obstacle is nearer than 15 cm.
"""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from typing import NamedTuple

from tests.machines.board import BUILT_IN_PROGRAM, Board, build_sketch
from tests.support.board_states import START_MS, STEADY_MS
from tests.support.sonar import (
    US_PER_CM,
    approaching_obstacle,
    driven_ms,
    ping_starts_ms,
    sonar_pins,
)
from tiniscript import compile_text, robots
from tiniscript.robots import firmware
from tools.bench import page

SEED_COUNT = 40
SAMPLE_COUNT = 100
SPEED_CM_MS = 0.05
LOOK_PROGRAM = "SI|LOOP(FOREVER);M(DISTANCE / 2, 0);END_LOOP"
STOP_PROGRAM = "SI|LOOP(FOREVER);IF(DISTANCE < 15);M(90, 0);ELSE;M(10, 0);ENDIF;END_LOOP"
NEAR_PWM = f"pwm {90 * 653 >> 8}"
PING_INTERVAL_MS = 30.07  # time between pings of a program that measures continuously
PHASE_COUNT = 12
NEAR_CM = 15.0
TRUST_DEFINE = "#define tiniscript_trusts_samples\n"
ROWS = (
    "wrong readings, one wrong sample in fifty",
    "3 s runs with a wrong reading",
    "until it detects that an obstacle approaching at 50 cm/s is near: median, most",
    "until it detects one that suddenly appears: median, most",
)


class WrongReadings(NamedTuple):
    reading_count: int
    wrong_count: int


def board_of(text: str, is_trusting: bool) -> Board:
    """Return a tinibot with a program, as `tests.firmware.test_boards` starts it."""
    robot = robots.load("tinibot")
    board = Board(robot, text)
    if is_trusting:
        header = firmware.header([robot], "the tests.").replace("#pragma once", TRUST_DEFINE, 1)
        elf = build_sketch(header, robot.board.chip)
        built_in_image = compile_text(BUILT_IN_PROGRAM, robot.kit).image
        own_image = compile_text(text, robot.kit).image
        offset = elf.index(built_in_image)
        board.elf = elf[:offset] + own_image + b"\0" * 4 + elf[offset + len(own_image) + 4 :]
    board.press(100, START_MS - STEADY_MS)
    return board


def look_at_wall(seed: int, is_trusting: bool) -> WrongReadings:
    true_distances, heard_distances = approaching_obstacle(seed, SAMPLE_COUNT)
    board = board_of(LOOK_PROGRAM, is_trusting)
    trigger, echo = sonar_pins(board.robot)
    board.watch(trigger)
    board.set_echoes(trigger, echo, [cm * US_PER_CM for cm in heard_distances])
    ping_times_ms = ping_starts_ms(board.run_for(START_MS + 2900), trigger)
    readings = driven_ms(board, 1)
    wrong_count = 0
    for ms in readings:
        number = sum(ping_ms < ms for ping_ms in ping_times_ms) - 1
        cm = 2 * int(board.motors(ms)[0].removeprefix("pwm ")) / 2.55
        wrong_count += abs(cm - true_distances[number]) > max(4, 0.2 * true_distances[number] + 3)
    return WrongReadings(len(readings), wrong_count)


def lateness_ms(distance_at: Callable[[float], float], phase: float, is_trusting: bool) -> float:
    """Return the time for which the obstacle has been near when the program notices it.

    `distance_at` says how far it is so many ms after the first ping, which is `phase` of a ping
    late.
    """
    board = board_of(STOP_PROGRAM, is_trusting)
    trigger, echo = sonar_pins(board.robot)
    board.watch(trigger)
    phase_ms = phase * PING_INTERVAL_MS
    distances_cm = [distance_at(number * PING_INTERVAL_MS + phase_ms) for number in range(60)]
    board.set_echoes(trigger, echo, [cm * US_PER_CM for cm in distances_cm])
    first_ping_ms = ping_starts_ms(board.run_for(START_MS + 1500), trigger)[0]
    near_ms = next(ms for ms in range(1500) if distance_at(ms + phase_ms) < NEAR_CM)
    known_ms = next(ms for ms in driven_ms(board, 1) if board.motors(ms)[0] == NEAR_PWM)
    return known_ms - first_ping_ms - near_ms


def approaching_cm(ms: float) -> float:
    return max(3, 60 - SPEED_CM_MS * ms)


def appearing_cm(ms: float) -> float:
    return 100 if ms < 500 else 8


def main() -> None:
    figure_rows: list[list[str]] = [[row] for row in ROWS]
    for is_trusting in (True, False):
        runs = [look_at_wall(seed, is_trusting) for seed in range(SEED_COUNT)]
        wrong_count, readings = (
            sum(run.wrong_count for run in runs),
            sum(run.reading_count for run in runs),
        )
        figure_rows[0].append(f"{wrong_count:,} of {readings:,}")
        figure_rows[1].append(f"{sum(run.wrong_count > 0 for run in runs)} of {SEED_COUNT}")
        for row, distance_cm in ((2, approaching_cm), (3, appearing_cm)):
            lateness_of_phases_ms = [
                lateness_ms(distance_cm, phase / PHASE_COUNT, is_trusting)
                for phase in range(PHASE_COUNT)
            ]
            figure_rows[row].append(
                f"{median(lateness_of_phases_ms):.0f} ms, {max(lateness_of_phases_ms):.0f} ms"
            )
    page.show("sonar", figure_rows)


if __name__ == "__main__":
    main()
