"""Commands for many robots: whatever becomes of each robot, its lines are printed before its row,
its row once, and the exit code and the sum count it.
"""

from __future__ import annotations

import json
import random
import threading
from argparse import Namespace
from collections import deque
from collections.abc import Sequence
from functools import partial
from types import SimpleNamespace
from typing import Any, NamedTuple, cast

import pytest

from tests.support.waiting import HANG_LIMIT_S
from tiniscript import robots
from tiniscript.base.bell import Bell
from tiniscript.cli import images
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import fleet as fleet_of
from tiniscript.cli.robot import fleet_upload, program_upload
from tiniscript.cli.robot import member as member_of
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.fleet import (
    ABSENT_REASONS,
    NO_ROBOT_REASONS,
    STRANGER_TIMEOUT_S,
    Reconnect,
    run_together,
)
from tiniscript.cli.robot.member import Member, Result, Target
from tiniscript.cli.terminal import fleet_table
from tiniscript.cli.terminal.fleet_table import FleetTable
from tiniscript.cli.terminal.progress import MAX_PERCENT
from tiniscript.cli.texts import text
from tiniscript.library import opening
from tiniscript.link import known_ports, ports
from tiniscript.virtual import directory

TINIBOT = robots.load("tinibot")
POLLS_OF_SLOW = 3  # after the time for strangers has passed
ABSENT_KINDS = "silent", "link_silent", *ABSENT_REASONS
KINDS = *("done", "bad", "stopped", "unstopped", "link_lost"), *ABSENT_KINDS
MIXED_KINDS = "done", "bad", "silent"
KINDS_OF_FLEETS = MIXED_KINDS, KINDS, MIXED_KINDS, ("done",), MIXED_KINDS, ABSENT_KINDS


class Course(NamedTuple):
    """What becomes of a robot. `kind` is done, bad, stopped, unstopped, silent, or a reason."""

    target: Target
    kind: str
    has_answered: bool
    line_count: int
    reconnect_count: int
    is_slow: bool

    @property
    def is_stranger(self) -> bool:
        return not (self.has_answered or self.target.is_named or self.target.is_known)

    @property
    def is_absent(self) -> bool:
        if self.kind == "silent":
            return True
        is_without_robot = self.kind in NO_ROBOT_REASONS and not self.target.is_known
        return (self.kind in ABSENT_REASONS or is_without_robot) and not self.target.is_named

    @property
    def state_text(self) -> str:
        if self.kind in ("done", "bad"):
            return self.kind
        if self.kind == "stopped":
            return text("robot_stopped", "en")
        if self.kind == "silent":
            return text("port_quiet", "en")
        return error_of(self).plain_sentence("en")

    @property
    def lines(self) -> list[str]:
        return [f"{self.target.port} says {k}" for k in range(self.line_count)]


def error_of(course: Course) -> CommandError:
    key = "not_confirmed" if course.kind == "unstopped" else course.kind
    values = dict.fromkeys(
        ("others", "verb", "who", "name", "ports", "found", "what", "known", "why"), "x"
    )
    return CommandError(3, key, **{**values, "port": course.target.port})


def drawn_course(rng: random.Random, port: str, is_named: bool, kinds: Sequence[str]) -> Course:
    kind = rng.choice([kind for kind in kinds if kind != "silent" or not is_named])
    is_silent = kind == "silent"  # and a stranger
    target = Target(port, rng.choice(("", "OLD")), is_named, not is_silent and rng.random() < 0.5)
    has_answered = not is_silent and rng.random() < 0.5
    course = Course(target, kind, has_answered, rng.randrange(3), rng.randrange(3), False)
    return course._replace(is_slow=not course.is_stranger and rng.random() < 0.5)


