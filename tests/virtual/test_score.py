"""Flags, points and stars of a world: the rules, and that each shipped task has three stars."""

from __future__ import annotations

import math

import pytest

from tests.support.virtual_robot import robot_in
from tiniscript import compile
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds
from tiniscript.virtual.score import SCORE_INTERVAL_MS, Score
from tiniscript.virtual.worlds import read

FLOOR = "[floor]\nwidth_cm = 300\nheight_cm = 100\n[start]\nx_cm = 40\ny_cm = 50\n"
FLAGS = FLOOR + "[task]\nseconds = 6\n[[flags]]\nx_cm = 90\ny_cm = 50\n[[flags]]\nx_cm = 140\n"
TWO = FLAGS + "y_cm = 50\n"
# Targets that a robot drives to in sequence.
WAYS = {
    "maze": [(25, 75), (75, 75), (75, 25), (125, 25), (125, 175), (175, 175), (175, 25)],
    "parking": [(125, 50), (125, 105)],
    "gaps": [(140, 31), (165, 38), (190, 72), (180, 94), (120, 110), (40, 110)],
    "line": [(130, 25), (163, 50), (126, 84), (85, 91), (48, 106), (30, 55), (60, 25)],
    "delivery": [(28, 25), (135, 25), (135, 62), (135, 104), (185, 104), (236, 104), (236, 186),
                 (54, 190)],
    "ring": [(60, 110), (75, 160), (104, 160), (150, 110), (100, 55)],
    "light": [(190, 130)],
    "corridor": [(155, 26), (155, 78), (75, 78), (75, 130), (175, 130), (175, 182)],
}  # fmt: skip


def run_to_score(text: str, program: str, ms: int = 9000) -> dict[str, int] | None:
    simulation = Simulation("tinibot", read(text, "own"), compile(program).image)
    for part in (ms // 3, ms // 3, ms // 3):
        simulation.advance(part)
    score: dict[str, int] | None = simulation.state()["score"]
    return score


def count_flags_and_stars(text: str, program: str, ms: int = 9000) -> tuple[int, int]:
    """Return the number of flags taken, and of stars."""
    score = run_to_score(text, program, ms)
    assert score is not None
    return score["taken"], score["stars"]


def test_a_world_without_flags_has_no_score() -> None:
    assert run_to_score(FLOOR, "F(1, 80)", 900) is None


def test_flags_are_taken_in_order_and_remaining_seconds_give_points() -> None:
    at_once = run_to_score(TWO, "F(100 CM, 80)") or {}
    assert (at_once["taken"], at_once["of"], at_once["stars"]) == (2, 2, 3)
    later = run_to_score(TWO, "W(2);F(100 CM, 80)") or {}
    assert at_once["points"] == later["points"] + 10
    turned_text = TWO.replace("x_cm = 90", "x_cm = 200").replace("x_cm = 140", "x_cm = 90")
    score = run_to_score(turned_text.replace("x_cm = 200", "x_cm = 140"), "F(100 CM, 80)") or {}
    assert (score["taken"], score["stars"], score["points"]) == (1, 0, 100)


def test_a_collision_and_a_late_end_cost_a_star_each() -> None:
    assert count_flags_and_stars(TWO, "W(5);F(100 CM, 80)", 12_000) == (2, 2)
    wall = "[[walls]]\npoints = [[20, 80], [20, 20]]\n"
    crashed_text = TWO.replace("seconds = 6", "seconds = 60") + wall
    assert count_flags_and_stars(crashed_text, "B(1, 80);F(4, 80)") == (2, 2)
    late = TWO.replace("seconds = 6", "seconds = 4") + wall
    assert count_flags_and_stars(late, "B(1, 80);W(3);F(4, 80)") == (2, 1)
    # Events after the last flag do not count.
    assert count_flags_and_stars(TWO, "F(9, 80)", 12_000) == (2, 3)


def test_a_rest_flag_requires_standing_still() -> None:
    rests = TWO + "rests = true\nreach_cm = 20\n"
    assert count_flags_and_stars(rests, "F(9, 80)")[0] == 1
    assert count_flags_and_stars(rests, "F(100 CM, 80)")[0] == 2  # the program ends there


@pytest.mark.parametrize("name", [name for name in worlds.names() if worlds.load(name).flags])
def test_each_task_has_three_stars(name: str) -> None:
    """A program that always knows its place drives at two thirds of the allowed power."""
    world = worlds.load(name)
    robot = robot_in(world, "liner" if name in ("line", "gaps", "ring") else "tinibot")
    score = Score(world)
    robot.started_ms, robot.is_running = 0, True
    driving = robot.driving

    def motors(left: float, right: float) -> None:
        driving.set_motors(robot.now_ms, left, right)
        robot.now_ms += SCORE_INTERVAL_MS
        score.update(robot)

    for x_cm, y_cm in WAYS[name]:
        while (distance_cm := math.dist((x_cm, y_cm), robot.pose[:2])) > 2:
            assert robot.now_ms < 1000 * world.seconds, robot.pose
            x, y, heading = robot.pose
            angle_off = math.degrees(math.atan2(y_cm - y, x_cm - x)) - heading
            angle_off = (angle_off + 180) % 360 - 180
            is_ahead = abs(angle_off) < max(4, 60 / distance_cm)
            motors(*((66, 66) if is_ahead else (-40, 40) if angle_off > 0 else (40, -40)))
        motors(0, 0)
    assert score.state() == {**(score.state() or {}), "stars": 3, "taken": len(world.flags)}
