"""`tsc check`: all mistakes and warnings, no output file."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from tiniscript.cli import inputs, outputs
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.robots.profile import Robot


def run(options: Namespace, language: str) -> int:
    given = inputs.program(options)
    robot = inputs.robot(options, language)
    if options.port is not None or options.virtual:
        robot = _of_port(options, robot, language)
    compiled = inputs.compiled(given, robot, is_strict=False)
    compiled = inputs.for_level(compiled, robot, options.text_level)
    if options.json:
        import json

        from tiniscript.diagnostics.rendering import as_json, message

        said = [
            message(diagnostic, compiled.source, language) for diagnostic in compiled.diagnostics
        ]
        print(json.dumps(as_json(said), indent=2))
    else:
        outputs.print_diagnostics(compiled, language)
        if compiled.is_right:
            print(text("no_mistakes", language).format(file=inputs.shown(given.name)))
    return 0 if compiled.is_right else 1


def _of_port(options: Namespace, robot: Robot, language: str) -> Robot:
    """Return the profile of the robot on a port, if it is known and `--robot` is not given."""
    from tiniscript.cli.robot import own_kit
    from tiniscript.cli.robot.connect import Connection

    with Connection(options, robot, language) as connection:
        connection.meet()
        own_kit.take(connection, options)
        return connection.profile
