"""`tsc doctor`: prints the doctor's findings, the robot's description, and the ports.

Findings also go into a report that may be sent.
"""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import whole_number
from tiniscript.cli.robot.connect import Connection, remember_profile
from tiniscript.cli.robot.description import (
    Description,
    trips_as_data,
    trips_in_words,
)
from tiniscript.cli.robot.diagnosing import diagnosis_of, examination_of, expectations_of
from tiniscript.cli.robot.fleet import run_together
from tiniscript.cli.robot.member import Member, Result, select_port
from tiniscript.cli.robot.port_rows import lines as lines_of_ports
from tiniscript.cli.robot.port_rows import list_rows
from tiniscript.cli.robot.simulator import running_address
from tiniscript.cli.texts import Sentence, text
from tiniscript.cli.texts.causes import as_data, sentences_of
from tiniscript.doctor import report
from tiniscript.doctor.diagnosis import Diagnosis
from tiniscript.doctor.examination import PING_COUNT, Expectations, RobotAnswers
from tiniscript.doctor.findings import OPEN
from tiniscript.library import opening
from tiniscript.link.authority import ownership_of
from tiniscript.link.messages import RESETS
from tiniscript.link.requests import device_info_of
from tiniscript.link.trim import trim_from_reply

LONGEST_WATCH_S = 600
BLANK_FIELD = "____"
# The steps of a bring-up: `step_` is the name, `do_` the action, `see_` the expected result.
FORM_STEPS = ("answers", "boot", "drive", "stop", "typed", "cable", "upload", "power", "bluetooth",
         "wifi", "supply")  # fmt: skip


def run(options: Namespace, language: str) -> int:
    count = whole_number("--count", options.count, PING_COUNT, 1, 10_000, language)
    expectations = expectations_of(options, language, count)
    if select_port(options):
        if options.report is not None or options.watch is not None:
            raise CommandError(2, "doctor_one")
        work = partial(_examine_member, expectations)
        return run_together(options, inputs.robot(options, language), language, work)
    robot_facts: dict[str, str] = {}  # the robot's description of itself
    answers: list[RobotAnswers] = []
    watch_s = whole_number("--watch", options.watch, 0, 0, LONGEST_WATCH_S, language)
    expectations = expectations._replace(on_facts=robot_facts.update, on_answers=answers.append)
    diagnosis = diagnosis_of(options, _port(options), expectations, language, watch_s * 1000)
    description = _description(diagnosis.port or "", answers[-1], language) if answers else None
    if description is not None:
        opening.remember(description.port, description.device_info.name)
        remember_profile(options, inputs.robot(options, language), description.device_info.kit)
    rows = list_rows(language)
    if options.json:
        fields = {**_fields(diagnosis, language), "ports": rows, "robot": None}
        if description is not None:
            fields["robot"] = {**description.fields(), **trips_as_data([*answers[-1].trips_ms])}
        print(json.dumps(fields, indent=2))
    else:
        lines = _lines(diagnosis, language)
        if description is not None:
            lines += ["", description.text()]
            if answers[-1].trips_ms:
                lines.append(trips_in_words([*answers[-1].trips_ms], language))
        lines += ["", text("doctor_ports", language), *lines_of_ports(rows, language)]
        print(Sentence("\n".join(lines)), flush=True)
    if options.report is not None:
        data = "\n".join(_report(diagnosis, robot_facts, language)) + "\n"
        outputs.write(Path(options.report), data.encode(), "unwritable_at --report")
        sentence = text("doctor_report", language).format(file=printable_name(options.report))
        print(sentence, file=sys.stderr if options.json else sys.stdout)
    is_fine = not any(finding.is_wrong for finding in diagnosis.findings)
    return 0 if is_fine else 3


def _port(options: Namespace) -> str | None:
    port: str | None = options.port
    if options.virtual:
        if port is not None:
            raise CommandError(2, "virtual_and_port")
        port = running_address(options)
    return None if port is None else inputs.check_port(port)


