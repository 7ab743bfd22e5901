"""A program on its way to a robot: sends it, follows its run, and says what became of it."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from tiniscript.cli import images, inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.connect import Connection, told
from tiniscript.cli.robot.run_monitor import RunMonitor, Saving
from tiniscript.link.messages import SAVED, STATUSES
from tiniscript.link.outcomes import LOST
from tiniscript.link.payloads import ReceiptReply

if TYPE_CHECKING:
    from collections.abc import Callable

    from tiniscript.cli.robot.event_printer import EventPrinter
    from tiniscript.link.requests import Reply


def send_program(
    connection: Connection, ready: images.Ready, options: Namespace, draw: Callable[[int], None]
) -> ReceiptReply:
    """Send a program to the robot; return its receipt. `draw` gets the number of code bytes that
    have arrived. Raises CommandError."""
    with told():
        reply = connection.client.send_program(
            ready.image, connection.profile, not options.no_run, not options.no_save,
            options.detach, draw,
        )  # fmt: skip
    if reply.status:
        raise _failure(connection, reply, ready)
    return reply.values


def follow_run(
    connection: Connection, ready: images.Ready, saving: Saving, options: Namespace,
    printer: EventPrinter,
) -> int:  # fmt: skip
    """Follow a program until it has ended and is saved; return the exit code.

    Raises CommandError.
    """
    code = 0
    if is_running(ready, options):
        if options.detach:
            return 0
        if connection.simulator is not None:
            connection.simulator.watch()
        code = RunMonitor(connection, printer, look=saving.look).follow(saving.run)
    elif has_button(connection, ready, options):
        from tiniscript.cli.robot.button_run import follow_button

        code = follow_button(connection, printer, saving)
    saving.wait()
    return code


def is_running(ready: images.Ready, options: Namespace) -> bool:
    """Whether a program runs once it has arrived."""
    return ready.image.start == "SI" and not options.no_run


def has_button(connection: Connection, ready: images.Ready, options: Namespace) -> bool:
    """Whether the program waits for the button of this command's own virtual robot."""
    return connection.simulator is not None and ready.image.start == "SB" and not options.no_run


def _failure(connection: Connection, reply: Reply[object], ready: images.Ready) -> CommandError:
    port = inputs.shown(connection.port)
    if reply.status == STATUSES["TOO_LARGE"]:
        code, room = len(ready.image.code), reply.detail
        return CommandError(
            1, "too_large_by", code=str(code), over=str(code - room), room=str(room)
        )
    if reply.status == LOST:
        return CommandError(3, "upload_lost", port=port)
    return connection.failure(reply)


def receipt(
    connection: Connection, ready: images.Ready, name: str, values: ReceiptReply,
    options: Namespace,
) -> dict[str, object]:  # fmt: skip
    """Return the result of the upload as data."""
    image, runs, saved = ready.image, is_running(ready, options), saved_name(values)
    return {
        "event": "RECEIPT",
        "robot": connection.device_info.name,
        "port": connection.port,
        "program": name,
        "image_bytes": ready.image_bytes,
        "code_bytes": len(image.code),
        "checksum": f"{values.program:08x}",
        "saved": saved,
        "slot": values.slot if saved == "STORED" else None,
        "start": image.start,
        "is_running": runs,
        "is_detached": runs and bool(options.detach),
        "is_pushed": has_button(connection, ready, options),  # JSON output has no keys
    }


def saved_name(values: ReceiptReply) -> str:
    """Return the place of the robot's program, as named in `link.messages`."""
    return SAVED[values.saved][0] if values.saved < len(SAVED) else "MEMORY"
