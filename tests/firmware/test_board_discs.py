"""Edge counts of an Uno and a Mega on simulated chips: every edge, and no glitch.

The distances of a tinibot2, whose wheels turn discs, are tested here, too.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from pathlib import Path
from unittest import mock

import pytest

from tests.machines.board import Board
from tests.machines.wired import Wired
from tests.support.casefile import ROOT
from tests.support.images import image_of
from tests.support.uno_with_discs import ENVIRONMENT, ROBOT, DrivenUno
from tests.support.wired_robots import with_discs
from tiniscript import robots
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.robots.profile import Robot
from tiniscript.virtual.wheels import Roughness
from tools.uno import CYCLES_PER_MS, Uno

BOARDS = ("uno", "mega")
each_board = pytest.mark.parametrize("name", BOARDS)
MOTORS = "D5", "D6"  # their PWM
# OCR1A and OCR1B are free on this robot: the counts are copied there
LEFT_COUNT_REGISTER, RIGHT_COUNT_REGISTER = 0x88, 0x8A
COPY_COUNTS_CODE = """
#include "firmware/board.h"
extern "C" void test_turn() {
  using Port = volatile unsigned char*;
  *reinterpret_cast<Port>(0x88) = static_cast<unsigned char>(tiniscript::board_edges(false));
  *reinterpret_cast<Port>(0x8a) = static_cast<unsigned char>(tiniscript::board_edges(true));
}
"""


def counting_board(robot: Robot) -> Board:
    board = Board(robot, extra_code=COPY_COUNTS_CODE)
    board.watched |= {LEFT_COUNT_REGISTER, RIGHT_COUNT_REGISTER}
    assert robot.board.discs
    for pin in robot.board.discs.pins.values():
        board.set_level(0, pin, False)
    return board


def pins(robot: Robot) -> tuple[int, int]:
    assert robot.board.discs
    return robot.board.discs.pins["left"], robot.board.discs.pins["right"]


def counts(board: Board, ms: float) -> tuple[int, int]:
    """Return the counts at a time, measured from 20 ms on."""
    first_counts = (
        board.register(LEFT_COUNT_REGISTER, 20),
        board.register(RIGHT_COUNT_REGISTER, 20),
    )
    then = (board.register(LEFT_COUNT_REGISTER, ms), board.register(RIGHT_COUNT_REGISTER, ms))
    return (then[0] - first_counts[0]) % 256, (then[1] - first_counts[1]) % 256


@pytest.mark.sampled("name")
@each_board
def test_each_edge_of_both_discs_counts(name: str) -> None:
    """Fast and slow ones, and both at once; 65.6 ms apart is no glitch where the clock wraps."""
    robot = robots.load("tinibot2", name)
    board = counting_board(robot)
    left, right = pins(robot)
    for k in range(20):
        board.set_level(30 + 2 * k, left, k % 2 == 0)
        board.set_level(30 + 2 * k, right, k % 2 == 0)
    for k in range(6):
        board.set_level(100 + 65.6 * k, left, k % 2 == 0)
    board.run_for(450)
    assert counts(board, 90) == (20, 20)
    assert counts(board, 445) == (26, 20)


@pytest.mark.sampled("name")
@each_board
@pytest.mark.parametrize("span_us", [1, 5, 20, 60, 200])
@pytest.mark.parametrize("is_high", [False, True])
def test_too_short_pulses_do_not_count(name: str, span_us: float, is_high: bool) -> None:
    """Motor brushes cause such pulses on a low or a high line. Edges between them count."""
    robot = robots.load("tinibot2", name)
    board = counting_board(robot)
    left, _ = pins(robot)
    rng = random.Random(5)
    board.set_level(25, left, is_high)
    at_ms = 40.0
    for _ in range(30):
        at_ms += rng.uniform(1, 5)
        board.set_level(at_ms, left, not is_high)
        board.set_level(at_ms + span_us / 1000, left, is_high)
    board.set_level(at_ms + 5, left, not is_high)
    for k in range(3):  # an edge that bounces
        board.set_level(at_ms + 12 + 0.03 * k, left, is_high == (k % 2 == 0))
    board.run_for(at_ms + 40)
    assert counts(board, at_ms + 35) == (is_high + 2, 0)


@each_board
@pytest.mark.parametrize("span_us", [4, 10, 37, 150])
def test_edges_count_again_after_an_endless_glitch(name: str, span_us: float) -> None:
    """Its interrupt is off in between, and the clock of the other disc's edges goes on."""
    robot = robots.load("tinibot2", name)
    board = counting_board(robot)
    left, right = pins(robot)
    pulses = round(40 / (2 * span_us / 1000))
    for k in range(2 * pulses):
        board.set_level(30 + k * span_us / 1000, left, k % 2 == 0)
    for k in range(16):
        board.set_level(30 + 2.3 * k, right, k % 2 == 0)
        board.set_level(80 + 2.3 * k, left, k % 2 == 0)
    board.run_for(140)
    assert counts(board, 135) == (16, 16)