def _examine_member(expectations: Expectations, connection: Connection, member: Member) -> Result:
    """Examine one of many robots as if it were the only one."""
    member.meet_robot(connection)
    language = connection.language
    findings, answers = examination_of(
        connection,
        expectations,
        lambda step: member.set_state(f"doing_{step}", n=expectations.ping_count),
    )
    wrong_findings = [finding for finding in findings if finding.is_wrong]
    rows, fields = [sentences_of(finding, language).finding for finding in wrong_findings], {}
    if answers is not None:
        description, trips_ms = (
            _description(connection.port, answers, language),
            [*answers.trips_ms],
        )
        rows.append(description.line())
        if trips_ms:
            rows.append(trips_in_words(trips_ms, language))
        fields = {**description.fields(), **trips_as_data(trips_ms)}
    fields["findings"] = [as_data(finding, language) for finding in findings]
    return Result(not wrong_findings, "; ".join(rows), fields)


def _description(port: str, answers: RobotAnswers, language: str) -> Description:
    """Return a robot's description of itself, based on its answers."""
    info = device_info_of(answers.hello)
    trim = None if answers.trim is None else trim_from_reply(answers.trim)
    return Description(port, info, answers.status, trim, ownership_of(info), language)


def _rows(diagnosis: Diagnosis, language: str, is_private: bool) -> list[str]:
    """Return the findings as lines; `is_private`: as a report may have them."""
    rows = []
    for number, finding in enumerate(diagnosis.findings, 1):
        values = report.values_of(finding) if is_private else None
        meaning, evidence, advice = sentences_of(finding, language, values)
        certainty_key = "doctor_sure" if finding.is_sure else "doctor_probably"
        if finding.verdict == OPEN:
            certainty_key = "doctor_note"
        rows += [
            text("doctor_finding", language).format(
                number=str(number), what=meaning, how=text(certainty_key, language)
            ),
            text("doctor_seen", language).format(seen=evidence),
            text("doctor_next", language).format(next=advice),
        ]
    return rows


def _lines(diagnosis: Diagnosis, language: str) -> list[str]:
    head = []
    if diagnosis.port is not None:
        head = [text("doctor_port", language).format(port=printable_name(diagnosis.port))]
    return head + _rows(diagnosis, language, is_private=False)


def _form(robot_facts: Mapping[str, str], language: str) -> list[str]:
    """Return the form of a bring-up, filled as far as a computer can."""
    facts = dict(robot_facts)
    if facts.get("reset") in dict(RESETS):
        facts["reset"] = text(f"reset_{facts['reset']}", language)
    rows = [text("bring_up_about", language), text("bring_up_person", language)]
    rows.append(text("bring_up_robot", language).format(**facts) if facts
                else text("bring_up_no_robot", language))  # fmt: skip
    for number, step in enumerate(FORM_STEPS, 1):
        answers_text = BLANK_FIELD
        if step == "answers" and "good" in facts:
            answers_text = text("bring_up_answers", language).format(**facts)
        rows.append(f"{number}. {text(f'step_{step}', language)}: {answers_text}")
        instruction, expectation = (text(f"{kind}_{step}", language) for kind in ("do", "see"))
        rows.append(text("bring_up_step", language).format(do=instruction, see=expectation))
    return rows


def _report(diagnosis: Diagnosis, robot_facts: Mapping[str, str], language: str) -> list[str]:
    """Return the lines of a report."""
    rows = report.head(report.REPORT_MARK, text("report_about", language),
                       report.facts(diagnosis.computer), diagnosis.port)  # fmt: skip
    rows += [
        f"{finding.cause} {'sure' if finding.is_sure else 'probably'}"
        for finding in diagnosis.findings
    ]
    return [
        *rows,
        "",
        *_rows(diagnosis, language, is_private=True),
        "",
        *_form(robot_facts, language),
    ]


def _fields(diagnosis: Diagnosis, language: str) -> dict[str, object]:
    """Return the diagnosis as data."""
    return {
        "port": diagnosis.port,
        "is_opened": diagnosis.is_opened,
        "bluetooth": diagnosis.computer.bluetooth,
        "findings": [as_data(finding, language) for finding in diagnosis.findings],
    }
