"""The doctor as commands use it: its input from outside, and from a robot that answers.

`tsc doctor`, the fleet, the self-test and the module's set-up use it if no robot answers.
"""

from __future__ import annotations

import os
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tiniscript.cli import inputs
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection, baud_of
from tiniscript.cli.terminal.asking import can_ask, confirm
from tiniscript.cli.terminal.progress import StatusLine
from tiniscript.cli.texts import text
from tiniscript.doctor.diagnosis import Diagnosis, DoctorServices, Question, diagnose
from tiniscript.doctor.examination import PING_COUNT, Expectations, RobotAnswers, examine
from tiniscript.doctor.findings import Finding
from tiniscript.doctor.robot import SharedRobot
from tiniscript.doctor.system import System
from tiniscript.library import opening
from tiniscript.library.known_kits import robot_name_of_kit
from tiniscript.link import ports
from tiniscript.link.authority import has_to_seal, is_impostor
from tiniscript.link.connection import LinkConnection
from tiniscript.link.keys import KeyFile
from tiniscript.link.messages import OWNED, SEALS
from tiniscript.link.outcomes import LOST
from tiniscript.link.payloads import HelloReply
from tiniscript.link.port_names import canonical_port
from tiniscript.link.requests import Reply, device_info_of
from tiniscript.link.sharing.shared_connection import join
from tiniscript.link.wire import Wire
from tiniscript.virtual import directory


def diagnosis_of(
    options: Namespace, port: str | None, expectations: Expectations, language: str,
    watch_ms: int = 0, may_open: bool = False,
) -> Diagnosis:  # fmt: skip
    """Diagnose a port, or the only port, and print the progress.

    `may_open`: the port of a cable may be opened without asking.
    """
    robot = inputs.robot(options, language)
    question = Question(
        port,
        opening.usable_last_port(),
        baud_of(options, robot, language),
        expectations,
        int.from_bytes(os.urandom(4), "little"),
        watch_ms,
        tuple(running_robot.address for running_robot in directory.unclaimed_robots()),
    )
    status_line = StatusLine(not options.json)
    try:
        return diagnose(
            _make_services(options, language, status_line, expectations.ping_count, may_open),
            question,
        )
    finally:
        status_line.end()


def expectations_of(
    options: Namespace, language: str, ping_count: int = PING_COUNT
) -> Expectations:
    """Return the robot that the options name, and this computer's knowledge of all robots."""
    robot = inputs.robot(options, language)
    kit = None if options.robot is None else robot.kit.fingerprint
    return Expectations(
        kit, robot.name, robot_name_of_kit, _has_key, _doubt_cause, ping_count=ping_count
    )


def examination_of(
    connection: Connection, expectations: Expectations,
    on_step: Callable[[str], None] = lambda step: None,
) -> tuple[list[Finding], RobotAnswers | None]:  # fmt: skip
    """Examine a robot that has answered; return the findings and its answers."""
    robot = SharedRobot(connection.connection, connection.wait)
    reply = robot.hello()
    if reply is None:
        raise connection.error_for_reply(Reply(LOST))
    answers: list[RobotAnswers] = []
    findings = examine(
        robot, reply, expectations._replace(on_answers=answers.append), on_step=on_step
    )
    return findings, answers[-1] if answers else None


def _has_key(robot_id: int) -> bool:
    return bool(KeyFile().keys_of_robot(robot_id))


def _doubt_cause(port: str, hello: HelloReply) -> str:
    """Return the cause why this may be another robot than the one of a key of this computer."""
    keys, info = KeyFile(serves_virtual_robots=opening.is_virtual(port)), device_info_of(hello)
    if is_impostor(keys, canonical_port(port), info):
        return "other_robot"
    is_proven = hello.features & (OWNED | SEALS) == (OWNED | SEALS)
    return "unproven" if has_to_seal(keys, info) and not is_proven else ""


def _make_services(
    options: Namespace, language: str, status_line: StatusLine, ping_count: int, is_agreed: bool
) -> DoctorServices:
    def open_wire(port: str, baud: int) -> Wire:
        return Wire(ports.open_port(port, baud))

    def confirm_opening(port: str) -> bool:
        if options.yes or is_agreed:
            return True
        if options.json or not can_ask():
            return False
        status_line.end()
        return confirm(text("doctor_yes", language).format(port=printable_name(port)))

    @contextmanager
    def share_port(port: str) -> Iterator[LinkConnection]:
        connection_options = Namespace(verb="doctor", port=port, baud=options.baud, virtual=False)
        with Connection(
            connection_options, inputs.robot(options, language), language
        ) as connection:
            connection.meet()
            yield connection.connection

    return DoctorServices(
        System(),
        open_wire,
        lambda port: join(port, "doctor"),
        confirm_opening,
        ports.is_radio,
        share_port,
        lambda step: status_line.show(text(f"doing_{step}", language).format(n=ping_count)),
    )
