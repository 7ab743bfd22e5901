"""Requests of the page to a robot, and its events: both as data for JSON.

The same code is in the page, over Web Serial and Web Bluetooth, and in `tsc studio`, over the ports
of the computer; in both places it uses the session of `tiniscript.link`. So a request, a receipt
and a refusal mean the same for every connection to a robot. `tsc studio` passes requests on and no
bytes: other commands share its port meanwhile, and the keys of robots stay in their file.

Knows no port, no browser and no clock.
"""

from __future__ import annotations

from collections.abc import Callable
from struct import iter_unpack
from typing import Any, NamedTuple, TypeVar

from tiniscript import robots
from tiniscript.base.fixed_point import ONE, value_text
from tiniscript.base.source import printable
from tiniscript.bytecode.image import Image, ImageRefused, unpack
from tiniscript.library.known_kits import shipped_name_of_kit
from tiniscript.library.refusing import refusal
from tiniscript.link.authority import ownership_of
from tiniscript.link.connection import (
    EXCHANGE_TIMEOUT_MS,
    FOREIGN,
    STATUS,
    LinkConnection,
    PendingRequest,
    Requester,
    find_stranger,
    reason_of,
)
from tiniscript.link.messages import (
    BREAKPOINTS,
    MAX_BALANCE,
    MAX_BREAKPOINTS,
    MAX_LEAST,
    MAX_PAD,
    NAME_BYTES,
    READINGS,
    REMOTE_KEYS,
    RESUME_GO,
    RESUME_STEP,
    STATE_IDLE,
    STATE_RUNNING,
    STATE_STOPPED,
    TASK_STATES,
)
from tiniscript.link.names import cause_name, fault_name, saved_name
from tiniscript.link.outcomes import Event
from tiniscript.link.payloads import (
    HelloReply,
    ReadingEvent,
    ReadTasksReply,
    ReadVariablesReply,
    ReceiptReply,
    TrimReply,
)
from tiniscript.link.remote import RemoteState, has_remote
from tiniscript.link.requests import OK, DeviceInfo, Reply
from tiniscript.link.statuses import name_of, status_text
from tiniscript.link.trim import Trim, trim_from_reply
from tiniscript.studio.recordings import ReadingRows

Json = dict[str, Any]
T = TypeVar("T")

LIMIT_MS = EXCHANGE_TIMEOUT_MS  # timeout of a known robot that is silent or busy saving
LONGEST_LIMIT_MS = 20_000
MAX_WAITING = 8  # requests at a time
TEXT_CHARACTERS = 200
MAX_EVENTS = 200  # most events at a time
MAX_COUNT = 2**31
MAX_PLACE = 0xFFFF  # an offset in a program's code


class BadRequest(Exception):
    """Raised for a request that is not from this page."""


class _PageRequest(NamedTuple):
    number: int
    pending_request: PendingRequest[Any]
    is_program: bool  # whether it sends or starts a program, not a line
    is_keys: bool  # whether it is a state of the remote control; only the newest waits


class _Run(NamedTuple):
    """A robot counts its runs anew after a reset."""

    boot: int
    number: int


