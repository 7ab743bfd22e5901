"""The debugger of `tsc upload --break` and `tsc live --break`, with a robot that is a plain model:
it halts where a person sees it, says what is so there, and goes on as the person wants.
"""

from __future__ import annotations

import random
from collections import deque
from struct import pack
from types import SimpleNamespace
from typing import Any, NamedTuple, cast

import pytest

from tiniscript import robots
from tiniscript.base.fixed_point import value_of
from tiniscript.bytecode.statements import statement_of, statement_starts
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import debugger as debugger_of
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.debugger import Debugger, HaltableProgram, breakpoint_offsets, parse_lines
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.live_state import LiveState
from tiniscript.cli.terminal.keys import Keys
from tiniscript.cli.texts import text
from tiniscript.library.source_map import map_of_compiled
from tiniscript.link.messages import RESUME_GO, RESUME_STEP, TASK_STATES
from tiniscript.link.payloads import HaltedEvent

KIT = robots.load("tinibot").kit
LINES = (
    "X = 4; READY = TRUE",
    "DEF TELL\nSHOW(X)\nX = X + 1\nEND_DEF",
    "LOOP(2)\nTELL\nIF(READY)\nREADY = NOT READY; W(1)\nENDIF\nX = X - 1\n"
    "DISTANCE\nIF(DISTANCE < 10)\nSHOW(X)\nENDIF\nEND_LOOP",  # the reading is taken once
)


def haltable_program(rng: random.Random, is_live: bool) -> HaltableProgram:
    """A program, or a live line behind the values and DEFs that it needs."""
    state = LiveState(KIT)
    if not is_live:
        compilation = state.compile_line("\n".join(LINES), 0).compilation
        return HaltableProgram(compilation.code, map_of_compiled(compilation))
    state.value_by_name = dict.fromkeys("XYZ", cast(Any, (4000, False)))
    state.value_by_name["READY"] = cast(Any, (1, True))
    state.text_by_def = {"TELL": LINES[1]}
    line = state.compile_line(LINES[2], rng.choice((0, 2000)))
    assert line.whole_map is not None and line.lines_before > 1
    return HaltableProgram(line.compilation.code, line.whole_map, line.lines_before + 1)


class Halt(NamedTuple):
    """What is said at a halt."""

    offset: int
    line: int
    sentence: str
    variables: dict[str, Any]
    tasks: list[dict[str, Any]]


class Robot:
    """A robot that executes statements along a path, and halts at breakpoints and after a step."""

    def __init__(self, rng: random.Random, program: HaltableProgram, path: list[int]) -> None:
        self.rng, self.program, self.path = rng, program, path
        self.place = -1
        self.breakpoints: tuple[int, ...] = ()
        self.events: deque[HaltedEvent] = deque()
        self.is_halted, self.resume_kind = False, RESUME_GO
        self.values: list[int] = []
        self.ask_count = 0
        self.tasks: list[tuple[int, int]] = []

    def halt(self, place: int) -> None:
        self.place, self.is_halted = place, True
        count, rng = len(self.program.map.variables), self.rng
        count -= rng.random() < 0.1  # it answers too little
        self.values = [rng.choice((0, 1, rng.randrange(-9000, 9000))) for _ in range(count)]
        self.tasks = [(rng.randrange(len(TASK_STATES)), rng.choice(self.path)) for _ in range(4)]
        self.events.append(HaltedEvent(1, self.path[place], rng.randrange(4)))

    def request(self, make_request: Any) -> Any:
        return make_request(self)

    def break_at(self, breakpoints: tuple[int, ...]) -> None:
        self.breakpoints = breakpoints

    def resume(self, kind: int) -> None:
        assert self.is_halted, "it runs already"
        self.is_halted, self.resume_kind = False, kind
        places = list(range(self.place + 1, len(self.path)))
        if kind == RESUME_GO:
            places = [place for place in places if self.path[place] in self.breakpoints]
        if places:
            self.halt(places[0])

    def _ask(self, name: str, _: object, first: int) -> Any:
        self.ask_count += 1
        assert name == "read_variables" and self.ask_count < 1000
        values = self.values[first : first + self.rng.randint(1, 3)]
        return SimpleNamespace(values=SimpleNamespace(values=pack(f"<{len(values)}i", *values)))

    def read_tasks(self) -> Any:
        rows = b"".join(pack("<BHI", state, offset, 0) for state, offset in self.tasks)
        return SimpleNamespace(values=SimpleNamespace(tasks=rows))

    def expected_halt(self, task: int) -> Halt:
        program, offset = self.program, self.path[self.place]
        location = last_location(program, offset)
        flags = program.map.yes_no_flags or [False] * 9
        variables = zip(program.map.variables, self.values, flags, strict=False)
        tasks = [
            {"state": TASK_STATES[state][0], "line": location.line - program.first_line + 1}
            for number, (state, place) in enumerate(self.tasks)
            if number != task and state and (location := program.map.location_at(place))
        ]
        location = last_location(program, offset)
        assert location is not None
        line = location.line - program.first_line + 1
        what = program.map.line(location.line)[location.column - 1 :].partition(";")[0].strip()
        sentence = text("halted", "en").format(line=line, what=what)
        values = {name: value_of(value, flag) for name, value, flag in variables}
        return Halt(offset, line, sentence, values, tasks)


