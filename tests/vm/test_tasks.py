"""The scheduler with a robot that is not ready, late, or lets it run few instructions at a time."""

from __future__ import annotations

import random

import pytest

from tests.machines import Senses
from tests.machines.python import lists_of, run_python
from tests.oracle.task_programs import task_program
from tests.support.task_states import STATES
from tiniscript import compile_text, robots
from tiniscript.base.trace import TracedRobot
from tiniscript.vm.machine import Machine
from tiniscript.vm.state import DONE, FAULT, RUNNING, WAITING
from tiniscript.vm.tasks import TaskMachine, machine_of

KIT = robots.load("tinibot").kit
MAX_MS = 300


class SlowRobot(TracedRobot):
    """Each reading is not there `asks` times, and there is no room for a SHOW `shows` times."""

    def __init__(self, senses: Senses, asks: int, shows: int = 0) -> None:
        super().__init__(KIT, lists_of(KIT, senses))
        self.asks = self.asks_left = asks
        self.shows = self.shows_left = shows

    def read(self, sensor: int) -> int | None:
        self.asks_left -= 1
        if self.asks_left >= 0:
            return None
        self.asks_left = self.asks
        return super().read(sensor)

    def show(self, value: int, is_yes_no: bool) -> bool:
        self.shows_left -= 1
        if self.shows_left >= 0:
            return False
        self.shows_left = self.shows
        return super().show(value, is_yes_no)


def machine_for(text: str, robot: TracedRobot, senses: Senses) -> Machine:
    code = compile_text(text, KIT).code
    return machine_of(code, robot, len(KIT.readings), senses.seed)


def trace_with(text: str, robot: TracedRobot, senses: Senses, budget: int) -> list[str]:
    """Return the trace where a call runs so many instructions; no turn leaves a value."""
    machine = machine_for(text, robot, senses)
    assert isinstance(machine, TaskMachine)
    while True:
        status = machine.tick(robot.now_ms, budget)
        if not machine.is_in_turn:
            assert not machine.task.stack
        if status in (DONE, FAULT):
            robot.record(status, (), f"FAULT {machine.fault}" if status == FAULT else "DONE")
        elif status == WAITING and machine.wake_ms <= senses.max_ms:
            robot.now_ms = max(robot.now_ms, machine.wake_ms)
            continue
        elif status == RUNNING:
            continue
        else:
            robot.now_ms = senses.max_ms
            robot.record("LIMIT", (), "LIMIT")
        return [f"{event}\n" for event in robot.events]


@pytest.mark.parametrize("budget", [1, 2, 7])
def test_the_return_address_does_not_change_the_meaning(budget: int) -> None:
    for seed in range(60):
        text, readings = task_program(random.Random(seed))
        senses = Senses(readings, MAX_MS)
        want = run_python(compile_text(text, KIT).image, KIT, senses)
        robot = TracedRobot(KIT, lists_of(KIT, senses))
        assert "".join(trace_with(text, robot, senses, budget)) == want, text


@pytest.mark.parametrize("asks", [1, 3])
def test_a_turn_that_waits_for_the_robot_leaves_no_value(asks: int) -> None:
    """If readings and room take calls but no time, each task acts the same."""
    for seed in range(60):
        text, readings = task_program(random.Random(seed))
        senses = Senses(readings, MAX_MS)
        robot = SlowRobot(senses, asks, asks)
        assert trace_with(text, robot, senses, 1000)[-1].split()[1] in ("DONE", "LIMIT")


def test_other_tasks_continue_while_a_reading_is_not_ready() -> None:
    text = "WHEN(DISTANCE < 10);END_WHEN;TASK;SHOW(1);W(0.005);SHOW(2);END_TASK"
    senses = Senses({"DISTANCE": [50_000]}, 30)
    robot = SlowRobot(senses, 10**9)
    machine = machine_for(text, robot, senses)
    for now_ms in range(10):
        robot.now_ms = now_ms
        assert machine.tick(now_ms, 1000) == WAITING
        assert machine.wake_ms <= now_ms
    assert [str(event) for event in robot.events] == ["0 SHOW 1", "5 SHOW 2"]


def test_the_first_turn_of_the_main_task_waits_for_its_reading() -> None:
    """Its first assignments are visible to all."""
    senses = Senses({"DISTANCE": [50_000]}, 30)
    robot = SlowRobot(senses, 3)
    machine = machine_for("N = DISTANCE;TASK;SHOW(N);END_TASK", robot, senses)
    while machine.tick(0, 1000) == RUNNING:
        pass
    assert [str(event) for event in robot.events] == ["0 READ DISTANCE 50", "0 SHOW 50"]


def test_a_late_task_follows_its_own_clock_for_20_ms() -> None:
    """Each task does this like a program without tasks."""
    text = "TASK;LOOP(3);W(0.01);SHOW(1);END_LOOP;END_TASK;LOOP(3);W(0.1);SHOW(2);END_LOOP"
    senses = Senses({}, 1000)
    robot = TracedRobot(KIT, lists_of(KIT, senses))
    machine = machine_for(text, robot, senses)
    rows = []
    for now_ms in (0, 25, 25, 25, 60, 125, 200, 350, 360, 450):
        robot.now_ms = now_ms
        machine.tick(now_ms, 1000)
        rows.append("".join(str(event).split()[-1] for event in robot.events))
        robot.events.clear()
    assert rows == ["", "1", "1", "", "1", "2", "", "2", "", "2"]


def test_a_blocked_show_is_sent_once_and_lets_other_tasks_continue() -> None:
    text = "A = 5;TASK;SHOW(A + 1);SHOW(7);END_TASK;WHEN(TRUE);BEEP(0.001, 100);END_WHEN"
    senses = Senses({}, 30)
    robot = SlowRobot(senses, 0, 2)
    trace = trace_with(text, robot, senses, 1000)
    assert [line for line in trace if "SHOW" in line] == ["0 SHOW 6\n", "0 SHOW 7\n"]
    assert trace[0] == "0 BEEP 100 1\n"


def test_other_tasks_begin_after_the_main_tasks_first_turn() -> None:
    senses = Senses({}, 100)
    robot = SlowRobot(senses, 2)
    machine = machine_for("DISTANCE;TASK;W(0.015);SHOW(1);END_TASK", robot, senses)
    for now_ms in (0, 6, 12, 26, 27):
        robot.now_ms = now_ms
        machine.tick(now_ms, 1000)
    assert [str(event) for event in robot.events] == ["12 READ DISTANCE 0", "27 SHOW 1"]


class DeafRobot(TracedRobot):
    """No echo comes back, and there is no room for a SHOW."""

    def read(self, sensor: int) -> int | None:
        return None if KIT.sensors[sensor].name == "DISTANCE" else super().read(sensor)

    def show(self, value: int, is_yes_no: bool) -> bool:
        return False

    def off(self) -> None:
        self.record("OFF", (), "OFF")


@pytest.mark.parametrize("state", STATES)
def test_a_fault_of_one_task_ends_all_of_them(state: str) -> None:
    senses = Senses({"LIGHT_L": [0, 0, 1_000_000]}, 100)
    robot = DeafRobot(KIT, lists_of(KIT, senses))
    machine = machine_for(STATES[state], robot, senses)
    for robot.now_ms in range(2000):
        machine.tick(robot.now_ms, 1000)
    assert (machine.status, machine.fault) == (FAULT, "DIVIDE_BY_ZERO")
    assert str(robot.events[-1]) == "40 OFF"
