"""`tsc upload`: sends a program to the robot, starts it, and follows it until it ends."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from time import monotonic

from tiniscript.cli import images, inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import own_kit
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import printer_of
from tiniscript.cli.robot.member import select_port
from tiniscript.cli.robot.program_upload import (
    follow_run,
    has_button,
    has_keys,
    is_running,
    receipt_fields,
    send_program,
)
from tiniscript.cli.robot.run_monitor import Saving, stop_and_say
from tiniscript.cli.terminal.progress import Progress
from tiniscript.cli.texts import say_aside
from tiniscript.link.messages import READINGS
from tiniscript.link.names import saved_name
from tiniscript.link.payloads import ReceiptReply
from tiniscript.robots.profile import Robot


def run(options: Namespace, language: str) -> int:
    program_input = inputs.program(options)
    robot = inputs.robot_for(program_input, options, language)
    acts_on_many = select_port(options)
    # the robot that answers may not be the default one
    may_choose_robot = options.robot is None and not acts_on_many and not program_input.is_image
    ready_program = _prepare(program_input, robot, options, may_choose_robot)
    if ready_program is None:
        return 1
    is_followed = ready_program.image.start == "SI" and not (options.no_run or options.detach)
    if options.record is not None and (acts_on_many or not is_followed):
        raise CommandError(2, "record_follows")
    if options.record is not None:
        from tiniscript.cli.robot.recorded_run import require_known_robot, source_text

        require_known_robot(robot)
        options.recorded_text = source_text(program_input)
    if options.breaks and (acts_on_many or not is_followed):
        raise CommandError(2, "break_follows")
    if acts_on_many:
        from tiniscript.cli.robot.fleet_upload import upload_to_many

        return upload_to_many(
            options, robot, language, ready_program, inputs.printable_name(program_input.name)
        )
    with Connection(options, robot, language) as connection:
        if connection.simulator is not None and options.detach:
            raise CommandError(2, "virtual_and_detach")
        if ready_program.image.start == "PING":  # a program that reads PING
            from tiniscript.cli.robot.description import introduce

            return introduce(connection, options.json)
        connection.meet()
        is_kit_wrong = (
            ready_program.image.devices and connection.device_info.kit != robot.kit.fingerprint
        )
        if may_choose_robot and is_kit_wrong and own_kit.use_answering_profile(connection, options):
            ready_program = images.ready_program(
                program_input, connection.profile, language, is_strict=True
            )
            if ready_program is None:
                return 1
        try:
            return _upload(
                connection, ready_program, inputs.printable_name(program_input.name), options
            )
        except KeyboardInterrupt:
            return stop_and_say(connection)


def _prepare(
    program_input: inputs.Input, robot: Robot, options: Namespace, may_choose_robot: bool
) -> images.ReadyProgram | None:  # fmt: skip
    """Return the program, or None if its mistakes have just been printed.

    One with words of another robot is compiled for the robot that answers, if there is one.
    """
    language: str = options.language
    if not may_choose_robot:
        return images.ready_program(program_input, robot, language, is_strict=True)
    try:
        return images.ready_program(
            program_input, robot, language, is_strict=True, may_choose_robot=True
        )
    except images.OtherRobot as error:
        answering_robot = own_kit.find_answering_robot(options, robot, language)
        if answering_robot is not None:
            return images.ready_program(program_input, answering_robot, language, is_strict=True)
        outputs.print_diagnostics(error.compilation, language)
        return None


def _upload(
    connection: Connection, ready_program: images.ReadyProgram, name: str, options: Namespace
) -> int:  # fmt: skip
    language = connection.language
    progress = Progress(
        language, 1 + len(ready_program.image.later_fields) + len(ready_program.image.code)
    )
    connection.wait_notice.before_print = progress.end

    def draw_progress(done_bytes: int) -> None:
        # Until then, the progress line shows what the robot is waiting for.
        if done_bytes and progress.draw(done_bytes):
            connection.wait_notice.note_other_output()

    tells_readings = options.record is not None and _ask_for_readings(connection)
    try:
        receipt_reply = send_program(connection, ready_program, options, draw_progress)
        sent_s = monotonic()  # measured before anything else is loaded or printed
    finally:
        progress.end()
    printer = printer_of(connection, options.json, ready_program.program_map, receipt_reply.program)
    recorder = None
    if options.record is not None:
        from tiniscript.cli.robot.recorder import Recorder
        from tiniscript.studio import recordings

        simulator = connection.simulator
        robot_ms = None if simulator is None else simulator.event_ms
        text, robot = options.recorded_text, connection.profile
        head = recordings.header_line(recordings.REAL, text, robot, receipt_reply.program)
        recorder = Recorder(options.record, head, sent_s, robot_ms, robot.kit)
        printer.add_row = recorder.add_event
        printer.readings = recorder.add_reading if tells_readings else None
    saving = Saving(connection, printer, receipt_reply)
    try:
        if options.json:
            print(
                json.dumps(receipt_fields(connection, ready_program, name, receipt_reply, options)),
                flush=True,
            )
        else:
            print(
                _receipt_line(connection, ready_program, name, receipt_reply, options), flush=True
            )
        connection.wait_notice.note_other_output()
        images.keep_map(ready_program)  # written last, so that the robot starts sooner
        return follow_run(connection, ready_program, saving, options, printer)
    except KeyboardInterrupt:
        exit_code = stop_and_say(connection)
        try:
            if recorder is not None:
                recorder.end_recording("STOPPED")
            saving.wait()  # a short wait, because the motors are off now
        except CommandError as error:
            print(error.sentence(language), file=sys.stderr)
        except KeyboardInterrupt:
            pass  # another one ends this wait: the stop has been reported
        return exit_code
    except OSError:  # tsc's output has no reader any more
        if connection.stop_unseen():
            saving.wait_unread()
        raise
    except CommandError:
        if recorder is not None:
            recorder.end_recording("LOST")
        raise
    finally:
        if recorder is not None:
            recorder.close()
            if recorder.unreadable_sensors:
                say_aside(
                    "record_incomplete", language, sensors=", ".join(recorder.unreadable_sensors)
                )


def _ask_for_readings(connection: Connection) -> bool:
    """Ask the robot for its program's readings; return whether it sends them. If not, print
    that.
    """
    if not connection.device_info.values.features & READINGS:
        say_aside("record_no_readings", connection.language)
        return False
    connection.request(lambda session: session.tell_readings(True))
    return True


def _receipt_line(
    connection: Connection,
    ready_program: images.ReadyProgram,
    name: str,
    receipt_reply: ReceiptReply,
    options: Namespace,
) -> str:
    how_key = "how_waits"
    if is_running(ready_program, options):
        how_key = "how_detached" if options.detach else "how_running"
    elif has_button(connection, ready_program, options):
        how_key = "how_key" if has_keys(connection) else "how_pushed"
    sentence = connection.text(how_key, start=ready_program.image.start)
    saved_state = saved_name(receipt_reply.saved)
    if not options.verbose:
        if saved_state != "SAVING":  # while it is SAVING, the state is printed later
            key = "saved" if saved_state == "STORED" else f"saved_{saved_state}"
            sentence = f"{connection.text(key)}   {sentence}"
        return connection.text("receipt", program=name, how=sentence)
    return connection.text(
        "receipt_whole",
        program=name,
        image=ready_program.image_bytes,
        code=len(ready_program.image.code),
        checksum=f"{receipt_reply.program:08x}",
        saved=connection.text(f"saved_{saved_state}", slot=receipt_reply.slot),
        how=sentence,
    )
