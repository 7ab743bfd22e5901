"""`tsc set trim`: how a robot's motors are wired, how strong each is and how fast it goes.

The robot keeps it.
"""

from __future__ import annotations

import json
from argparse import Namespace
from typing import Any

from tiniscript.base.fixed_point import ONE
from tiniscript.cli.errors import CommandError
from tiniscript.cli.options import thousandths, whole_number
from tiniscript.cli.robot.connect import Connection, connect
from tiniscript.cli.robot.description import trim_in_words
from tiniscript.cli.robot.trim_wizard import guide
from tiniscript.link.messages import MAX_BALANCE, MAX_LEAST
from tiniscript.link.trim import MAX_PACE, Pace, Trim, trim_from_reply


def run(options: Namespace, language: str) -> int:
    typed_values = _trim_options(options, language)
    with connect(options, language) as connection:
        connection.meet()
        old_trim = trim_from_reply(connection.request(lambda session: session.trim()).values)
        if options.show:
            _print(connection, "trim_tells", old_trim, options.json)
            return 0
        if options.reset or typed_values:
            trim = _change_trim(old_trim, typed_values, options.reset)
        else:
            trim = guide(connection, old_trim)
        # This trim may be set already; the status OK means that it is saved.
        connection.request(lambda session: session.trim(trim.data()))
        _print(connection, "trim_keeps", trim, options.json)
    return 0


def _change_trim(old_trim: Trim, typed_values: dict[str, Any], is_reset: bool) -> Trim:
    """Return a trim changed by the options."""
    paces = {name: typed_values.pop(name) for name in Pace._fields if name in typed_values}
    if paces and old_trim.pace is None:
        raise CommandError(1, "trim_no_pace")
    if old_trim.pace is not None:
        pace = (Pace() if is_reset else old_trim.pace)._replace(**paces)
        if not pace.rises:
            raise CommandError(2, "trim_not_faster")
        typed_values["pace"] = pace
    return (Trim() if is_reset else old_trim)._replace(**typed_values)


def _trim_options(options: Namespace, language: str) -> dict[str, Any]:
    """Return the fields of a trim that the options set."""
    fields: dict[str, Any] = {}
    for option, name in (
        ("exchange", "is_exchanged"),
        ("reverse_left", "is_left_reversed"),
        ("reverse_right", "is_right_reversed"),
    ):
        word: str | None = getattr(options, option)
        if word is not None:
            fields[name] = word == "yes"
    if options.balance is not None:
        fields["balance"] = whole_number(
            "--balance", options.balance, 0, -MAX_BALANCE, MAX_BALANCE, language
        )
    for name in Pace._fields:
        text: str | None = getattr(options, name)
        if text is not None:
            option, most_thousandths = f"--{name.replace('_', '-')}", round(MAX_PACE * ONE)
            size = thousandths(option, text.replace(",", "."), 0, 0, most_thousandths, language)
            fields[name] = size / ONE
    if options.least is not None:
        fields["least"] = whole_number("--least", options.least, 0, 0, MAX_LEAST, language)
    return fields


def _print(connection: Connection, key: str, trim: Trim, is_json: bool) -> None:
    if is_json:
        print(json.dumps({"robot": connection.device_info.name, "port": connection.port,
                          **trim.as_data()}))  # fmt: skip
        return
    connection.print_text(key, trim=trim_in_words(trim, connection.language))
