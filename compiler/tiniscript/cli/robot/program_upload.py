"""A program on its way to a robot: sends it, follows its run, and says what became of it.

The virtual robot of one command has its button on a key; without a terminal the button is pushed
at once.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable

from tiniscript.cli import images, inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.debugger import (
    Debugger,
    Halting,
    lines_of,
    places_of,
    require_breakpoints,
)
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.run_monitor import DONE, RunMonitor, Saving, exit_code_of
from tiniscript.cli.terminal.keys import Keys, is_in_front
from tiniscript.cli.texts import text
from tiniscript.library.compiling import compile_text, kit_of
from tiniscript.link.messages import STATUSES
from tiniscript.link.names import cause_name, saved_name
from tiniscript.link.outcomes import LOST, Event
from tiniscript.link.payloads import ReceiptReply
from tiniscript.link.requests import Reply


def send_program(
    connection: Connection,
    ready_program: images.ReadyProgram,
    options: Namespace,
    draw_progress: Callable[[int], None],
) -> ReceiptReply:
    """Send a program to the robot; return its receipt. `draw_progress` gets the number of code
    bytes that have arrived. Raises CommandError."""
    places: tuple[int, ...] = ()
    if options.breaks:
        places = places_of(lines_of(options.breaks, connection.language), _halting(ready_program))
        require_breakpoints(connection)
    runs = not options.no_run and not places
    reply = connection.send_program(
        ready_program.image, runs, not options.no_save, options.detach, draw_progress
    )
    if reply.status:
        raise _failure(connection, reply, ready_program)
    if places:  # it starts with them
        connection.request(lambda session: session.break_at(places))
        return connection.request(lambda session: session.start()).values
    return reply.values


def follow_run(
    connection: Connection, ready_program: images.ReadyProgram, saving: Saving, options: Namespace,
    printer: EventPrinter,
) -> int:  # fmt: skip
    """Follow a program until it has ended and is saved; return the exit code.

    Raises CommandError.
    """
    exit_code = 0
    if is_running(ready_program, options):
        if options.detach:
            return 0
        if connection.simulator is not None:
            connection.simulator.watch()
        if options.breaks:
            exit_code = _follow_halts(connection, ready_program, saving, printer)
        else:
            exit_code = RunMonitor(connection, printer, on_wait=saving.look).follow(saving.run)
    elif has_button(connection, ready_program, options):
        exit_code = follow_button(connection, printer, saving)
    saving.wait()
    return exit_code


def _follow_halts(
    connection: Connection,
    ready_program: images.ReadyProgram,
    saving: Saving,
    printer: EventPrinter,
) -> int:
    """The same for a program with breakpoints."""
    with Debugger(connection, printer, _halting(ready_program)) as debugger:

        def on_wait() -> None:
            saving.look()
            debugger.look()

        return RunMonitor(connection, printer, debugger.hold, on_wait).follow(saving.run)


def _halting(ready_program: images.ReadyProgram) -> Halting:
    if ready_program.places is None:
        raise CommandError(2, "break_image")
    return Halting(ready_program.image.code, ready_program.places)


def is_running(ready_program: images.ReadyProgram, options: Namespace) -> bool:
    """Whether a program runs once it has arrived."""
    return ready_program.image.start == "SI" and not options.no_run


def has_button(
    connection: Connection, ready_program: images.ReadyProgram, options: Namespace
) -> bool:
    """Whether the program waits for the button of this command's own virtual robot."""
    return (
        connection.simulator is not None
        and ready_program.image.start == "SB"
        and not options.no_run
    )


def _failure(
    connection: Connection, reply: Reply[object], ready_program: images.ReadyProgram
) -> CommandError:
    port = inputs.printable_name(connection.port)
    if reply.status == STATUSES["TOO_LARGE"]:
        code_bytes, room = len(ready_program.image.code), reply.detail
        return CommandError(
            1, "too_large_by", code=str(code_bytes), over=str(code_bytes - room), room=str(room)
        )
    if reply.status == LOST:
        return CommandError(3, "upload_lost", port=port)
    return connection.failure(reply)


def receipt(
    connection: Connection, ready_program: images.ReadyProgram, name: str, values: ReceiptReply,
    options: Namespace,
) -> dict[str, object]:  # fmt: skip
    """Return the result of the upload as data."""
    image, runs, saved = (
        ready_program.image,
        is_running(ready_program, options),
        saved_name(values.saved),
    )
    return {
        "event": "RECEIPT",
        "robot": connection.device_info.name,
        "port": connection.port,
        "program": name,
        "image_bytes": ready_program.image_bytes,
        "code_bytes": len(image.code),
        "checksum": f"{values.program:08x}",
        "saved": saved,
        "slot": values.slot if saved == "STORED" else None,
        "start": image.start,
        "is_running": runs,
        "is_detached": runs and bool(options.detach),
        "is_pushed": has_button(connection, ready_program, options),  # JSON output has no keys
    }


def follow_line(
    connection: Connection, line: str, printer: EventPrinter, hold: Callable[[Event], bool]
) -> int:
    """Let the robot do a right line now, and follow it; return the exit code.

    Raises CommandError.
    """
    compilation = compile_text(f"SI|{line}", connection.profile.kit)
    kit = kit_of(compilation, connection.profile)
    run = connection.request(lambda session: session.live(compilation.code, kit)).values.run
    return RunMonitor(connection, printer, hold).follow(run)


PUSH_KEYS = "bB "  # the keys that `tsc robot` has, too
QUIT_KEYS = "qQ\x04"


def has_keys(connection: Connection) -> bool:
    """Whether the robot is drawn on a terminal with keys."""
    simulator = connection.simulator
    return simulator is not None and simulator.is_drawn and sys.stdin.isatty() and is_in_front()


def follow_button(connection: Connection, printer: EventPrinter, saving: Saving) -> int:
    """Stay until a program has ended by itself; return the exit code.

    The button also stops the program and starts it again. Raises CommandError if the link ends.
    """
    simulator = connection.simulator
    assert simulator is not None
    is_person = has_keys(connection)
    simulator.watch(text("button_keys", connection.language) if is_person else "")
    if not is_person:
        simulator.push()
    with Keys() as keys:
        while True:
            for key in keys.read_pressed() if is_person else "":
                if key in QUIT_KEYS:
                    return DONE
                if key in PUSH_KEYS:
                    simulator.push()
            result = connection.event()
            saving.look()
            if connection.is_time_over:
                return RunMonitor(connection, printer).stop_in_time()
            if result is None:
                continue
            _check_event(connection, result[1], saving.program)
            if result[1].name != "STARTED":
                printer.tell(*result)
            exit_code = exit_code_of(result[1], None)
            if exit_code is not None and not (is_person and _is_push(result[1])):
                return exit_code


def _check_event(connection: Connection, event: Event, program: int) -> None:
    """Raise CommandError if the robot is lost or has another program."""
    if event.name == "LOST":
        raise CommandError(3, "link_lost", port=printable_name(connection.port))
    if event.name == "STARTED" and event.program != program:
        raise CommandError(3, "replaced", port=printable_name(connection.port))


def _is_push(event: Event) -> bool:
    """Whether the button has stopped the program."""
    return event.name == "STOPPED" and cause_name(event.cause) == "BUTTON"
