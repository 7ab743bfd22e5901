"""The virtual robot of the page: the same runs as `tsc run` and `tsc robot` have."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterable

import pytest

from tests.support.casefile import ROOT
from tests.support.page_simulation import started_simulation, trace_of
from tests.support.virtual_robot import Talk, trace
from tiniscript import compile
from tiniscript.robots import load
from tiniscript.studio import worker
from tiniscript.studio.checking import check
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import VirtualRobot


@pytest.mark.parametrize(
    ("name", "robot", "world"),
    [
        ("obstacle", "tinibot", "obstacles"),
        ("light", "tinibot", "light"),
        ("line", "liner", "line"),
    ],
)
def test_a_simulated_run_matches_the_virtual_robot(name: str, robot: str, world: str) -> None:
    text = (ROOT / "examples" / f"{name}.ts").read_text(encoding="utf-8")
    simulation = Simulation(robot, worlds.load(world), compile(text, robot).image)
    simulation.advance(8000)
    other_robot = VirtualRobot(load(robot), worlds.load(world))
    talk = Talk(other_robot)
    talk.upload(text)
    talk.wait(8000)
    page_trace, virtual_trace = trace_of(simulation), trace(other_robot.take_events())
    shorter = min(len(page_trace), len(virtual_trace)) - 5  # the two were uploaded at other times
    assert shorter > 10 and page_trace[:shorter] == virtual_trace[:shorter]


def test_the_running_part_of_the_text_is_reported() -> None:
    text = "F(1, 80);\nR(0.5, 60);\nS"
    simulation = started_simulation(text)
    simulation.advance(300)
    assert simulation.state()["at"] in range(3) and not simulation.state()["is_held"]
    simulation.step(5000)
    assert simulation.held_at == simulation.state()["at"] == 3
    assert simulation.robot.now_ms - simulation.state()["began_ms"] == 1000
    simulation.step(5000)
    simulation.step(5000)
    assert simulation.state()["at"] is None and not simulation.state()["is_running"]


TASKS = """\
F(FOREVER, 60)
WHEN(TIME > 0.2 AND TIME < 0.25)
  B(0.1, 60)
END_WHEN
TASK
  LOOP(3)
    SHOW(TIME)
    W(0.15)
  END_LOOP
