"""Whole sessions of `tsc live` at the prompt: whatever came before a line, it does what a plain
model does, each value that the robot shows is printed once, and each Ctrl-C stops the robot.
"""

from __future__ import annotations

import contextlib
import random
import sys
from argparse import Namespace
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar, NamedTuple, cast

import pytest

from tests.support.command import Tsc
from tiniscript import robots
from tiniscript.base import files
from tiniscript.base.fixed_point import as_text
from tiniscript.base.trace import Ending, Senses
from tiniscript.cli.commands import live
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import own_kit, remote_keys
from tiniscript.cli.robot.bookkeeping import BOOKKEEPING_MARK
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.live_state import LiveState
from tiniscript.cli.robot.run_monitor import DONE, FAULTY, INTERRUPTED
from tiniscript.cli.texts import text
from tiniscript.library import source_map
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import Event, ShownEvent, StartedEvent
from tiniscript.link.payloads import DoneEvent, FaultEvent, StoppedEvent
from tiniscript.link.requests import OK, Reply
from tiniscript.vm.runner import run as run_code

TINIBOT = robots.load("tinibot")
KINDS = "set", "add", "not", "show", "show", "lamp", "fault", "mark", "if", "loop"
NAMES, LAMP = ("X", "Y", "Z"), "READY"
MARK = as_text(BOOKKEEPING_MARK)
BUTTON_RUN = 999  # of a program that the button has started
FIRST_LINE = "X = 1; Y = 2; Z = 3; READY = TRUE"
DEF_NAMES = "DASH", "HOP", "JIG"  # each calls only those before it
ROOMY, NARROW = 2000, 24  # bytes of code that a robot accepts at once


# -- a plain model of what lines do --------------------------------------------------------------


class Fault(Exception):
    """A program's own fault."""


class State:
    """What a session knows, and what a line has shown so far."""

    def __init__(self) -> None:
        self.values: dict[str, int | bool] = {"X": 1, "Y": 2, "Z": 3, LAMP: True}
        self.defs: dict[str, list[Step]] = {}
        self.shown: list[str] = []

    def show(self, value: int | bool) -> None:
        self.shown.append(f"SHOW {str(value).upper()}")


class Step(NamedTuple):
    """An instruction, and what it does."""

    text: str
    do: Callable[[State], None]


def text_of(steps: list[Step]) -> str:
    return "; ".join(step.text for step in steps)


def do_all(steps: list[Step], state: State) -> None:
    for step in steps:
        step.do(state)


def drawn_step(rng: random.Random, callable_names: list[str], depth: int = 0) -> Step:
    def assign(name: str, value_of: Callable[[State], int | bool]) -> Callable[[State], None]:
        return lambda state: state.values.update({name: value_of(state)})

    def fail(_: State) -> None:
        raise Fault

    name, other, number = rng.choice(NAMES), rng.choice(NAMES), rng.randint(1, 9)
    kind = rng.choice([*KINDS, *["call"] * 4])
    if kind == "call" and callable_names:
        called_name = rng.choice(callable_names)
        return Step(called_name, lambda state: do_all(state.defs[called_name], state))
    if kind in ("if", "loop") and depth < 1:
        inner = drawn_step(rng, callable_names, depth + 1)
        if kind == "if":
            return Step(
                f"IF({LAMP}); {inner.text}; ENDIF",
                lambda state: inner.do(state) if state.values[LAMP] else None,
            )
        return Step(f"LOOP(2); {inner.text}; END_LOOP", lambda state: do_all([inner, inner], state))
    if kind == "set":
        return Step(f"{name} = {number}", assign(name, lambda _: number))
    if kind == "add":
        return Step(
            f"{name} = {other} - {number}", assign(name, lambda state: state.values[other] - number)
        )
    if kind == "not":
        return Step(f"{LAMP} = NOT {LAMP}", assign(LAMP, lambda state: not state.values[LAMP]))
    if kind == "lamp":
        return Step(f"SHOW({LAMP})", lambda state: state.show(state.values[LAMP]))
    if kind == "fault":
        return Step(f"SHOW(1 / ({name} - {name}))", fail)
    if kind == "mark":  # by chance
        return Step(f"SHOW({MARK})", lambda state: state.shown.append(f"SHOW {MARK}"))
    return Step(f"SHOW({name})", lambda state: state.show(state.values[name]))