class Screen:
    """A terminal that keeps what is printed on it; each frame lets the robots go on."""

    def __init__(self) -> None:
        self.rows: list[str] = []
        self.picture: list[str] = []
        self.begin_count = self.end_count = 0

    def begin(self) -> None:
        self.begin_count += 1

    def end(self) -> None:
        self.end_count += 1

    def print_line(self, line: str) -> None:
        self.rows.append(line)

    def draw(self, table: Any, now_ms: float) -> None:
        self.picture = [line.plain for line in table.lines(300, 50, now_ms)]


class Room:
    """Robots that go their courses, on a clock that waits until all that end by themselves have
    ended."""

    def __init__(self, courses: Sequence[Course]) -> None:
        self.course_by_port = {course.target.port: course for course in courses}
        self.quick_ports = [
            course.target.port
            for course in courses
            if not course.is_slow and course.kind != "silent"
        ]
        self.member_by_port: dict[str, Member] = {}
        self.polls = self.late_polls = 0
        self.may_end, self.is_over = threading.Event(), threading.Event()
        self.remembered: list[tuple[str, str, bool]] = []
        self.tries = dict.fromkeys(self.course_by_port, 0)
        self.screen = Screen()

    def monotonic(self) -> float:
        return STRANGER_TIMEOUT_S + 1 if self.is_late() else 0.0

    def is_late(self) -> bool:
        return self.polls > 0 and all(
            port in self.member_by_port and self.member_by_port[port].result is not None
            for port in self.quick_ports
        )

    def poll(self) -> None:
        self.polls += 1
        assert self.polls < 2_000, "it never ends"
        if self.is_late():
            self.late_polls += 1
            if self.late_polls > POLLS_OF_SLOW:
                self.may_end.set()

    def connect(self, options: Namespace, *_: object, is_one_of_many: bool) -> Any:
        assert is_one_of_many
        course = self.course_by_port[options.port]
        return FakeConnection(self, course)

    def work(self, connection: Connection, member: Member) -> Result:
        course = self.course_by_port[member.target.port]
        self.member_by_port[member.target.port] = member
        self.tries[member.target.port] += 1
        if self.tries[member.target.port] <= course.reconnect_count:
            raise Reconnect
        if course.has_answered:
            member.meet_robot(connection)
        if course.kind == "silent":
            self.is_over.wait(HANG_LIMIT_S)
            return Result(False, "")
        if course.is_slow:
            self.may_end.wait(HANG_LIMIT_S)
        for line in course.lines:
            member.queue_line(line)
        if course.kind in ("done", "bad"):
            return Result(course.kind == "done", course.kind, {"more": 5})
        if course.kind in ("stopped", "unstopped"):
            raise KeyboardInterrupt
        raise error_of(course)


class FakeConnection:
    def __init__(self, room: Room, course: Course) -> None:
        self.room, self.course = room, course
        self.port = course.target.port
        self.connection = SimpleNamespace(robot=None)
        self.name = self.port.upper()
        self.device_info = SimpleNamespace(name=self.name)

    def __enter__(self) -> FakeConnection:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def meet(self) -> None:
        self.connection.robot = self.device_info

    def interrupt(self) -> None:
        pytest.fail("nobody has pressed Ctrl-C")

    def stop(self) -> bool:
        return self.course.kind == "stopped"