END_TASK
"""


def test_the_place_of_each_task_is_reported() -> None:
    """The parts that wait; an ended task has none."""
    simulation = started_simulation(TASKS, robot="tinibot32")
    places = check(TASKS.encode(), "tinibot32", "en").places

    def marked_lines() -> set[int]:
        """The lines of the text that are marked."""
        lines = set()
        for offset in simulation.state()["places"]:
            lines.add(next(place for place in reversed(places) if place.offset <= offset).line)
        return lines

    simulation.advance(100)
    assert marked_lines() == {1, 2, 8}
    simulation.advance(130)
    assert marked_lines() == {1, 3, 8}
    simulation.advance(500)
    assert marked_lines() == {1, 2}
    simulation.stop()
    assert simulation.state()["places"] == []
    plain_simulation = started_simulation("W(1)")
    plain_simulation.advance(500)
    assert plain_simulation.state()["places"] == [plain_simulation.state()["at"]]


@pytest.mark.parametrize("parts", [range(8), (2,), (4, 5)])
def test_held_tasks_do_the_same_as_unheld_ones(parts: Iterable[int]) -> None:
    free, simulation = (
        started_simulation(TASKS, held_parts, robot="tinibot32") for held_parts in ((), parts)
    )
    free.advance(600)
    held_places: set[int | None] = set()
    while simulation.robot.now_ms < free.robot.now_ms:
        held_places.add(simulation.held_at)
        simulation.go_on()
        simulation.advance(1)
    assert trace_of(simulation) == trace_of(free)
    places = [place.offset for place in check(TASKS.encode(), "tinibot32", "en").places]
    assert {places[k] for k in parts} <= held_places


def test_a_stop_is_confirmed_and_the_motors_are_off() -> None:
    simulation = Simulation(
        "tinibot", worlds.load("obstacles"), compile("F(FOREVER, 80) UNTIL(FALSE)").image
    )
    simulation.advance(500)
    assert simulation.state()["motors"] == [80, 80]
    now_ms_before = simulation.robot.now_ms
    simulation.stop()
    state = simulation.state()
    assert state["motors"] == [0, 0] and not state["is_running"]
    assert state["events"][-1][1] == "STOP" and simulation.robot.now_ms - now_ms_before < 200
    simulation.advance(1000)
    assert simulation.state()["events"] == []


LOOPING_PROGRAM = "SI|LOOP(FOREVER);\nSHOW(TIME);\nF(0.07, 60);\nR(0.03, 40);\nW(0.01);\nEND_LOOP"
BUTTON_PROGRAM = "SB|LOOP(3);SHOW(TIME);F(0.1, 60);R(0.1, 40);END_LOOP;F(60, 20)"


@pytest.mark.parametrize("seed", range(16))
def test_a_run_after_any_history_equals_the_first(seed: int) -> None:
    """Each stop counts, whatever stopped the robot before."""
    rng = random.Random(seed)
    fresh_simulation, simulation = (
        started_simulation(BUTTON_PROGRAM),
        started_simulation(BUTTON_PROGRAM, is_held=rng.random() < 0.3),
    )
    parts = simulation.marks.part_offsets
    actions: list[Callable[[], object]] = [
        simulation.push,
        simulation.push,
        simulation.go_on,
        lambda: simulation.advance(rng.choice((1, 30, 150, 700))),
        lambda: simulation.step(rng.choice((1, 50, 400))),
        lambda: simulation.press(rng.randrange(64), 0, 0),
        simulation.stop,
    ]
    if rng.random() < 0.3:
        actions += [lambda: simulation.set_breakpoints(rng.sample(parts, rng.randint(0, 2)))]
    for _ in range(rng.randint(2, 9)):
        act = rng.choice(actions)
        act()
        assert act != simulation.stop or not any(simulation.state()["motors"])
    simulation.set_breakpoints(())
    simulation.stop()
    assert not simulation.robot.is_running and not any(simulation.state()["motors"])
    runs = []
    for one_simulation in (fresh_simulation, simulation):
        one_simulation.robot.take_events()
        one_simulation.push()
        one_simulation.advance(1500)
        assert one_simulation.held_at is None
        runs.append(trace_of(one_simulation))
    assert runs[0] == runs[1] and len(runs[0]) > 10


@pytest.mark.parametrize("seed", range(8))
def test_breakpoints_count_from_whenever_they_are_set(seed: int) -> None:
    """The program halts as if they had been set at its start, in place of any others."""
    rng = random.Random(seed)
    parts = started_simulation(LOOPING_PROGRAM).marks.part_offsets
    breakpoints = rng.sample(parts[1:], rng.randint(1, 2))
    set_ms = rng.randrange(500)
    halts = list[list[tuple[int, int]]]()
    for breakpoints_before in (breakpoints, rng.sample(parts, rng.randint(0, 1)), ()):
        simulation = started_simulation(LOOPING_PROGRAM)
        start_ms = simulation.robot.now_ms
        simulation.set_breakpoints(breakpoints_before)
        halts.append([])
        for ms in range(1000):
            if ms == set_ms:
                simulation.set_breakpoints(breakpoints)
            while simulation.robot.now_ms - start_ms <= ms:
                simulation.advance(1)
                if simulation.held_at is not None:
                    if ms >= set_ms:
                        halts[-1].append((ms, simulation.held_at))
                    simulation.go_on()
    assert halts[0] and halts[1] == halts[2] == halts[0]


def test_a_fault_is_named() -> None:
    simulation = Simulation(
        "tinibot", worlds.load("obstacles"), compile("W(1); X = 0; SHOW(1 / X)").image
    )
    assert simulation.state()["fault_at"] is None
    while not simulation.state()["fault"]:
        simulation.advance(1)
    state = simulation.state()
    assert (state["fault"], state["at"]) == ("DIVIDE_BY_ZERO", None)
    result = check(b"W(1); X = 0; SHOW(1 / X)", "tinibot", "en")
    place = max(place for place in result.places if place.offset <= state["fault_at"])
    assert (place.line, place.column) == (1, 14)
    state = started_simulation("X = 0; SHOW(1 / X)").state()  # fails immediately
    assert state["fault"] == "DIVIDE_BY_ZERO" and state["fault_at"] is not None


STICK = "SI|LOOP(FOREVER);\nM(PAD_Y, PAD_Y);\nW(0.02);\nEND_LOOP"


def test_a_remote_control_is_read_until_it_times_out() -> None:
    """For half a second of the robot's time, however long that takes."""
    simulation = started_simulation(STICK)
    for _ in range(5):
        simulation.press(0, 0, 60)
        simulation.advance(400)
        assert round(simulation.robot.driving.left) == 60
    simulation.advance(200)
    assert round(simulation.robot.driving.left) == 0
    simulation.press(0, 0, -60)
    simulation.advance(60)
    assert round(simulation.robot.driving.left) == -60
    simulation.press(0, 0, 0)
    simulation.advance(60)
    assert round(simulation.robot.driving.left) == 0


