"""The file of a run, `.tsr`: all that the virtual robot needs to do it again, and what happened.

docs/develop/runs.md has the form. `read` checks the whole file, so every result can be played.
Knows no clock and no page.
"""

from __future__ import annotations

import json
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from tiniscript import robots
from tiniscript.base.kit import Kit
from tiniscript.base.version import __version__
from tiniscript.link.messages import AFTER_GAP
from tiniscript.link.payloads import ReadingEvent
from tiniscript.link.remote import RemoteState
from tiniscript.robots.profile import ProfileRefused, Robot
from tiniscript.studio.world_form import Form, form_of, toml_of
from tiniscript.virtual import worlds
from tiniscript.virtual.world import World

HEADER_KEY = "tiniscript_run"
# Key in the header of version 0.3.0 and earlier, without a program.
OLD_HEADER_KEY = "tiniscript_recording"
VERSION = 1
MAX_BYTES = 1_000_000
MAX_ROW_BYTES = 600_000  # most bytes of rows, after which the recording ends
MAX_MS = 600_000
MAX_TEXT = 200_000  # bytes of a program
MAX_READINGS = 10_000
MS_MODULUS = 1 << 16  # modulus of the time in a robot's readings

VIRTUAL, REAL = "virtual", "real"
# Actions of people: all others are the robot's. HALT is a stop over the link, or during a pause.
KEYS, DOWN, UP, HALT, HELD = "KEYS", "BUTTON DOWN", "BUTTON UP", "HALT", "HALT HELD"
READ, UNREAD = "READ", "UNREAD"  # a reading, and that some of its sensor are missing from then on
END = "END"  # the recording reaches as far as this row, the last one
CUT_EVENTS = (
    "STOPPED",
    "LOST",
    "MISSED",
)  # the end of a real robot's recording, not of its program
_EVENT = re.compile(r"[A-Z_]{1,20}(?: [A-Za-z0-9_.\-]{1,60}){0,2}")
_KEYS = re.compile(r"KEYS (\d{1,3}) (-?\d{1,3}) (-?\d{1,3})")
_REAL = re.compile(
    r"SHOW (?:TRUE|FALSE|-?\d{1,7}(?:\.\d{1,3})?)|READ [A-Z0-9_]{1,40} (?:TRUE|FALSE|-?\d{1,7}"
    r"(?:\.\d{1,3})?)|UNREAD [A-Z0-9_]{1,40}|DONE|STOPPED|LOST|MISSED|FAULT [A-Z_0-9]{1,40}"
)
_PROGRAM = re.compile(r"[0-9a-f]{8}")
_KIT = re.compile(r"[0-9a-f]{4}")
_VERSION = re.compile(r"[0-9a-z.+]{1,20}")


class BadRecording(Exception):
    """`reason` is unreadable, cut, older, other_version, too_long or other_robot; `line` where that
    is, from 1."""

    def __init__(self, reason: str, line: int = 1) -> None:
        super().__init__(reason)
        self.reason = reason
        self.line = line


class Row(NamedTuple):
    """An event at `ms`; `offset` is the place of a SHOW in the code, if known."""

    ms: int
    event: str
    offset: int = -1

    @property
    def is_input(self) -> bool:
        """Return whether a person caused this event of a virtual robot."""
        return self.event in (DOWN, UP, HALT, HELD) or self.event.startswith("KEYS ")

    @property
    def is_reading(self) -> bool:
        return self.event.startswith((f"{READ} ", f"{UNREAD} "))

    @property
    def cells(self) -> list[Any]:
        """Return the cells in the file."""
        return [*self] if self.offset >= 0 else [*self[:2]]

    @property
    def remote_state(self) -> RemoteState | None:
        """The keys held from then on, if the row contains them."""
        match = _KEYS.fullmatch(self.event)
        return RemoteState(*map(int, match.groups())) if match else None


class Recording(NamedTuple):
    """A run of the program `text` on `robot`, whose `robot_kind` is VIRTUAL or REAL.

    Of a virtual robot `ms` count from when it is switched on, in `world` with `seed` and
    `given_readings` in thousandths, by sensor number; of a real one from when its program began,
    and where that `was_started_by_button`, from its first row. `rows` are in their order, without
    END, which was at `end_ms`; `version` is that of the tsc which recorded it.
    """

    robot_kind: str
    text: str
    robot: str
    kit: int
    program: int
    rows: tuple[Row, ...]
    end_ms: int
    world: World | None = None
    seed: int = 1
    given_readings: Mapping[int, Sequence[int]] = {}
    was_started_by_button: bool = False
    version: str = __version__

    @property
    def is_virtual(self) -> bool:
        return self.robot_kind == VIRTUAL


