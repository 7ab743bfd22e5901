"""`tsc upload`: a program goes to the robot, starts there, and is looked after until it ends."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from tiniscript.cli import images, inputs, outputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.options import Options
from tiniscript.cli.robot import own_kit
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.run_monitor import Attendant, Saving, stop_and_say
from tiniscript.cli.robot.simulator_options import takes_world
from tiniscript.cli.robot.targets import are_many, takes_ports
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from collections.abc import Callable

    from tiniscript.cli.robot.event_printer import Teller
    from tiniscript.link.connection import Asked, Asks
    from tiniscript.link.requests import Reply
    from tiniscript.robots.profile import Robot

HELP = (
    """\
tsc upload PROGRAM [--port P ...] [--all] [--no-run] [--no-save] [--detach]
                   [--robot NAME|FILE]

Compiles a program, brings it to the robot and starts it there if it begins with SI. Stays until
it ends: prints what it shows, and a fault with its line. Ctrl-C stops the robot. A program
that begins with SB waits for the robot's button.
  --port P      the robot's port (/dev/ttyUSB0, /dev/rfcomm0, COM5, socket://host:port, ...);
                the last used one where nothing is said; several for several robots
  --all         every robot that answers, all at once
  --baud N      its speed (the one of the robot's profile)
  --no-run      brings the program, and does not start it
  --no-save     the robot forgets it when it is switched off
  --detach      starts it and leaves: it goes on without tsc
  --robot R     for which robot: a name (tinibot, ...) or a profile's file
  --json        prints the receipt and what comes after it as lines of JSON
  --virtual     no robot: a virtual one drives here, until the program ends or Ctrl-C; the one of
                tsc robot, if that runs in another terminal. The key b is the button of one here;
                where nobody is at a terminal, it is pushed at once
With --virtual:
  --world W     its world: obstacles, line, light, or a file (obstacles)
  --plot F.png  draws the world and the way when it ends
  --for S       ends after so many seconds of the robot's time
  --hurry N     N times as fast; max: as fast as this computer can
  --seed N, --noise X, --motors L,R, --faults X, --sensor NAME=1,2,3    as tsc robot --help says
Exit code: 0 when it is done, 1 after mistakes or a fault, 2 after Ctrl-C, 3 where the robot or
the link has ended it.
""",
    """\
tsc upload PROGRAMA [--port P ...] [--all] [--no-run] [--no-save] [--detach]
                    [--robot NOMBRE|ARCHIVO]

Compila un programa, lo lleva al robot y lo inicia ahí si empieza con SI. Se queda hasta que
termina: imprime lo que muestra, y una falla con su línea. Ctrl-C detiene el robot. Un programa
que empieza con SB espera el botón del robot.
  --port P      el puerto del robot (/dev/ttyUSB0, /dev/rfcomm0, COM5, socket://host:puerto, ...);
                el último usado si no se dice nada; varios para varios robots
  --all         todos los robots que responden, todos a la vez
  --baud N      su velocidad (la del perfil del robot)
  --no-run      lleva el programa y no lo inicia
  --no-save     el robot lo olvida cuando se apaga
  --detach      lo inicia y se va: sigue sin tsc
  --robot R     para qué robot: un nombre (tinibot, ...) o el archivo de un perfil
  --json        imprime el recibo y lo que viene después como líneas de JSON
  --virtual     sin robot: uno virtual se mueve aquí, hasta que el programa termina o Ctrl-C; el
                de tsc robot, si está en marcha en otra terminal. La tecla b es el botón del de
                aquí; si no hay nadie en una terminal, se pulsa enseguida
Con --virtual:
  --world W     su mundo: obstacles, line, light, o un archivo (obstacles)
  --plot F.png  dibuja el mundo y el camino cuando termina
  --for S       termina después de tantos segundos del tiempo del robot
  --hurry N     N veces más rápido; max: lo más rápido que esta computadora pueda
  --seed N, --noise X, --motors I,D, --faults X, --sensor NOMBRE=1,2,3    como en tsc robot --help
Código de salida: 0 si termina, 1 con errores o una falla, 2 después de Ctrl-C, 3 si el robot o
la conexión lo terminó.
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("upload", language, HELP)
    parser.takes_program()
    takes_ports(parser)
    takes_world(parser)
    for name in ("--no-run", "--no-save", "--detach", "--json"):
        parser.add_argument(name, action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    given = inputs.program(options)
    robot = inputs.robot(options, language)
    is_many = are_many(options)
    # the robot that answers may be another one than the default
    is_open = options.robot is None and not is_many and not given.is_image
    ready = _ready(given, robot, options, is_open)
    if ready is None:
        return 1
    if is_many:
        _keep_map(ready)
        from tiniscript.cli.robot.fleet_upload import upload_to_many

        return upload_to_many(options, robot, language, ready, inputs.shown(given.name))
    with Connection(options, robot, language) as connection:
        if connection.company is not None and options.detach:
            raise Trouble(2, "virtual_and_detach")
        if ready.image.start == "PING":  # a program that asks who is there
            from tiniscript.cli.commands.ping import ping

            return ping(connection, options.json)
        connection.meet()
        is_kit_wrong = ready.image.kit and connection.card.kit != robot.kit.fingerprint
        if is_open and is_kit_wrong and own_kit.take(connection, options):
            ready = images.ready(given, connection.profile, language, is_strict=True)
            if ready is None:
                return 1
        try:
            return _upload(connection, ready, inputs.shown(given.name), options)
        except KeyboardInterrupt:
            return stop_and_say(connection)


def _ready(
    given: inputs.Input, robot: Robot, options: Namespace, is_open: bool
) -> images.Ready | None:  # fmt: skip
    """Return the program, or None where its mistakes have just been printed.

    One with words of another robot is compiled for the robot that answers, if there is one.
    """
    language: str = options.language
    if not is_open:
        return images.ready(given, robot, language, is_strict=True)
    try:
        return images.ready(given, robot, language, is_strict=True, is_open=True)
    except images.OtherRobot as other:
        found = own_kit.of_answering(options, robot, language)
        if found is not None:
            return images.ready(given, found, language, is_strict=True)
        outputs.print_problems(other.compiled, language)
        return None


def _upload(
    connection: Connection, ready: images.Ready, name: str, options: Namespace
) -> int:  # fmt: skip
    from tiniscript.cli.terminal.progress import Progress

    language = connection.language
    progress = Progress(language, len(ready.image.code))
    try:
        values = brought(connection, ready, options, progress.draw)
    finally:
        progress.end()
    teller = connection.teller(options.json, ready.places)
    saving = Saving(connection, teller, values)
    try:
        if options.json:
            print(json.dumps(receipt(connection, ready, name, values, options)), flush=True)
        else:
            print(_receipt_line(connection, ready, name, values, options), flush=True)
        _keep_map(ready)  # now that it moves
        return looked_after(connection, ready, saving, options, teller)
    except KeyboardInterrupt:
        code = stop_and_say(connection)
        try:
            saving.wait()  # now that its motors stand, it is not long
        except Trouble as trouble:
            print(trouble.sentence(language), file=sys.stderr)
        return code
    except OSError:  # nobody reads any more what tsc prints
        if connection.stop_unseen():
            saving.wait_unseen()
        raise


def _keep_map(ready: images.Ready) -> None:
    """Let other commands know which instruction comes from which line."""
    if ready.places is not None:
        from tiniscript.bytecode.image import pack
        from tiniscript.codegen import source_map

        image = ready.image
        source_map.remember(pack(image.start, image.kit, image.code), ready.places)


def brought(
    connection: Connection, ready: images.Ready, options: Namespace, draw: Callable[[int], None]
) -> dict[str, int]:
    """Bring a program to the robot; return what it says of it. `draw` is given the bytes of code
    that have arrived. Raises Trouble."""

    def make(session: Asks) -> Asked:
        return session.upload(ready.image, not options.no_run, not options.no_save, options.detach)

    task = connection.do(make)
    reply = connection.wait(task, lambda: draw(task.done_bytes))
    if reply.status:
        raise _trouble(connection, reply, ready)
    return {key: value for key, value in reply.values.items() if isinstance(value, int)}


def looked_after(
    connection: Connection, ready: images.Ready, saving: Saving, options: Namespace,
    teller: Teller,
) -> int:  # fmt: skip
    """Stay with a program until it has ended and is saved; return the exit code. Raises Trouble."""
    code = 0
    if is_running(ready, options):
        if options.detach:
            return 0
        if connection.company is not None:
            connection.company.watch()
        code = Attendant(connection, teller, look=saving.look).attend(saving.run)
    elif has_button(connection, ready, options):
        from tiniscript.cli.robot.button_run import attend_button

        code = attend_button(connection, teller, saving)
    saving.wait()
    return code


def is_running(ready: images.Ready, options: Namespace) -> bool:
    """Whether a program runs once it has arrived."""
    return ready.image.start == "SI" and not options.no_run


def has_button(connection: Connection, ready: images.Ready, options: Namespace) -> bool:
    """Whether the button of a virtual robot that is here for this command starts the program."""
    return connection.company is not None and ready.image.start == "SB" and not options.no_run


def _trouble(connection: Connection, reply: Reply, ready: images.Ready) -> Trouble:
    from tiniscript.link.messages import STATUSES
    from tiniscript.link.outcomes import LOST

    port = inputs.shown(connection.port)
    if reply.status == STATUSES["TOO_LARGE"]:
        code, room = len(ready.image.code), reply.detail
        return Trouble(1, "too_large_by", code=str(code), over=str(code - room), room=str(room))
    if reply.status == LOST:
        return Trouble(3, "upload_lost", port=port)
    return connection.trouble(reply)


def receipt(
    connection: Connection, ready: images.Ready, name: str, values: dict[str, int],
    options: Namespace,
) -> dict[str, object]:  # fmt: skip
    """Return what has arrived and what becomes of it, as data."""
    image, runs, saved = ready.image, is_running(ready, options), saved_name(values)
    return {
        "event": "RECEIPT",
        "robot": connection.card.name,
        "port": connection.port,
        "program": name,
        "image_bytes": ready.image_bytes,
        "code_bytes": len(image.code),
        "checksum": f"{values['program']:08x}",
        "saved": saved,
        "slot": values["slot"] if saved == "STORED" else None,
        "start": image.start,
        "is_running": runs,
        "is_detached": runs and bool(options.detach),
        "is_pushed": has_button(connection, ready, options),  # who reads JSON has no key for it
    }


def _receipt_line(
    connection: Connection, ready: images.Ready, name: str, values: dict[str, int],
    options: Namespace,
) -> str:  # fmt: skip
    language = connection.language
    how = "how_waits"
    if is_running(ready, options):
        how = "how_detached" if options.detach else "how_running"
    elif has_button(connection, ready, options):
        from tiniscript.cli.robot.button_run import has_keys

        how = "how_key" if has_keys(connection) else "how_pushed"
    return text("receipt", language).format(
        program=name,
        robot=connection.name,
        port=inputs.shown(connection.port),
        image=ready.image_bytes,
        code=len(ready.image.code),
        checksum=f"{values['program']:08x}",
        saved=text(f"saved_{saved_name(values)}", language).format(slot=values["slot"]),
        how=text(how, language).format(start=ready.image.start),
    )


def saved_name(values: dict[str, int]) -> str:
    """Return where the robot has its program, by the name of `link.messages`."""
    from tiniscript.link.messages import SAVED

    return SAVED[values["saved"]][0] if values["saved"] < len(SAVED) else "MEMORY"
