"""A connection of the library treats its last program as a fresh connection would: leaving it stops
the robot, or not, however the programs before it ended."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable
from time import monotonic
from types import SimpleNamespace
from typing import Any

import pytest

from tests.support.link_events import event
from tiniscript import compile_text, robots
from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.image import Image, checksum
from tiniscript.library import connection, opening
from tiniscript.library.connection import RobotConnection
from tiniscript.library.errors import RobotError, UsageError
from tiniscript.link.messages import SAVED_SAVING, SAVED_STORED
from tiniscript.link.outcomes import Event, RestartedEvent, ShownEvent, StartedEvent
from tiniscript.link.payloads import DoneEvent, FaultEvent, ReceiptReply, StatusReply
from tiniscript.link.requests import OK, Reply

KIT = robots.load("tinibot").kit
PROGRAM = 7
CLOSE_ACTION = "close"
SAVING_LOOKS = 3  # of a saving robot: it reports success


class Asked:
    """Records the requests that it gets."""

    def __getattr__(self, name: str) -> Callable[..., str]:
        return lambda *_: name


class Line:
    """A robot that runs its commands, and the record of its client's actions."""

    def __init__(self, *_: object) -> None:
        self.run, self.program = 0, PROGRAM
        self.unsaved_looks = 0  # for which it is still saving its program
        self.events: list[tuple[int, Event]] = []
        self.did: list[str] = []
        self.drives_another = self.holds_for_others = False
        self.device_info = SimpleNamespace(kit=KIT.fingerprint, name="")

    def meet(self) -> Any:
        return self.device_info

    def request(self, make: Callable[[Any], object] | None) -> Reply[Any]:
        if getattr(make, "__name__", "") == "status":
            fields: dict[str, Any] = dict.fromkeys(StatusReply._fields, 0)
            self.unsaved_looks = max(0, self.unsaved_looks - 1)
            saved = SAVED_SAVING if self.unsaved_looks else SAVED_STORED
            return Reply(OK, 0, StatusReply(**{**fields, "program": self.program, "saved": saved}))
        if make is not None and make(Asked()) == "undo":
            self.program, self.unsaved_looks = self.program - 1, SAVING_LOOKS
        self.run += 1
        fields = dict.fromkeys(ReceiptReply._fields, 0)
        fields |= {"program": self.program, "run": self.run, "saved": SAVED_SAVING}
        return Reply(OK, 0, ReceiptReply(**fields))

    def send_program(
        self, image: Image, runs: bool, saves: bool, *_: object, **__: object
    ) -> Reply[Any]:
        self.program, self.unsaved_looks = image.checksum, SAVING_LOOKS * saves
        return self.request(None)

    def event(self, limit_s: float) -> tuple[int, Event] | None:
        return self.events.pop(0) if self.events else None

    def stop(self) -> bool:
        self.did.append("stop")
        return True

    def close(self) -> None:
        self.did.append(CLOSE_ACTION if not self.unsaved_looks else "close while it saves")


# The end of a program, and whether its starter looks on.
END_ACTIONS: dict[str, Callable[[Line], list[Event]]] = {
    "runs on": lambda line: [],
    "done": lambda line: [DoneEvent(line.run)],
    "stopped": lambda line: [event("STOPPED")],
    "replaced": lambda line: [StartedEvent(line.run + 1, line.program)],
    "restarted": lambda line: [RestartedEvent()],
}
START_ACTIONS = ("start", "start detached", "upload", "upload for good", "live", "undo")
Story = tuple[str, str, bool]


def play_story(robot: RobotConnection, line: Line, story: Story) -> str:
    kind, end, looks = story
    if kind.startswith("upload"):
        robot.upload(f"SI|F({line.run + 1}, 50)", save=kind == "upload for good")
    elif kind == "live":
        robot.live("F(2, 50)")
    elif kind == "undo":
        robot.undo()
    else:
        robot.start(detached=kind == "start detached")
    events = [StartedEvent(line.run, line.program), *END_ACTIONS[end](line)]
    line.events += [(int(monotonic() * 1000), event) for event in events]
    if not looks:
        return ""
    try:
        return robot.wait(0).name
    except (RobotError, UsageError) as error:
        return error.reason


def connect_client(monkeypatch: pytest.MonkeyPatch) -> tuple[RobotConnection, Line]:
    line = Line()
    monkeypatch.setattr(connection, "Client", lambda *_: line)
    monkeypatch.setattr(opening, "remember", lambda *_: None)
    return RobotConnection("P", robots.load("tinibot"), False, None, "en"), line


def leave_robot(robot: RobotConnection, line: Line, kind: type[BaseException] | None) -> list[str]:
    robot.__exit__(kind)
    return line.did


STORIES = list(itertools.product(START_ACTIONS, END_ACTIONS, (False, True)))


@pytest.mark.sampled("seed", keep=20)
@pytest.mark.parametrize("kind", [None, ValueError, KeyboardInterrupt])
@pytest.mark.parametrize("seed", range(len(STORIES)))
def test_leaving_concerns_only_the_last_program(
    monkeypatch: pytest.MonkeyPatch, seed: int, kind: type[BaseException] | None
) -> None:
    rng = random.Random(seed)
    last_story = STORIES[seed]
    robot, line = connect_client(monkeypatch)
    outcome = play_story(robot, line, last_story)
    fresh = leave_robot(robot, line, kind)
    for _ in range(8):
        robot, line = connect_client(monkeypatch)
        earlier_stories = [rng.choice(STORIES) for _ in range(rng.randint(1, 3))]
        for story in earlier_stories:
            play_story(robot, line, story)
            line.events.clear()
            line.unsaved_looks = 0
        assert play_story(robot, line, last_story) == outcome, earlier_stories
        assert leave_robot(robot, line, kind) == fresh, (earlier_stories, last_story)


def test_a_program_that_keeps_running_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """The reference for the others. Ctrl-C stops any run."""
    for story, calls in (
        (("start", "runs on", False), ["stop", CLOSE_ACTION]),
        (("start detached", "runs on", False), [CLOSE_ACTION]),
        (("upload for good", "runs on", False), ["stop", CLOSE_ACTION]),
        (("undo", "runs on", False), ["stop", CLOSE_ACTION]),
        (("upload", "replaced", True), [CLOSE_ACTION]),
        (("upload", "replaced", False), [CLOSE_ACTION]),
    ):
        for kind in (None, KeyboardInterrupt):
            robot, line = connect_client(monkeypatch)
            play_story(robot, line, story)
            outcome = leave_robot(robot, line, kind)
            assert outcome == calls if kind is None else outcome[0] == "stop", (story, kind)


def test_late_values_belong_to_the_text_of_their_program(monkeypatch: pytest.MonkeyPatch) -> None:
    """The next one has the same code. Its own events were not read before that."""
    robot, line = connect_client(monkeypatch)
    for name, end in (("NEAR", "; "), ("FAR", "\n")):
        compilation = compile_text(f"SI|{name} = TIME{end}SHOW({name} / 0)", KIT)
        assert compilation.image
        program = checksum(compilation.image)
        line.program = program
        robot.upload(compilation.source.text, save=False)
        offset = rows(compilation.code)[-1].offset
        late_events: list[Event] = [
            ShownEvent(1000, 0, line.run, program, offset),
            FaultEvent(line.run, 1, offset, program),
        ]
        line.events += [(int(monotonic() * 1000), event) for event in late_events]
    events = list(robot.events(0.2))
    assert [(event.values.get("name"), event.values["line"]) for event in events] == [
        ("NEAR / 0", 1), (None, 1), ("FAR / 0", 2), (None, 2),
    ]  # fmt: skip
