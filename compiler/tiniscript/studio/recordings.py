"""What a robot has told of a run, as a file, and the same run on the virtual robot.

A file is JSON Lines: `{"tiniscript_recording": 1, "program": "89abcdef", "robot": "tinibot"}`, then
a line for each event, `{"ms": 120, "event": "SHOW 2.5"}`, with the milliseconds since the program
began. Events are SHOW, DONE, FAULT and STOPPED; one that ends the run is the last one. Knows no
clock and no page.
"""

from __future__ import annotations

import json
import re
from typing import NamedTuple

from tiniscript.bytecode.image import checksum
from tiniscript.codegen.source_map import from_compiled
from tiniscript.fixed_point import ONE
from tiniscript.library.compiling import compiled
from tiniscript.semantics import ir
from tiniscript.studio.checking import profile_of
from tiniscript.studio.simulation import Marks, Simulation
from tiniscript.virtual.world import World

VERSION = 1
MOST_BYTES = 1_000_000
MOST_MS = 600_000
LEAST_OFF_MS, OFF = 250, 0.05  # how much later or earlier is the same time
STEP_MS = 100
_EVENT = re.compile(
    r"SHOW (?:TRUE|FALSE|-?\d{1,7}(?:\.\d{1,3})?)|DONE|STOPPED|FAULT [A-Z_0-9]{1,40}"
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
    program: int
    events: tuple[Recorded, ...]


class Parting(NamedTuple):
    """Where a recording and the virtual robot part.

    `what` is same, other_program, value, time, robot_more or virtual_more; `line` is that of the
    program, or 0, and `robot` and `virtual` are the events there. `agreed` events were the same.
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
    lines = data.decode("utf-8", "replace").removesuffix("\n").split("\n")
    head = _fields(lines[0], 1)
    if "tiniscript_recording" in head and head["tiniscript_recording"] != VERSION:
        raise BadRecording("other_version", 1)
    program = head.get("program")
    if head.get("tiniscript_recording") != VERSION or not _is(_PROGRAM, program):
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
            raise BadRecording("unreadable", number)  # behind the end
        events.append(Recorded(ms, str(event)))
    return Recording(int(str(program), 16), tuple(events))


def _fields(line: str, number: int) -> dict[str, object]:
    try:
        found = json.loads(line)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise BadRecording("unreadable", number)
    return found


def _is(form: re.Pattern[str], found: object) -> bool:
    return isinstance(found, str) and form.fullmatch(found) is not None


def replay(recording: Recording, text: bytes, robot: str, world: World) -> Parting:
    """Run a program on the virtual robot with the readings of a recording, and compare.

    A reading is known where the program shows a sensor, `SHOW(DISTANCE)`: from there on the
    virtual sensor has that reading, until the next one. Other sensors are those of `world`.
    Raises WorldRefused.
    """
    profile = profile_of(robot)
    found = compiled(text, profile, "", is_strict=True)
    if found.program is None or not found.image or checksum(found.image) != recording.program:
        return Parting("other_program")
    sensors = _shown_sensors(found.program)
    places = from_compiled(found).places
    shows = {place.offset: (place.line, sensors[its.span.start]) for its, place in
             zip(found.places, places, strict=True) if its.span.start in sensors}  # fmt: skip
    parts = tuple(place.offset for place in places)
    simulation = Simulation(robot, world, found.image, Marks(parts, tuple(shows)))
    virtual: list[Recorded] = []
    lines: list[int] = []
    ends = recording.events[-1] if recording.events else Recorded(0, "STOPPED")
    until_ms = ends.ms + _off_ms(ends.ms)
    while simulation.robot.now_ms - (simulation.robot.started_ms or 0) < until_ms:
        began_ms = simulation.robot.started_ms or 0
        if simulation.held_at is not None:
            line, sensor = shows[simulation.held_at]
            said = recording.events[len(lines)].event if len(lines) < len(recording.events) else ""
            if sensor is not None and said.startswith("SHOW"):
                simulation.robot.sensing.tell(sensor, _number(said))
            lines.append(line)
            simulation.go_on()
        simulation.go(STEP_MS)
        for event in simulation.robot.take_events():
            if _EVENT.fullmatch(event.text):
                virtual.append(Recorded(event.time_ms - began_ms, event.text))
        if not simulation.robot.is_running or len(virtual) > len(recording.events):
            break
    simulation.close()
    return _compared(recording.events, virtual, lines, until_ms)


def _shown_sensors(program: ir.Program) -> dict[int, int | None]:
    """Return where each SHOW begins, and the sensor that it shows, if it is one alone."""
    found: dict[int, int | None] = {}
    for statement in ir.every(program):
        if isinstance(statement, ir.Show):
            is_one = len(statement.value) == 1 and statement.value[0].op == "SENSOR"
            found[statement.span.start] = statement.value[0].value if is_one else None
    return found


def _number(event: str) -> int:
    """Return what a SHOW event says, as a reading."""
    said = event.removeprefix("SHOW ")
    return int(said == "TRUE") if said in ("TRUE", "FALSE") else round(float(said) * ONE)


def _off_ms(ms: int) -> int:
    return LEAST_OFF_MS + round(ms * OFF)


def _compared(
    recorded: tuple[Recorded, ...], virtual: list[Recorded], lines: list[int], until_ms: int
) -> Parting:
    for count, ours in enumerate(recorded):
        line = lines[count] if count < len(lines) else 0
        theirs = virtual[count] if count < len(virtual) else None
        if theirs is None:
            if ours.event == "STOPPED":
                break  # a person has done that
            return Parting("robot_more", count, line, ours)
        if ours.event == "STOPPED":
            break
        if ours.event != theirs.event:
            return Parting("value", count, line, ours, theirs)
        if abs(ours.ms - theirs.ms) > _off_ms(max(ours.ms, theirs.ms)):
            return Parting("time", count, line, ours, theirs)
    else:
        if len(virtual) > len(recorded) and virtual[len(recorded)].ms <= until_ms:
            count = len(recorded)
            line = lines[count] if count < len(lines) else 0
            return Parting("virtual_more", count, line, None, virtual[count])
    return Parting("same", len(recorded))
