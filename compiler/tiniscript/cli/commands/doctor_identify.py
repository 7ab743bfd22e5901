"""`tsc doctor --identify`: a robot blinks and plays its tune, so that all see which one it is."""

from __future__ import annotations

import json
from argparse import Namespace

from tiniscript.cli import inputs
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.fleet import run_together
from tiniscript.cli.robot.member import Member, Result, select_port


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    if select_port(options):
        return run_together(options, robot, language, _identify_member)
    with Connection(options, robot, language) as connection:
        connection.meet()
        text = _identify(connection)
        print(json.dumps(_fields(connection)) if options.json else text)
    return 0


def _identify(connection: Connection) -> str:
    connection.request(lambda session: session.identify())
    return connection.text("identified")


def _fields(connection: Connection) -> dict[str, object]:
    info = connection.device_info
    return {"port": connection.port, "robot": info.name, "id": f"{info.id:08x}", "is_done": True}


def _identify_member(connection: Connection, member: Member) -> Result:
    member.meet_robot(connection)
    member.set_state("crew_identifying")
    return Result(True, _identify(connection), {"id": f"{connection.device_info.id:08x}"})