@pytest.mark.sampled("name")
@each_board
def test_two_channels_count_backwards(name: str) -> None:
    robot = with_discs(name, "two_channel")
    board = counting_board(robot)
    discs = robot.board.discs
    assert discs
    a, b = discs.pins["left"], discs.pins["left_b"]
    states = [(True, False), (True, True), (False, True), (False, False)]
    for k in range(16):  # four holes ahead
        for pin, level in zip((a, b), states[k % 4], strict=True):
            board.set_level(30 + 2 * k, pin, level)
    for k in range(10):  # and back again
        for pin, level in zip((a, b), states[(2 - k) % 4], strict=True):
            board.set_level(100 + 2 * k, pin, level)
    board.run_for(150)
    assert counts(board, 90) == (8, 0)
    assert counts(board, 145) == (3, 0)


# -- how far a tinibot2 goes whose wheels turn discs ----------------------------------------------


def test_moves_and_turns_have_the_requested_length(sketches: Callable[[str], Path]) -> None:
    robot = DrivenUno(sketches(ENVIRONMENT), 1, (107.5, 92.5), Roughness(0.005))
    with robot.uno:
        assert robot.drive("F(30 CM, 60); R(90 DEG, 60)") == "DONE"
        pose = robot.pose
    assert abs(pose.x_cm - 30) <= 1.5 and abs(pose.y_cm) <= 2 and abs(pose.heading + 90) <= 6


def test_a_move_interrupted_by_when_keeps_its_length(sketches: Callable[[str], Path]) -> None:
    robot = DrivenUno(sketches(ENVIRONMENT), 2, (92.5, 107.5), Roughness(0.005))
    text = """X = 0; F(60 CM, 80)
WHEN(X < 3 AND TIME > 0.35 + X * 0.65); X = X + 1; M(0, 0); W(0.4); END_WHEN"""
    with robot.uno:
        assert robot.until(robot.session.hello()) == OK
        assert robot.until(robot.session.upload(image_of(text, ROBOT.kit))) == OK
        robot.run(6000)
        pose = robot.pose
    assert abs(pose.x_cm - 60) <= 1.5 and abs(pose.y_cm) <= 2


def test_moves_are_straight_after_a_wheel_was_held(sketches: Callable[[str], Path]) -> None:
    """The fault is that of the wheel. The next program is as straight as the first one."""
    robot = DrivenUno(sketches(ENVIRONMENT), 1, (107.5, 92.5), Roughness(0.005))
    held_wheel = robot.wheels.wheels[1]
    with robot.uno:
        with mock.patch.object(held_wheel, "step", lambda has_two: 0.0):
            assert robot.drive("F(60 CM, 80)") == "FAULT"
        assert robot.until(robot.session.clear()) == OK
        pose_before = robot.pose
        assert robot.drive("F(100 CM, 80)") == "DONE"
        pose = robot.pose
    heading_rad = math.radians(pose_before.heading)
    x, y = pose.x_cm - pose_before.x_cm, pose.y_cm - pose_before.y_cm
    assert abs(x * math.cos(heading_rad) + y * math.sin(heading_rad) - 100) <= 1.5
    assert abs(y * math.cos(heading_rad) - x * math.sin(heading_rad)) <= 2.4


