"""`tsc stop`: the robot stops now, whatever else is wrong."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from tiniscript.cli import inputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.run_monitor import confirmed
from tiniscript.cli.robot.targets import are_many, takes_ports
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.cli.robot.fleet import Member, Result

HELP = (
    """\
tsc stop [--port P ...] [--all] [--json]

Stops the robot now, and says when it has confirmed that. Asks nothing before, so it stops a
robot of another version or kit, too. The robot stays stopped until a new start or its button.
Where no port is named it stops every robot that a tsc on this computer has now, virtual ones
too, and the last used one.
  --port P      the robot's port; several for several
  --all         stops every robot that there is, all at once
  --json        prints a line of JSON for each robot
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     virtual robots alone: those of tsc robot, and of commands with --virtual
""",
    """\
tsc stop [--port P ...] [--all] [--json]

Detiene el robot ahora, y dice cuándo lo ha confirmado. No pregunta nada antes, así que también
detiene un robot de otra versión o de otro kit. Queda detenido hasta otro inicio o su botón.
Si no se nombra un puerto, detiene todos los robots que un tsc tiene ahora en esta computadora,
también los virtuales, y el último usado.
  --port P      el puerto del robot; varios para varios
  --all         detiene todos los robots que hay, todos a la vez
  --json        imprime una línea de JSON por cada robot
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     solo robots virtuales: los de tsc robot, y los de comandos con --virtual
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("stop", language, HELP)
    takes_ports(parser)
    parser.add_argument("--robot")
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    robot = inputs.robot(options, language)
    is_many = are_many(options)
    if not is_many and options.port is None:
        from tiniscript.cli.robot import in_use

        options.ports = in_use.to_stop(options.virtual)
        options.virtual = options.virtual and not options.ports
        is_many = are_many(options)
    if is_many:
        from tiniscript.cli.robot.fleet import together

        return together(options, robot, language, _one_of_many)
    while True:
        with Connection(options, robot, language) as connection:
            port = connection.port
            if confirmed(connection.line):
                if options.json:
                    print(json.dumps({"port": port, "is_done": True}))
                else:
                    print(text("stopped_on", language).format(port=shown(port)))
                return 0
            if not _may_be_opened(connection):
                raise Trouble(3, "not_confirmed", port=shown(port))
        options.port = port


def _may_be_opened(connection: Connection) -> bool:
    """Whether the holder of the port has ended in the middle: now the port can be opened."""
    return bool(connection.line.held_by) and connection.line.has_ended


def _one_of_many(connection: Connection, member: Member) -> Result:
    from tiniscript.cli.robot.fleet import Again, Result

    member.tell("crew_stopping")
    if confirmed(connection.line):
        return Result(True, text("robot_stopped", connection.language))
    if _may_be_opened(connection):
        raise Again
    raise Trouble(3, "not_confirmed", port=shown(connection.port))
