"""`tsc ping`: whether the robot is there, and how long an answer takes."""

from __future__ import annotations

import json
from statistics import median
from time import perf_counter

from tiniscript.cli.connecting import Connection, connected, takes_robot
from tiniscript.cli.options import Options, whole_number
from tiniscript.cli.texts import text

HELP = (
    """\
tsc ping [--port P] [--count N] [--json]

Says who answers on the port, and how long a round trip takes: at least, in the middle, at most.
  --port P      the robot's port; the last used one where nothing is said
  --baud N      its speed (the one of the profile that --robot NAME|FILE chooses)
  --virtual     the virtual robot of tsc robot, which runs in another terminal
  --count N     so many round trips (10)
""",
    """\
tsc ping [--port P] [--count N] [--json]

Dice quién responde en el puerto, y cuánto tarda una ida y vuelta: mínimo, medio y máximo.
  --port P      el puerto del robot; el último usado si no se dice nada
  --baud N      su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --virtual     el robot virtual de tsc robot, que está en marcha en otra terminal
  --count N     tantas idas y vueltas (10)
""",
)

COUNT = 10


def run(arguments: list[str], language: str) -> int:
    parser = Options("ping", language, HELP)
    takes_robot(parser)
    parser.add_argument("--count")
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    count = whole_number("--count", options.count, COUNT, 1, 10_000, language)
    with connected(options, language) as connection:
        return ping(connection, options.json, count)


def ping(connection: Connection, is_json: bool, count: int = COUNT) -> int:
    """Measure round trips and print them, below the robot's description."""
    from tiniscript.cli.describing import Description

    connection.meet()
    trips = []
    for _ in range(count):
        begin_s = perf_counter()
        connection.ask(lambda session: session.ping())
        trips.append((perf_counter() - begin_s) * 1000)
    numbers = {"least": min(trips), "median": median(trips), "most": max(trips)}
    description = Description(connection)
    if is_json:
        times = {f"{name}_ms": round(each, 1) for name, each in numbers.items()}
        print(json.dumps({**description.fields(), "round_trips": count, **times}, indent=2))
    else:
        print(description.text())
        shown = {name: f"{each:.1f}" for name, each in numbers.items()}
        print(text("ping", connection.language).format(n=count, **shown))
    return 0
