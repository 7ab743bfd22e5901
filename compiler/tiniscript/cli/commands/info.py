"""`tsc info`: what the robot says of itself."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from tiniscript.cli import inputs
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options
from tiniscript.cli.robot.connect import Connection, robot_of_kit
from tiniscript.cli.robot.targets import are_many, takes_ports
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.cli.robot.fleet import Member, Result

HELP = (
    """\
tsc info [--port P ...] [--all] [--json]

Prints what the robot says of itself: name, kit, room, program, state, last fault.
  --port P      the robot's port; the last used one where nothing is said; several for several
  --all         every robot that answers, a line each
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     the virtual robot of tsc robot, which runs in another terminal
  --json        the same as data
""",
    """\
tsc info [--port P ...] [--all] [--json]

Imprime lo que el robot dice de sí mismo: nombre, kit, sitio, programa, estado, última falla.
  --port P      el puerto del robot; el último usado si no se dice nada; varios para varios
  --all         todos los robots que responden, una línea por cada uno
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     el robot virtual de tsc robot, que está en marcha en otra terminal
  --json        lo mismo como datos
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("info", language, HELP)
    takes_ports(parser)
    parser.add_argument("--robot")
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    robot = inputs.robot(options, language)
    if are_many(options):
        from tiniscript.cli.robot.fleet import together

        return together(options, robot, language, _one_of_many)
    with Connection(options, robot, language) as connection:
        connection.meet()
        description = Description(connection)
    print(json.dumps(description.fields(), indent=2) if options.json else description.text())
    return 0


def _one_of_many(connection: Connection, member: Member) -> Result:
    from tiniscript.cli.robot.fleet import Result

    member.meet(connection)
    description = Description(connection)
    return Result(True, description.line(), description.fields())


class Description:
    """What HELLO and STATUS have said."""

    def __init__(self, connection: Connection) -> None:
        self.connection = connection
        self.card = connection.card
        status = connection.ask(lambda session: session.status()).values
        said = {**self.card.values, **status}
        self.values = {key: value for key, value in said.items() if isinstance(value, int)}

    def fields(self) -> dict[str, object]:
        """Return it as data."""
        from tiniscript.cli.robot.event_printer import fault_name
        from tiniscript.link.messages import RESETS, SAVED, SAVED_NOTHING, SAVED_STORED, STATES

        values = self.values
        has_program = values["saved"] != SAVED_NOTHING
        fault = None
        if values["fault"]:
            program = f"{values['fault_program']:08x}"
            fault = {"fault": fault_name(values["fault"]), "at": values["fault_at"],
                     "program": program}  # fmt: skip
        return {
            "name": self.card.name,
            "id": f"{self.card.id:08x}",
            "port": self.connection.port,
            "kit": f"{self.card.kit:04x}",
            "robot": robot_of_kit(self.card.kit),
            "link": f"{values['major']}.{values['minor']}",
            "isa": f"{self.card.isa[0]}.{self.card.isa[1]}",
            "room": self.card.room,
            "state": _name(STATES, values["state"]),
            "program": f"{values['program']:08x}" if has_program else None,
            "code_bytes": values["length"] if has_program else None,
            "saved": _name(SAVED, values["saved"]),
            "slot": values["slot"] if values["saved"] == SAVED_STORED else None,
            "fault": fault,
            "reset": _name(RESETS, values["reset"]),
            "damaged": values["damaged"],
            "dropped": values["dropped"],
            "framing": values["framing"],
            "overrun": values["overrun"],
        }

    def line(self) -> str:
        """Return the most important of it in one line."""
        state = text(f"state_{self.fields()['state']}", self.connection.language)
        return f"{self._program()}; {state}"

    def _program(self) -> str:
        from tiniscript.codegen import source_map
        from tiniscript.link.messages import SAVED_NOTHING

        language, values, fields = self.connection.language, self.values, self.fields()
        if values["saved"] == SAVED_NOTHING:
            return text("info_no_program", language)
        places = source_map.recall(values["program"])
        return text("info_program", language).format(
            checksum=fields["program"],
            name=f" ({shown(places.name)})" if places is not None else "",
            code=values["length"],
            saved=text(f"saved_{fields['saved']}", language).format(slot=values["slot"]),
        )

    def text(self) -> str:
        """Return it as lines."""
        language, values, fields = self.connection.language, self.values, self.fields()
        kit = f"{fields['kit']} ({fields['robot']})" if fields["robot"] else fields["kit"]
        head = {"robot": self.connection.name, "port": shown(self.connection.port)}
        state, reset = (text(f"{what}_{fields[what]}", language) for what in ("state", "reset"))
        lines = [
            text("info_robot", language).format(**head, id=fields["id"]),
            text("info_kit", language).format(kit=kit, isa=fields["isa"], room=self.card.room),
            self._program(),
            text("info_state", language).format(state=state, reset=reset),
        ]
        if values["fault"]:
            lines.append(self._fault())
        counts = {name: values[name] for name in ("damaged", "dropped", "framing", "overrun")}
        if any(counts.values()):
            lines.append(text("info_hearing", language).format(**counts))
        return "\n".join(lines)

    def _fault(self) -> str:
        from tiniscript.cli.robot.event_printer import fault_sentence

        values = self.values
        said = fault_sentence(values["fault"], values["fault_at"], values["fault_program"], None,
                              self.connection.language)  # fmt: skip
        return text("info_fault", self.connection.language).format(fault=said)


def _name(table: tuple[tuple[str, str], ...], number: int) -> str:
    """Return the name of a number; the first one's for what only a newer robot knows."""
    return table[number if number < len(table) else 0][0]
