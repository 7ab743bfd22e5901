"""`tsc trim`: how a robot's motors are wired, and how strong each is; the robot keeps it."""

from __future__ import annotations

import json
from argparse import Namespace
from typing import Any

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options, whole_number
from tiniscript.cli.robot.connect import Connection, connected, takes_robot
from tiniscript.cli.texts.common import text
from tiniscript.link.messages import MOST_BALANCE, MOST_LEAST
from tiniscript.link.trim import Trim, told

HELP = (
    """\
tsc trim [--port P] [--show] [--reset]
         [--exchange yes|no] [--reverse-left yes|no] [--reverse-right yes|no]
         [--balance N] [--least N] [--json]

Makes a robot drive straight: turns its motors, asks what you see, and the robot keeps what
follows from it in its own memory, whatever program it runs. No wire is changed and nothing flashed.
  --show               only prints what the robot keeps
  --reset              motors as they are wired, both equally strong
  --exchange yes       left and right motor are the wrong way round
  --reverse-left yes   the left wheel turns backward; --reverse-right likewise
  --balance N          the left wheel gets N % less; with -N the right one does (up to 40)
  --least N            the percent of power from which on the wheels move (0 to 40)
  --json               prints what the robot keeps as data
  --port P, --baud N   as for tsc upload
""",
    """\
tsc trim [--port P] [--show] [--reset]
         [--exchange yes|no] [--reverse-left yes|no] [--reverse-right yes|no]
         [--balance N] [--least N] [--json]

Hace que un robot vaya derecho: gira sus motores, pregunta qué ves, y el robot guarda lo que
resulta en su propia memoria, con cualquier programa. No se cambia ningún cable ni se graba nada.
  --show               solo imprime lo que guarda el robot
  --reset              motores como están conectados, los dos con igual fuerza
  --exchange yes       el motor izquierdo y el derecho están al revés
  --reverse-left yes   la rueda izquierda gira hacia atrás; --reverse-right igual
  --balance N          la rueda izquierda recibe N % menos; con -N, la derecha (hasta 40)
  --least N            el porcentaje de potencia desde el que se mueven las ruedas (0 a 40)
  --json               imprime lo que guarda el robot como datos
  --port P, --baud N   como en tsc upload
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("trim", language, HELP)
    takes_robot(parser)
    for name in ("--show", "--reset", "--json"):
        parser.add_argument(name, action="store_true")
    for name in ("--exchange", "--reverse-left", "--reverse-right", "--balance", "--least"):
        parser.add_argument(name)
    options = parser.read(arguments)
    if options is None:
        return 0
    given = _given(options, language)
    with connected(options, language) as connection:
        connection.meet()
        before = told(connection.ask(lambda session: session.trim()).values)
        if options.show:
            _print(connection, "trim_tells", before, options.json)
            return 0
        if options.reset or given:
            trim = (Trim() if options.reset else before)._replace(**given)
        else:
            from tiniscript.cli.robot.trim_wizard import guided

            trim = guided(connection, before)
        # The one that may have been set already: OK says that it is kept.
        connection.ask(lambda session: session.trim(trim.data()))
        _print(connection, "trim_keeps", trim, options.json)
    return 0


def _given(options: Namespace, language: str) -> dict[str, Any]:
    """Return what the options set of a trim."""
    found: dict[str, Any] = {}
    for option, name in (
        ("exchange", "is_exchanged"),
        ("reverse_left", "is_left_reversed"),
        ("reverse_right", "is_right_reversed"),
    ):
        word: str | None = getattr(options, option)
        if word is not None:
            if word not in ("yes", "no"):
                shown_option = "--" + option.replace("_", "-")
                raise Trouble(2, "trim_yes_no", option=shown_option, found=shown(word) or "''")
            found[name] = word == "yes"
    if options.balance is not None:
        found["balance"] = whole_number(
            "--balance", options.balance, 0, -MOST_BALANCE, MOST_BALANCE, language
        )
    if options.least is not None:
        found["least"] = whole_number("--least", options.least, 0, 0, MOST_LEAST, language)
    return found


def _print(connection: Connection, key: str, trim: Trim, is_json: bool) -> None:
    if is_json:
        print(json.dumps({"robot": connection.card.name, "port": connection.port,
                          **trim._asdict()}))  # fmt: skip
        return
    said = text(key, connection.language).format(
        robot=connection.name, port=shown(connection.port), trim=words(trim, connection.language)
    )
    print(said)


def words(trim: Trim, language: str) -> str:
    """Return what a trim means."""
    found = [
        text(key, language)
        for key, is_so in (
            ("trim_exchanged", trim.is_exchanged),
            ("trim_left_reversed", trim.is_left_reversed),
            ("trim_right_reversed", trim.is_right_reversed),
        )
        if is_so
    ] or [text("trim_as_wired", language)]
    key = "trim_left_weaker" if trim.balance > 0 else "trim_right_weaker"
    balance = key if trim.balance else "trim_even"
    found.append(text(balance, language).format(n=abs(trim.balance)))
    if trim.least:
        found.append(text("trim_least", language).format(n=trim.least))
    return ", ".join(found)