class Rows:
    """The rows of a run as it goes on: a reading has one only where it changes, and a stop of a
    program that was held is the last one.

    `is_full`: there is no room for more, and the recording ends before what comes then.
    """

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self.is_full = False
        self._last_values: dict[str, str] = {}
        self._byte_count = 0

    def add(self, row: Row) -> bool:
        """Take a row; return whether the file has it."""
        if row.event.startswith("READ "):
            _, name, value = row.event.split(" ", 2)
            if self._last_values.get(name) == value:
                return False
            self._last_values[name] = value
        self._byte_count += len(encode_row(row)) + 1
        self.is_full = self.is_full or self._byte_count > MAX_ROW_BYTES or row.ms > MAX_MS
        if self.is_full:
            return False
        self.rows.append(row)
        self.is_full = row.event == HELD  # after a halt, the rest of the run is unknown
        return True


class ReadingRows:
    """The rows of a real robot's run for what it says about its readings.

    `incomplete_names` are the sensors whose readings it could not all report.
    """

    def __init__(self, kit: Kit) -> None:
        self._devices = kit.readings
        self._ms = 0  # time of the last row, since the start
        self._next_ms: dict[str, int] = {}  # earliest time of the next row, by sensor
        self.incomplete_names: list[str] = []

    def rows(self, event: ReadingEvent, since_ms: int) -> list[Row]:
        """Return the rows of an event at a time since the start of its run, which may precede the
        last row.
        """
        number = event.sensor & ~AFTER_GAP
        device = self._devices[number] if number < len(self._devices) else None
        if device is None or not device.name:
            return []
        self._ms += (event.ms - self._ms) % MS_MODULUS
        self._ms += max(0, round((since_ms - self._ms) / MS_MODULUS)) * MS_MODULUS
        rows = []
        if event.sensor & AFTER_GAP and device.name not in self.incomplete_names:
            self.incomplete_names.append(device.name)
            rows.append(Row(self._next_ms.get(device.name, 0), f"{UNREAD} {device.name}"))
        self._next_ms[device.name] = self._ms + 1
        return [*rows, Row(self._ms, f"{READ} {device.name} {device.text(event.value)}")]


def header_line(
    robot_kind: str, text: str, robot: Robot, program: int, *, world: str | Form | None = None,
    seed: int = 1, given_readings: dict[int, list[int]] | None = None,
    was_started_by_button: bool = False,
) -> str:  # fmt: skip
    """Return the first line of a file; `world` is the name of a shipped one, or a form."""
    fields: dict[str, Any] = {
        HEADER_KEY: VERSION,
        "tsc": __version__,
        "of": robot_kind,
        "robot": robot.name,
        "kit": f"{robot.kit.fingerprint:04x}",
        "program": f"{program:08x}",
        "text": text,
    }
    if robot_kind == VIRTUAL:
        names = [device.name for device in robot.kit.readings]
        fields |= {"world": world, "seed": seed}
        fields["told"] = {
            names[number]: values for number, values in (given_readings or {}).items()
        }
    elif was_started_by_button:
        fields["is_by_button"] = True
    return json.dumps(fields, ensure_ascii=False, separators=(",", ":")) + "\n"


def encode_row(row: Row) -> str:
    """Return a row as a line of the file, without its end."""
    return json.dumps(row.cells, separators=(",", ":"))


def encode(header: str, rows: Iterable[Row], end_ms: int) -> str:
    """Return the whole file that begins with the line `header`."""
    return "".join((header, *(f"{encode_row(row)}\n" for row in (*rows, Row(end_ms, END)))))


def decode(data: bytes) -> Recording:
    """Return the recording in a file. Raises BadRecording."""
    if len(data) > MAX_BYTES:
        raise BadRecording("too_long")
    lines = _decode_text(data).rstrip("\r\n").split("\n")
    fields = _parse(lines[0], 1, dict)
    if OLD_HEADER_KEY in fields:
        raise BadRecording("older")
    if HEADER_KEY in fields and fields[HEADER_KEY] != VERSION:
        raise BadRecording("other_version" if type(fields[HEADER_KEY]) is int else "unreadable")
    recording = _parse_header(fields)
    rows: list[Row] = []
    last_ms = 0
    for number, line in enumerate(lines[1:], 2):
        if rows and rows[-1].event == END:
            raise BadRecording("unreadable", number)
        row = _row(line, number, recording.robot_kind)
        is_late = not recording.is_virtual and row.is_reading  # the row arrived after its time
        if row.ms < last_ms and not is_late:
            raise BadRecording("unreadable", number)
        last_ms = last_ms if is_late else row.ms
        if row.ms > MAX_MS:
            raise BadRecording("too_long", number)
        if rows and not recording.is_virtual and rows[-1].event in CUT_EVENTS and row.event != END:
            raise BadRecording("unreadable", number)
        rows.append(row)
    if not rows or rows[-1].event != END:
        raise BadRecording("cut", len(lines))
    *rows, end_row = rows
    if not recording.is_virtual:
        rows = [row._replace(ms=min(row.ms, end_row.ms)) for row in rows]
        rows.sort(key=lambda row: (row.ms, not row.is_reading))
    return recording._replace(rows=tuple(rows), end_ms=end_row.ms)