def use_room(room: Room, monkeypatch: pytest.MonkeyPatch, is_terminal: bool) -> None:
    """Make the fleet of a command consist of these robots."""

    class PolledBell(Bell):
        def wait(self, timeout_s: float) -> bool:
            room.poll()
            return super().wait(min(timeout_s, 0.005))

    def draw(table: Any) -> None:
        room.poll()
        threading.Event().wait(0.002)
        table.screen.draw(table, 0)

    def remember(port: str, name: str, is_used: bool) -> None:
        room.remembered.append((port, name, is_used))

    monkeypatch.setattr(
        fleet_of, "targets", lambda _: [course.target for course in room.course_by_port.values()]
    )
    monkeypatch.setattr(fleet_of, "Connection", room.connect)
    monkeypatch.setattr(fleet_of, "Bell", PolledBell)
    monkeypatch.setattr(fleet_of, "monotonic", room.monotonic)
    monkeypatch.setattr(fleet_table, "Screen", lambda: room.screen)
    monkeypatch.setattr(FleetTable, "draw", draw)
    monkeypatch.setattr(opening, "remember", remember)
    monkeypatch.setattr("sys.stderr.isatty", lambda: is_terminal)


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize("output", ["lines", "json", "a table"])
def test_each_robot_has_its_row_whatever_becomes_of_the_others(
    output: str, seed: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = random.Random(seed)
    is_named = rng.random() < 0.4
    kinds = KINDS_OF_FLEETS[seed % len(KINDS_OF_FLEETS)]
    ports = [f"p{number}" for number in rng.sample(range(12), rng.randint(1, 6))]
    courses = [drawn_course(rng, port, is_named, kinds) for port in ports]
    room, attend_count = Room(courses), 0

    def attend() -> None:
        nonlocal attend_count
        attend_count += 1

    options = Namespace(verb="upload", detach=True, json=output == "json", attend=attend)
    use_room(room, monkeypatch, output == "a table")
    run = partial(run_together, options, TINIBOT, "en", room.work)
    absent = [course for course in courses if course.is_absent]
    present = [course for course in courses if not course.is_absent]
    try:
        if present:
            assert run() == (0 if all(course.kind == "done" for course in present) else 3)
        else:
            with pytest.raises(CommandError) as exception_info:
                run()
            assert exception_info.value.key == "no_robots"
    finally:
        room.is_over.set()
    out, err = capsys.readouterr()
    rows = room.screen.rows if output == "a table" else out.splitlines()
    check_rows(output, rows, courses)
    if output == "a table":
        assert room.screen.picture == [] and room.screen.begin_count == 1
        assert room.screen.end_count >= 1
    if output == "json" or not present:
        assert err == ""
    else:
        done_count = sum(course.kind == "done" for course in present)
        sum_line, *absent_lines = err.splitlines()
        assert sum_line == text("crew_sum", "en").format(done=done_count, all=len(present))
        absent_ports = sorted(
            (course.target.port for course in absent), key=lambda port: int(port[1:])
        )
        expected_line = text("crew_absent", "en").format(ports=", ".join(absent_ports))
        assert absent_lines == [expected_line] * bool(absent)
    assert attend_count >= room.polls
    assert sorted(room.remembered) == sorted(
        (course.target.port, course.target.port.upper(), False)
        for course in courses
        if course.has_answered
    )


def check_rows(output: str, rows: Sequence[str], courses: Sequence[Course]) -> None:
    left = list(rows)
    for course in courses:
        port = course.target.port
        name = port.upper() if course.has_answered else course.target.name
        row = f"{name} ({port}): {course.state_text}" if name else f"{port}: {course.state_text}"
        if output == "json":
            fields = {"more": 5} if course.kind in ("done", "bad") else {}
            row = json.dumps({
                "event": "RESULT", "port": port, "robot": name or None,
                "is_done": course.kind == "done", "is_absent": course.is_absent,
                "said": course.state_text, **fields,
            })  # fmt: skip
        expected_rows = [*(course.lines if course.kind != "silent" else []), row]
        if output != "json" and course.is_absent:
            expected_rows.pop()
        assert [row for row in rows if row in expected_rows] == expected_rows
        left = [row for row in left if row not in expected_rows]
    assert left == []
    if output == "a table":
        present = [course for course in courses if not course.is_absent]
        marks = [next(
            (course.kind == "done" for course in present if row.endswith(f"): {course.state_text}")
             or row.startswith(f"{course.target.port}: ")), None
        ) for row in rows if " says " not in row]  # fmt: skip
        assert marks == sorted(marks, key=lambda is_done: not is_done), "failures are last"


def test_a_row_that_comes_as_the_time_for_strangers_ends_is_printed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    times_s = iter((0.0,))
    monkeypatch.setattr(fleet_of, "monotonic", lambda: next(times_s, STRANGER_TIMEOUT_S + 1))
    options = Namespace(verb="stop", json=False)
    fleet = fleet_of.Fleet([Target("p1", "", False, False)], options, TINIBOT, "en")
    fleet.members[0].result = Result(False, "It is broken.")
    fleet.print_until_done(None)
    assert capsys.readouterr().out == "p1: It is broken.\n"


@pytest.mark.parametrize("is_in_sentence", [False, True])
@pytest.mark.parametrize("is_terminal", [False, True])
def test_a_bug_in_one_thread_is_raised(
    is_terminal: bool, is_in_sentence: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also one while a failure is put in words; the terminal is left as it was."""

    class Broken(CommandError):
        def plain_sentence(self, language: str) -> str:
            raise ZeroDivisionError

    targets = [Target(port, "", True, True) for port in ("p1", "p2", "p3")]
    room = Room([Course(target, "done", True, 0, 0, False) for target in targets])

    def work(connection: Connection, member: Member) -> Result:
        if member.target.port == "p2":
            raise Broken(3, "no_robots") if is_in_sentence else ZeroDivisionError
        return room.work(connection, member)

    use_room(room, monkeypatch, is_terminal)
    with pytest.raises(ZeroDivisionError):
        run_together(Namespace(verb="stop", json=False), TINIBOT, "en", work)
    assert room.screen.begin_count == is_terminal and room.screen.end_count >= is_terminal


@pytest.mark.parametrize("seed", range(20))
def test_a_low_table_shows_what_is_not_done_and_moves_no_column_back(seed: int) -> None:
    rng = random.Random(seed)
    members = [Member(Target(f"p{k}", "", False, True), deque()) for k in range(9)]
    table, column = FleetTable(members, "en"), 0
    for _ in range(30):
        member, height = rng.choice(members), rng.randint(3, 12)
        member.name = "N" * rng.randint(1, 9)
        member.result = rng.choice((None, None, Result(True, "ok"), Result(False, "no")))
        rows = [line.plain for line in table.lines(200, height, 0)][1:]
        shown_count = len(members) if len(members) < height else height - 2
        unready = [member for member in members if member.mark != "ok"]
        ready = [member for member in members if member.mark == "ok"]
        shown = [*unready, *ready][:shown_count]
        if shown_count == len(members):
            shown = members
        assert [row.split()[1] for row in rows[:shown_count]] == [it.target.port for it in shown]
        columns = {row.index(it.state_text("en")) for row, it in zip(rows, shown, strict=False)}
        assert len(columns) == 1 and min(columns) >= column
        column = min(columns)


# -- uploads -------------------------------------------------------------------------------------


@pytest.mark.parametrize("is_json", [False, True])
@pytest.mark.parametrize("is_terminal", [False, True])
def test_the_row_of_an_upload_says_the_end_and_the_table_the_last_value(
    is_json: bool, is_terminal: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: is_terminal)
    member = Member(Target("p1", "OLD", True, True), deque())
    ready_program = SimpleNamespace(program_map=None)
    connection = SimpleNamespace(language="en", port="p1")
    printer = fleet_upload.MemberPrinter(
        cast(Connection, connection), cast(Any, ready_program), member, is_json, 0
    )
    for value in (5, 6):
        printer.print_values(0, "SHOW", str(value), value=value)
        assert member.value == f"SHOW {value}"
    printer.print_values(0, "FAULT", "x", "It failed.\n  In line 1.", is_bad=True)
    printer.print_values(0, "SAVED", "1", "Saved.", slot=1)
    assert (printer.end_text, member.value) == ("It failed.  In line 1.", "SHOW 6")
    events = [json.loads(line)["event"] for line in member.lines] if is_json else []
    assert events == ["SHOW", "SHOW", "FAULT", "SAVED"] * is_json
    if not is_json:
        assert [*member.lines] == ["OLD (p1): SHOW 5", "OLD (p1): SHOW 6"] * (not is_terminal)


def test_an_upload_to_many_keeps_its_map_and_learns_their_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The map is kept before anything is sent."""
    kept: list[object] = []
    ready_program: Any = SimpleNamespace(
        image=SimpleNamespace(start="SB", code=bytes(10)), program_map=None
    )
    member = Member(Target("p1", "OLD", True, True), deque())
    connection: Any = SimpleNamespace(meet=lambda: None, name="NEW", port="p1", language="en")
    receipt = {"checksum": "1", "code_bytes": 10}

    def send_program(*words: Any) -> Any:
        for done_bytes, percent in ((0, 0), (5, 50), (10, MAX_PERCENT)):
            words[-1](done_bytes)
            assert member.state == ("crew_sending", {"percent": percent})
        return SimpleNamespace(program=1, run=1, saved=0)

    monkeypatch.setattr(images, "keep_map", kept.append)
    monkeypatch.setattr(fleet_upload, "run_together", lambda *words: words[-1](connection, member))
    monkeypatch.setattr(fleet_upload, "Saving", lambda *_: None)
    monkeypatch.setattr(program_upload, "send_program", send_program)
    monkeypatch.setattr(program_upload, "receipt_fields", lambda *_: receipt)
    monkeypatch.setattr(program_upload, "is_running", lambda *_: False)
    monkeypatch.setattr(program_upload, "follow_run", lambda *_: 0)
    options = Namespace(json=True, detach=False, verbose=False)
    result = cast(Result, fleet_upload.upload_to_many(options, TINIBOT, "en", ready_program, ""))
    assert kept == [ready_program] and member.name == "NEW"
    assert result.is_done and result.fields == {"checksum": "1"}
    assert [json.loads(line) for line in member.lines] == [receipt]


# -- which robots --------------------------------------------------------------------------------

PORTS = "/dev/a", "/dev/b", "ble://Tini 1", "BLE://tini 1", "ble://Tini 2", "tcp://one", "TCP://One"


@pytest.mark.parametrize("seed", range(20))
def test_each_port_that_may_have_a_robot_is_a_target_once(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However many ways lead to it: the first one counts for its place and its spelling."""
    rng = random.Random(seed)

    def draw_ports() -> list[str]:
        return rng.sample(PORTS, rng.randint(0, 4))

    held, listed, running, named, missing, gone = (draw_ports() for _ in range(6))
    remembered = {port: f"R{number}" for number, port in enumerate(draw_ports())}
    is_all = rng.random() < 0.6
    monkeypatch.setattr(member_of, "find_all", lambda: [SimpleNamespace(port=it) for it in held])
    monkeypatch.setattr(member_of, "exists", lambda port: port not in missing)
    monkeypatch.setattr(directory, "is_gone", lambda port: port in gone)
    monkeypatch.setattr(ports, "list_ports", lambda: [ports.ListedPort(it, "") for it in listed])
    robots_here = [SimpleNamespace(address=address) for address in running]
    monkeypatch.setattr(directory, "running_robots", lambda: robots_here)
    monkeypatch.setattr(
        known_ports, "remembered_ports", lambda: SimpleNamespace(name_by_port=remembered)
    )
    known = [port for port in remembered if port not in (*missing, *gone)]
    candidates = [*held, *known, *listed, *running] if is_all else named
    expected: dict[str, Target] = {}
    for port in candidates:
        name = next((name for it, name in remembered.items() if it.lower() == port.lower()), None)
        target = Target(port, name or "", not is_all, name is not None)
        expected.setdefault(port.lower(), target)
    options = Namespace(all=is_all, ports=[] if is_all else named)
    assert member_of.targets(options) == [*expected.values()]