class Line(NamedTuple):
    """A line with a new DEF, or without one, and then `steps`."""

    text: str
    new_def: dict[str, list[Step]]
    steps: list[Step]


def drawn_line(rng: random.Random, known_names: list[str]) -> Line:
    steps = [drawn_step(rng, known_names) for _ in range(rng.randint(1, 3))]
    if rng.random() < 0.4:
        return Line(text_of(steps), {}, steps)
    name = rng.choice(DEF_NAMES)
    earlier_names = [known for known in known_names if known < name]  # none calls itself
    body = [drawn_step(rng, earlier_names) for _ in range(rng.randint(1, 2))]
    text = f"DEF {name}; {text_of(body)}; END_DEF"
    if rng.random() < 0.6:
        return Line(text, {name: body}, [])
    # A known DEF that calls the new one would have to stand behind it.
    steps = [drawn_step(rng, [*earlier_names, name]) for _ in range(rng.randint(1, 3))]
    return Line(f"{text}; {text_of(steps)}", {name: body}, steps)


# -- a robot that does lines ---------------------------------------------------------------------


class LiveRobot:
    """A connection to a robot that runs code on the machine in Python. `presses_after` is the
    number of events of the next run after which somebody presses Ctrl-C, if anybody does."""

    def __init__(self) -> None:
        self.language, self.port = "en", "p"
        self.profile = TINIBOT
        self.device_info = SimpleNamespace(values=SimpleNamespace(features=0))
        self.simulator = SimpleNamespace(
            print_line=print, print_error=lambda line: print(line, file=sys.stderr),
            start_drawing=lambda: self._draw(True), stop_drawing=lambda: self._draw(False),
        )  # fmt: skip
        self.is_drawing = False
        self.is_time_over = False
        self.timeouts_s: list[float] = []  # of waits for an event
        self.wait_notice: Any = SimpleNamespace(
            poll=None, note_other_output=lambda: None, with_sentence=lambda _: self.wait_notice
        )
        self.room = ROOMY
        self.events: deque[Event] = deque()
        self.presses_after: int | None = None
        self.stop_count = self.run = 0
        self.own_shows: int | None = None  # of a line whose last value after these is lost
        self.loses_value = False
        self.failure: CommandError | None = None  # of the next line, or the next stop
        self._events_left: int | None = None  # before the press, in a run

    def meet(self) -> None:
        pass

    def _draw(self, is_drawing: bool) -> None:
        self.is_drawing = is_drawing

    def text(self, key: str) -> str:
        return key

    def print_text(self, key: str) -> None:
        pass

    def event(self, timeout_s: float = 0) -> tuple[int, Event] | None:
        self.timeouts_s.append(timeout_s)
        assert len(self.timeouts_s) < 10_000, "it never ends"
        if self._events_left == 0:
            self._events_left = None
            raise KeyboardInterrupt
        if not self.events:
            return None
        event = self.events.popleft()
        if self._events_left is not None:
            self._events_left = None if event.name in ("DONE", "FAULT") else self._events_left - 1
        return 0, event

    def stop(self) -> bool:
        self.stop_count += 1
        self._fail()
        self.events = deque(
            event for event in self.events if getattr(event, "run", 0) == BUTTON_RUN
        )
        self.events.append(StoppedEvent(0))
        return True

    def _fail(self) -> None:
        failure, self.failure = self.failure, None
        if failure is not None:
            raise failure

    def error_for_reply(self, reply: Reply[Any]) -> CommandError:
        assert reply.status == STATUSES["NO_REMOTE"]
        return CommandError(3, "refused")

    def request(self, make_request: Callable[[Any], Reply[Any]]) -> Reply[Any]:
        return make_request(self)

    def live(self, code: bytes, kit: int, halts: bool) -> Reply[Any]:
        self._fail()
        assert len(code) <= self.room
        self.run += 1
        events = list(events_of(code, self.run))
        if self.own_shows is not None:
            self.loses_value = sum(event.name == "SHOW" for event in events) > self.own_shows
            if self.loses_value:
                del events[-2]
        self.events += [StartedEvent(self.run, 0), *events]
        self._events_left, self.presses_after = self.presses_after, None
        return Reply(OK, 0, SimpleNamespace(run=self.run, program=0))


