"""`tsc doctor --selftest`: whether a robot is ready for a lesson, as far as a computer can see."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from pathlib import Path

from tiniscript import robots
from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.self_test import SelfTest
from tiniscript.cli.texts import say, text
from tiniscript.cli.texts.causes import label, said
from tiniscript.doctor import report
from tiniscript.doctor.findings import OK, OPEN, WRONG, Finding, sure


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    port, name = options.port, ""
    try:
        connection = Connection(options, robot, language)
    except CommandError as failure:
        if options.report is None or failure.exit_code != 3:
            raise
        found = [sure("plain", said=failure.sentence(language))]
    else:
        with connection:
            port = connection.port
            try:
                test = SelfTest(connection, options.robot is not None, not options.yes)
                found = test.run()
            except BaseException:  # Ctrl-C, too: the motors may turn
                connection.stop()
                raise
            if connection.line.robot is not None:
                name = connection.name
    _print(found, name, port, options.json, language)
    if options.report is not None:
        data = ("\n".join(_report(found, name, port or "", language)) + "\n").encode()
        outputs.write(Path(options.report), data, "unwritable_at --report")
        if not options.json:
            say("selftest_report", language, file=shown(options.report))
    return 3 if any(each.verdict == WRONG for each in found) else 0


def _print(found: list[Finding], name: str, port: str | None, is_json: bool, language: str) -> None:
    if is_json:
        fields = [_fields(each, language) for each in found]
        print(json.dumps({"robot": name, "port": port, "found": fields}, indent=2))
        return
    if name:
        say("selftest_head", language, robot=name, port=shown(port or ""))
    print("\n".join(_rows(found, language)))
    counts = {each: sum(row.verdict == each for row in found) for each in (OK, WRONG, OPEN)}
    good, wrong, left = counts[OK], counts[WRONG], counts[OPEN]
    say("selftest_end", language, good=good, all=len(found), wrong=wrong, open=left)


def _fields(found: Finding, language: str) -> dict[str, object]:
    """Return it as data."""
    what, _, then = said(found, language)
    return {
        "what": found.part,
        "verdict": found.verdict,
        "finding": found.cause,
        "values": dict(found.values),
        "said": what,
        "next": then or None,
    }


def _rows(found: list[Finding], language: str) -> list[str]:
    rows = []
    for each in found:
        what, _, then = said(each, language)
        mark = text(f"selftest_{each.verdict}", language)
        rows.append(
            text("selftest_row", language).format(mark=mark, what=label(each, language), said=what)
        )
        if then:
            rows.append(text("selftest_next", language).format(then=then))
    return rows


def _report(found: list[Finding], name: str, port: str, language: str) -> list[str]:
    """Return the lines of a report: nothing in it tells whose robot or computer it is."""
    hidden = [(each, report.shown_port(port)) for each in (port, shown(port)) if port]
    if name and name not in robots.names():  # a shipped one's says what it is, not whose
        hidden.append((name, report.HIDDEN))

    def without_names(row: str) -> str:
        for private, public in hidden:
            row = row.replace(private, public)
        return row

    head = report.head(report.SELFTEST_MARK, text("selftest_about", language),
                       [("system", sys.platform)], port)  # fmt: skip
    return [*head, "", *map(without_names, _rows(found, language))]
