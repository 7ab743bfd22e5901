"""`tsc set owner --give-up`: the owner gives a robot up."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli.robot.connect import connect
from tiniscript.link.messages import KEY_OWNER, KEY_TEACHER, OWNED


def run(options: Namespace, language: str) -> int:
    key_kind = KEY_TEACHER if options.teacher else KEY_OWNER
    with connect(options, language) as connection:
        info = connection.meet()
        if key_kind == KEY_OWNER and not info.values.features & OWNED:
            connection.print_text("not_owned")
            return 0
        connection.request(lambda session: session.disown(key_kind))
        connection.print_text("disowned" if key_kind == KEY_OWNER else "disowned_teacher")
    return 0