def events_of(code: bytes, run: int) -> Iterator[Event]:
    """Run code; return what its robot says, but not from where in the code."""
    for event in run_code(code, TINIBOT.kit, Senses(TINIBOT.kit, {})):
        if isinstance(event, Ending):
            yield DoneEvent(run) if event.kind == "DONE" else FaultEvent(run, 1, event.offset, 0)
        elif event.kind == "SHOW":
            yield ShownEvent(event.values[0], event.text.endswith("E"), run)


class Session:
    """A session at the prompt, where a person types texts, and presses keys that are exceptions."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.robot = LiveRobot()
        monkeypatch.setattr(live, "_history", lambda _: contextlib.nullcontext())
        monkeypatch.setattr(live, "short_bytes", lambda _: self.robot.room)
        monkeypatch.setattr(own_kit, "use_answering_profile", lambda *_: False)
        self.remembered_count = 0
        monkeypatch.setattr(source_map, "remember", self.remember)
        self.repl = live.Repl(
            cast(Connection, self.robot), LiveState(TINIBOT.kit), Namespace(breaks=[])
        )
        self.monkeypatch = monkeypatch

    def remember(self, *_: object) -> None:
        self.remembered_count += 1

    def run(self, typed: Iterator[str | BaseException]) -> int:
        """Run the prompt. In front of it nothing is drawn, and nothing waits to be printed."""

        def read(prompt: str) -> str:
            self.prompt = prompt
            assert not self.robot.is_drawing
            assert not self.robot.events or prompt != live.PROMPT
            text = next(typed)
            if isinstance(text, BaseException):
                raise text
            return text

        self.monkeypatch.setattr("builtins.input", read)
        return self.repl.run_prompt()


@pytest.mark.sampled("seed", keep=3)
@pytest.mark.parametrize("seed", range(10))
def test_a_line_does_the_same_whatever_came_before_it(
    seed: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A line that fails, is stopped, or is too long leaves what the lines before it have set. What
    a robot shows between two lines is printed before the second one's."""
    rng = random.Random(seed)
    state, session, has_left = State(), Session(monkeypatch), False
    robot, expected_stops = session.robot, 0

    def take_output() -> tuple[list[str], str]:
        out, err = capsys.readouterr()
        return [row for row in out.splitlines() if row.startswith("SHOW")], err

    def typed() -> Iterator[str | BaseException]:
        nonlocal expected_stops, has_left
        yield FIRST_LINE
        yield "LOOP(2); F(2 80)"
        assert session.prompt == live.PROMPT, "the mistake is said before the end of the block"
        assert "comma" in take_output()[1]
        for _ in range(25):
            line, line_state = drawn_line(rng, sorted(state.defs)), State()
            line_state.values, line_state.defs = {**state.values}, {**state.defs, **line.new_def}
            is_faulty = False
            try:
                do_all(line.steps, line_state)
            except Fault:
                is_faulty = True
            expected_rows = []
            if rng.random() < 0.2:
                values = 7000, *([BOOKKEEPING_MARK, 5000] if rng.random() < 0.5 else [])
                robot.events += [ShownEvent(value, False, BUTTON_RUN) for value in values]
                expected_rows.append("SHOW 7")  # the others are of another session's line
            if rng.random() < 0.2:
                if rng.random() < 0.5:
                    yield "LOOP(2)"  # it is dropped
                robot.failure = rng.choice((None, None, CommandError(3, "not_confirmed", port="p")))
                expected_sentence = "not confirmed" if robot.failure else "has confirmed"
                yield KeyboardInterrupt()
                expected_stops += 1
                rows, err = take_output()
                assert rows == expected_rows and expected_sentence in err
                expected_rows = []
            robot.room = NARROW if rng.random() < 0.2 else ROOMY
            presses_after = rng.randrange(8) if line.steps and rng.random() < 0.3 else None
            robot.presses_after = presses_after
            if line.steps and presses_after is None and rng.random() < 0.1:
                robot.failure = CommandError(3, "link_lost", port="p")
            may_fail = robot.failure is not None
            loses_value = rng.random() < 0.1 and f"SHOW {MARK}" not in line_state.shown
            robot.own_shows = len(line_state.shown) if loses_value else None
            robot.loses_value = False
            stops_before = robot.stop_count
            yield line.text
            rows, err = take_output()
            is_stopped, robot.presses_after = robot.stop_count > stops_before, None
            has_failed, robot.failure = may_fail and robot.failure is None, None
            assert err or not has_failed
            is_refused, is_forgotten = "room for" in err, "are not kept" in err
            assert robot.room == NARROW or not (is_refused or is_forgotten)
            assert not (is_forgotten and is_faulty)
            if is_stopped:
                assert presses_after is not None
                expected_stops += 1
                shown_rows = line_state.shown[: max(0, presses_after - 1)]  # after the start
                own_rows = rows[len(expected_rows) :]
                held_rows = shown_rows[len(own_rows) :]  # perhaps the values of its variables
                assert not held_rows or held_rows[0] == f"SHOW {MARK}"
                expected_rows += shown_rows[: len(own_rows)]
            elif not (is_refused or has_failed):
                expected_rows += line_state.shown
                if not is_faulty:
                    state.defs = line_state.defs
                    state.values = (
                        state.values if is_forgotten or robot.loses_value else line_state.values
                    )
            assert (rows, robot.stop_count) == (expected_rows, expected_stops), line.text + err
        robot.room, robot.own_shows = ROOMY, None
        yield "; ".join(f"SHOW({name})" for name in state.values)
        assert take_output()[0] == [f"SHOW {str(value).upper()}" for value in state.values.values()]
        has_left = True
        yield rng.choice((EOFError(), "exit"))
        pytest.fail("it goes on")

    assert session.run(typed()) == 0 and has_left
    assert session.remembered_count >= robot.run


