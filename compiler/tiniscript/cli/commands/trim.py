"""`tsc trim`: how a robot's motors are wired, and how strong each is; the robot keeps it."""

from __future__ import annotations

import json
from argparse import Namespace
from typing import Any

from tiniscript.cli.inputs import shown
from tiniscript.cli.options import whole_number
from tiniscript.cli.robot.connect import Connection, connected
from tiniscript.cli.robot.trim_wizard import guided
from tiniscript.cli.texts.common import text
from tiniscript.link.messages import MOST_BALANCE, MOST_LEAST
from tiniscript.link.trim import Trim, told


def run(options: Namespace, language: str) -> int:
    given = _given(options, language)
    with connected(options, language) as connection:
        connection.meet()
        before = told(connection.ask(lambda session: session.trim()).values)
        if options.show:
            _print(connection, "trim_tells", before, options.json)
            return 0
        if options.reset or given:
            trim = (Trim() if options.reset else before)._replace(**given)
        else:
            trim = guided(connection, before)
        # This trim may be set already; the status OK means that it is saved.
        connection.ask(lambda session: session.trim(trim.data()))
        _print(connection, "trim_keeps", trim, options.json)
    return 0


def _given(options: Namespace, language: str) -> dict[str, Any]:
    """Return the fields of a trim that the options set."""
    found: dict[str, Any] = {}
    for option, name in (
        ("exchange", "is_exchanged"),
        ("reverse_left", "is_left_reversed"),
        ("reverse_right", "is_right_reversed"),
    ):
        word: str | None = getattr(options, option)
        if word is not None:
            found[name] = word == "yes"
    if options.balance is not None:
        found["balance"] = whole_number(
            "--balance", options.balance, 0, -MOST_BALANCE, MOST_BALANCE, language
        )
    if options.least is not None:
        found["least"] = whole_number("--least", options.least, 0, 0, MOST_LEAST, language)
    return found


def _print(connection: Connection, key: str, trim: Trim, is_json: bool) -> None:
    if is_json:
        print(json.dumps({"robot": connection.device_info.name, "port": connection.port,
                          **trim._asdict()}))  # fmt: skip
        return
    said = text(key, connection.language).format(
        robot=connection.name, port=shown(connection.port), trim=words(trim, connection.language)
    )
    print(said)


def words(trim: Trim, language: str) -> str:
    """Return a trim in words."""
    found = [
        text(key, language)
        for key, is_so in (
            ("trim_exchanged", trim.is_exchanged),
            ("trim_left_reversed", trim.is_left_reversed),
            ("trim_right_reversed", trim.is_right_reversed),
        )
        if is_so
    ] or [text("trim_as_wired", language)]
    key = "trim_left_weaker" if trim.balance > 0 else "trim_right_weaker"
    balance = key if trim.balance else "trim_even"
    found.append(text(balance, language).format(n=abs(trim.balance)))
    if trim.least:
        found.append(text("trim_least", language).format(n=trim.least))
    return ", ".join(found)
