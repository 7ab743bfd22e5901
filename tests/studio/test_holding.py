"""A program that is held, at breakpoints and after steps, and does the same as ever."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random

import pytest

from tests.support.casefile import ROOT
from tests.support.page_simulation import started_simulation, trace_of
from tiniscript import run
from tiniscript.studio.checking import check
from tiniscript.studio.simulation import Marks, Simulation
from tiniscript.virtual import worlds

COUNTING_PROGRAM = "X = 3;\nLOOP(2);\n  X = X + 1;\n  SHOW(X);\nEND_LOOP;\nIS = X > 4;\nF(0.5, 80)"
STEPS = ["X = 3", "LOOP(2);", "X = X + 1", "SHOW(X)", "LOOP(2);", "X = X + 1", "SHOW(X)",
         "LOOP(2);", "IS = X > 4", "F(0.5, 80)"]  # fmt: skip
REPEATING_PROGRAMS = (
    COUNTING_PROGRAM,
    "LOOP(2);\n  W(0.3) UNTIL(DISTANCE < 3);\n  F(0.1, 80);\nEND_LOOP",
    "DEF HOP;\n  F(0.1, 80);\nEND_DEF;\nLOOP(3);\n  HOP;\n  X = 2;\n  SHOW(X);\nEND_LOOP",
    "WHEN(DISTANCE < 60);\n  BEEP(0.1, 440);\nEND_WHEN;\nLOOP(4);\n  F(0.2, 80);\nEND_LOOP",
)
EXAMPLES = (
    ("obstacle", "tinibot", "obstacles"),
    ("line", "liner", "line"),
)
LONGEST_PART_MS = 1000
HISTORIES = 10


def part(text: str, simulation: Simulation) -> str:
    """Return the first line of the part of the text before which a program is paused."""
    at = simulation.held_at
    assert at is not None
    place = next(
        map_location
        for map_location in check(text.encode(), "tinibot", "en").places
        if map_location.offset == at
    )
    end = place.end_column - 1 if place.end_line == place.line else None
    return text.split("\n")[place.line - 1][place.column - 1 : end]


def steps(text: str, simulation: Simulation, max_count: int = 100) -> Iterable[str]:
    for _ in range(max_count):
        if simulation.held_at is None:
            return
        yield part(text, simulation)
        simulation.step(5000)


def test_steps_go_through_every_part_and_into_defined_words() -> None:
    simulation = started_simulation(COUNTING_PROGRAM, is_held=True)
    assert simulation.state()["events"] == [[simulation.robot.now_ms, "START", -1]]
    assert list(steps(COUNTING_PROGRAM, simulation)) == STEPS
    assert not simulation.robot.is_running
    text = "DEF HOP;\n  F(0.1, 80);\nEND_DEF;\nHOP;\nSHOW(1)"
    expected_texts = ["DEF HOP;", "HOP", "F(0.1, 80)", "SHOW(1)"]
    assert list(steps(text, started_simulation(text, is_held=True))) == expected_texts


def test_variables_are_reported_at_a_halt() -> None:
    simulation = started_simulation(COUNTING_PROGRAM, is_held=True)
    values = []
    while simulation.held_at is not None:
        values.append(simulation.state()["variables"])
        simulation.step(5000)
    assert values[:4] == [[0, 0], [3, 0], [3, 0], [4, 0]] and values[-1] == [5, 0.001]
    simulation.advance(500)
    assert simulation.state()["variables"] == [5, 0.001]  # values left by the program


@pytest.mark.parametrize("mode", ["steps", "breakpoints"])
@pytest.mark.parametrize(("name", "robot", "world"), EXAMPLES)
def test_a_held_program_does_the_same(name: str, robot: str, world: str, mode: str) -> None:
    """The events and times are the same, with steps and at 1,000 breakpoints."""
    result = check((ROOT / "examples" / f"{name}.ts").read_bytes(), robot, "en")
    plain_simulation = Simulation(robot, worlds.load(world), result.image)
    plain_simulation.advance(2500)
    expected_events = plain_simulation.robot.take_events()
    parts = tuple(place.offset for place in result.places)
    marks = Marks(
        parts, (*parts, *range(1000)) if mode == "breakpoints" else (), 0, mode == "steps"
    )
    held_simulation = Simulation(robot, worlds.load(world), result.image, marks)
    pauses = 0
    while held_simulation.robot.now_ms < plain_simulation.robot.now_ms:
        if mode == "steps":
            held_simulation.step(plain_simulation.robot.now_ms - held_simulation.robot.now_ms)
        else:
            held_simulation.go_on()
            held_simulation.advance(plain_simulation.robot.now_ms - held_simulation.robot.now_ms)
        pauses += held_simulation.held_at is not None
    assert pauses > 5
    assert held_simulation.robot.take_events() == expected_events
    assert held_simulation.robot.pose == plain_simulation.robot.pose


def test_a_held_program_takes_its_calculation_time() -> None:
    """It resumes in the tick in which it paused, with the remaining instructions."""
    text = "X = 0;\nLOOP(300);\n  X = X + 1;\nEND_LOOP;\nBEEP(0.1, 440)"
    runs = []
    for held_parts in ((), (2,)):
        simulation = started_simulation(text, held_parts)
        while simulation.robot.is_running:
            simulation.go_on()
            simulation.advance(50)
        runs.append(trace_of(simulation))
    assert runs[0] == runs[1] == ["2 BEEP 440 100", "100 DONE"]


@pytest.mark.parametrize("text", REPEATING_PROGRAMS)
def test_breakpoints_work_alike_whenever_they_are_set(text: str) -> None:
    """A run in which they change at random moments, and in which somebody steps, is held where and
    when one is that has had a breakpoint everywhere from the beginning.
    """
    parts = range(len(check(text.encode(), "tinibot", "en").places))
    held_simulation = started_simulation(text, parts)
    arrivals = []
    while held_simulation.held_at is not None:
        arrivals.append((held_simulation.robot.now_ms, held_simulation.held_at))
        held_simulation.go_on()
        held_simulation.advance(LONGEST_PART_MS)
    pauses = [holds_of_a_run(text, arrivals, Random(seed)) for seed in range(HISTORIES)]
    assert sum(map(bool, pauses)) > HISTORIES / 2


def holds_of_a_run(text: str, arrivals: list[tuple[int, int]], rng: Random) -> int:
    """Return the number of pauses of a run, each at the right arrival."""
    offsets = sorted({offset for _, offset in arrivals})
    simulation = started_simulation(text, is_held=rng.random() < 0.5)
    breakpoints: list[int] = []
    pauses = 0
    while arrivals:
        place, now_ms = simulation.held_at, simulation.robot.now_ms
        if place is None:
            arrivals = [arrival for arrival in arrivals if arrival[0] > now_ms]
        else:
            assert (now_ms, place) == arrivals[0]
            arrivals = arrivals[1:]
            pauses += 1
        if rng.random() < 0.5:
            breakpoints = rng.sample(offsets, rng.choice((0, 1, len(offsets))))
            simulation.set_breakpoints(breakpoints)
        duration_ms, is_step = rng.randint(1, 100), rng.random() < 0.2
        if is_step:
            simulation.step(duration_ms)
        else:
            simulation.go_on()
            simulation.advance(duration_ms)
        arrival_indexes = [
            k for k, (_, offset) in enumerate(arrivals) if is_step or offset in breakpoints
        ]
        if arrival_indexes and arrivals[arrival_indexes[0]][0] <= now_ms + duration_ms:
            arrivals = arrivals[arrival_indexes[0] :]
            assert (simulation.robot.now_ms, simulation.held_at) == arrivals[0]
        else:
            assert simulation.held_at is None
    return pauses


def test_a_breakpoint_is_reached_once_however_long_the_halt_lasts() -> None:
    """The looks of an UNTIL, fifty in a second, are one stay."""
    text = "LOOP(2);\n  W(1) UNTIL(DISTANCE < 3);\nEND_LOOP"
    simulation = started_simulation(text, held_parts=(1,))
    times = []
    while simulation.robot.is_running:
        if simulation.held_at is not None:
            times.append(simulation.robot.now_ms)
            simulation.go_on()
        simulation.advance(5000)
    assert len(times) == 2 and times[1] - times[0] == 1000


def test_time_does_not_pass_during_a_halt() -> None:
    simulation = started_simulation("F(1, 80);\nR(1, 60)", held_parts=(1,))
    simulation.advance(5000)
    state = simulation.state()
    assert state["is_held"] and simulation.robot.now_ms - state["began_ms"] == 1000
    simulation.advance(5000)
    assert simulation.state() == {**state, "events": [], "rows": []}


def test_a_stop_ends_a_held_program() -> None:
    """No more of it is executed."""
    simulation = started_simulation("F(1, 80);\nR(1, 60)", held_parts=(1,))
    simulation.advance(5000)
    simulation.state()
    simulation.set_breakpoints(())
    simulation.stop()
    state = simulation.state()
    assert [text for _, text, _ in state["events"]] == ["STOP"]
    assert not state["is_held"] and state["at"] is None and state["motors"] == [0, 0]


def test_a_program_that_never_waits_can_be_held() -> None:
    simulation = started_simulation(
        "LOOP(FOREVER);\n  X = X + 1;\nEND_LOOP".replace("X = X", "X = 1"), held_parts=(1,)
    )
    for _ in range(5):
        simulation.advance(100)
        assert simulation.held_at is not None
        simulation.go_on()
    simulation.set_breakpoints(())
    simulation.go_on()
    simulation.advance(400)
    assert simulation.held_at is None and simulation.robot.is_running


def test_a_program_restarted_by_its_button_can_be_held_again() -> None:
    simulation = started_simulation("SB|F(0.2, 80);SHOW(5)", held_parts=(1,))
    for end_action in (simulation.stop, simulation.go_on):
        simulation.advance(100)
        simulation.push()
        simulation.advance(1000)
        assert simulation.held_at is not None
        end_action()
        simulation.advance(1000)
        assert not simulation.robot.is_running


def test_offsets_outside_the_program_cause_no_halt() -> None:
    simulation = started_simulation("F(0.1, 80)")
    simulation.set_breakpoints([-1, 5000, 70_000, 1 << 40])
    simulation.advance(2000)
    assert not simulation.robot.is_running
    assert trace_of(simulation) == [
        f"{event.ms} {event.text}" for event in run("F(0.1, 80)").events
    ]
