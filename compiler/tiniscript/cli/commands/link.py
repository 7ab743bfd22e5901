"""`tsc link`: holds a port, so that other commands share it, and tells what goes on."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options
from tiniscript.cli.robot.connect import Connection, connected, takes_robot
from tiniscript.cli.robot.event_printer import Bookkeeping, Teller
from tiniscript.cli.texts.common import text
from tiniscript.library import way
from tiniscript.link.requests import OK

if TYPE_CHECKING:
    from tiniscript.link.connection import Asked
    from tiniscript.link.outcomes import Event

HELP = (
    """\
tsc link [--port P] [--json]

Holds the robot's port until Ctrl-C, so that other tsc commands share it: tsc stop works while
another terminal drives, and an upload does not reset the board. Prints what goes on. Where the
robot is lost, it looks for it until it is there again. (live, monitor, and an upload or start
that stays share their port, too.)
  --port P      the robot's port; the last used one where nothing is said
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --json        prints lines of JSON
""",
    """\
tsc link [--port P] [--json]

Tiene el puerto del robot hasta Ctrl-C, para que otros comandos de tsc lo compartan: tsc stop
funciona mientras otra terminal conduce, y un upload no reinicia la placa. Imprime lo que pasa. Si
el robot se pierde, lo busca hasta que vuelve. (live, monitor, y un upload o start que se queda
también comparten su puerto.)
  --port P      el puerto del robot; el último usado si no se dice nada
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --json        imprime líneas de JSON
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("link", language, HELP)
    takes_robot(parser)
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    try:
        with connected(options, language) as connection:
            if connection.line.held_by:
                values = {"port": shown(connection.port), "verb": connection.line.held_by}
                raise Trouble(3, "held_already", **values)
            if connection.host is None:
                raise Trouble(3, "cannot_share", port=shown(connection.port))
            connection.meet()
            _Log(connection, options.json).keep()
    except KeyboardInterrupt:  # that is how a person leaves
        print(file=sys.stderr)
    return 0


class _Log:
    """What goes on on a port, a line each."""

    def __init__(self, connection: Connection, is_json: bool) -> None:
        self.connection = connection
        self.language = connection.language
        self.teller = Teller(connection.language, is_json)
        self.bookkeeping = Bookkeeping()
        self.search: Asked | None = None  # for a robot that was lost

    def keep(self) -> None:
        """Tell what goes on, until the port is gone."""
        from tiniscript.link.outcomes import Gone

        self._say("LINKED", "linked", robot=self.connection.name, port=shown(self.connection.port))
        try:
            while True:
                found = self.connection.line.event()
                if found is not None:
                    self._tell(*found)
                if self.search is not None and self.search.outcome is not None:
                    self._look_again()
        except Gone as gone:
            raise self.connection.gone(gone) from None

    def _tell(self, time_ms: int, event: Event) -> None:
        name, values = event
        if name in ("JOINED", "LEFT"):
            verb = values["verb"]
            assert isinstance(verb, bytes)
            self._say(name, name.lower(), verb=verb.decode())
        elif name == "STARTED":
            program = values["program"]
            assert isinstance(program, int)
            self._say(name, "link_started", program=f"{program:08x}")
        elif name == "LOST":
            self._say(name, "link_searching", port=shown(self.connection.port))
            self.search = way.hello(self.connection.line, way.ANSWER_MS)
        elif not self.bookkeeping.hides(event):
            self.teller.tell(time_ms, event)

    def _look_again(self) -> None:
        assert self.search is not None and self.search.outcome is not None
        if self.search.outcome.status == OK:
            self.search = None
            self._say("FOUND", "link_found", robot=self.connection.name)
        else:
            self.search = way.hello(self.connection.line, way.ANSWER_MS)

    def _say(self, name: str, key: str, **values: str) -> None:
        said = text(key, self.language).format(**values)
        fields: dict[str, object] = {**values}
        self.teller.say(0, name, "", said, is_bad=False, **fields)
