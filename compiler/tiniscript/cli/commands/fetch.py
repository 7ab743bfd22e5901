"""`tsc fetch`: the program that the robot holds, read back."""

from __future__ import annotations

from pathlib import Path

from tiniscript.cli import images, inputs, outputs
from tiniscript.cli.commands import show
from tiniscript.cli.options import Options
from tiniscript.cli.robot.connect import connected, takes_robot
from tiniscript.cli.texts.common import text

HELP = (
    """\
tsc fetch [--port P] [-o FILE] [--json]

Reads back the program that the robot holds and lists it, beside its lines where they are known.
  --port P      the robot's port; the last used one where nothing is said
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     the virtual robot of tsc robot, which runs in another terminal
  -o FILE       writes its image instead
  --json        the listing as data
""",
    """\
tsc fetch [--port P] [-o ARCHIVO] [--json]

Lee de vuelta el programa que tiene el robot y lo lista, junto a sus líneas si se conocen.
  --port P      el puerto del robot; el último usado si no se dice nada
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     el robot virtual de tsc robot, que está en marcha en otra terminal
  -o ARCHIVO    escribe su imagen en vez de eso
  --json        la lista como datos
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("fetch", language, HELP)
    takes_robot(parser)
    parser.add_argument("-o", dest="output")
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    robot = inputs.robot(options, language)
    with connected(options, language) as connection:
        connection.meet()
        data = connection.ask(lambda session: session.fetch()).values["image"]
        name = connection.name
    assert isinstance(data, bytes)
    given = inputs.Input(name, data, Path("fetched.bin"))
    if options.robot is None:
        robot = images.robot_for(given, robot)
    ready = images.ready(given, robot, language)
    assert ready is not None  # an image has no mistakes
    if options.output is not None:
        outputs.write(Path(options.output), data, "unwritable")
        print(text("fetched", language).format(
            robot=name,
            port=inputs.shown(connection.port),
            target=inputs.shown(options.output),
            image=len(data),
            code=len(ready.image.code),
            checksum=f"{ready.image.checksum:08x}",
        ))  # fmt: skip
    elif options.json:
        show.print_json(ready, robot)
    else:
        show.print_listing(ready, robot, name, language)
    return 0
