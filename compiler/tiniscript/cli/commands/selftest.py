"""`tsc doctor --selftest`: whether a robot is ready for a lesson, as far as a computer can see."""

from __future__ import annotations

import json
import platform
from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path

from tiniscript import robots
from tiniscript.base.version import __version__
from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.self_test import OK, OPEN, WRONG, Found, SelfTest
from tiniscript.cli.texts import say, text
from tiniscript.doctor import report


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    port, name = options.port, ""
    try:
        connection = Connection(options, robot, language)
    except CommandError as failure:
        if options.report is None or failure.exit_code != 3:
            raise
        found = [Found("answers", WRONG, "self_plain", "then_doctor",
                       {"said": failure.sentence(language)})]  # fmt: skip
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


def _print(found: list[Found], name: str, port: str | None, is_json: bool, language: str) -> None:
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


def _fields(found: Found, language: str) -> dict[str, object]:
    """Return it as data."""
    return {
        "what": found.what,
        "verdict": found.verdict,
        "finding": found.key.removeprefix("self_").removeprefix("doctor_"),
        "values": dict(found.values),
        "said": _said(found.key, found.values, language),
        "next": _said(found.then, found.values, language) if found.then else None,
    }


def _rows(found: list[Found], language: str) -> list[str]:
    rows = []
    for each in found:
        what = _said(f"self_{each.what}", each.values, language)
        said = _said(each.key, each.values, language)
        mark = text(f"selftest_{each.verdict}", language)
        rows.append(text("selftest_row", language).format(mark=mark, what=what, said=said))
        if each.then:
            then = _said(each.then, each.values, language)
            rows.append(text("selftest_next", language).format(then=then))
    return rows


def _said(key: str, values: Mapping[str, str], language: str) -> str:
    return text(key, language).format(**values)


def _report(found: list[Found], name: str, port: str, language: str) -> list[str]:
    """Return the lines of a report: nothing in it tells whose robot or computer it is."""
    hidden = [(each, report.port(port)) for each in (port, shown(port)) if port]
    if name and name not in robots.names():  # a shipped one's says what it is, not whose
        hidden.append((name, report.HIDDEN))

    def without_names(row: str) -> str:
        for private, public in hidden:
            row = row.replace(private, public)
        return row

    kind = report.port(port) if port else "-"
    head = [report.SELFTEST_MARK, text("selftest_about", language), ""]
    head += [f"tsc: {__version__}, Python {platform.python_version()}"]
    head += [f"system: {platform.system()}", f"port: {kind}", ""]
    return [*head, *map(without_names, _rows(found, language))]
