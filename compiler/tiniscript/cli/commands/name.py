"""`tsc name`: the robot gets another name."""

from __future__ import annotations

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options
from tiniscript.cli.robot.connect import connected, takes_robot
from tiniscript.cli.texts.common import text

HELP = (
    """\
tsc name NEW [--port P]

Names the robot: 1 to 16 bytes of UTF-8. It keeps its name when it is switched off.
  --port P      the robot's port; the last used one where nothing is said
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     the virtual robot of tsc robot, which runs in another terminal
""",
    """\
tsc name NUEVO [--port P]

Le pone nombre al robot: de 1 a 16 bytes de UTF-8. Lo conserva cuando se apaga.
  --port P      el puerto del robot; el último usado si no se dice nada
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     el robot virtual de tsc robot, que está en marcha en otra terminal
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("name", language, HELP)
    takes_robot(parser)
    parser.add_argument("name", nargs="?")
    options = parser.read(arguments)
    if options is None:
        return 0
    if options.name is None:
        raise Trouble(2, "no_name")
    name: str = options.name
    data = name_bytes(name)
    with connected(options, language) as connection:
        connection.meet()
        reply = connection.give(lambda session: session.name(data))
        connection.remember(name)
        if reply.status:  # it is called so, and may forget it
            raise connection.trouble(reply)
        said = {"port": shown(connection.port), "name": shown(name)}
        print(text("named", language).format(**said))
    return 0


def name_bytes(name: str) -> bytes:
    """Return a name as a robot keeps it. Raises Trouble where it has no room."""
    from tiniscript.link.messages import NAME_BYTES

    data = name.encode("utf-8", "surrogateescape")
    if not 1 <= len(data) <= NAME_BYTES or not name.isprintable() or not name.strip():
        raise Trouble(2, "bad_name", bytes=str(len(data)))
    return data
