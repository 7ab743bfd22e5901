"""`tsc stop`: stops the robot now, even if something else is wrong."""

from __future__ import annotations

import json
from argparse import Namespace

from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.member import select_port
from tiniscript.cli.robot.stopping import hold_back, may_be_opened, stop_one
from tiniscript.cli.texts import say


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    acts_on_many = select_port(options)
    if not acts_on_many and options.port is None:
        from tiniscript.cli.robot import in_reach

        options.ports = in_reach.ports_to_stop(options.virtual)
        options.virtual = options.virtual and not options.ports
        acts_on_many = select_port(options)
    if acts_on_many:
        from tiniscript.cli.robot.fleet import run_together

        return run_together(options, robot, language, stop_one)
    while True:
        with Connection(options, robot, language) as connection:
            port = connection.port
            if connection.stop():
                if options.teacher:
                    hold_back(connection)
                if options.json:
                    print(json.dumps({"port": port, "is_done": True}))
                else:
                    key = "held_back" if options.teacher else "stopped_on"
                    say(key, language, port=printable_name(port))
                return 0
            if not may_be_opened(connection):
                raise CommandError(3, "not_confirmed", port=printable_name(port))
        options.port = port
