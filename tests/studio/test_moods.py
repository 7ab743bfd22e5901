"""The virtual robot's face shows the events of its run: the page's own code, in node."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

from tests.support.drawn_robots import STANDING_STILL, drawings_of, shapes
from tests.support.node import in_node
from tiniscript import compile
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds

SCRIPT = Path(__file__).with_name("moods_in_node.mjs")
STEP_MS = 50
MOODS = ("calm", "glad", "dizzy", "tired")
State = dict[str, Any]
Face = dict[str, Any]


def faces(*runs: list[State]) -> list[tuple[list[Face], list[Face]]]:
    """Return the robot's faces in each state of its runs, and when looking back."""
    rows = json.loads(in_node(SCRIPT, input_text=json.dumps(runs))[0])
    return [(face["seen"], face["again"]) for face in rows]


def run(text: str, world: str, ms: int) -> list[State]:
    simulation = Simulation("tinibot", worlds.load(world), compile(text).image)
    states = []
    for _ in range(ms // STEP_MS):
        simulation.advance(STEP_MS)
        states.append(json.loads(json.dumps(simulation.state())))
    return states


def make_states(rng: random.Random) -> list[State]:
    """Return states of a run that no robot has driven."""
    state: State = {"now_ms": 0, "bumps": 0, "score": {"taken": 0}, "motors": [0, 0], "fault": None,
                    "touches": None, "is_running": True, "is_waiting": False}  # fmt: skip
    states = []
    for _ in range(200):
        state = {**state, "now_ms": state["now_ms"] + rng.choice((20, 100, 700))}
        event = rng.random()
        if event < 0.1:
            state["motors"] = [rng.randint(-100, 100), rng.randint(-100, 100)]
        elif event < 0.2:
            state["motors"] = [0, 0]
        elif event < 0.23:
            state["bumps"] += 1
        elif event < 0.26:
            state["score"] = {"taken": state["score"]["taken"] + 1}
        states.append(state)
    return states


def sign(number: float) -> int:
    return (number > 0) - (number < 0)


def test_the_face_looks_ahead_and_is_the_same_on_rewinding() -> None:
    runs = [make_states(random.Random(seed)) for seed in range(20)]
    moods = set()
    for states, (frames, looked_back) in zip(runs, faces(*runs), strict=True):
        assert looked_back == frames
        for state, face in zip(states, frames, strict=True):
            left, right = state["motors"]
            assert sign(face["ahead"]) == sign(left + right), state
            assert sign(face["aside"]) == sign(right - left), state
            assert abs(face["ahead"]) <= 1 and abs(face["aside"]) <= 1
        moods |= {face["mood"] for face in frames}
    assert moods == set(MOODS)


def test_the_mood_follows_the_events() -> None:
    """Dizzy after a crash, glad at a flag, tired while it waits, and calm again."""
    crash, flag, wait, pause, drive = (
        run("F(9, 80)", "obstacles", 4500),
        run("F(9, 60)", "delivery", 6000),
        run("SB|F(1, 80)", "free", 500),
        run("W(9);F(2, 80)", "free", 10_000),
        run("F(1, 80)", "free", 800),
    )
    face_frames = [frames for frames, _ in faces(crash, flag, wait, pause, drive)]
    for states, frames in zip((crash, flag), face_frames, strict=False):
        for state, face in zip(states, frames, strict=True):
            if not state["bumps"] and not state["score"]:
                assert face["mood"] == "calm", state
            if state["touches"]:
                assert face["mood"] == "dizzy", state
    assert "dizzy" in {face["mood"] for face in face_frames[0]}
    assert {face["mood"] for face in face_frames[2]} == {"tired"}
    resting = [face["mood"] for face in face_frames[3]]
    assert resting[0] == resting[-1] == "calm" and "tired" in resting
    assert {face["mood"] for face in face_frames[4]} == {"calm"}
    assert any(face["isBlinking"] for face in face_frames[3])
    assert not all(face["isBlinking"] for face in face_frames[3])


def test_each_mood_is_drawn_in_its_own_way_and_in_the_chosen_colour() -> None:
    """This includes robots without a distance sensor, which have their own face."""
    calm = {"mood": "calm", "ahead": 0, "aside": 0, "isBlinking": False}
    face_states = [*({**calm, "mood": mood} for mood in MOODS), {**calm, "isBlinking": True}]
    for name in ("tinibot", "liner", "grabber"):
        drawing = drawings_of(
            *((name, None, {**STANDING_STILL, "face": face}) for face in face_states)
        )
        assert len({json.dumps(calls) for calls in drawing}) == len(face_states), name
        ahead_drawing, turned_drawing = drawings_of(
            (name, None, {**STANDING_STILL, "face": {**calm, "ahead": 1}}),
            (name, None, {**STANDING_STILL, "face": {**calm, "aside": 1}}),
        )
        pupils = [
            shapes(calls, "fill", "#20242a")
            for calls in (drawing[0], ahead_drawing, turned_drawing)
        ]
        still_drawing, to_front, to_left = (
            [row for row in drawn_shapes if len(row) == 5] for drawn_shapes in pupils
        )
        assert [a[0] > b[0] for a, b in zip(to_front, still_drawing, strict=True)].count(True) == 2
        assert [a[1] > b[1] for a, b in zip(to_left, still_drawing, strict=True)].count(True) == 2
        (colour_drawing,) = drawings_of(
            (name, None, {**STANDING_STILL, "colours": ["#123456", "#654321"]})
        )
        assert shapes(colour_drawing, "fill", "#123456") and shapes(
            colour_drawing, "stroke", "#654321"
        )
