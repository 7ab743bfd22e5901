"""A distance sensor on a simulated board: its pins, its pings, and its echoes."""

from __future__ import annotations

import random

from tests.machines.board import MS, Board
from tiniscript.robots.profile import Robot

US_PER_CM = 2 / 0.0343
STEP_CM = 1.5  # distance in 30 ms at 50 cm/s
SAMPLES_PER_WRONG_ONE = 50


def sonar_pins(robot: Robot, number: int = 2) -> tuple[int, int]:
    pins = robot.board.sensors[number].pins
    return pins["trigger"], pins["echo"]


def ping_starts_ms(board: Board, trigger: int) -> list[float]:
    """Return the times of the pings, in ms."""
    return [cycle / MS for cycle in board.edges(trigger)[1::2]]


def driven_ms(board: Board, motors: int) -> list[float]:
    """Return the times at which so many motors have just been turned on."""
    times = [cycle / MS for cycle in board.list_motor_changes()]
    return [ms for ms in times if sum("pwm" in pin for pin in board.motors(ms)) == motors]


def approaching_obstacle(seed: int, samples: int) -> tuple[list[float], list[float]]:
    """Return the distance of an obstacle that approaches at 50 cm/s at each ping, and the
    echoes.
    """
    rng = random.Random(seed)
    true = [max(20.0, 160 - STEP_CM * number) for number in range(samples)]
    heard_cm = list(true)
    for start_index in range(0, samples, SAMPLES_PER_WRONG_ONE):
        heard_cm[start_index + rng.randrange(SAMPLES_PER_WRONG_ONE)] = rng.choice(
            [2, 5, 40, 90, 250, 400]
        )
    return true, heard_cm
