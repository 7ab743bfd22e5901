"""`tsc set text`: whether lines of text may drive a robot that has an owner."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.connect import connect
from tiniscript.link.messages import OWNED


def run(options: Namespace, language: str) -> int:
    if options.whether is None:
        raise CommandError(2, "on_or_off")
    is_allowed = options.whether == "on"
    with connect(options, language) as connection:
        info = connection.meet()
        connection.request_or_raise(
            lambda session: session.allow_text(is_allowed), "text_none", "BAD_VALUE"
        )
        key = "text_on" if is_allowed else "text_off"
        if not info.values.features & OWNED:
            key = "text_free"
        connection.print_text(key)
    return 0
