"""Shown values name their SHOW, even if it had to wait for the wire."""

from __future__ import annotations

import pytest

from tests.support.rows import each_row
from tests.support.source_maps import make_source_map
from tests.support.virtual_robot import robot_in
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import checksum, unpack
from tiniscript.library.shows import ShowFinder
from tiniscript.library.source_map import SourceMap
from tiniscript.link.outcomes import ShownEvent
from tiniscript.link.requests import OK
from tiniscript.virtual import worlds
from tiniscript.virtual.computer import Computer

KINDS = ("tinibot", "tinibot2", "grabber", "tinibot32")  # each has a firmware of its own
SLOW = 2400  # bauds: a value needs 70 ms
ONE = "SI|A = 1; LOOP(4); SHOW(A); SHOW(A + 1); END_LOOP; SHOW(A + 2)"
DEFS = "SI|DEF TELL(V); SHOW(V); END_DEF; TELL(1); TASK; TELL(1); END_TASK"
SEVERAL = """SI|ONE = 1; TWO = 2; THREE = 3
LOOP(5); SHOW(THREE); END_LOOP
TASK; LOOP(5); SHOW(ONE); END_LOOP; END_TASK
TASK; LOOP(5); SHOW(TWO); W(0.001); SHOW(TWO + 2); END_LOOP; END_TASK
TASK; LOOP(3); SHOW(5 * ONE); F(0.1, 50); END_LOOP; END_TASK"""
NAMES = {1: "ONE", 2: "TWO", 3: "THREE", 4: "TWO + 2", 5: "5 * ONE"}


class Desk:
    """A robot, a computer on its line, and the texts of what it has sent."""

    def __init__(self, robot: str, baud: int) -> None:
        self.robot = robot_in(worlds.load("free"), robot, baud=baud)
        self.computer = Computer(self.robot, 1)
        self.maps: dict[int, SourceMap] = {}
        self.finder = ShowFinder(self.maps)

    def send(self, text: str) -> None:
        compilation = compile_text(text, robots.load(self.robot.profile.name).kit)
        assert compilation.is_right and compilation.image
        self.maps[checksum(compilation.image)] = make_source_map(compilation)
        request = self.computer.session.upload(unpack(compilation.image), runs=True)
        assert self.computer.wait_for(request).status == OK

    def list_shown_values(self, limit_ms: int) -> list[tuple[int, str]]:
        """Return values and their names, until a program ends or for so long."""
        values: list[tuple[int, str]] = []
        for _ in range(limit_ms):
            self.computer.wait(1)
            for event in self.computer.session.events():
                if event.name == "DONE":
                    return values
                if isinstance(event, ShownEvent):
                    show = self.finder.show_of(event)
                    values.append((event.value // 1000, "" if show is None else show.text))
        return values


@each_row("kind", KINDS)
@pytest.mark.parametrize("baud", [0, SLOW])
def test_values_of_one_task_have_the_names_of_their_shows(kind: str, baud: int) -> None:
    desk = Desk(kind, baud)
    desk.send(ONE)
    assert desk.list_shown_values(30_000) == [(1, "A"), (2, "A + 1")] * 4 + [(3, "A + 2")]


@each_row("kind", KINDS)
@pytest.mark.parametrize("baud", [0, SLOW, 9600])
def test_values_of_tasks_that_wait_for_the_line_have_the_names_of_their_shows(
    kind: str, baud: int
) -> None:
    desk = Desk(kind, baud)
    desk.send(SEVERAL)
    values = desk.list_shown_values(60_000)
    assert dict(values) == NAMES
    assert all(NAMES[value] == name for value, name in values)
    assert [value for value, _ in values].count(3) == 5


@each_row("kind", KINDS)
def test_the_copies_of_a_def_have_one_name(kind: str) -> None:
    desk = Desk(kind, SLOW)
    desk.send(DEFS)
    assert desk.list_shown_values(30_000) == [(1, "V")] * 2


@each_row("kind", KINDS)
@pytest.mark.parametrize("stops", [False, True])
def test_a_program_after_one_with_waiting_values_has_its_own_names(kind: str, stops: bool) -> None:
    """Both have their SHOWs at the same places."""
    desk = Desk(kind, SLOW)
    desk.send("SI|NEAR = 1; LOOP(FOREVER); SHOW(NEAR); END_LOOP")
    shown_before = desk.list_shown_values(700)
    assert shown_before and set(shown_before) == {(1, "NEAR")}
    if stops:
        desk.computer.session.stop(desk.robot.now_ms)
        shown_before += desk.list_shown_values(1500)
    desk.send("SI|FAR = 2; LOOP(3); SHOW(FAR); END_LOOP")
    values = desk.list_shown_values(10_000)
    assert [row for row in values if row[0] == 2] == [(2, "FAR")] * 3
    assert {*shown_before, *values} == {(1, "NEAR"), (2, "FAR")}


@each_row("kind", KINDS)
def test_the_robots_own_trace_agrees(kind: str) -> None:
    desk = Desk(kind, 0)
    desk.send(SEVERAL)
    desk.list_shown_values(60_000)
    [places] = desk.maps.values()
    for event in desk.robot.take_events():
        if event.kind == "SHOW":
            location = places.location_at(event.offset)
            assert location and NAMES[event.values[0] // 1000] in places.line(location.line)
