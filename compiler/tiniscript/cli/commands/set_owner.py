"""`tsc set owner`: the robot gets an owner, when its button is held down."""

from __future__ import annotations

import sys
from argparse import Namespace

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection, connect
from tiniscript.link.authority import NOT_OWNER, OWNED_BY_OTHER, ownership_of
from tiniscript.link.connection import CLAIM_TIMEOUT_MS
from tiniscript.link.keys import KeyFile
from tiniscript.link.messages import KEY_OWNER, KEY_TEACHER, OWNERS, STATUSES
from tiniscript.link.outcomes import UNKEPT
from tiniscript.link.requests import Reply


def run(options: Namespace, language: str) -> int:
    with connect(options, language) as connection:
        connection.meet()
        _check_claimable(connection)
        key_kind = KEY_TEACHER if options.teacher else KEY_OWNER
        _claim(connection, key_kind)
    return 0


def _claim(connection: Connection, key_kind: int) -> None:
    request = connection.connection.begin(lambda session: session.claim(key_kind))
    # Printed once the robot is asked: a press that has already lasted 2 s does not count.
    sentence = connection.text("claim_hold", seconds=CLAIM_TIMEOUT_MS // 1000)
    print(sentence, file=sys.stderr, flush=True)
    reply = connection.wait(request)
    if reply.status == UNKEPT:
        raise CommandError(2, "unkept_key", file=printable_name(str(KeyFile().path)))
    if reply.status in (STATUSES["SAVING"], STATUSES["LOW_SUPPLY"]):
        key = "claim_saving"
    elif reply.status:
        raise connection.error_for_reply(reply)
    else:
        key = "claimed" if key_kind == KEY_OWNER else "claimed_teacher"
    connection.print_text(key)


def _check_claimable(connection: Connection) -> None:
    """Print the reasons that a button cannot change. Raises CommandError."""
    device_info = connection.device_info
    if not device_info.values.features & OWNERS:
        raise CommandError(3, "no_owners", robot=connection.name)
    if ownership_of(device_info) == OWNED_BY_OTHER and not KeyFile().keys_of_robot(device_info.id):
        raise connection.error_for_reply(Reply(NOT_OWNER))