class RobotLink:
    """A page's part in a connection: one thread uses it. `owns_run`: a run that the page has
    started may still be running."""

    def __init__(self, connection: LinkConnection, language: str) -> None:
        self.language = language
        self._connection = connection
        connection.enable_place_events()
        self._requests: list[_PageRequest] = []
        self._answers: list[Json] = []
        # Runs: which the page has started, which was the last to begin, and to end.
        self._own_run: _Run | None = None
        self._begun_run: _Run | None = None
        self._ended_run: _Run | None = None
        self._reading_rows: ReadingRows | None = None
        self._readings_run: tuple[_Run, int] | None = None  # theirs, and when it began
        self._program_run: _Run | None = None  # the newest program that the page has started

    @property
    def owns_run(self) -> bool:
        return self._own_run is not None or any(
            request.pending_request.starts_program for request in self._requests
        )

    def ask(self, request: Json) -> None:
        """Begin a request; its answer is among the news, with its `id`.

        Raises BadRequest, ConnectionLost.
        """
        number, action = whole_number(request, "id", 0, MAX_COUNT), request.get("do")
        if action == "stop":
            self.stop()
            self._answers.append({"id": number, "ok": True})
            return
        if not isinstance(action, str) or action not in _MAKERS:
            raise BadRequest
        if action != "keys" and sum(not item.is_keys for item in self._requests) >= MAX_WAITING:
            raise BadRequest
        make_request = _MAKERS[action](request)
        limit_ms = whole_number(request, "limit_ms", 1, LONGEST_LIMIT_MS, LIMIT_MS)
        refusal_reply = self._refusal_of(request) if "image" in request else None
        if refusal_reply is not None:
            self._answers.append({"id": number, **self._failure_data(refusal_reply)})
            return

        def make_pending(session: Requester) -> PendingRequest[Any]:
            pending_request = make_request(session)
            if action != "claim":  # a claim waits for a hand on the button
                pending_request.limit_ms = limit_ms
            return pending_request

        if action in ("upload", "start") and self._tells_readings:
            self._connection.begin(lambda session: session.tell_readings(True))
        pending = self._connection.begin(make_pending)
        self._requests.append(
            _PageRequest(number, pending, action in ("upload", "start"), action == "keys")
        )

    def stop(self) -> None:
        """Stop the robot, whoever started its program."""
        self._connection.stop()

    def news(self, timeout_s: float = 0) -> list[Json]:
        """Return answers and events since the last call; wait that long for one.

        Raises ConnectionLost.
        """
        news, self._answers = self._answers, []
        news += self._outcomes()
        for _ in range(MAX_EVENTS):
            event = self._connection.event(0 if news else timeout_s)
            news += self._outcomes()  # an answer is there before the events that follow from it
            if event is None:
                break
            self._note_run(event[1])
            if isinstance(event[1], ReadingEvent):
                news += self._rows_of_reading(event[1], event[0])
            else:
                news += self._event_data(event[1])
        return news

    def _outcomes(self) -> list[Json]:
        finished_requests = [
            request for request in self._requests if request.pending_request.outcome is not None
        ]
        self._requests = [
            request for request in self._requests if request.pending_request.outcome is None
        ]
        for request in finished_requests:
            reply = request.pending_request.outcome
            if reply and reply.status == OK and isinstance(reply.values, ReceiptReply):
                if request.is_program:
                    self._program_run = self._known_run(reply.values.run)
        return [
            {"id": request.number, **self._answer_data(request.pending_request)}
            for request in finished_requests
        ]

    def _note_run(self, event: Event) -> None:
        """Find the end of the page's run. An end may come before the answer that names the run;
        one without a number may be that of a run before. Another run that begins ends it, too: what
        the page leaves to be stopped is its own."""
        if event.name == "STARTED":
            run = self._known_run(event.run)
            if self._begun_run == self._own_run != run:
                self._own_run = None
            self._begun_run, self._ended_run = run, None
        elif event.name in ("DONE", "FAULT"):
            self._ended_run = self._known_run(event.run)
        elif event.name == "STOPPED":
            self._ended_run = self._begun_run
        if event.name in ("LOST", "RESTARTED") or (
            self._ended_run is not None and self._ended_run == self._own_run
        ):
            self._own_run = None

    @property
    def _tells_readings(self) -> bool:
        robot = self._connection.robot
        return robot is not None and bool(robot.values.features & READINGS)

    def _rows_of_reading(self, event: ReadingEvent, time_ms: int) -> list[Json]:
        """Return an event with the rows of a reading for the recording of its run."""
        robot, run = self._connection.robot, self._known_run(event.run)
        name = shipped_name_of_kit(robot.kit) if robot is not None else None
        if name is None:
            return []
        # The first reading of this run.
        if self._readings_run is None or self._readings_run[0] != run:
            self._reading_rows = ReadingRows(robots.load(name).kit)
            self._readings_run = run, time_ms - event.ms
        assert self._reading_rows is not None
        rows = self._reading_rows.rows(event, time_ms - self._readings_run[1])
        return [{"event": event.name, "rows": [row.cells for row in rows]}]

    def _known_run(self, number: int) -> _Run:
        return _Run(self._connection.boot, number)

    # -- requests ---------------------------------------------------------------------------------

    def _refusal_of(self, request: Json) -> Reply[Any] | None:
        """Return the refusal of a program of another kit, before any byte is sent."""
        robot = self._connection.robot
        if robot is None:
            return None
        return refusal(_image(request), robots.load(robot_of(request)), robot)

    def _answer_data(self, pending_request: PendingRequest[Any]) -> Json:
        reply = pending_request.outcome
        assert reply is not None
        if reply.status != OK:
            return self._failure_data(reply)
        values = reply.values
        if isinstance(values, ReceiptReply):
            run = self._known_run(values.run)
            if pending_request.starts_program and run != self._ended_run:
                self._own_run = run
            return {
                "ok": True,
                "program": f"{values.program:08x}",
                "saved": saved_name(values.saved),
            }
        if isinstance(values, TrimReply):
            return {"ok": True, "trim": trim_from_reply(values).as_data()}
        if isinstance(values, ReadVariablesReply):
            variables = [value / ONE for (value,) in iter_unpack("<i", values.values)]
            return {"ok": True, "variables": variables}
        if isinstance(values, ReadTasksReply):
            tasks = [[TASK_STATES[state][0], offset]
                     for state, offset, _ in iter_unpack("<BHI", values.tasks)]  # fmt: skip
            return {"ok": True, "tasks": tasks}
        robot = self._connection.robot
        if isinstance(values, HelloReply) and robot is not None:
            return {"ok": True, "robot": robot_data(robot)}
        return {"ok": True}

    def _failure_data(self, reply: Reply[Any]) -> Json:
        reason = reason_of(self._connection, reply)
        board = find_stranger(self._connection) if reason == FOREIGN else None
        if board is not None:
            from tiniscript.link.foreign import explain

            message, advice = explain(board, self.language)
            return {"failure": reason, "said": message, "advice": advice}
        if reason != STATUS:
            return {"failure": reason, "said": "", "advice": ""}
        message, advice = status_text(reply.status, reply.detail, self.language)
        return {"failure": name_of(reply.status), "said": message, "advice": advice}

    # -- events -----------------------------------------------------------------------------------

    def _event_data(self, event: Event) -> list[Json]:
        data: Json = {"event": event.name}
        if event.name == "SHOW":
            data["value"] = value_text(event.value, bool(event.is_yes_no))
            if event.offset >= 0:
                data |= {"at": event.offset, "program": f"{event.program:08x}"}
        elif event.name == "FAULT":
            data |= {"fault": fault_name(event.fault), "at": event.offset,
                      "program": f"{event.program:08x}"}  # fmt: skip
        elif event.name == "STOPPED":
            data["cause"] = cause_name(event.cause)
        elif event.name == "PLACE":
            data |= {"at": event.offset, "program": f"{event.program:08x}"}
        elif event.name == "HALTED":
            data |= {"at": event.offset, "task": event.task,
                      "is_program": self._known_run(event.run) == self._program_run}  # fmt: skip
        elif event.name == "MISSED":
            data["count"] = event.count
        elif event.name == "TEXT":
            data["text"] = printable(event.text.decode("utf-8", "replace"), TEXT_CHARACTERS)
        elif event.name == "STARTED":
            data["program"] = f"{event.program:08x}"
            # A program, not a line, of this page.
            data["is_program"] = self._known_run(event.run) == self._program_run
        elif event.name not in ("DONE", "RESTARTED", "LOST"):
            return []  # other users of the port do not concern a page
        return [data]


