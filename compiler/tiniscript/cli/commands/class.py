"""`tsc class`: lists the robots of a class at an MQTT broker, uploads, stops, or listens to all."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import classroom


def run(options: Namespace, language: str) -> int:
    actions = {
        None: classroom.list_robots,
        "list": classroom.list_robots,
        "upload": classroom.upload,
        "stop": classroom.stop,
        "show": classroom.show,
    }
    if options.action != "upload" and (options.program is not None or options.texts):
        raise CommandError(2, "class_no_upload")
    if options.action != "show" and options.csv is not None:
        raise CommandError(2, "class_no_show")
    return actions[options.action](classroom.Classroom(options, language))
