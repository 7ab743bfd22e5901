"""`tsc set name`: the robot gets another name."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import name_bytes
from tiniscript.cli.robot.connect import connect
from tiniscript.link.requests import ACCEPTING_STATUSES


def run(options: Namespace, language: str) -> int:
    if options.name is None:
        raise CommandError(2, "no_name")
    name: str = options.name
    data = name_bytes(name)
    with connect(options, language) as connection:
        connection.meet()
        reply = connection.request(lambda session: session.name(data), ACCEPTING_STATUSES)
        connection.remember(name)
        if reply.status:  # the name is set, but may not be saved
            raise connection.error_for_reply(reply)
        connection.print_text("named", name=printable_name(name))
    return 0