def robot_data(robot: DeviceInfo) -> Json:
    """Return a robot's description: `robot` is the name of its shipped profile or None, `owner` is
    free, yours or other, `room` in bytes of code.
    """
    return {
        "name": printable(robot.name),
        "id": f"{robot.id:08x}",
        "robot": shipped_name_of_kit(robot.kit),
        "owner": ownership_of(robot),
        "room": robot.room,
        "is_running": robot.values.state == STATE_RUNNING,
        "is_idle": robot.values.state in (STATE_IDLE, STATE_STOPPED),
        "has_remote": has_remote(robot),
        "has_breakpoints": bool(robot.values.features & BREAKPOINTS),
        "has_readings": bool(robot.values.features & READINGS),
    }


# -- the fields of a request ----------------------------------------------------------------------

_Make = Callable[[Requester], PendingRequest[Any]]


def _upload(request: Json) -> _Make:
    image, kit = _image(request), robots.load(robot_of(request)).kit.fingerprint
    runs = request.get("runs") is True
    return lambda session: session.upload(image, runs, kit=kit)


def _live(request: Json) -> _Make:
    image, kit = _image(request), robots.load(robot_of(request)).kit.fingerprint
    return lambda session: session.live(image.code, kit if image.devices else 0)


def _name(request: Json) -> _Make:
    name = request.get("name")
    if (
        not isinstance(name, str)
        or not name.isprintable()
        or not 1 <= len(name.encode()) <= NAME_BYTES
    ):
        raise BadRequest
    return lambda session: session.name(name.encode())


