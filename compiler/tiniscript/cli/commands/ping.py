"""`tsc ping`: whether the robot is there, and how long an answer takes."""

from __future__ import annotations

import json
from argparse import Namespace
from statistics import median
from time import perf_counter

from tiniscript.cli import inputs
from tiniscript.cli.commands.info import Description
from tiniscript.cli.options import whole_number
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.fleet import Work, together
from tiniscript.cli.robot.member import Member, Result, are_many
from tiniscript.cli.texts import text

COUNT = 10


def run(options: Namespace, language: str) -> int:
    count = whole_number("--count", options.count, COUNT, 1, 10_000, language)
    robot = inputs.robot(options, language)
    if are_many(options):
        return together(options, robot, language, one_of_many(count))
    with Connection(options, robot, language) as connection:
        return ping(connection, options.json, count)


def ping(connection: Connection, is_json: bool, count: int = COUNT) -> int:
    """Measure round trips and print them, below the robot's description."""
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
    """Measure round trips; return the result as a sentence and as data."""
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
    """Return the function that pings each of many robots."""

    def work(connection: Connection, member: Member) -> Result:
        member.meet(connection)
        member.tell("crew_pinging")
        return Result(True, *_measured(connection, count))

    return work
