"""What a robot has told of a run, as a file, and the same run on the virtual robot.

A file is JSON Lines: `{"tiniscript_recording": 1, "program": "89abcdef", "robot": "tinibot"}`, then
a line for each event, `{"ms": 120, "event": "SHOW 2.5"}`, with the milliseconds since the program
began; those of a program that waits for the robot's button count from its first event. Events are
SHOW, and one that is the last: DONE, FAULT, STOPPED (or saved while it ran), LOST (the link) and
MISSED (values did not arrive). A recording is compared as far as it goes. Knows no clock and no
page.
"""

from __future__ import annotations

import json
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from typing import NamedTuple

from tiniscript.base.fixed_point import ONE
from tiniscript.bytecode.image import checksum
from tiniscript.library.compiling import compile_source, for_robot
from tiniscript.library.source_map import made
from tiniscript.semantics import ir
from tiniscript.studio.checking import profile_of
from tiniscript.studio.simulation import Marks, Simulation
from tiniscript.virtual.world import World

VERSION = 1
MOST_BYTES = 1_000_000
MOST_MS = 600_000
LEAST_OFF_MS, OFF = 250, 0.05  # how much later or earlier is the same time
STEP_MS = 100
BEGINNING_MS = 1000  # limit for a program to begin after its button
CUT = ("STOPPED", "LOST", "MISSED")  # the end of a recording, and not what the program did
_EVENT = re.compile(
    r"SHOW (?:TRUE|FALSE|-?\d{1,7}(?:\.\d{1,3})?)|DONE|STOPPED|LOST|MISSED|FAULT [A-Z_0-9]{1,40}"
)
_PROGRAM = re.compile(r"[0-9a-f]{8}")


class BadRecording(Exception):
    """`reason` is unreadable, other_version or too_long; `line` where that is, from 1."""

    def __init__(self, reason: str, line: int) -> None:
        super().__init__(reason)
        self.reason = reason
        self.line = line


class Recorded(NamedTuple):
    ms: int
    event: str


class Recording(NamedTuple):
    """`robot` is the name that the file has, which need not be that of a robot; None for none."""

    program: int
    events: tuple[Recorded, ...]
    robot: str | None = None


class Parting(NamedTuple):
    """Where a recording and the virtual robot part.

    `what` is same, missed (the same until values did not arrive), empty (nothing to compare),
    other_program, value, time, robot_more or virtual_more; `line` is that of the program, or 0,
    and `robot` and `virtual` are the events there. `agreed` events were the same.
    """

    what: str
    agreed: int = 0
    line: int = 0
    robot: Recorded | None = None
    virtual: Recorded | None = None


def read(data: bytes) -> Recording:
    """Return the recording in a file. Raises BadRecording."""
    if len(data) > MOST_BYTES:
        raise BadRecording("too_long", 1)
    lines = _decoded(data).rstrip("\r\n").split("\n")
    head = _fields(lines[0], 1)
    if "tiniscript_recording" in head and head["tiniscript_recording"] != VERSION:
        raise BadRecording("other_version", 1)
    program, robot = head.get("program"), head.get("robot")
    if head.get("tiniscript_recording") != VERSION or not _is(_PROGRAM, program):
        raise BadRecording("unreadable", 1)
    if robot is not None and not isinstance(robot, str):
        raise BadRecording("unreadable", 1)
    events: list[Recorded] = []
    for number, line in enumerate(lines[1:], 2):
        fields = _fields(line, number)
        ms, event = fields.get("ms"), fields.get("event")
        if type(ms) is not int or ms < (events[-1].ms if events else 0) or not _is(_EVENT, event):
            raise BadRecording("unreadable", number)
        if ms > MOST_MS:
            raise BadRecording("too_long", number)
        if events and not events[-1].event.startswith("SHOW"):
            raise BadRecording("unreadable", number)  # after the end
        events.append(Recorded(ms, str(event)))
    return Recording(int(str(program), 16), tuple(events), robot)


def _decoded(data: bytes) -> str:
    """Return the text of a file, also as PowerShell and Notepad write it."""
    is_wide = data.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
    return data.decode("utf-16" if is_wide else "utf-8-sig", "replace")


def _fields(line: str, number: int) -> dict[str, object]:
    try:
        fields = json.loads(line)
    except (ValueError, RecursionError):
        fields = None
    if not isinstance(fields, dict):
        raise BadRecording("unreadable", number)
    return fields


def _is(form: re.Pattern[str], found: object) -> bool:
    return isinstance(found, str) and form.fullmatch(found) is not None


