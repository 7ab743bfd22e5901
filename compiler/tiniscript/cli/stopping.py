"""`tsc stop`: the robot stops now, whatever else is wrong."""

from __future__ import annotations

from tiniscript.cli.attending import confirmed
from tiniscript.cli.connecting import connected, takes_robot
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options
from tiniscript.cli.texts import text
from tiniscript.cli.trouble import Trouble

HELP = (
    """\
tsc stop [--port P]

Stops the robot now, and says when it has confirmed that. Asks nothing before, so it stops a
robot of another version or kit, too. The robot stays stopped until a new start or its button.
  --port P      the robot's port; the last used one where nothing is said
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     the virtual robot of tsc robot, which runs in another terminal
""",
    """\
tsc stop [--port P]

Detiene el robot ahora, y dice cuándo lo ha confirmado. No pregunta nada antes, así que también
detiene un robot de otra versión o de otro kit. Queda detenido hasta otro inicio o su botón.
  --port P      el puerto del robot; el último usado si no se dice nada
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     el robot virtual de tsc robot, que está en marcha en otra terminal
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("stop", language, HELP)
    takes_robot(parser)
    options = parser.read(arguments)
    if options is None:
        return 0
    while True:
        with connected(options, language) as connection:
            port = connection.port
            if confirmed(connection.line):
                print(text("stopped_on", language).format(port=shown(port)))
                return 0
            if not (connection.line.held_by and connection.line.has_ended):
                raise Trouble(3, "not_confirmed", port=shown(port))
        options.port = port  # its holder has ended in the middle: now it can be opened
