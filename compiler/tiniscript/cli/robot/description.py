"""A robot's description of itself, as data, lines and one line, and its response times."""

from __future__ import annotations

import json
from contextlib import suppress
from statistics import median
from typing import NamedTuple

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection, name_of
from tiniscript.cli.robot.event_printer import fault_sentence
from tiniscript.cli.robot.member import Member, Result
from tiniscript.cli.texts import text
from tiniscript.doctor.examination import trips_of
from tiniscript.doctor.robot import SharedRobot
from tiniscript.library import source_map
from tiniscript.library.known_kits import shipped_name_of_kit
from tiniscript.link.authority import OWNED_BY_OTHER, ownership_of
from tiniscript.link.messages import (
    RESETS,
    SAVED_NOTHING,
    SAVED_OTHER_VERSION,
    SAVED_STATES,
    SAVED_STORED,
    SAVED_UNREADABLE,
    STATES,
    TEXT_LEVEL,
    TEXT_LEVELS,
)
from tiniscript.link.names import fault_name, row_name
from tiniscript.link.outcomes import LOST
from tiniscript.link.payloads import StatusReply
from tiniscript.link.requests import DeviceInfo, Reply
from tiniscript.link.trim import Pace, Trim, trim_from_reply

ROUND_TRIP_COUNT = 10  # round trips


class Description(NamedTuple):
    """The replies of a robot to HELLO, STATUS and TRIM. `owner`: see `authority.ownership_of`."""

    port: str
    device_info: DeviceInfo
    status: StatusReply
    trim: Trim | None
    owner: str
    language: str

    def fields(self) -> dict[str, object]:
        """Return the description as data."""
        status, hello = self.status, self.device_info.values
        has_program = not self._no_program_key()
        fault = None
        if status.fault:
            program = f"{status.fault_program:08x}"
            fault = {"fault": fault_name(status.fault), "at": status.fault_at,
                     "program": program}  # fmt: skip
        return {
            "name": self.device_info.name,
            "id": f"{self.device_info.id:08x}",
            "port": self.port,
            "owner": self.owner,
            "kit": f"{self.device_info.kit:04x}",
            "robot": shipped_name_of_kit(self.device_info.kit),
            "link": f"{hello.major}.{hello.minor}",
            "isa": f"{self.device_info.isa[0]}.{self.device_info.isa[1]}",
            "room": self.device_info.room,
            "text_level": self._text_level(),
            "state": row_name(STATES, status.state),
            "program": f"{status.program:08x}" if has_program else None,
            "code_bytes": status.length if has_program else None,
            "saved": row_name(SAVED_STATES, status.saved),
            "slot": status.slot if status.saved == SAVED_STORED else None,
            "fault": fault,
            "reset": row_name(RESETS, hello.reset),
            "trim": None if self.trim is None else self.trim.as_data(),
            "damaged": status.damaged,
            "dropped": status.dropped,
            "framing": status.framing,
            "overrun": status.overrun,
            "noise": [*status.noise] or None,
        }

    def line(self) -> str:
        """Return the most important of it in one line."""
        fields = self.fields()
        state, owner = self._text(f"state_{fields['state']}"), self._text(f"whose_{self.owner}")
        return f"{self._program()}; {state}; {owner}"

    def text(self) -> str:
        """Return the description as lines."""
        format_text, status, fields = self._text, self.status, self.fields()
        kit = f"{fields['kit']} ({fields['robot']})" if fields["robot"] else fields["kit"]
        state, reset = (
            format_text(f"state_{fields['state']}"),
            format_text(f"reset_{fields['reset']}"),
        )
        lines = [
            format_text("info_robot", id=fields["id"], whose=format_text(f"whose_{self.owner}")),
            format_text("info_kit", kit=kit, isa=fields["isa"], room=self.device_info.room),
            self._reader(),
            self._program(),
            format_text("info_state", state=state, reset=reset),
        ]
        if self.trim not in (None, Trim(), Trim(pace=Pace())):
            lines.append(
                format_text("info_trim", trim=trim_in_words(self.trim or Trim(), self.language))
            )
        if status.fault:
            lines.append(self._fault())
        if status.damaged or status.dropped or status.framing or status.overrun:
            lines.append(format_text("info_hearing", **status._asdict()))
        if any(status.noise):
            left, right = status.noise
            lines.append(format_text("info_noise", left=left, right=right))
        return "\n".join(lines)

    def _text(self, key: str, **values: object) -> str:
        names = {
            "robot": name_of(self.device_info, self.language),
            "port": printable_name(self.port),
        }
        return text(key, self.language).format(**{**names, **values})

    def _program(self) -> str:
        format_text, status, fields = self._text, self.status, self.fields()
        no_program_key = self._no_program_key()
        if no_program_key:
            return format_text(no_program_key)
        program_map = source_map.recall(status.program)
        name = f" ({printable_name(program_map.name)})" if program_map is not None else ""
        saved_text = format_text(f"saved_{fields['saved']}", slot=status.slot)
        return format_text(
            "info_program",
            checksum=fields["program"],
            name=name,
            code=status.length,
            saved=saved_text,
        )

    def _text_level(self) -> str | None:
        """Return the level of text that the robot reads, or None."""
        number = self.device_info.values.features & TEXT_LEVEL
        return row_name(TEXT_LEVELS, number).lower() if number else None

    def _reader(self) -> str:
        level = self._text_level()
        return self._text("info_no_text" if level is None else "info_text", level=level)

    def _no_program_key(self) -> str:
        """Return the reason why the robot holds no program, or an empty text."""
        key_by_saved = {
            SAVED_NOTHING: "info_no_program", SAVED_OTHER_VERSION: "info_other_version",
            SAVED_UNREADABLE: "info_unreadable",
        }  # fmt: skip
        return key_by_saved.get(self.status.saved, "")

    def _fault(self) -> str:
        status = self.status
        sentence = fault_sentence(status.fault, status.fault_at, status.fault_program, None,
                              self.language)  # fmt: skip
        return self._text("info_fault", fault=sentence)