def replay(recording: Recording, text: bytes, robot: str, world: World) -> Parting:
    """Run a program on the virtual robot with the readings of a recording, and compare.

    A reading is known where the program shows a sensor, `SHOW(DISTANCE)`: from there on the
    virtual sensor has that reading, until the next one. Other sensors are those of `world`.
    Raises WorldRefused.
    """
    profile = profile_of(robot)
    found = compile_source(text, profile, "", is_strict=True, is_chosen=True)
    found = for_robot(found, profile)
    if found.program is None or not found.image or checksum(found.image) != recording.program:
        return Parting("other_program")
    if not recording.events or recording.events[0].event == "LOST":
        return Parting("empty")
    sensors = _shown_sensors(found.program)
    places = made(found.source, found.places).places
    shows = {place.offset: (place.line, sensors[its.span.start]) for its, place in
             zip(found.places, places, strict=True) if its.span.start in sensors}  # fmt: skip
    parts = tuple(place.offset for place in places)
    simulation = Simulation(robot, world, found.image, Marks(parts, tuple(shows)))
    virtual: list[Recorded] = []
    lines: list[int] = []
    is_by_button = found.program.start == "SB"
    if is_by_button:
        _push(simulation)
    events = recording.events
    until_ms = _until_ms(events, [], is_by_button)
    while simulation.robot.now_ms - (simulation.robot.started_ms or 0) < until_ms:
        began_ms = simulation.robot.started_ms or 0
        if simulation.held_at is not None:
            line, sensor = shows[simulation.held_at]
            said = events[len(lines)].event if len(lines) < len(events) else ""
            if sensor is not None and said.startswith("SHOW"):
                simulation.robot.sensing.tell(sensor, _number(said))
            lines.append(line)
            simulation.go_on()
        simulation.go(STEP_MS)
        for event in simulation.robot.take_events():
            if _EVENT.fullmatch(event.text):
                virtual.append(Recorded(event.time_ms - began_ms, event.text))
        until_ms = _until_ms(events, virtual, is_by_button)
        if not simulation.robot.is_running or len(virtual) > len(events):
            break
    simulation.close()
    if is_by_button:
        events = _since(events, virtual)
    return _compared(events, virtual, lines)


def _push(simulation: Simulation) -> None:
    """Push the start button, and wait until the program has begun."""
    simulation.push()
    for _ in range(BEGINNING_MS):
        if simulation.robot.started_ms is not None:
            return
        simulation.go(1)
    raise AssertionError("the program does not begin")


def _until_ms(events: tuple[Recorded, ...], virtual: list[Recorded], is_by_button: bool) -> int:
    """Return how long the virtual robot runs to be compared with all of `events`.

    By its button its first event is waited for, whose time the recording does not have.
    """
    if not events:
        return 0
    if not is_by_button or not _is_said(events[0]):
        return events[-1].ms + _off_ms(events[-1].ms)
    if not virtual:
        return MOST_MS
    last_ms = _since(events, virtual)[-1].ms
    return last_ms + _off_ms(last_ms)


def _since(events: tuple[Recorded, ...], virtual: list[Recorded]) -> tuple[Recorded, ...]:
    """Return `events` as if the first one had been at the time of the virtual one."""
    if not events or not virtual:
        return events
    late_ms = virtual[0].ms - events[0].ms
    return tuple(event._replace(ms=event.ms + late_ms) for event in events)


def _is_said(event: Recorded) -> bool:
    """Whether the program has said that, so that the virtual robot should say it, too."""
    return event.event not in CUT


def _shown_sensors(program: ir.Program) -> dict[int, int | None]:
    """Return where each SHOW begins, and the sensor that it shows, if it is one alone."""
    shown_sensors: dict[int, int | None] = {}
    for statement in ir.every(program):
        if isinstance(statement, ir.Show):
            is_one = len(statement.value) == 1 and statement.value[0].op == "SENSOR"
            shown_sensors[statement.span.start] = statement.value[0].value if is_one else None
    return shown_sensors


def _number(event: str) -> int:
    """Return what a SHOW event says, as a reading."""
    said = event.removeprefix("SHOW ")
    return int(said == "TRUE") if said in ("TRUE", "FALSE") else round(float(said) * ONE)


def _off_ms(ms: int) -> int:
    return LEAST_OFF_MS + round(ms * OFF)


def _compared(recorded: tuple[Recorded, ...], virtual: list[Recorded], lines: list[int]) -> Parting:
    shown = tuple(filter(_is_said, recorded))
    for count, ours in enumerate(shown):
        line = lines[count] if count < len(lines) else 0
        theirs = virtual[count] if count < len(virtual) else None
        if theirs is None:
            return Parting("robot_more", count, line, ours)
        if ours.event != theirs.event:
            return Parting("value", count, line, ours, theirs)
        if abs(ours.ms - theirs.ms) > _off_ms(max(ours.ms, theirs.ms)):
            return Parting("time", count, line, ours, theirs)
    count = len(shown)
    ends = recorded[-1] if recorded else Recorded(0, "STOPPED")
    if ends.event == "STOPPED" and len(virtual) > count:
        theirs = virtual[count]  # the robot has not said that, and had the time for it
        if theirs.ms + _off_ms(ends.ms) < ends.ms:
            line = lines[count] if count < len(lines) else 0
            return Parting("virtual_more", count, line, None, theirs)
    return Parting("missed" if ends.event == "MISSED" else "same", count)