def test_keys_held_during_a_halt_count_when_the_run_continues() -> None:
    simulation = started_simulation(STICK, held_parts=(1,))
    simulation.advance(100)
    assert simulation.held_at is not None
    for _ in range(3):
        simulation.press(0, 0, 60)
        simulation.advance(400)  # time does not advance
    assert round(simulation.robot.driving.left) == 0
    simulation.set_breakpoints(())
    simulation.press(0, 0, 30)
    simulation.go_on()
    simulation.advance(100)
    assert round(simulation.robot.driving.left) == 30
    simulation.stop()
    simulation.press(0, 0, 60)
    simulation.advance(1000)
    assert round(simulation.robot.driving.left) == 0 and not simulation.robot.is_running


def test_the_page_sends_the_held_keys() -> None:
    """A new run begins without held keys."""

    def motors(action: str, data: bytes = b"", **fields: object) -> object:
        return json.loads(worker.answer(json.dumps({"do": action, **fields}), data))["motors"]

    answer = json.loads(
        worker.answer(
            json.dumps({"do": "check", "robot": "tinibot", "language": "en"}), STICK.encode()
        )
    )
    assert answer["remote"] == ["PAD_Y"]
    on = {"robot": "tinibot", "world": "obstacles", "language": "en"}
    image = bytes.fromhex(answer["image"])
    assert motors("power_on", image, **on) == [0, 0]
    assert motors("go", duration_ms=100, held=[0, 0, 60]) == [60, 60]
    assert motors("go", duration_ms=100, held=[0, 0, 0]) == [0, 0]
    assert motors("step", limit_ms=100, held=[0, 0, 50]) == [50, 50]
    assert motors("power_on", image, **on) == [0, 0]
    assert motors("go", duration_ms=300) == [0, 0]


def test_the_page_requests_the_whole_simulation() -> None:
    def ask(data: bytes = b"", **fields: object) -> dict[str, object]:
        answer: dict[str, object] = json.loads(worker.answer(json.dumps(fields), data))
        return answer

    image = compile("SB|F(1, 80);R(1, 80)").image
    ask(image, do="power_on", robot="tinibot", world="obstacles", parts=[0, 3])
    ask(do="go", duration_ms=1500)
    ask(do="push")
    assert ask(do="step", limit_ms=3000)["is_running"]
    assert ask(do="stop")["motors"] == [0, 0]
