"""`tsc monitor`: what the robot shows, while it does what it does."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, TextIO

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options, whole_number
from tiniscript.cli.robot.connect import Connection, connected, takes_robot
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.cli.robot.event_printer import Teller
    from tiniscript.cli.terminal.plot import Board

HELP = (
    """\
tsc monitor [--port P] [--plot] [--csv FILE] [--json] [--max-time S]

Prints what the robot tells, each with the milliseconds since the first: values of SHOW, how a
program ends, faults with their lines. Starts and stops nothing; Ctrl-C leaves. (Opening the
port of an Arduino with a cable resets it: then nothing runs before its button is pressed.)
  --port P      the robot's port; the last used one where nothing is said
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     the virtual robot of tsc robot, which runs in another terminal
  --plot        on a terminal: draws the values of the last 30 seconds as a curve
  --csv FILE    writes rows of ms,event,value, too
  --json        prints lines of JSON
  --max-time S  leaves after so many seconds
""",
    """\
tsc monitor [--port P] [--plot] [--csv ARCHIVO] [--json] [--max-time S]

Imprime lo que el robot cuenta, cada cosa con los milisegundos desde la primera: valores de SHOW,
cómo termina un programa, fallas con sus líneas. No inicia ni detiene nada; Ctrl-C sale. (Abrir
el puerto de un Arduino con cable lo reinicia: nada se mueve antes de pulsar su botón.)
  --port P      el puerto del robot; el último usado si no se dice nada
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     el robot virtual de tsc robot, que está en marcha en otra terminal
  --plot        en una terminal: dibuja los valores de los últimos 30 segundos como una curva
  --csv ARCHIVO escribe además filas de ms,event,value
  --json        imprime líneas de JSON
  --max-time S  sale después de tantos segundos
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("monitor", language, HELP)
    takes_robot(parser)
    parser.add_argument("--plot", action="store_true")
    parser.add_argument("--csv")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--max-time")
    options = parser.read(arguments)
    if options is None:
        return 0
    seconds = whole_number("--max-time", options.max_time, 0, 1, 10**6, language)
    rows: TextIO | None = None
    from tiniscript.cli.robot.event_printer import Teller

    try:
        with connected(options, language) as connection:
            connection.meet()
            if options.csv is not None:  # where no robot answers, the last rows stay
                rows = _rows(options.csv)
            said = {"robot": connection.name, "port": shown(connection.port)}
            print(text("watching", language).format(**said), file=sys.stderr)
            if options.plot and sys.stderr.isatty():
                from tiniscript.cli.terminal.plot import Board

                with Board() as board:
                    teller = Teller(language, options.json, has_times=True, rows=rows,
                                    out=board.say, err=board.warn)  # fmt: skip
                    _watch(connection, teller, seconds, board)
            else:
                teller = Teller(language, options.json, has_times=True, rows=rows)
                _watch(connection, teller, seconds)
    except KeyboardInterrupt:  # that is how a person leaves
        print(file=sys.stderr)
    finally:
        if rows is not None:
            _close(rows)
    return 0


def _watch(
    connection: Connection, teller: Teller, seconds: int, board: Board | None = None
) -> None:
    from tiniscript.cli.robot.event_printer import Bookkeeping
    from tiniscript.link.outcomes import Gone

    bookkeeping = Bookkeeping()
    end_s = monotonic() + seconds if seconds else None
    try:
        while end_s is None or monotonic() < end_s:
            if board is not None:
                board.draw(int(monotonic() * 1000))
            found = connection.line.event()
            if found is None or bookkeeping.hides(found[1]):
                continue
            if board is not None:
                board.take(*found)
            if found[1].name == "LOST":
                raise Trouble(3, "link_lost", port=shown(connection.port))
            teller.tell(*found)
    except Gone as gone:
        raise connection.gone(gone) from None


def _rows(name: str) -> TextIO:
    try:
        rows = Path(name).open("w", encoding="utf-8", newline="\n")  # noqa: SIM115
        rows.write("ms,event,value\n")
        rows.flush()
    except (OSError, ValueError) as why:
        reason = why.strerror if isinstance(why, OSError) and why.strerror else str(why)
        raise Trouble(2, "unwritable_rows", file=shown(name), why=reason) from None
    return rows


def _close(rows: TextIO) -> None:
    with suppress(OSError):  # what did not fit has been said
        rows.close()
