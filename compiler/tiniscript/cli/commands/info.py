"""`tsc info`: the robot's description of itself."""

from __future__ import annotations

import json
from argparse import Namespace
from contextlib import suppress

from tiniscript.cli import inputs
from tiniscript.cli.commands.trim import words
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import fault_sentence
from tiniscript.cli.robot.fleet import together
from tiniscript.cli.robot.member import Member, Result, are_many
from tiniscript.library import source_map
from tiniscript.library.known_kits import shipped_of_kit
from tiniscript.link.authority import OF_ANOTHER, whose
from tiniscript.link.messages import (
    RESETS,
    SAVED,
    SAVED_NOTHING,
    SAVED_OTHER_VERSION,
    SAVED_STORED,
    SAVED_UNREADABLE,
    STATES,
    TEXT_LEVEL,
    TEXT_LEVELS,
)
from tiniscript.link.names import fault_name, row_name
from tiniscript.link.trim import Pace, Trim, told


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    if are_many(options):
        return together(options, robot, language, one_of_many)
    with Connection(options, robot, language) as connection:
        connection.meet()
        description = Description(connection)
    print(json.dumps(description.fields(), indent=2) if options.json else description.text())
    return 0


def one_of_many(connection: Connection, member: Member) -> Result:
    member.meet(connection)
    description = Description(connection)
    return Result(True, description.line(), description.fields())


class Description:
    """The replies to HELLO and STATUS."""

    def __init__(self, connection: Connection) -> None:
        self.connection = connection
        self.device_info = connection.device_info
        self.hello = self.device_info.values
        self.status = connection.ask(lambda session: session.status()).values
        self.trim: Trim | None = None
        if whose(self.device_info) != OF_ANOTHER:  # it would count as a wrong key
            with suppress(CommandError):
                self.trim = told(connection.ask(lambda session: session.trim()).values)

    def fields(self) -> dict[str, object]:
        """Return it as data."""
        status = self.status
        has_program = not self._why_no_program()
        fault = None
        if status.fault:
            program = f"{status.fault_program:08x}"
            fault = {"fault": fault_name(status.fault), "at": status.fault_at,
                     "program": program}  # fmt: skip
        return {
            "name": self.device_info.name,
            "id": f"{self.device_info.id:08x}",
            "port": self.connection.port,
            "owner": whose(self.device_info),
            "kit": f"{self.device_info.kit:04x}",
            "robot": shipped_of_kit(self.device_info.kit),
            "link": f"{self.hello.major}.{self.hello.minor}",
            "isa": f"{self.device_info.isa[0]}.{self.device_info.isa[1]}",
            "room": self.device_info.room,
            "text_level": self._text_level(),
            "state": row_name(STATES, status.state),
            "program": f"{status.program:08x}" if has_program else None,
            "code_bytes": status.length if has_program else None,
            "saved": row_name(SAVED, status.saved),
            "slot": status.slot if status.saved == SAVED_STORED else None,
            "fault": fault,
            "reset": row_name(RESETS, self.hello.reset),
            "trim": None if self.trim is None else self.trim.as_data(),
            "damaged": status.damaged,
            "dropped": status.dropped,
            "framing": status.framing,
            "overrun": status.overrun,
            "noise": [*status.noise] or None,
        }

    def line(self) -> str:
        """Return the most important of it in one line."""
        fields, say = self.fields(), self.connection.text
        state, owner = say(f"state_{fields['state']}"), say(f"whose_{fields['owner']}")
        return f"{self._program()}; {state}; {owner}"

    def _program(self) -> str:
        say, status, fields = self.connection.text, self.status, self.fields()
        why = self._why_no_program()
        if why:
            return say(why)
        places = source_map.recall(status.program)
        name = f" ({shown(places.name)})" if places is not None else ""
        saved = say(f"saved_{fields['saved']}", slot=status.slot)
        return say("info_program", checksum=fields["program"], name=name, code=status.length,
                   saved=saved)  # fmt: skip

    def _text_level(self) -> str | None:
        """Return the level of text that the robot reads, or None."""
        number = self.hello.features & TEXT_LEVEL
        return row_name(TEXT_LEVELS, number).lower() if number else None

    def _reader(self) -> str:
        level = self._text_level()
        key = "info_no_text" if level is None else "info_text"
        return self.connection.text(key, level=level)

    def _why_no_program(self) -> str:
        """Return the reason why the robot holds no program, or an empty text."""
        texts = {
            SAVED_NOTHING: "info_no_program", SAVED_OTHER_VERSION: "info_other_version",
            SAVED_UNREADABLE: "info_unreadable",
        }  # fmt: skip
        return texts.get(self.status.saved, "")

    def text(self) -> str:
        """Return it as lines."""
        language, say = self.connection.language, self.connection.text
        status, fields = self.status, self.fields()
        kit = f"{fields['kit']} ({fields['robot']})" if fields["robot"] else fields["kit"]
        state, reset = say(f"state_{fields['state']}"), say(f"reset_{fields['reset']}")
        owner = say(f"whose_{fields['owner']}")
        lines = [
            say("info_robot", id=fields["id"], whose=owner),
            say("info_kit", kit=kit, isa=fields["isa"], room=self.device_info.room),
            self._reader(),
            self._program(),
            say("info_state", state=state, reset=reset),
        ]
        if self.trim not in (None, Trim(), Trim(pace=Pace())):
            lines.append(say("info_trim", trim=words(self.trim or Trim(), language)))
        if status.fault:
            lines.append(self._fault())
        if status.damaged or status.dropped or status.framing or status.overrun:
            lines.append(say("info_hearing", **status._asdict()))
        if any(status.noise):
            left, right = status.noise
            lines.append(say("info_noise", left=left, right=right))
        return "\n".join(lines)

    def _fault(self) -> str:
        status = self.status
        said = fault_sentence(status.fault, status.fault_at, status.fault_program, None,
                              self.connection.language)  # fmt: skip
        return self.connection.text("info_fault", fault=said)
