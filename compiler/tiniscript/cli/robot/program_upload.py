"""A program on its way to a robot: sends it, follows its run, and reports the result.

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
    HaltableProgram,
    breakpoint_offsets,
    parse_lines,
    require_breakpoints,
)
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.run_monitor import DONE, RunMonitor, Saving, exit_code_of
from tiniscript.cli.terminal.keys import Keys, is_in_front
from tiniscript.cli.texts import text
from tiniscript.library.compiling import compile_text, used_fingerprint
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
    breakpoints: tuple[int, ...] = ()
    if options.breaks:
        breakpoints = breakpoint_offsets(
            parse_lines(options.breaks, connection.language), _haltable_program(ready_program)
        )
        require_breakpoints(connection)
    starts_program = not options.no_run and not breakpoints
    reply = connection.send_program(
        ready_program.image, starts_program, not options.no_save, options.detach, draw_progress
    )
    if reply.status:
        raise _upload_error(connection, reply, ready_program)
    if breakpoints:  # the program starts with the breakpoints set
        connection.request(lambda session: session.break_at(breakpoints))
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
            connection.simulator.start_drawing()
        if options.breaks:
            exit_code = _follow_halts(connection, ready_program, saving, printer)
        else:
            exit_code = RunMonitor(connection, printer, on_wait=saving.poll).follow(saving.run)
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
    """Follow a program with breakpoints."""
    with Debugger(connection, printer, _haltable_program(ready_program)) as debugger:

        def on_wait() -> None:
            saving.poll()
            debugger.poll_keys()

        return RunMonitor(connection, printer, debugger.hold_event, on_wait).follow(saving.run)


def _haltable_program(ready_program: images.ReadyProgram) -> HaltableProgram:
    if ready_program.program_map is None:
        raise CommandError(2, "break_image")
    return HaltableProgram(ready_program.image.code, ready_program.program_map)


def is_running(ready_program: images.ReadyProgram, options: Namespace) -> bool:
    """Return whether a program starts once it is uploaded."""
    return ready_program.image.start == "SI" and not options.no_run


def has_button(
    connection: Connection, ready_program: images.ReadyProgram, options: Namespace
) -> bool:
    """Return whether the program waits for the button of this command's own virtual robot."""
    return (
        connection.simulator is not None
        and ready_program.image.start == "SB"
        and not options.no_run
    )


def _upload_error(
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
    return connection.error_for_reply(reply)


def receipt_fields(
    connection: Connection,
    ready_program: images.ReadyProgram,
    name: str,
    receipt_reply: ReceiptReply,
    options: Namespace,
) -> dict[str, object]:
    """Return the result of the upload as data."""
    image, starts_program, saved_state = (
        ready_program.image,
        is_running(ready_program, options),
        saved_name(receipt_reply.saved),
    )
    return {
        "event": "RECEIPT",
        "robot": connection.device_info.name,
        "port": connection.port,
        "program": name,
        "image_bytes": ready_program.image_bytes,
        "code_bytes": len(image.code),
        "checksum": f"{receipt_reply.program:08x}",
        "saved": saved_state,
        "slot": receipt_reply.slot if saved_state == "STORED" else None,
        "start": image.start,
        "is_running": starts_program,
        "is_detached": starts_program and bool(options.detach),
        "is_pushed": has_button(connection, ready_program, options),  # JSON output has no keys
    }


def follow_line(
    connection: Connection, line: str, printer: EventPrinter, hold: Callable[[Event], bool]
) -> int:
    """Execute a correct line on the robot, and follow it; return the exit code.

    Raises CommandError.
    """
    compilation = compile_text(f"SI|{line}", connection.profile.kit)
    kit = used_fingerprint(compilation, connection.profile)
    run = connection.request(lambda session: session.live(compilation.code, kit)).values.run
    return RunMonitor(connection, printer, hold).follow(run)


PUSH_KEYS = "bB "  # the keys that `tsc robot` has, too
QUIT_KEYS = "qQ\x04"


def has_keys(connection: Connection) -> bool:
    """Return whether the robot is drawn on a terminal with keys."""
    simulator = connection.simulator
    return simulator is not None and simulator.is_drawn and sys.stdin.isatty() and is_in_front()


def follow_button(connection: Connection, printer: EventPrinter, saving: Saving) -> int:
    """Stay until a program has ended by itself; return the exit code.

    The button also stops the program and starts it again. Raises CommandError if the link ends.
    """
    simulator = connection.simulator
    assert simulator is not None
    has_person = has_keys(connection)
    simulator.start_drawing(text("button_keys", connection.language) if has_person else "")
    if not has_person:
        simulator.push()
    with Keys() as keys:
        while True:
            for key in keys.read_keys() if has_person else "":
                if key in QUIT_KEYS:
                    return DONE
                if key in PUSH_KEYS:
                    simulator.push()
            timed_event = connection.event()
            saving.poll()
            if connection.is_time_over:
                return RunMonitor(connection, printer).stop_in_time()
            if timed_event is None:
                continue
            _check_event(connection, timed_event[1], saving.program)
            if timed_event[1].name != "STARTED":
                printer.print_event(*timed_event)
            exit_code = exit_code_of(timed_event[1], None)
            if exit_code is not None and not (has_person and _is_push(timed_event[1])):
                return exit_code


def _check_event(connection: Connection, event: Event, program: int) -> None:
    """Raise CommandError if the robot is lost or has another program."""
    if event.name == "LOST":
        raise CommandError(3, "link_lost", port=printable_name(connection.port))
    if event.name == "STARTED" and event.program != program:
        raise CommandError(3, "replaced", port=printable_name(connection.port))


def _is_push(event: Event) -> bool:
    """Return whether the button has stopped the program."""
    return event.name == "STOPPED" and cause_name(event.cause) == "BUTTON"
