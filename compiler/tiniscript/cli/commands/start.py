"""`tsc start`: the program that the robot holds begins."""

from __future__ import annotations

from tiniscript.cli.options import Options
from tiniscript.cli.robot.connect import Connection, connected, takes_robot
from tiniscript.cli.robot.run_monitor import Attendant, stop_and_say
from tiniscript.cli.texts.common import text

HELP = (
    """\
tsc start [--port P] [--detach] [--json]

Starts the program that the robot holds and stays until it ends, as tsc upload does. Ctrl-C stops
the robot.
  --port P      the robot's port; the last used one where nothing is said
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     the virtual robot of tsc robot, which runs in another terminal
  --detach      starts it and leaves: it goes on without tsc
  --json        prints what it tells as lines of JSON
""",
    """\
tsc start [--port P] [--detach] [--json]

Inicia el programa que tiene el robot y se queda hasta que termina, como tsc upload. Ctrl-C
detiene el robot.
  --port P      el puerto del robot; el último usado si no se dice nada
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     el robot virtual de tsc robot, que está en marcha en otra terminal
  --detach      lo inicia y se va: sigue sin tsc
  --json        imprime lo que cuenta como líneas de JSON
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("start", language, HELP)
    takes_robot(parser)
    parser.add_argument("--detach", action="store_true")
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    with connected(options, language) as connection:
        connection.meet()
        try:
            return _start(connection, options.detach, options.json)
        except KeyboardInterrupt:
            return stop_and_say(connection)


def _start(connection: Connection, is_detached: bool, is_json: bool) -> int:
    from tiniscript.cli.robot.event_printer import Teller

    reply = connection.ask(lambda session: session.start(is_detached))
    number, run = reply.values["program"], reply.values["run"]
    assert isinstance(number, int) and isinstance(run, int)
    key = "started_detached" if is_detached else "started"
    said = text(key, connection.language).format(robot=connection.name, checksum=f"{number:08x}")
    teller = Teller(connection.language, is_json)
    teller.say(0, "STARTED", "", said, program=f"{number:08x}")
    return 0 if is_detached else Attendant(connection, teller).attend(run)