def _trim(request: Json) -> _Make:
    fields = request.get("trim")
    if fields is None:
        return lambda session: session.trim()
    if not isinstance(fields, dict):
        raise BadRequest
    trim = Trim(  # without a pace, the robot keeps its own
        fields.get("is_exchanged") is True,
        fields.get("is_left_reversed") is True,
        fields.get("is_right_reversed") is True,
        whole_number(fields, "balance", -MAX_BALANCE, MAX_BALANCE),
        whole_number(fields, "least", 0, MAX_LEAST),
    )
    return lambda session: session.trim(trim.data())


def _keys(request: Json) -> _Make:
    keys = whole_number(request, "keys", 0, (1 << len(REMOTE_KEYS)) - 1)
    state = RemoteState(
        keys, *(whole_number(request, axis, -MAX_PAD, MAX_PAD) for axis in ("x", "y"))
    )
    return lambda session: session.press(*state)


def _break(request: Json) -> _Make:
    places = request.get("places")
    if (
        not isinstance(places, list)
        or len(places) > MAX_BREAKPOINTS
        or not all(type(place) is int and 0 <= place <= MAX_PLACE for place in places)
    ):
        raise BadRequest
    return lambda session: session.break_at(places)


def _resume(request: Json) -> _Make:
    mode = RESUME_STEP if request.get("is_step") is True else RESUME_GO
    return lambda session: session.resume(mode)


def _variables(request: Json) -> _Make:
    first = whole_number(request, "first", 0, 255)
    return lambda session: session.read_variables(first)


_MAKERS: dict[str, Callable[[Json], _Make]] = {
    "hello": lambda request: lambda session: session.hello(),
    "upload": _upload,
    "live": _live,
    "start": lambda request: lambda session: session.start(),
    "undo": lambda request: lambda session: session.undo(),
    "identify": lambda request: lambda session: session.identify(),
    "name": _name,
    "trim": _trim,
    "keys": _keys,
    "break": _break,
    "resume": _resume,
    "variables": _variables,
    "tasks": lambda request: lambda session: session.read_tasks(),
    "claim": lambda request: lambda session: session.claim(0),
    "disown": lambda request: lambda session: session.disown(0),
}


def whole_number(
    request: Json, name: str, least: int, most: int, default: int | None = None
) -> int:
    """Return a number of a request. Raises BadRequest."""
    number = request.get(name, default)
    if type(number) is not int or not least <= number <= most:
        raise BadRequest
    return number


def robot_of(request: Json) -> str:
    """Return the name of a shipped robot. Raises BadRequest."""
    robot = request.get("robot")
    if robot not in robots.names():
        raise BadRequest
    return str(robot)


def _image(request: Json) -> Image:
    try:
        return unpack(bytes.fromhex(request["image"]))
    except (ImageRefused, TypeError, ValueError, KeyError):
        raise BadRequest from None
