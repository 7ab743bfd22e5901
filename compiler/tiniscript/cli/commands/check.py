"""`tsc check`: all mistakes and warnings, no output file."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from tiniscript.cli import inputs, outputs
from tiniscript.cli.options import Options
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.robots.profile import Robot

HELP = (
    """\
tsc check PROGRAM [--json] [--robot NAME|FILE] [--port P]

Shows all mistakes and warnings of a program.
  --json        as a list of {code, severity, line, column, end_line, end_column, message, fix};
                lines and columns count from 1, columns in characters, the end is not included
  --robot R     for which robot: a name (tinibot, ...) or a profile's file
  --port P      for the robot on this port, which is asked; --baud N is its speed
  --virtual     for the virtual robot of tsc robot, which runs in another terminal
""",
    """\
tsc check PROGRAMA [--json] [--robot NOMBRE|ARCHIVO] [--port P]

Muestra todos los errores y avisos de un programa.
  --json        como lista de {code, severity, line, column, end_line, end_column, message, fix};
                líneas y columnas desde 1, columnas en caracteres, el final no se incluye
  --robot R     para qué robot: un nombre (tinibot, ...) o el archivo de un perfil
  --port P      para el robot en este puerto, al que se pregunta; --baud N es su velocidad
  --virtual     para el robot virtual de tsc robot, que está en marcha en otra terminal
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("check", language, HELP)
    parser.takes_program()
    for name in ("--port", "--baud"):
        parser.add_argument(name)
    for name in ("--virtual", "--json"):
        parser.add_argument(name, action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    given = inputs.program(options)
    robot = inputs.robot(options, language)
    if options.port is not None or options.virtual:
        robot = _of_port(options, robot, language)
    compiled = inputs.compiled(given, robot, is_strict=False)
    if options.json:
        import json

        from tiniscript.diagnostics.rendering import as_json, message

        said = [message(problem, compiled.source, language) for problem in compiled.problems]
        print(json.dumps(as_json(said), indent=2))
    else:
        outputs.print_problems(compiled, language)
        if compiled.is_right:
            print(text("no_mistakes", language).format(file=inputs.shown(given.name)))
    return 0 if compiled.is_right else 1


def _of_port(options: Namespace, robot: Robot, language: str) -> Robot:
    """Return the profile of the robot on a port, if it is known and no other one is named."""
    from tiniscript.cli.robot import own_kit
    from tiniscript.cli.robot.connect import Connection

    with Connection(options, robot, language) as connection:
        connection.meet()
        own_kit.take(connection, options)
        return connection.profile