@pytest.mark.parametrize("key", ["port_gone", "radio_gone", "holder_ended"])
def test_a_session_whose_port_is_gone_ends(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session(monkeypatch)

    def typed() -> Iterator[str | BaseException]:
        yield FIRST_LINE
        session.robot.failure = CommandError(3, key, port="p")
        yield "SHOW(X)"
        pytest.fail("it goes on")

    with pytest.raises(CommandError) as exception_info:
        session.run(typed())
    assert exception_info.value.key == key


# A virtual robot's time is over before a line, or while one runs.
@pytest.mark.parametrize("is_inside", [False, True])
@pytest.mark.parametrize("way", ["prompt", "file", "keys"])
def test_a_time_limit_ends_a_session_and_is_said_once(
    way: str, is_inside: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    session = Session(monkeypatch)
    robot = session.robot
    live_line = robot.live

    def over(*words: Any) -> Reply[Any]:
        robot.is_time_over = True
        return live_line(*words)

    def lines() -> Iterator[str]:
        yield FIRST_LINE
        if is_inside:
            monkeypatch.setattr(robot, "live", over)
        else:
            robot.is_time_over = True
        yield "SHOW(X)"
        pytest.fail("it goes on")

    if way == "keys":
        monkeypatch.setattr(live, "TerminalRemote", RemoteKeys)
        robot.is_time_over = not is_inside
        monkeypatch.setattr(robot, "live", over)
        exit_code = session.repl.drive_by_keys("W(1)" if is_inside else None)
    elif way == "file":
        exit_code = session.repl.run_lines(lines())
    else:
        exit_code = session.run(lines())
    assert exit_code == 0
    assert capsys.readouterr().out.count(text("time_over", "en")) == 1
    assert robot.run == (way != "keys") + is_inside


class RemoteKeys:
    """The keys of a terminal, of which `q` or Ctrl-C is pressed at the `presses_at`-th look."""

    quits = False
    presses_at: int | None = None
    calls: ClassVar[list[str]] = []

    def __init__(self, connection: object) -> None:
        self.has_quit, self.polls = False, 0

    def __enter__(self) -> RemoteKeys:
        self.calls.append("open")
        return self

    def __exit__(self, *_: object) -> None:
        self.calls.append("close")

    def poll(self) -> None:
        self.polls += 1
        if self.polls == self.presses_at:
            self.has_quit = self.quits
            raise KeyboardInterrupt


@pytest.mark.parametrize("line", [None, "SHOW(5)", "SHOW(1 / (TIME - TIME))"])
@pytest.mark.parametrize("does_quit", [False, True])
@pytest.mark.parametrize("presses_at", [1, 2, 9])
@pytest.mark.parametrize("is_stop_lost", [False, True])
def test_a_terminal_as_a_remote_control_says_how_it_ended(
    line: str | None, does_quit: bool, presses_at: int, is_stop_lost: bool,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """Whatever happens, the terminal is left, and what the robot shows is printed."""
    session = Session(monkeypatch)
    monkeypatch.setattr(live, "TerminalRemote", RemoteKeys)
    monkeypatch.setattr(RemoteKeys, "calls", [])
    monkeypatch.setattr(RemoteKeys, "quits", does_quit)
    monkeypatch.setattr(RemoteKeys, "presses_at", presses_at)
    if line is None:
        session.robot.events.append(ShownEvent(5000, False, BUTTON_RUN))
    is_pressed = line is None or presses_at < 3  # the start, and the next event
    exit_code = 0 if does_quit else INTERRUPTED
    if not is_pressed:
        exit_code = DONE if line == "SHOW(5)" else FAULTY
    if is_stop_lost and is_pressed:
        monkeypatch.setattr(session.robot, "stop", lambda: False)
        with pytest.raises(CommandError, match="not_confirmed"):
            session.repl.drive_by_keys(line)
    else:
        assert session.repl.drive_by_keys(line) == exit_code
    assert RemoteKeys.calls == ["open", "close"] and not session.robot.is_drawing
    assert ("SHOW 5" in capsys.readouterr().out) == (
        line in (None, "SHOW(5)") and not (line and is_pressed)
    )
    assert max(session.robot.timeouts_s) <= remote_keys.POLL_S


# -- what a terminal remembers -------------------------------------------------------------------


class Readline:
    """GNU readline with a history, as far as it is used."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.length = -1

    def read_history_file(self, path: Path) -> None:
        self.lines += path.read_text(encoding="utf-8").splitlines()

    def set_history_length(self, length: int) -> None:
        self.length = length

    def write_history_file(self, path: Path) -> None:
        kept_lines = self.lines if self.length < 0 else self.lines[-self.length :]
        path.write_text("".join(f"{line}\n" for line in kept_lines), encoding="utf-8")

    def set_completer(self, complete: Callable[[str, int], str | None]) -> None:
        self.complete = complete

    def set_completer_delims(self, _: str) -> None:
        pass

    parse_and_bind = set_completer_delims


@pytest.mark.skipif(sys.platform == "win32", reason="its console has a history of its own")
def test_the_lines_of_earlier_sessions_come_back_and_no_disk_ends_a_session(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    folder, typed_lines = tmp_path / "cache", list[str]()
    monkeypatch.setattr(files, "cache_folder", lambda: folder)
    state = LiveState(TINIBOT.kit)
    for k in range(6):
        readline = Readline()
        monkeypatch.setitem(sys.modules, "readline", readline)
        is_unwritable = k in (2, 5)
        if is_unwritable:  # another file is in its place
            saved_folder = folder.rename(tmp_path / "saved")
            folder.write_bytes(b"")
        with contextlib.suppress(KeyboardInterrupt), live._history(state):
            assert readline.lines == ([] if is_unwritable else typed_lines[-500:])
            readline.lines += (new_lines := [f"SHOW({k * 1000 + number})" for number in range(300)])
            state.text_by_def[f"ZIG{k}"] = ""
            assert readline.complete(f"zig{k}", 0) == f"ZIG{k}"
            assert readline.complete("DIST", 0) == "DISTANCE"
            assert readline.complete("DIST", 1) is None
            if k == 1:
                raise KeyboardInterrupt
        if is_unwritable:
            folder.unlink()
            saved_folder.rename(folder)
        else:
            typed_lines += new_lines


# -- lines that are not sent ---------------------------------------------------------------------


def test_wrong_use_is_reported(tsc: Tsc, monkeypatch: pytest.MonkeyPatch) -> None:
    tsc("live", "S", "-e", "S").gives(2)
    tsc("live", "S", "--keys").gives(2, "not a terminal")
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    tsc("live", "-", "--keys").gives(2, "not a terminal")
    tsc("live", "S", "--keys", "--break", "1").gives(2, "--break")


def test_a_line_for_a_remote_control_is_refused_where_there_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    session = Session(monkeypatch)
    with pytest.raises(CommandError, match="refused"):
        session.repl.run_line("SHOW(KEY_UP)")
    assert session.robot.run == 0