def flicker(uno: Uno, hertz: int, milliseconds: int, run_ms: Callable[[int], None]) -> None:
    """Toggle both discs at this rate."""
    half = CYCLES_PER_MS * 1000 // (2 * hertz)
    cycle, is_high = uno.cycle, False
    for _ in range(milliseconds):
        while cycle < uno.cycle + CYCLES_PER_MS:
            is_high = not is_high
            for number, pin in enumerate(pins(ROBOT)):
                uno.drive(f"D{pin}", is_high, at_cycle=cycle + number * half // 3)
            cycle += half
        run_ms(1)


@pytest.mark.sampled("hertz")
@pytest.mark.parametrize("program", ["F(200 CM, 60)", "M(60, 60); W(30)"])
@pytest.mark.parametrize("hertz", [50_000, 3300])
def test_a_typed_stop_gets_through_while_both_discs_flicker(
    hertz: int, program: str, sketches: Callable[[str], Path]
) -> None:
    """Within a millisecond. The robot answers meanwhile, and no watchdog restarts it."""
    baud = ROBOT.board.baud
    with Uno(sketches(ENVIRONMENT), baud=baud, resets_on_open=False, tells_sleep=False) as uno:
        robot = Wired(uno, Session(1, baud, ROBOT.kit.fingerprint))
        for pin in pins(ROBOT):
            uno.drive(f"D{pin}", False)
        robot.run(300)
        assert robot.until(robot.session.hello()) == OK
        image = image_of(program, ROBOT.kit)
        assert robot.until(robot.session.upload(image, is_detached=True)) == OK
        robot.run(50)
        event_count_before = len(uno.events)
        pending_request = robot.session.ping()
        flicker(uno, hertz, 350, robot.run)  # wheels that show no edge are stuck later
        assert pending_request.outcome and pending_request.outcome.status == OK
        assert not any(
            event.kind in ("reset", "watchdog") for event in uno.events[event_count_before:]
        )
        assert [uno.pins[pin].state for pin in MOTORS] == ["pwm", "pwm"]
        event_count_before = len(uno.events)
        uno.send(b"STOP\r")
        flicker(uno, hertz, 20, uno.run_ms)
        ended = [
            event.cycle for event in uno.events[event_count_before:] if event.kind == "received"
        ][-1]
        for motor in MOTORS:
            change = uno.pins[motor]
            assert change.state == "low" and 0 < change.cycle - ended < CYCLES_PER_MS


@pytest.mark.sampled(of="long ways of a chip")
def test_a_nano_with_discs_runs_tasks(sketches: Callable[[str], Path]) -> None:
    """The reader of text has left room for them: it backs away from obstacles."""
    robot = DrivenUno(sketches("nano_tinibot2"), 1, (100, 100), Roughness())
    pins = ROBOT.board.sensors[2].pins
    eye = f"D{pins['trigger']}", f"D{pins['echo']}"
    text = (ROOT / "examples" / "away.ts").read_text(encoding="utf-8")
    with robot.uno:
        robot.uno.set_sonar_distance(*eye, 50)
        assert robot.until(robot.session.hello()) == OK
        image = image_of(text, ROBOT.kit)
        assert robot.until(robot.session.upload(image)) == OK
        counts = []
        for distance_cm, milliseconds in ((50, 500), (9, 300), (50, 500), (50, 500)):
            robot.uno.set_sonar_distance(*eye, distance_cm)
            robot.run(milliseconds)
            counts.append(
                tuple(
                    (wheel.wanted_speed > 0) - (wheel.wanted_speed < 0)
                    for wheel in robot.wheels.wheels
                )
            )
    assert counts == [(1, 1), (-1, -1), (1, -1), (1, 1)]