def describe_robot(connection: Connection) -> Description:
    """Ask a robot that has answered HELLO for its description."""
    status = connection.request(lambda session: session.status()).values
    owner = ownership_of(connection.device_info)
    trim: Trim | None = None
    if owner != OWNED_BY_OTHER:  # another owner's key would count as a wrong key
        with suppress(CommandError):
            trim = trim_from_reply(connection.request(lambda session: session.trim()).values)
    return Description(
        connection.port, connection.device_info, status, trim, owner, connection.language
    )


def describe_in_a_line(connection: Connection, member: Member) -> Result:
    """Describe one of many robots."""
    member.meet_robot(connection)
    description = describe_robot(connection)
    return Result(True, description.line(), description.fields())


def introduce(connection: Connection, is_json: bool) -> int:
    """Print a robot's description and its response time; return the exit code."""
    connection.meet()
    trips_ms = _measure_trips(connection, ROUND_TRIP_COUNT)
    description = describe_robot(connection)
    if is_json:
        print(json.dumps({**description.fields(), **trips_as_data(trips_ms)}, indent=2))
    else:
        print(description.text())
        print(trips_in_words(trips_ms, connection.language))
    return 0


def describe_and_measure(connection: Connection, member: Member) -> Result:
    """Describe one of many robots, and say how soon it answers."""
    result = describe_in_a_line(connection, member)
    member.set_state("crew_pinging")
    trips_ms = _measure_trips(connection, ROUND_TRIP_COUNT)
    text = f"{result.sentence}; {trips_in_words(trips_ms, connection.language)}"
    return Result(True, text, {**result.fields, **trips_as_data(trips_ms)})


def _measure_trips(connection: Connection, count: int) -> list[float]:
    """Return the times in ms of immediate answers. Raises CommandError if there are none."""
    trips_ms = trips_of(SharedRobot(connection.connection, connection.wait), count)
    if not trips_ms:
        raise connection.error_for_reply(Reply(LOST))
    return [*trips_ms]


def _trip_summary(trips_ms: list[float]) -> dict[str, float]:
    return {"least": min(trips_ms), "median": median(trips_ms), "most": max(trips_ms)}


def trips_as_data(trips_ms: list[float]) -> dict[str, object]:
    summary = _trip_summary(trips_ms) if trips_ms else {}
    return {"round_trips": len(trips_ms)} | {
        f"{name}_ms": round(ms, 1) for name, ms in summary.items()
    }


def trips_in_words(trips_ms: list[float], language: str) -> str:
    ms_texts = {name: f"{ms:.1f}" for name, ms in _trip_summary(trips_ms).items()}
    return text("ping", language).format(n=len(trips_ms), **ms_texts)


def trim_in_words(trim: Trim, language: str) -> str:
    """Return a trim in words."""
    parts = [
        text(key, language)
        for key, is_set in (
            ("trim_exchanged", trim.is_exchanged),
            ("trim_left_reversed", trim.is_left_reversed),
            ("trim_right_reversed", trim.is_right_reversed),
        )
        if is_set
    ] or [text("trim_as_wired", language)]
    weaker_side_key = "trim_left_weaker" if trim.balance > 0 else "trim_right_weaker"
    balance_key = weaker_side_key if trim.balance else "trim_even"
    parts.append(text(balance_key, language).format(n=abs(trim.balance)))
    if trim.least:
        parts.append(text("trim_least", language).format(n=trim.least))
    if trim.pace is not None:
        pace_rows = (("trim_speed", trim.pace[:2]), ("trim_turn", trim.pace[2:]))
        parts += [
            text(key, language).format(at_40=f"{at_40:g}", at_80=f"{at_80:g}")
            for key, (at_40, at_80) in pace_rows
            if at_80
        ] or [text("trim_kits_pace", language)]
    return ", ".join(parts)
