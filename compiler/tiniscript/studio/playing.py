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
    CUT_EVENTS,
    HALT,
    HELD,
    MAX_MS,
    UNREAD,
    BadRecording,
    Recording,
    Row,
)
from tiniscript.studio.simulation import Marks, Simulation
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import Settings
from tiniscript.virtual.world import World

MIN_TOLERANCE_MS, TOLERANCE = 250, 0.05  # tolerance in ms, and as a share of the time
STEP_MS = 100
NO_SENSOR = -1
EARLY_MS = 10  # half of the time between two checks: no clock is more exact
BEGINNING_MS = 1000  # limit for a program to begin after its button
_WORD = re.compile(r"\w+")
PROGRAM_EVENTS = ("SHOW", "DONE", "FAULT")  # program events that a real robot reports too


class Divergence(NamedTuple):
    """The place where a recording and the virtual robot diverge.

    `outcome` is again (a virtual robot has done all of it again), otherwise (not), same, missed
    (the same until values did not arrive), unread (the same until the program read what the
    recording does not have), empty (nothing to compare), value, time, robot_more or virtual_more;
    `line` is that of the program, or 0, and `robot` and `virtual` are the rows there. `agreed` rows
    were the same; `sensor` was read. `at_ms` is the time there, since the virtual robot was
    switched on.
    """

    outcome: str
    agreed: int = 0
    line: int = 0
    robot: Row | None = None
    virtual: Row | None = None
    sensor: str = ""
    at_ms: int | None = None


SAME_OUTCOMES = ("again", "same", "missed", "unread")


class PlayableRecording(NamedTuple):
    """A recording whose program was compiled again, to the same image."""

    recording: Recording
    image: bytes
    program_map: SourceMap
    sensor_of_show: dict[int, int | None]  # the sensor that each SHOW alone shows, by its offset
    read_offsets: tuple[int, ...]  # the offsets of code that names a sensor
    robot: Robot


def prepare(recording: Recording) -> PlayableRecording:
    """Raises BadRecording if the program is another one for this version of tsc."""
    profile = load(recording.robot)
    data = recording.text.encode("utf-8", "replace")
    compilation: Compilation = compile_source(data, profile, "", is_strict=True, is_chosen=True)
    compilation = fit_to_robot(compilation, profile)
    if (
        compilation.program is None
        or not compilation.image
        or checksum(compilation.image) != recording.program
    ):
        raise BadRecording("other_program")
    shown_sensors = _shown_sensors(compilation.program)
    program_map = map_of_compiled(compilation)
    sensor_of_show = {
        place.offset: shown_sensors[code_location.span.start]
        for code_location, place in zip(compilation.locations, program_map.locations, strict=True)
        if code_location.span.start in shown_sensors
    }
    names = {device.name for device in profile.kit.readings}
    lines = compilation.source.text.split("\n")
    read_offsets = tuple(
        location.offset for location in program_map.locations if names & _words(lines, location)
    )
    return PlayableRecording(
        recording, compilation.image, program_map, sensor_of_show, read_offsets, profile
    )


def _words(lines: list[str], location: MapLocation) -> set[str]:
    """Return the words of a part of the text, in capitals."""
    part = "\n".join(lines[location.line - 1 : location.end_line])
    end = len(part) - len(lines[location.end_line - 1]) + location.end_column - 1
    return set(_WORD.findall(part[location.column - 1 : end].upper()))


