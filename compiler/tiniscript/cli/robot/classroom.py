"""`tsc class`: the robots of a class at an MQTT broker, as one fleet."""

from __future__ import annotations

from argparse import Namespace
from contextlib import suppress
from functools import partial
from time import monotonic
from typing import TYPE_CHECKING

from tiniscript.cli import images, inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import whole_number
from tiniscript.cli.paths import CLASS_ROWS_HEADER
from tiniscript.cli.robot import broker_options
from tiniscript.cli.robot.connect import Connection, convert_port_error
from tiniscript.cli.robot.description import describe_in_a_line
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.fleet import run_together
from tiniscript.cli.robot.fleet_upload import upload_to_many
from tiniscript.cli.robot.member import Member, Result
from tiniscript.cli.robot.recorder import Rows
from tiniscript.cli.robot.stopping import stop_one
from tiniscript.cli.spreadsheet import escape_formula
from tiniscript.cli.texts import say, say_aside, text
from tiniscript.cli.texts.options import options_of
from tiniscript.link.errors import NOT_INSTALLED, PortError
from tiniscript.link.port_connection import now_ms

if TYPE_CHECKING:
    from tiniscript.link.transports.broker import Access, Broker, RobotPresence

STOP_MESSAGES = 3  # messages to all, as each may be lost
UPLOAD_VERB = "upload"  # the verb that asks most of a fleet's options


class Classroom:
    """A broker, a class, and how this computer signs in there. Raises CommandError."""

    def __init__(self, options: Namespace, language: str) -> None:
        if options.broker is None:
            if options.user is not None:
                raise CommandError(2, "broker_no_user")
            raise CommandError(2, "class_no_broker")
        broker_options.read_certificate(options)
        self.options = options
        self.language = language
        self.address = broker_options.broker_address(options, options.tls)
        self.class_name = broker_options.class_name(options)
        self.broker = self._connect(options)

    def _connect(self, options: Namespace) -> Broker:
        with convert_port_error(f"mqtt://{self.address}"):
            try:
                from tiniscript.link.transports import broker
            except ImportError as error:
                raise PortError(NOT_INSTALLED, error.name or "") from None
            broker.sign_in(*self.address, self._access(options))
            return broker.connect(*self.address)

    def _access(self, options: Namespace) -> Access:
        from tiniscript.link.transports.broker import Access

        user, password = broker_options.ask_user(options, self.language)
        name, password_text = (data.decode("utf-8", "surrogateescape") for data in (user, password))
        return Access(name, password_text, bool(options.tls), options.trust)

    def present_robots(self) -> list[RobotPresence]:
        """Return the robots that the broker knows, including those that have left."""
        with convert_port_error(f"mqtt://{self.address}"):
            try:
                known_robots = self.broker.list_robots(self.class_name)
            finally:
                for topic, size in self.broker.skipped_topics.items():
                    say_aside(
                        "class_skipped", self.language, topic=printable_name(topic), bytes=size
                    )
        if not any(robot.is_here for robot in known_robots):
            raise CommandError(3, "class_empty", group=self.class_name, host=str(self.address))
        return known_robots

    def options_for(self, present_robots: list[RobotPresence], verb: str = "class") -> Namespace:
        """Return the options with which a verb reaches these robots.

        Only a teacher who lets pupils drive them needs to attend to them.
        """
        from tiniscript.link.transports.broker import port_of

        ports = [
            port_of(*self.address, self.class_name, robot.id)
            for robot in present_robots
            if robot.is_here
        ]
        fleet_defaults = {option.name: option.default for option in options_of(UPLOAD_VERB)}
        target_options = Namespace(**{**fleet_defaults, "port": None, **vars(self.options)})
        target_options.ports, target_options.verb = ports, verb
        if verb == UPLOAD_VERB:
            target_options.attend = self.broker.attend
        return target_options


def list_robots(classroom: Classroom) -> int:
    known_robots = classroom.present_robots()
    target_options = classroom.options_for(known_robots)
    exit_code = run_together(
        target_options,
        inputs.robot(target_options, classroom.language),
        classroom.language,
        describe_in_a_line,
    )
    for robot in known_robots:
        if not robot.is_here and not target_options.json:
            say("class_gone", classroom.language, robot=printable_name(robot.name), id=robot.id)
    return exit_code


def upload(classroom: Classroom) -> int:
    """Send a program to all at once, and follow it until it ends on each."""
    target_options = classroom.options_for(classroom.present_robots(), UPLOAD_VERB)
    program_input = inputs.program(target_options)
    robot = inputs.robot_for(program_input, target_options, classroom.language)
    ready_program = images.ready_program(program_input, robot, classroom.language, is_strict=True)
    if ready_program is None:
        return 1
    return upload_to_many(
        target_options, robot, classroom.language, ready_program, printable_name(program_input.name)
    )


def stop(classroom: Classroom) -> int:
    """Stop all at once, with one message; then ask each of them whether it has stopped."""
    is_published = False
    for _ in range(STOP_MESSAGES):
        with suppress(OSError):
            is_published = classroom.broker.stop(classroom.class_name) or is_published
    try:
        known_robots = classroom.present_robots()
    except CommandError:
        if is_published:
            say_aside(
                "class_stop_sent", classroom.language, group=printable_name(classroom.class_name)
            )
        raise
    target_options = classroom.options_for(known_robots, "stop")
    return run_together(
        target_options,
        inputs.robot(target_options, classroom.language),
        classroom.language,
        stop_one,
    )


def show(classroom: Classroom) -> int:
    """Print what the robots show, until Ctrl-C or for some seconds."""
    options, language = classroom.options, classroom.language
    seconds = whole_number("--max-time", options.max_time, 0, 1, 10**6, language)
    target_options = classroom.options_for(classroom.present_robots())
    end_s = monotonic() + seconds if seconds else None
    rows = Rows(options.csv, CLASS_ROWS_HEADER) if options.csv is not None else None
    listener = Listener(target_options.json, end_s, rows)
    try:
        exit_code = run_together(
            target_options, inputs.robot(target_options, language), language, listener.listen
        )
    finally:
        if rows is not None:
            rows.close()
    return 0 if exit_code == 2 else exit_code  # Ctrl-C is the usual way to end it


class Listener:
    """Prints the events of one of many robots, without changing its run.

    The times of all count from when the listener is made.
    """

    def __init__(self, is_json: bool, end_s: float | None, rows: Rows | None = None) -> None:
        self.is_json = is_json
        self.end_s = end_s
        self.rows = rows
        self.began_ms = now_ms()

    def listen(self, connection: Connection, member: Member) -> Result:
        member.meet_robot(connection)
        robot_fields = {"port": connection.port, "robot": connection.name}

        def print_line(line: str) -> None:
            member.queue_line(line if self.is_json else f"{connection.name}: {line}")

        add_row = self.rows.add_row if self.rows is not None else None
        first_cells = (
            escape_formula(printable_name(connection.name)),
            f"{connection.device_info.id:08x}",
        )
        printer = EventPrinter(
            connection.language, self.is_json, robot_fields=robot_fields, has_times=self.is_json,
            print_line=print_line, print_error=print_line,
            add_row=partial(add_row, *first_cells) if add_row is not None else None,
            began_ms=self.began_ms,
        )  # fmt: skip
        try:
            for timed_event in connection.watch(self.end_s):
                if timed_event is not None:
                    printer.print_event(*timed_event)
        except KeyboardInterrupt:
            pass
        return Result(True, text("class_over", connection.language))
