"""Plays a recorded run on the virtual robot, and finds where the two part.

A virtual robot's run is the same again, to the millisecond. A real robot's is compared with what
the virtual one does with the same readings, as far as these are known. Knows no clock and no page.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from tiniscript.base.fixed_point import ONE
from tiniscript.bytecode.image import checksum
from tiniscript.library.compiling import Compilation, compile_source, fit_to_robot
from tiniscript.library.source_map import MapLocation, SourceMap, map_of_compiled
from tiniscript.robots import load
from tiniscript.robots.profile import Robot
from tiniscript.semantics import ir
from tiniscript.studio.recordings import (
    CUT,
    HALT,
    HELD,
    MOST_MS,
    UNREAD,
    BadRecording,
    Recording,
    Row,
)
from tiniscript.studio.simulation import Marks, Simulation
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import Settings
from tiniscript.virtual.world import World

LEAST_OFF_MS, OFF = 250, 0.05  # how much later or earlier is the same time
STEP_MS = 100
NO_SENSOR = -1
EARLY_MS = 10  # half of the time between two checks: no clock is more exact
BEGINNING_MS = 1000  # limit for a program to begin after its button
_WORD = re.compile(r"\w+")
TOLD = ("SHOW", "DONE", "FAULT")  # what a real robot says of its program, too


class Parting(NamedTuple):
    """Where a recording and the virtual robot part.

    `what` is again (a virtual robot has done all of it again), otherwise (not), same, missed (the
    same until values did not arrive), unread (the same until the program read what the recording
    does not have), empty (nothing to compare), value, time, robot_more or virtual_more; `line` is
    that of the program, or 0, and `robot` and `virtual` are the rows there. `agreed` rows were the
    same; `sensor` was read. `at_ms` is the time there, since the virtual robot was switched on.
    """

    what: str
    agreed: int = 0
    line: int = 0
    robot: Row | None = None
    virtual: Row | None = None
    sensor: str = ""
    at_ms: int | None = None


SAME = ("again", "same", "missed", "unread")


class Ready(NamedTuple):
    """A recording whose program was compiled again, to the same image."""

    recording: Recording
    image: bytes
    places: SourceMap
    shows: dict[int, int | None]  # the sensor that each SHOW alone shows, by its offset
    reads: tuple[int, ...]  # the offsets of what names a sensor
    robot: Robot


def ready(recording: Recording) -> Ready:
    """Raises BadRecording where the program is another one for this version of tsc."""
    profile = load(recording.robot)
    data = recording.text.encode("utf-8", "replace")
    compiled: Compilation = compile_source(data, profile, "", is_strict=True, is_chosen=True)
    compiled = fit_to_robot(compiled, profile)
    if (
        compiled.program is None
        or not compiled.image
        or checksum(compiled.image) != recording.program
    ):
        raise BadRecording("other_program")
    sensors = _shown_sensors(compiled.program)
    places = map_of_compiled(compiled)
    shows = {place.offset: sensors[part.span.start] for part, place in
             zip(compiled.locations, places.locations, strict=True)
             if part.span.start in sensors}  # fmt: skip
    names = {device.name for device in profile.kit.readings}
    lines = compiled.source.text.split("\n")
    reads = tuple(item.offset for item in places.locations if names & _words(lines, item))
    return Ready(recording, compiled.image, places, shows, reads, profile)


def _words(lines: list[str], place: MapLocation) -> set[str]:
    """Return the words of a part of the text, in capitals."""
    part = "\n".join(lines[place.line - 1 : place.end_line])
    end = len(part) - len(lines[place.end_line - 1]) + place.end_column - 1
    return set(_WORD.findall(part[place.column - 1 : end].upper()))


class PlayedRun(Simulation):
    """The run of a recording, in `world` if it is a real robot's. It ends where the recording does.

    A program that waits for its button has it pushed. Raises WorldRefused.
    """

    def __init__(
        self, ready: Ready, world: World | None = None, marks: Marks | None = None
    ) -> None:
        recording = ready.recording
        self.ready, self.recording = ready, recording
        self.parting: Parting | None = None
        self._next = 0  # of the rows that change what it does
        self._inputs = recording.rows
        if not recording.is_virtual:
            self._inputs = tuple(row for row in recording.rows if row.is_reading)
        self._is_over = False
        self._held_at_end = False
        self._virtual: list[Row] = []
        self._places: list[int] = []  # the line of each row that the virtual robot has told
        told = recording.told if recording.is_virtual else self._first_readings()
        self._known = set(told)  # sensors whose readings the recording has
        self._lost = set[int]()  # those of which the recording lacks some
        self._shown: int | None = None  # the one whose reading the SHOW that begins has told
        self._unread: tuple[str, Row, int] | None = None
        self._recorded = self._compared_rows()
        self._seen = 0
        self._at: int | None = None  # what the program does, as far as it names a sensor
        where = recording.world or world or worlds.load(worlds.DEFAULT)
        settings = Settings(seed=recording.seed, given_readings=told)
        marks = (marks or Marks(()))._replace(is_held=False, breakpoints=())
        if not recording.is_virtual:
            marks = marks._replace(breakpoints=(*ready.shows, *ready.reads))
        super().__init__(recording.robot, where, ready.image, marks, settings)
        if not recording.is_virtual and recording.is_by_button:
            self._push_button()

    # -- its time ---------------------------------------------------------------------------------

    @property
    def is_over(self) -> bool:
        return self._is_over

    def go(self, duration_ms: int) -> None:
        """Let time go on, to the end of the recording at most."""
        if self.recording.is_virtual:
            self._go_again(duration_ms)
        else:
            self._go_beside(duration_ms)

    def step(self, limit_ms: int) -> None:
        self.go(STEP_MS)

    def press(self, keys: int, x: int, y: int) -> None:
        """Nobody but who is recorded holds anything."""

    def push(self) -> None:
        """Nor pushes a button."""

    def set_breakpoints(self, breakpoints: object) -> None:
        """A recorded run is looked at on its time line."""

    def stop(self) -> None:
        self._end()

    def _end(self) -> None:
        if not self._is_over:
            self._is_over = True
            self._take_rows()
            self.robot.rest()

    def state(self) -> dict[str, Any]:
        """Return what is to be seen, too: whether it is over, and where the two part."""
        parting = None
        if self.parting is not None:
            recorded_row, virtual_row = (
                row and row._asdict() for row in (self.parting.robot, self.parting.virtual)
            )
            started_ms = (self.robot.started_ms or 0) if self.recording.is_virtual else 0
            told = {"robot": recorded_row, "virtual": virtual_row, "began_ms": started_ms}
            parting = {**self.parting._asdict(), **told}
        whole = {**super().state(), "is_held": False}  # nobody but this class holds it
        return {**whole, "is_over": self._is_over, "parting": parting}

    # -- a virtual robot's run, again -------------------------------------------------------------

    def _go_again(self, duration_ms: int) -> None:
        for _ in range(duration_ms):
            if self._is_over:
                return
            super()._advance(1)
            # the recording may have ended within a millisecond, where its program was held
            is_whole = self._held_at_end or self.robot.now_ms > self.recording.end_ms
            self._compare(is_whole)
            if is_whole:
                return self._end()

    def _let_in(self) -> None:
        while self._next < len(self._inputs) and self._is_due(self._inputs[self._next]):
            row = self._inputs[self._next]
            self._next += 1
            if not self.recording.is_virtual:
                self._learn(row)
            elif row.event == HALT:
                self.session.stop(self.robot.now_ms)
            elif row.event == HELD:
                self._held_at_end = True
            elif row.is_input:
                self._replay_event(row.event)

    def _is_due(self, row: Row) -> bool:
        if self.recording.is_virtual:
            return row.ms <= self.robot.now_ms
        due_ms = row.ms if row.event.startswith(UNREAD) else row.ms - EARLY_MS
        started_ms = self.robot.started_ms
        return started_ms is not None and due_ms + started_ms <= self.robot.now_ms

    def _compare(self, is_whole: bool) -> None:
        """Find the first row that is another one than in the recording."""
        self._take_rows()
        if self.parting is not None:
            return
        made_rows = self._rows.rows
        recorded = self._recorded
        while self._seen < len(made_rows):
            row, k = made_rows[self._seen], self._seen
            if k >= len(recorded):
                if row.ms < self._last_ms:
                    return self._part("otherwise", k, None, row)
                break
            if recorded[k] != row:
                return self._part("otherwise", k, recorded[k], row)
            self._seen += 1
        if is_whole and self._seen < len(recorded):
            self._part("otherwise", self._seen, recorded[self._seen], None)
        elif is_whole:
            self.parting = Parting("again", len(recorded))

    def _compared_rows(self) -> tuple[Row, ...]:
        """Return what the robot did up to where its program was held and stopped, or to the end."""
        rows = self.recording.rows
        count = next((k for k, row in enumerate(rows) if row.event == HELD), len(rows))
        self._last_ms = rows[count].ms if count < len(rows) else self.recording.end_ms
        return tuple(row for row in rows[:count] if not row.is_input)

    def _part(
        self, what: str, agreed: int, recorded_row: Row | None, virtual_row: Row | None
    ) -> None:
        at_ms = min(row.ms for row in (recorded_row, virtual_row) if row is not None)
        at = (
            virtual_row.at if virtual_row is not None and virtual_row.at >= 0 else self.robot.offset
        )
        place = self.ready.places.location_at(at) if at is not None else None
        line = place.line if place is not None else 0
        self.parting = Parting(what, agreed, line, recorded_row, virtual_row, "", at_ms)

    # -- a real robot's run, beside it ------------------------------------------------------------

    def _go_beside(self, duration_ms: int) -> None:
        for _ in range(duration_ms):
            if self._is_over:
                return
            self._replace_readings()
            super()._advance(1)
            self._replace_readings()
            started_ms = self.robot.started_ms or 0
            is_late = self.robot.now_ms - started_ms >= self._until_ms()
            has_more = len(self._virtual) > len(self.recording.rows)
            has_ended = self.robot.started_ms is not None and not self.robot.is_running
            if is_late or has_more or has_ended:
                if self.parting is None:
                    self.parting = self._compare_runs()
                return self._end()

    def _replace_readings(self) -> None:
        """At each SHOW the sensor that it shows has the reading that the robot has shown."""
        self._listen()
        while self.held_at is not None:
            self._at = self.held_at
            if self._at in self.ready.shows:
                self._tell_shown(self._at)
            self.go_on()
            self._listen()

    def _tell_shown(self, at: int) -> None:
        sensor, place = self.ready.shows[at], self.ready.places.location_at(at)
        texts = [row.event for row in self.recording.rows if _is_told(row)]
        message = texts[len(self._places)] if len(self._places) < len(texts) else ""
        if sensor is not None and message.startswith("SHOW"):
            self.robot.sensing.set_reading(sensor, _number(message.removeprefix("SHOW ")))
            self._shown = sensor
            if sensor not in self._lost:
                self._known.add(sensor)
        self._places.append(place.line if place is not None else 0)

    def _first_readings(self) -> dict[int, list[int]]:
        """Return what each sensor reads first, whenever that is."""
        found: dict[int, list[int]] = {}
        lost = set[int]()
        for row in self._inputs:
            what, number, value = self._reading(row)
            if what == UNREAD:
                lost.add(number)
            elif number not in lost:
                found.setdefault(number, [value])
        found.pop(NO_SENSOR, None)
        return found

    def _reading(self, row: Row) -> tuple[str, int, int]:
        """Return the parts of the row of a reading; its sensor may be NO_SENSOR."""
        what, name, *value = row.event.split(" ")
        readings = self.ready.robot.kit.readings
        number = next((k for k, each in enumerate(readings) if each.name == name), NO_SENSOR)
        if not value or number == NO_SENSOR:
            return what, number, 0
        return (
            what,
            number,
            max(readings[number].low, min(readings[number].high, _number(value[0]))),
        )

    def _learn(self, row: Row) -> None:
        """The virtual sensors have the readings that the robot has told."""
        what, number, value = self._reading(row)
        if what == UNREAD:
            self._lost.add(number)
            self._known.discard(number)
        elif number != NO_SENSOR:
            self.robot.sensing.set_reading(number, value)
            if number not in self._lost:
                self._known.add(number)

    def _listen(self) -> None:
        started_ms = self.robot.started_ms or 0
        for event in self.take_events():
            is_read = event.kind == "READ"
            is_shown = is_read and event.values[0] == self._shown
            if is_shown:
                self._shown = None
            is_unread = is_read and not is_shown and event.values[0] not in self._known
            if is_unread and not self._unread:
                name = self.robot.profile.kit.readings[event.values[0]].name
                place = self.ready.places.location_at(self._at) if self._at is not None else None
                row = Row(event.time_ms - started_ms, event.text)
                self._unread = (name, row, place.line if place is not None else 0)
                self._virtual.append(row)
            elif event.kind in TOLD:
                self._virtual.append(Row(event.time_ms - started_ms, event.text))

    def _push_button(self) -> None:
        """Push the start button, and wait until the program has begun."""
        self.robot.press()
        for k in range(BEGINNING_MS):
            if k == STEP_MS:
                self.robot.let_go()
            if self.robot.started_ms is not None and k >= STEP_MS:
                return
            super()._advance(1)
        raise AssertionError("the program does not begin")

    def _until_ms(self) -> int:
        """Return how long the virtual robot runs to be compared with the whole recording.

        By its button its first row is waited for, whose time the recording does not have.
        """
        recording = self.recording
        messages = [row for row in recording.rows if _is_told(row)]
        if not recording.is_by_button or not messages:
            return recording.end_ms + _off_ms(recording.end_ms)
        texts = [row for row in self._virtual if _is_told(row)]
        if not texts:
            return MOST_MS
        late_ms = texts[0].ms - messages[0].ms
        return recording.end_ms + late_ms + _off_ms(recording.end_ms + late_ms)

    def _compare_runs(self) -> Parting:
        rows = self.recording.rows
        messages = [row for row in rows if _is_told(row)]
        virtual = [row for row in self._virtual if _is_told(row)]
        if not rows or rows[0].event == "LOST":
            return Parting("empty")
        late_ms = 0
        if self.recording.is_by_button and messages and virtual:
            late_ms = virtual[0].ms - messages[0].ms
        messages = [row._replace(ms=row.ms + late_ms) for row in messages]
        end_ms = self.recording.end_ms + late_ms
        started_ms = self.robot.started_ms or 0
        before = len(virtual)  # rows of the virtual robot before it read what nobody knows
        if self._unread is not None:
            before = self._virtual.index(self._unread[1])
        for count, recorded_row in enumerate(messages):
            line = self._places[count] if count < len(self._places) else 0
            virtual_row = virtual[count] if count < len(virtual) else None
            if self._unread is not None and count >= before:
                return self._unread_parting(count, started_ms)
            if virtual_row is None:
                return Parting(
                    "robot_more", count, line, recorded_row, None, "", recorded_row.ms + started_ms
                )
            if recorded_row.event != virtual_row.event:
                return Parting(
                    "value", count, line, recorded_row, virtual_row, "", virtual_row.ms + started_ms
                )
            if abs(recorded_row.ms - virtual_row.ms) > _off_ms(
                max(recorded_row.ms, virtual_row.ms)
            ):
                return Parting(
                    "time", count, line, recorded_row, virtual_row, "", virtual_row.ms + started_ms
                )
        count = len(messages)
        cut = rows[-1].event if rows[-1].event in CUT else ""
        if self._unread is not None:
            return self._unread_parting(count, started_ms)
        if cut in ("", "STOPPED") and len(virtual) > count:
            virtual_row = virtual[count]  # the robot has not said that, and had the time for it
            if virtual_row.ms + _off_ms(end_ms) < end_ms:
                line = self._places[count] if count < len(self._places) else 0
                return Parting(
                    "virtual_more", count, line, None, virtual_row, "", virtual_row.ms + started_ms
                )
        return Parting("missed" if cut == "MISSED" else "same", count)

    def _unread_parting(self, agreed: int, started_ms: int) -> Parting:
        assert self._unread is not None
        name, row, line = self._unread
        return Parting("unread", agreed, line, None, row, name, row.ms + started_ms)


def play(ready: Ready, world: World | None = None) -> PlayedRun:
    """Return the run, when it is over. Raises WorldRefused."""
    played = PlayedRun(ready, world)
    while not played.is_over:
        played.go(STEP_MS)
    return played


def _is_told(row: Row) -> bool:
    """Whether a robot says that of its program, real or virtual."""
    return row.event.partition(" ")[0] in TOLD


def _shown_sensors(program: ir.Program) -> dict[int, int | None]:
    """Return where each SHOW begins, and the sensor that it shows, if it is one alone."""
    shown_sensors: dict[int, int | None] = {}
    for statement in ir.all_statements(program):
        if isinstance(statement, ir.Show):
            is_one = len(statement.value) == 1 and statement.value[0].op == "SENSOR"
            shown_sensors[statement.span.start] = statement.value[0].value if is_one else None
    return shown_sensors


def _number(said: str) -> int:
    """Return what a row says, as a reading."""
    return int(said == "TRUE") if said in ("TRUE", "FALSE") else round(float(said) * ONE)


def _off_ms(ms: int) -> int:
    return LEAST_OFF_MS + round(ms * OFF)
