"""`tsc upload` to many robots: sends the program to each, and follows it until it ends there."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from functools import partial

from tiniscript.cli import images
from tiniscript.cli.images import ReadyProgram
from tiniscript.cli.robot import program_upload
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.description import describe_and_measure
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.fleet import run_together
from tiniscript.cli.robot.member import Member, Result
from tiniscript.cli.robot.run_monitor import Saving
from tiniscript.cli.terminal.progress import MAX_PERCENT
from tiniscript.cli.texts import text
from tiniscript.robots.profile import Robot


def upload_to_many(
    options: Namespace, robot: Robot, language: str, ready_program: ReadyProgram, name: str
) -> int:  # fmt: skip
    """Send a program to many robots, keep its source map; return the exit code."""
    images.keep_map(ready_program)
    is_ping = ready_program.image.start == "PING"  # a program that reads PING
    work = describe_and_measure if is_ping else partial(_upload, options, ready_program, name)
    return run_together(options, robot, language, work)


def _upload(
    options: Namespace,
    ready_program: ReadyProgram,
    name: str,
    connection: Connection,
    member: Member,
) -> Result:
    language = connection.language
    code_bytes = max(1, len(ready_program.image.code))
    member.meet_robot(connection)

    def draw_progress(done_bytes: int) -> None:
        member.set_state("crew_sending", percent=min(100 * done_bytes // code_bytes, MAX_PERCENT))

    draw_progress(0)
    receipt_reply = program_upload.send_program(connection, ready_program, options, draw_progress)
    receipt = program_upload.receipt_fields(connection, ready_program, name, receipt_reply, options)
    if options.json:
        member.queue_line(json.dumps(receipt))
    starts_program = program_upload.is_running(ready_program, options)
    member.set_state("crew_running" if starts_program and not options.detach else "crew_saving")
    printer = MemberPrinter(connection, ready_program, member, options.json, receipt_reply.program)
    saving = Saving(connection, printer, receipt_reply)
    exit_code = program_upload.follow_run(connection, ready_program, saving, options, printer)
    if not starts_program or options.detach:
        key = "how_waits" if not starts_program else "how_detached"
        printer.end_text = text(key, language).format(start=ready_program.image.start)
    sentence = printer.end_text
    if options.verbose:
        sentence = text("crew_uploaded", language).format(
            checksum=receipt["checksum"], code=receipt["code_bytes"], how=sentence
        )
    return Result(exit_code == 0, sentence, {"checksum": receipt["checksum"]})


class MemberPrinter(EventPrinter):
    """Prints the events of one of many robots. `end_text` is the end of its program, in one
    line."""

    def __init__(
        self,
        connection: Connection,
        ready_program: ReadyProgram,
        member: Member,
        is_json: bool,
        checksum: int,
    ) -> None:
        super().__init__(
            connection.language,
            is_json,
            program_map=ready_program.program_map,
            robot_fields={"port": connection.port},
            print_line=member.queue_line,
            checksum=checksum,
        )
        self.member = member
        self.end_text = ""

    def print_values(
        self, since_ms: int, name: str, shown_value: str, sentence: str = "", cell: str = "", /,
        is_bad: bool = False, **fields: object,
    ) -> None:  # fmt: skip
        line = sentence or f"{name} {shown_value}"
        if name == "SHOW":
            self.member.value = line
        elif name != "SAVED":
            self.end_text = "  ".join(part.strip() for part in line.splitlines())
        if self.is_json:
            super().print_values(
                since_ms, name, shown_value, sentence, cell, is_bad=is_bad, **fields
            )
        elif name == "SHOW" and not sys.stderr.isatty():  # without a table, values are printed
            self.print_line(f"{self.member.name} ({self.member.target.port}): {line}")
