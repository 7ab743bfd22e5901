"""`tsc upload` to many robots: sends the program to each, and follows it until it ends there."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from functools import partial

from tiniscript.cli import images
from tiniscript.cli.images import Ready
from tiniscript.cli.robot import program_upload
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.description import measure_line
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.fleet import run_together
from tiniscript.cli.robot.member import Member, Result
from tiniscript.cli.robot.run_monitor import Saving
from tiniscript.cli.terminal.progress import MOST_PERCENT
from tiniscript.cli.texts import text
from tiniscript.robots.profile import Robot


def upload_to_many(
    options: Namespace, robot: Robot, language: str, ready: Ready, name: str
) -> int:  # fmt: skip
    """Send a program to many robots, keep its source map; return the exit code."""
    images.keep_map(ready)
    is_ping = ready.image.start == "PING"  # a program that asks who is there
    work = measure_line if is_ping else partial(_upload, options, ready, name)
    return run_together(options, robot, language, work)


def _upload(
    options: Namespace, ready: Ready, name: str, connection: Connection, member: Member
) -> Result:
    language = connection.language
    whole = max(1, len(ready.image.code))
    member.meet(connection)

    def draw(done: int) -> None:
        member.tell("crew_sending", percent=min(100 * done // whole, MOST_PERCENT))

    draw(0)
    values = program_upload.send_program(connection, ready, options, draw)
    receipt = program_upload.receipt(connection, ready, name, values, options)
    if options.json:
        member.print(json.dumps(receipt))
    runs = program_upload.is_running(ready, options)
    member.tell("crew_running" if runs and not options.detach else "crew_saving")
    printer = MemberPrinter(connection, ready, member, options.json, values.program)
    saving = Saving(connection, printer, values)
    exit_code = program_upload.follow_run(connection, ready, saving, options, printer)
    if not runs or options.detach:
        key = "how_waits" if not runs else "how_detached"
        printer.end = text(key, language).format(start=ready.image.start)
    sentence = printer.end
    if options.verbose:
        sentence = text("crew_uploaded", language).format(
            checksum=receipt["checksum"], code=receipt["code_bytes"], how=sentence
        )
    return Result(exit_code == 0, sentence, {"checksum": receipt["checksum"]})


class MemberPrinter(EventPrinter):
    """Prints the events of one of many robots. `end` is the end of its program, in one line."""

    def __init__(
        self, connection: Connection, ready: Ready, member: Member, is_json: bool, program: int
    ) -> None:
        about = {"port": connection.port}
        super().__init__(connection.language, is_json, places=ready.places, about=about,
                         out=member.print, program=program)  # fmt: skip
        self.member = member
        self.end = ""

    def say(
        self, since_ms: int, name: str, what: str, said: str = "", cell: str = "", /,
        is_bad: bool = False, **fields: object,
    ) -> None:  # fmt: skip
        line = said or f"{name} {what}"
        if name == "SHOW":
            self.member.value = line
        elif name != "SAVED":
            self.end = "  ".join(item.strip() for item in line.splitlines())
        if self.is_json:
            super().say(since_ms, name, what, said, cell, is_bad=is_bad, **fields)
        elif name == "SHOW" and not sys.stderr.isatty():  # there is no table
            self.out(f"{self.member.name} ({self.member.target.port}): {line}")
