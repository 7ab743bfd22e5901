"""`tsc doctor --selftest`: whether a robot is ready for a lesson, as far as a computer can see."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from pathlib import Path

from tiniscript import robots
from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.diagnosing import diagnosis_of, expectations_of
from tiniscript.cli.robot.self_test import SelfTest
from tiniscript.cli.texts import say, text
from tiniscript.cli.texts.causes import as_data, finding_lines
from tiniscript.doctor import report
from tiniscript.doctor.examination import Expectations
from tiniscript.doctor.findings import CAUSES, OK, OPEN, WRONG, Finding, sure_finding
from tiniscript.library import opening


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    expectations = expectations_of(options, language)
    port, name = options.port or opening.usable_last_port(), ""
    try:
        with Connection(options, robot, language) as connection:
            port = connection.port
            try:
                connection.meet()
                findings = SelfTest(connection, expectations, not options.yes).run()
            except CommandError:  # nothing was started, because no robot answered
                raise
            except BaseException:  # Ctrl-C, too: the motors may turn
                connection.stop()
                raise
            name = connection.name
    except CommandError as error:
        if error.exit_code != 3 or options.virtual:
            raise
        findings = _without_robot(options, port, expectations, error, language)
    _print(findings, name, port, options.json, language)
    if options.report is not None:
        data = ("\n".join(_report(findings, name, port or "", language)) + "\n").encode()
        outputs.write(Path(options.report), data, "unwritable_at --report")
        if not options.json:
            say("selftest_report", language, file=printable_name(options.report))
    return 3 if any(finding.verdict == WRONG for finding in findings) else 0


def _without_robot(
    options: Namespace, port: str | None, expectations: Expectations, error: CommandError,
    language: str,
) -> list[Finding]:  # fmt: skip
    """Return the doctor's findings when no robot has answered.

    It may open the port that was to be opened, and no other one.
    """
    may_open = port is not None
    findings = diagnosis_of(options, port, expectations, language, may_open=may_open).findings
    wrong_findings = [finding for finding in findings if finding.is_wrong]
    if not wrong_findings:  # the robot has answered by now
        return [sure_finding("plain", said=error.sentence(language))]
    return [finding._replace(part_name=finding.part or "answers") for finding in wrong_findings]


def _print(
    findings: list[Finding], name: str, port: str | None, is_json: bool, language: str
) -> None:
    if is_json:
        fields = [
            {"what": finding.part, "verdict": finding.verdict, **as_data(finding, language)}
            for finding in findings
        ]
        print(json.dumps({"robot": name, "port": port, "found": fields}, indent=2))
        return
    if name:
        say("selftest_head", language, robot=name, port=printable_name(port or ""))
    print("\n".join(finding_lines(findings, language)))
    counts = {
        verdict: sum(row.verdict == verdict for row in findings) for verdict in (OK, WRONG, OPEN)
    }
    good_count, wrong_count, open_count = counts[OK], counts[WRONG], counts[OPEN]
    say(
        "selftest_end",
        language,
        good=good_count,
        all=len(findings),
        wrong=wrong_count,
        open=open_count,
    )


def _report(findings: list[Finding], name: str, port: str, language: str) -> list[str]:
    """Return the lines of a report: it does not identify the owner or the computer."""
    hidden_names = [
        (item, report.redacted_port(port)) for item in (port, printable_name(port)) if port
    ]
    if name and name not in robots.names():  # the description of a shipped robot is not personal
        hidden_names.append((name, report.HIDDEN))

    def without_names(row: str) -> str:
        for private_name, public_name in hidden_names:
            row = row.replace(private_name, public_name)
        return row

    head = report.head(report.SELFTEST_MARK, text("selftest_about", language),
                       [("system", sys.platform)], port)  # fmt: skip
    private_findings = [
        finding
        if CAUSES[finding.cause].part
        else finding._replace(values=report.values_of(finding))
        for finding in findings  # findings without a part concern the computer and its port
    ]
    return [*head, "", *map(without_names, finding_lines(private_findings, language))]