class PlayedRun(Simulation):
    """The run of a recording, in `world` if it is a real robot's. It ends where the recording does.

    A program that waits for its button has it pushed. Raises WorldRefused.
    """

    def __init__(
        self, playable: PlayableRecording, world: World | None = None, marks: Marks | None = None
    ) -> None:
        recording = playable.recording
        self.playable, self.recording = playable, recording
        self.divergence: Divergence | None = None
        self._next_input = 0  # index of the next input row
        self._inputs = recording.rows
        if not recording.is_virtual:
            self._inputs = tuple(row for row in recording.rows if row.is_reading)
        self._is_over = False
        self._held_at_end = False
        self._virtual_rows: list[Row] = []
        # The line of each row that the virtual robot has reported.
        self._virtual_lines: list[int] = []
        readings = recording.given_readings if recording.is_virtual else self._first_readings()
        self._known_sensors = set(readings)  # sensors whose readings the recording has
        self._incomplete_sensors = set[int]()  # sensors with gaps in the recording
        self._shown_sensor: int | None = None  # the reading reported by the SHOW that begins
        self._first_unread: tuple[str, Row, int] | None = None
        self._recorded_rows = self._compared_rows()
        self._compared_count = 0
        # Offset of the program's place, if it names a sensor.
        self._program_offset: int | None = None
        played_world = recording.world or world or worlds.load(worlds.DEFAULT)
        settings = Settings(seed=recording.seed, given_readings=readings)
        marks = (marks or Marks(()))._replace(is_held=False, breakpoints=())
        if not recording.is_virtual:
            marks = marks._replace(breakpoints=(*playable.sensor_of_show, *playable.read_offsets))
        super().__init__(recording.robot, played_world, playable.image, marks, settings)
        if not recording.is_virtual and recording.was_started_by_button:
            self._push_button()

    # -- its time ---------------------------------------------------------------------------------

    @property
    def is_over(self) -> bool:
        return self._is_over

    def advance(self, duration_ms: int) -> None:
        """Advance time, at most to the end of the recording."""
        if self.recording.is_virtual:
            self._advance_again(duration_ms)
        else:
            self._advance_beside(duration_ms)

    def step(self, limit_ms: int) -> None:
        self.advance(STEP_MS)

    def press(self, keys: int, x: int, y: int) -> None:
        """Ignore keys, because only the recorded person presses them."""

    def push(self) -> None:
        """It does not push a button either."""

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
        """Return the visible state, including whether the run is over and where it diverges."""
        divergence = None
        if self.divergence is not None:
            recorded_row, virtual_row = (
                row and row._asdict() for row in (self.divergence.robot, self.divergence.virtual)
            )
            started_ms = (self.robot.started_ms or 0) if self.recording.is_virtual else 0
            rows = {"robot": recorded_row, "virtual": virtual_row, "began_ms": started_ms}
            divergence = {**self.divergence._asdict(), **rows}
        state = {**super().state(), "is_held": False}  # only this class can pause the run
        return {**state, "is_over": self._is_over, "parting": divergence}

    # -- a virtual robot's run, again -------------------------------------------------------------

    def _advance_again(self, duration_ms: int) -> None:
        for _ in range(duration_ms):
            if self._is_over:
                return
            super()._advance(1)
            # the recording may have ended within a millisecond, where its program was held
            is_whole = self._held_at_end or self.robot.now_ms > self.recording.end_ms
            self._compare(is_whole)
            if is_whole:
                return self._end()

    def _apply_inputs(self) -> None:
        while self._next_input < len(self._inputs) and self._is_due(self._inputs[self._next_input]):
            row = self._inputs[self._next_input]
            self._next_input += 1
            if not self.recording.is_virtual:
                self._learn_readings(row)
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
        if self.divergence is not None:
            return
        made_rows = self._rows.rows
        recorded_rows = self._recorded_rows
        while self._compared_count < len(made_rows):
            row, k = made_rows[self._compared_count], self._compared_count
            if k >= len(recorded_rows):
                if row.ms < self._last_ms:
                    return self._diverge("otherwise", k, None, row)
                break
            if recorded_rows[k] != row:
                return self._diverge("otherwise", k, recorded_rows[k], row)
            self._compared_count += 1
        if is_whole and self._compared_count < len(recorded_rows):
            self._diverge(
                "otherwise", self._compared_count, recorded_rows[self._compared_count], None
            )
        elif is_whole:
            self.divergence = Divergence("again", len(recorded_rows))

    def _compared_rows(self) -> tuple[Row, ...]:
        """Return the robot's actions until its program was held and stopped, or to the end."""
        rows = self.recording.rows
        count = next((k for k, row in enumerate(rows) if row.event == HELD), len(rows))
        self._last_ms = rows[count].ms if count < len(rows) else self.recording.end_ms
        return tuple(row for row in rows[:count] if not row.is_input)

    def _diverge(
        self, outcome: str, agreed: int, recorded_row: Row | None, virtual_row: Row | None
    ) -> None:
        at_ms = min(row.ms for row in (recorded_row, virtual_row) if row is not None)
        offset = (
            virtual_row.offset
            if virtual_row is not None and virtual_row.offset >= 0
            else self.robot.offset
        )
        location = self.playable.program_map.location_at(offset) if offset is not None else None
        line = location.line if location is not None else 0
        self.divergence = Divergence(outcome, agreed, line, recorded_row, virtual_row, "", at_ms)

    # -- a real robot's run, beside it ------------------------------------------------------------

    def _advance_beside(self, duration_ms: int) -> None:
        for _ in range(duration_ms):
            if self._is_over:
                return
            self._replace_readings()
            super()._advance(1)
            self._replace_readings()
            started_ms = self.robot.started_ms or 0
            is_late = self.robot.now_ms - started_ms >= self._until_ms()
            has_more = len(self._virtual_rows) > len(self.recording.rows)
            has_ended = self.robot.started_ms is not None and not self.robot.is_running
            if is_late or has_more or has_ended:
                if self.divergence is None:
                    self.divergence = self._compare_runs()
                return self._end()

    def _replace_readings(self) -> None:
        """Set each shown sensor at its SHOW to the value that the robot showed."""
        self._read_events()
        while self.held_at is not None:
            self._program_offset = self.held_at
            if self._program_offset in self.playable.sensor_of_show:
                self._tell_shown(self._program_offset)
            self.go_on()
            self._read_events()

    def _tell_shown(self, offset: int) -> None:
        sensor = self.playable.sensor_of_show[offset]
        location = self.playable.program_map.location_at(offset)
        recorded_events = [row.event for row in self.recording.rows if _is_program_event(row)]
        event = (
            recorded_events[len(self._virtual_lines)]
            if len(self._virtual_lines) < len(recorded_events)
            else ""
        )
        if sensor is not None and event.startswith("SHOW"):
            self.robot.sensing.set_reading(sensor, _reading_value(event.removeprefix("SHOW ")))
            self._shown_sensor = sensor
            if sensor not in self._incomplete_sensors:
                self._known_sensors.add(sensor)
        self._virtual_lines.append(location.line if location is not None else 0)

    def _first_readings(self) -> dict[int, list[int]]:
        """Return the first reading of each sensor, whenever it occurs."""
        readings: dict[int, list[int]] = {}
        incomplete_sensors = set[int]()
        for row in self._inputs:
            kind, number, value = self._reading(row)
            if kind == UNREAD:
                incomplete_sensors.add(number)
            elif number not in incomplete_sensors:
                readings.setdefault(number, [value])
        readings.pop(NO_SENSOR, None)
        return readings

    def _reading(self, row: Row) -> tuple[str, int, int]:
        """Return the parts of the row of a reading; its sensor may be NO_SENSOR."""
        kind, name, *value = row.event.split(" ")
        readings = self.playable.robot.kit.readings
        number = next((k for k, device in enumerate(readings) if device.name == name), NO_SENSOR)
        if not value or number == NO_SENSOR:
            return kind, number, 0
        return (
            kind,
            number,
            max(readings[number].low, min(readings[number].high, _reading_value(value[0]))),
        )

    def _learn_readings(self, row: Row) -> None:
        """Give the virtual sensors the robot's reported readings."""
        kind, number, value = self._reading(row)
        if kind == UNREAD:
            self._incomplete_sensors.add(number)
            self._known_sensors.discard(number)
        elif number != NO_SENSOR:
            self.robot.sensing.set_reading(number, value)
            if number not in self._incomplete_sensors:
                self._known_sensors.add(number)

    def _read_events(self) -> None:
        started_ms = self.robot.started_ms or 0
        for event in self.take_events():
            is_read = event.kind == "READ"
            is_shown = is_read and event.values[0] == self._shown_sensor
            if is_shown:
                self._shown_sensor = None
            is_unread = is_read and not is_shown and event.values[0] not in self._known_sensors
            if is_unread and not self._first_unread:
                name = self.robot.profile.kit.readings[event.values[0]].name
                location = (
                    self.playable.program_map.location_at(self._program_offset)
                    if self._program_offset is not None
                    else None
                )
                row = Row(event.time_ms - started_ms, event.text)
                self._first_unread = (name, row, location.line if location is not None else 0)
                self._virtual_rows.append(row)
            elif event.kind in PROGRAM_EVENTS:
                self._virtual_rows.append(Row(event.time_ms - started_ms, event.text))

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
        """Return the time that the virtual robot runs to be compared with the whole recording.

        If it was started by the button, wait for its first row, whose time is not in the recording.
        """
        recording = self.recording
        recorded_rows = [row for row in recording.rows if _is_program_event(row)]
        if not recording.was_started_by_button or not recorded_rows:
            return recording.end_ms + _tolerance_ms(recording.end_ms)
        virtual_rows = [row for row in self._virtual_rows if _is_program_event(row)]
        if not virtual_rows:
            return MAX_MS
        late_ms = virtual_rows[0].ms - recorded_rows[0].ms
        return recording.end_ms + late_ms + _tolerance_ms(recording.end_ms + late_ms)

    def _compare_runs(self) -> Divergence:
        rows = self.recording.rows
        recorded_rows = [row for row in rows if _is_program_event(row)]
        virtual_rows = [row for row in self._virtual_rows if _is_program_event(row)]
        if not rows or rows[0].event == "LOST":
            return Divergence("empty")
        late_ms = 0
        if self.recording.was_started_by_button and recorded_rows and virtual_rows:
            late_ms = virtual_rows[0].ms - recorded_rows[0].ms
        recorded_rows = [row._replace(ms=row.ms + late_ms) for row in recorded_rows]
        end_ms = self.recording.end_ms + late_ms
        started_ms = self.robot.started_ms or 0
        known_count = len(
            virtual_rows
        )  # rows of the virtual robot before its first unknown reading
        if self._first_unread is not None:
            known_count = self._virtual_rows.index(self._first_unread[1])
        for count, recorded_row in enumerate(recorded_rows):
            line = self._virtual_lines[count] if count < len(self._virtual_lines) else 0
            virtual_row = virtual_rows[count] if count < len(virtual_rows) else None
            if self._first_unread is not None and count >= known_count:
                return self._unread_parting(count, started_ms)
            if virtual_row is None:
                return Divergence(
                    "robot_more", count, line, recorded_row, None, "", recorded_row.ms + started_ms
                )
            if recorded_row.event != virtual_row.event:
                return Divergence(
                    "value", count, line, recorded_row, virtual_row, "", virtual_row.ms + started_ms
                )
            if abs(recorded_row.ms - virtual_row.ms) > _tolerance_ms(
                max(recorded_row.ms, virtual_row.ms)
            ):
                return Divergence(
                    "time", count, line, recorded_row, virtual_row, "", virtual_row.ms + started_ms
                )
        count = len(recorded_rows)
        cut_event = rows[-1].event if rows[-1].event in CUT_EVENTS else ""
        if self._first_unread is not None:
            return self._unread_parting(count, started_ms)
        if cut_event in ("", "STOPPED") and len(virtual_rows) > count:
            virtual_row = virtual_rows[count]  # the robot did not report that, and had time to
            if virtual_row.ms + _tolerance_ms(end_ms) < end_ms:
                line = self._virtual_lines[count] if count < len(self._virtual_lines) else 0
                return Divergence(
                    "virtual_more", count, line, None, virtual_row, "", virtual_row.ms + started_ms
                )
        return Divergence("missed" if cut_event == "MISSED" else "same", count)

    def _unread_parting(self, agreed: int, started_ms: int) -> Divergence:
        assert self._first_unread is not None
        name, row, line = self._first_unread
        return Divergence("unread", agreed, line, None, row, name, row.ms + started_ms)


def play(playable: PlayableRecording, world: World | None = None) -> PlayedRun:
    """Return the run, when it is over. Raises WorldRefused."""
    run = PlayedRun(playable, world)
    while not run.is_over:
        run.advance(STEP_MS)
    return run


def _is_program_event(row: Row) -> bool:
    """Return whether robots report this event of a program, real or virtual."""
    return row.event.partition(" ")[0] in PROGRAM_EVENTS


def _shown_sensors(program: ir.Program) -> dict[int, int | None]:
    """Return the offset of each SHOW, and the sensor it shows, if it shows a single one."""
    shown_sensors: dict[int, int | None] = {}
    for statement in ir.all_statements(program):
        if isinstance(statement, ir.Show):
            is_one = len(statement.value) == 1 and statement.value[0].op == "SENSOR"
            shown_sensors[statement.span.start] = statement.value[0].value if is_one else None
    return shown_sensors


def _reading_value(text: str) -> int:
    """Return the reading in a row."""
    return int(text == "TRUE") if text in ("TRUE", "FALSE") else round(float(text) * ONE)


def _tolerance_ms(ms: int) -> int:
    return MIN_TOLERANCE_MS + round(ms * TOLERANCE)