def _parse_header(fields: dict[str, Any]) -> Recording:
    """Return the content of the first line. Raises BadRecording."""
    text, robot, robot_kind = fields.get("text"), fields.get("robot"), fields.get("of")
    seed = fields.get("seed", 1)
    if (
        fields.get(HEADER_KEY) != VERSION
        or robot_kind not in (VIRTUAL, REAL)
        or not isinstance(text, str)
        or len(text.encode("utf-8", "replace")) > MAX_TEXT
        or not isinstance(robot, str)
        or not _matches(_PROGRAM, fields.get("program"))
        or not _matches(_KIT, fields.get("kit"))
        or not _matches(_VERSION, fields.get("tsc"))
        or type(seed) is not int
        or not 1 <= seed < 1 << 32
    ):
        raise BadRecording("unreadable")
    kit = int(fields["kit"], 16)
    if robot not in robots.names() or robots.load(robot).kit.fingerprint != kit:
        raise BadRecording("other_robot")
    is_virtual = robot_kind == VIRTUAL
    return Recording(
        robot_kind=robot_kind,
        text=text,
        robot=robot,
        kit=kit,
        program=int(fields["program"], 16),
        rows=(),
        end_ms=0,
        world=world_in(fields.get("world")) if is_virtual else None,
        seed=seed,
        given_readings=_parse_readings(fields.get("told"), robots.load(robot))
        if is_virtual
        else {},
        was_started_by_button=not is_virtual and fields.get("is_by_button") is True,
        version=fields["tsc"],
    )


def world_in(data: object) -> World:
    """Return a shipped world by its name, or the one of a form. Raises BadRecording."""
    if isinstance(data, str) and data in worlds.names():
        return worlds.load(data)
    try:
        assert isinstance(data, dict)
        return worlds.read(toml_of(data), "")
    except (ProfileRefused, AssertionError, KeyError, TypeError, ValueError, AttributeError,
            RecursionError, OverflowError):  # fmt: skip
        raise BadRecording("unreadable") from None


def stored_form(world: World) -> tuple[World, str | Form]:
    """Return a world as the file of a run has it: a shipped one by its name, another one as a form
    that is read again."""
    if world.name in worlds.names() and worlds.load(world.name) == world:
        return world, world.name
    form = form_of(world)
    return world_in(form), form


def _parse_readings(data: object, robot: Robot) -> dict[int, list[int]]:
    """Return the readings that single sensors gave one after the other."""
    numbers = {device.name: k for k, device in enumerate(robot.kit.readings) if device.name}
    readings: dict[int, list[int]] = {}
    for name, values in data.items() if isinstance(data, dict) else ():
        number = numbers.get(name)
        if number is None or not isinstance(values, list) or not 0 < len(values) <= MAX_READINGS:
            raise BadRecording("unreadable")
        device = robot.kit.readings[number]
        if any(
            type(value) is not int or not device.low <= value <= device.high for value in values
        ):
            raise BadRecording("unreadable")
        readings[number] = values
    return readings


def _row(line: str, number: int, robot_kind: str) -> Row:
    cells = _parse(line, number, list)
    if len(cells) not in (2, 3) or any(type(cell) is not int for cell in (cells[0], *cells[2:])):
        raise BadRecording("unreadable", number)
    row = Row(*cells)
    match_event = _EVENT.fullmatch if robot_kind == VIRTUAL else _REAL.fullmatch
    is_event = isinstance(row.event, str) and (
        row.event == END or match_event(row.event) is not None
    )
    if not is_event and not (
        isinstance(row.event, str) and robot_kind == VIRTUAL and row.remote_state
    ):
        raise BadRecording("unreadable", number)
    if row.ms < 0 or not -1 <= row.offset < 1 << 16:
        raise BadRecording("unreadable", number)
    if row.event.startswith("KEYS") and (row.remote_state is None or not row.remote_state.is_sound):
        raise BadRecording("unreadable", number)
    return row


def _decode_text(data: bytes) -> str:
    """Return the text of a file, also as PowerShell and Notepad write it."""
    is_wide = data.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
    return data.decode("utf-16" if is_wide else "utf-8-sig", "replace")


def _parse(line: str, number: int, json_type: type) -> Any:
    try:
        value = json.loads(line)
    except (ValueError, RecursionError):
        value = None
    if not isinstance(value, json_type):
        raise BadRecording("unreadable", number)
    return value


def _matches(pattern: re.Pattern[str], value: object) -> bool:
    return isinstance(value, str) and pattern.fullmatch(value) is not None


def from_rows(rows: Sequence[Sequence[Any]]) -> list[Row]:
    """Return rows as the page keeps them: `[ms, event]` or `[ms, event, at]`."""
    return [Row(*row) for row in rows]
