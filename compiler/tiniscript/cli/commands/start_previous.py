"""`tsc start --previous`: the robot holds the program before again."""

from __future__ import annotations

import json
from argparse import Namespace
from typing import ClassVar

from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter, printer_of
from tiniscript.cli.robot.fleet import run_together
from tiniscript.cli.robot.member import Member, Result, select_port
from tiniscript.cli.robot.run_monitor import Saving
from tiniscript.library import source_map
from tiniscript.link.names import saved_name
from tiniscript.link.payloads import ReceiptReply


class UndoSaving(Saving):
    """Waits until the robot has saved its choice: until then, the undone program is not lost."""

    KEY_BY_REASON: ClassVar = {"saves_later": "undo_later", "low_supply": "undo_low_supply",
                      "not_saved": "undo_not_saved"}  # fmt: skip


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    if select_port(options):
        return run_together(options, robot, language, _undo_member)
    with Connection(options, robot, language) as connection:
        connection.meet()
        receipt = UndoReceipt(connection)
        print(json.dumps(receipt.fields()) if options.json else receipt.text(), flush=True)
        try:
            UndoSaving(connection, printer_of(connection, options.json), receipt.values).wait()
            return 0
        except CommandError as error:
            if error.key == "plain":
                raise
    # the command that held the port has ended, as its program has
    with Connection(options, robot, language) as connection:
        connection.meet()
        status = connection.request(lambda session: session.status()).values
        if status.program != receipt.values.program:
            raise CommandError(3, "undo_lost", port=printable_name(connection.port))
        UndoSaving(connection, printer_of(connection, options.json), receipt.values).wait()
    return 0


def _undo_member(connection: Connection, member: Member) -> Result:
    member.meet_robot(connection)
    receipt = UndoReceipt(connection)
    member.set_state("crew_saving")
    printer = EventPrinter(connection.language, False, print_line=lambda line: None)
    UndoSaving(connection, printer, receipt.values).wait()
    return Result(True, receipt.line(), receipt.program_fields())


class UndoReceipt:
    """The receipt of UNDO."""

    def __init__(self, connection: Connection) -> None:
        self.connection = connection
        self.values: ReceiptReply = connection.request(lambda session: session.undo()).values
        program_map = source_map.recall(self.values.program)
        self.program = None if program_map is None else program_map.name

    def program_fields(self) -> dict[str, object]:
        """Return the restored program as data. `program`: its file, if known."""
        return {"checksum": f"{self.values.program:08x}", "program": self.program}

    def fields(self) -> dict[str, object]:
        """Return the receipt as data."""
        saved_text = saved_name(self.values.saved)
        return {
            "event": "RECEIPT",
            "robot": self.connection.device_info.name,
            "port": self.connection.port,
            **self.program_fields(),
            "saved": saved_text,
            "slot": self.values.slot if saved_text == "STORED" else None,
        }

    def line(self) -> str:
        """Return the restored program as one line."""
        name = f" ({printable_name(self.program)})" if self.program is not None else ""
        checksum = f"{self.values.program:08x}"
        return self.connection.text("undone_line", checksum=checksum, name=name)

    def text(self) -> str:
        """Return the receipt as lines."""
        return self.connection.text("undone", line=self.line())
