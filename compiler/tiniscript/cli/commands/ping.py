"""`tsc ping`: whether the robot is there, and how long an answer takes."""

from __future__ import annotations

import json
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING

from tiniscript.cli import inputs
from tiniscript.cli.options import Options, whole_number
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.targets import are_many, takes_ports
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.cli.robot.fleet import Member, Result, Work

HELP = (
    """\
tsc ping [--port P ...] [--all] [--count N] [--json]

Says who answers on the port, and how long a round trip takes: at least, in the middle, at most.
  --port P      the robot's port; the last used one where nothing is said; several for several
  --all         every robot that answers, a line each
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     the virtual robot of tsc robot, which runs in another terminal
  --count N     so many round trips (10)
""",
    """\
tsc ping [--port P ...] [--all] [--count N] [--json]

Dice quién responde en el puerto, y cuánto tarda una ida y vuelta: mínimo, medio y máximo.
  --port P      el puerto del robot; el último usado si no se dice nada; varios para varios
  --all         todos los robots que responden, una línea por cada uno
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     el robot virtual de tsc robot, que está en marcha en otra terminal
  --count N     tantas idas y vueltas (10)
""",
)

COUNT = 10


def run(arguments: list[str], language: str) -> int:
    parser = Options("ping", language, HELP)
    takes_ports(parser)
    parser.add_argument("--robot")
    parser.add_argument("--count")
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    count = whole_number("--count", options.count, COUNT, 1, 10_000, language)
    robot = inputs.robot(options, language)
    if are_many(options):
        from tiniscript.cli.robot.fleet import together

        return together(options, robot, language, one_of_many(count))
    with Connection(options, robot, language) as connection:
        return ping(connection, options.json, count)


def ping(connection: Connection, is_json: bool, count: int = COUNT) -> int:
    """Measure round trips and print them, below the robot's description."""
    from tiniscript.cli.commands.info import Description

    connection.meet()
    said, times = _measured(connection, count)
    description = Description(connection)
    if is_json:
        print(json.dumps({**description.fields(), **times}, indent=2))
    else:
        print(description.text())
        print(said)
    return 0


def _measured(connection: Connection, count: int) -> tuple[str, dict[str, object]]:
    """Measure round trips; return what there is to say of them, as a sentence and as data."""
    trips = []
    for _ in range(count):
        begin_s = perf_counter()
        connection.ask(lambda session: session.ping())
        trips.append((perf_counter() - begin_s) * 1000)
    numbers = {"least": min(trips), "median": median(trips), "most": max(trips)}
    times = {f"{name}_ms": round(each, 1) for name, each in numbers.items()}
    shown = {name: f"{each:.1f}" for name, each in numbers.items()}
    said = text("ping", connection.language).format(n=count, **shown)
    return said, {"round_trips": count, **times}


def one_of_many(count: int) -> Work:
    """Return what is done with each of many robots."""
    from tiniscript.cli.robot.fleet import Result

    def work(connection: Connection, member: Member) -> Result:
        member.meet(connection)
        member.tell("crew_pinging")
        return Result(True, *_measured(connection, count))

    return work