def last_location(program: HaltableProgram, offset: int) -> Any:
    """Return the last place of a statement that a person sees, or None."""
    starts = statement_starts(program.code)
    end = min((start for start in starts if start > offset), default=offset + 1)
    places = [location for location in program.map.locations if location.offset < end]
    is_seen = places and places[-1].line >= program.first_line and places[-1][1:3] != places[-1][3:]
    return places[-1] if is_seen else None


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("has_keys", [False, True])
def test_a_program_halts_and_goes_on_as_a_person_wants(
    has_keys: bool, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = random.Random(seed)
    is_live = rng.random() < 0.7
    program = haltable_program(rng, is_live)
    if rng.random() < 0.2:  # of an earlier version
        program = program._replace(map=program.map._replace(yes_no_flags=()))
    starts = statement_starts(program.code)
    path = [starts[0], *(rng.choice(starts) for _ in range(40))]
    lines = parse_lines([str(rng.randint(1, 9)) for _ in range(3)] + ["2", "2"], "en")
    breakpoints = breakpoint_offsets(lines, program)
    expected_breakpoints = set()
    for line in lines:
        expected_breakpoints.add(min(
            statement_of(starts, location.offset) for location in program.map.locations
            if location.line - program.first_line + 1 >= line >= 1
            and location[1:3] != location[3:]
        ))  # fmt: skip
    assert breakpoints == tuple(sorted(expected_breakpoints))
    robot = Robot(rng, program, path)
    printed_halts: list[Halt] = []

    def print_values(
        since_ms: int, name: str, shown: str, sentences: str,
        *, line: int, at: int, variables: Any, tasks: Any,
    ) -> None:  # fmt: skip
        printed_halts.append(Halt(at, line, sentences.splitlines()[0], variables, tasks))

    monkeypatch.setattr("sys.stdin.isatty", lambda: has_keys)
    monkeypatch.setattr(debugger_of, "is_in_front", lambda: True)
    printer = SimpleNamespace(language="en", is_json=False, print_values=print_values)
    debugger = Debugger(
        cast(Connection, robot), cast(EventPrinter, printer), program,
        breakpoints if is_live else None,
    )  # fmt: skip
    typed_keys = ""
    monkeypatch.setattr(debugger.keys, "read_keys", lambda: typed_keys)
    robot.breakpoints = () if is_live else breakpoints
    if is_live:
        robot.halt(0)  # it began halted
    else:
        robot.is_halted = True
        robot.resume(RESUME_GO)
    is_stepping = False
    while robot.events:
        event, place = robot.events.popleft(), robot.place
        location = last_location(program, event.offset)
        begins = location is not None and statement_of(starts, location.offset) == event.offset
        is_reported = begins if is_stepping else event.offset in breakpoints
        expected = [robot.expected_halt(event.task)] if is_reported else []
        printed_halts.clear()
        assert debugger.hold_event(event)
        assert printed_halts == expected
        assert set(robot.breakpoints) == set(breakpoints)
        if not (is_reported and has_keys):
            assert not robot.is_halted or robot.place > place, "nothing lets it go on"
            assert robot.resume_kind == (
                RESUME_STEP if is_stepping and not is_reported else RESUME_GO
            )
            is_stepping = is_stepping and not is_reported
            continue
        assert robot.is_halted and robot.place == place, "it does not wait for a key"
        typed_keys = rng.choice("sg")
        debugger.poll_keys()
        is_stepping = typed_keys == "s"
        assert robot.resume_kind == (RESUME_STEP if is_stepping else RESUME_GO)
        assert not robot.is_halted or robot.place > place


def test_no_more_lines_than_a_robot_has_breakpoints() -> None:
    """A line that is typed twice counts once."""
    assert parse_lines(["4", "1", "4", "2", "3", "1"], "en") == (1, 2, 3, 4)
    with pytest.raises(CommandError, match="break_most"):
        parse_lines(["1", "2", "3", "4", "5"], "en")


class TakenKeys(Keys):
    def __init__(self) -> None:
        self.calls: list[str] = []

    def __enter__(self) -> TakenKeys:
        self.calls.append("take")
        return self

    def __exit__(self, *_: object) -> None:
        self.calls.append("give back")


@pytest.mark.parametrize(("is_typed", "is_front", "is_json"), [
    (True, True, False), (True, True, True), (True, False, False), (False, True, False),
])  # fmt: skip
def test_the_keys_of_a_terminal_are_given_back(
    is_typed: bool, is_front: bool, is_json: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are not taken in the background, nor where a program reads."""
    monkeypatch.setattr("sys.stdin.isatty", lambda: is_typed)
    monkeypatch.setattr(debugger_of, "is_in_front", lambda: is_front)
    monkeypatch.setattr(debugger_of, "Keys", TakenKeys)
    printer = cast(EventPrinter, SimpleNamespace(language="en", is_json=is_json))
    program = haltable_program(random.Random(0), is_live=False)
    with Debugger(cast(Connection, None), printer, program) as debugger:
        pass
    takes_keys = is_typed and is_front and not is_json
    assert cast(TakenKeys, debugger.keys).calls == ["take", "give back"] * takes_keys
