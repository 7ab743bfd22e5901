"""The picture of the virtual robot shows its actions: drawn by the page's own code, in node."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from tests.support.drawn_robots import DRAW_SCRIPT, STANDING_STILL, Drawing, drawings_of, shapes
from tests.support.node import in_node
from tiniscript import compile
from tiniscript.studio.description import description
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds

TREAD_COLOUR, LIT_COLOUR, WAVE_COLOUR = "#b9c2cb", "#fff3a8", "#7a2fb8"


def state_after(text: str, robot: str, ms: int) -> dict[str, Any]:
    """Return the state of a robot some time after its program has begun."""
    simulation = Simulation(robot, worlds.load("obstacles"), compile(text, robot).image)
    simulation.advance(ms)
    return json.loads(json.dumps(simulation.state()))  # type: ignore[no-any-return]


def test_a_sensor_on_a_servo_faces_the_servos_direction() -> None:
    """A servo with a sensor has no jaws."""
    robot_by_name = {robot["name"]: robot for robot in description()["robots"]}
    grabber = json.loads(json.dumps(robot_by_name["grabber"]))
    grabber["places"]["DISTANCE"]["turns_with"] = "GRIPPER"
    state = state_after("SI|GRIPPER(45);W(9)", "grabber", 100)
    turned_robots: list[tuple[Any, dict[str, int]]] = [
        (robot_by_name["grabber"], {}),
        (grabber, {"GRIPPER": -45}),
    ]
    requests = [
        {"robot": robot, "state": {**state, "turned": turned}, "seen": STANDING_STILL}
        for robot, turned in turned_robots
    ]
    ahead_drawing, turned_drawing = json.loads(
        in_node(DRAW_SCRIPT, input_text=json.dumps(requests))[0]
    )
    (cone,), (turned_cone,) = (
        shapes(drawing, "fill", "#e0452f33") for drawing in (ahead_drawing, turned_drawing)
    )
    assert [a - b for a, b in zip(turned_cone[-2:], cone[-2:], strict=True)] == pytest.approx(
        [-math.pi / 4] * 2
    )
    jaws = [shapes(drawing, "stroke", "#37434f") for drawing in (ahead_drawing, turned_drawing)]
    assert len(jaws[0]) == len(jaws[1]) + 2


def test_wheels_are_drawn_turned_by_the_rolled_distance() -> None:
    still_drawing, ahead_drawing, backward, turning, turned = drawings_of(
        *(("tinibot", None, {**STANDING_STILL, "rolled_cm": rolled})
          for rolled in ([0, 0], [0.5, 0.5], [-0.5, -0.5], [1.6, 1.6], [0.5, 0]))
    )  # fmt: skip

    def treads(drawing: Drawing, is_left: bool) -> list[float]:
        """Return the positions of a wheel's treads, from the back to the front."""
        rows = [
            shape for shape in shapes(drawing, "stroke", TREAD_COLOUR) if (shape[1] > 0) == is_left
        ]
        return sorted(row[0] for row in rows)

    for is_left in (True, False):
        treads_before = treads(still_drawing, is_left)
        assert len(treads_before) == 4
        assert [tread - 0.5 for tread in treads(ahead_drawing, is_left)][1:] == pytest.approx(
            treads_before
        )
        assert treads(turning, is_left) == pytest.approx(treads_before)
        assert treads(backward, is_left) != treads_before
    assert treads(turned, True) == treads(ahead_drawing, True)
    assert treads(turned, False) == treads(still_drawing, False)


def test_active_devices_are_drawn() -> None:
    """A lamp, the robot's own light where its button would start it, and the buzzer's sound."""
    of_rows = (
        ("grabber", state_after("LED(TRUE);W(1)", "grabber", 300), STANDING_STILL),
        ("grabber", state_after("W(1)", "grabber", 300), STANDING_STILL),
        ("tinibot", state_after("SB|F(1, 80)", "tinibot", 300), STANDING_STILL),
        ("tinibot", state_after("F(1, 80)", "tinibot", 300), STANDING_STILL),
        ("tinibot", None, {**STANDING_STILL, "isBeeping": True}),
        ("tinibot", None, STANDING_STILL),
    )
    lit, dark, waiting, driving, loud, silent_drawing = drawings_of(*of_rows)
    assert shapes(lit, "fill", LIT_COLOUR) and not shapes(dark, "fill", LIT_COLOUR)
    assert shapes(waiting, "fill", "#ffd84d") and not shapes(driving, "fill", "#ffd84d")
    assert shapes(loud, "stroke", WAVE_COLOUR) and not shapes(silent_drawing, "stroke", WAVE_COLOUR)


def test_the_jaws_are_drawn_with_their_opening() -> None:
    def gap(drawing: Drawing) -> float:
        right_jaw, left = shapes(drawing, "stroke", "#37434f")
        return left[-1] - right_jaw[-1]

    states = [state_after(f"GRIPPER({angle});W(1)", "grabber", 300) for angle in (0, 90, 180)]
    closed, half, wide_gap = map(
        gap, drawings_of(*(("grabber", state, STANDING_STILL) for state in states))
    )
    assert closed < half < wide_gap
    assert half - closed == pytest.approx(wide_gap - half)


def test_a_cone_is_drawn_with_the_length_of_its_reading() -> None:
    state = state_after("W(1)", "tinibot", 300)
    [drawing] = drawings_of(("tinibot", state, STANDING_STILL))
    [cone] = shapes(drawing, "fill", "#e0452f33")
    assert cone[4] == state["readings"][2]["value"] > 0  # index after the tip and the middle
    far_state, near_state = json.loads(json.dumps(state)), json.loads(json.dumps(state))
    far_state["readings"][0]["value"], near_state["readings"][0]["value"] = 0, 1023
    dim, bright = (
        [color for _, _, color in picture if color.startswith("#e08a1e")]
        for picture in drawings_of(
            ("tinibot", far_state, STANDING_STILL), ("tinibot", near_state, STANDING_STILL)
        )
    )
    assert dim[0] < bright[0] and dim[1] == bright[1]  # the other one has not changed


def test_contact_points_of_a_robot_are_reported() -> None:
    """It turns right into a box, whose left side is 184 cm from the left wall."""
    assert state_after("F(1, 80)", "tinibot", 300)["touches"] is None
    state = state_after("F(9, 80)", "tinibot", 4000)
    assert state["bumps"] == 1 and state["touches"][0] == pytest.approx(184, abs=0.5)
