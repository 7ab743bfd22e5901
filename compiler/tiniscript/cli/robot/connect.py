"""The connection to a robot: `--port` and `--baud`, the choice of a port, and the robot there.

Every failure becomes a sentence with the next step.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from typing import TYPE_CHECKING, TypeVar

from tiniscript import robots
from tiniscript.cli import inputs, streams
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import whole_number
from tiniscript.cli.robot.bookkeeping import Bookkeeping
from tiniscript.cli.terminal import asking
from tiniscript.cli.terminal.progress import RepeatedWaitNotice, show_wait
from tiniscript.cli.texts import Sentence, say_aside, text
from tiniscript.cli.texts.options import virtual_names
from tiniscript.library import opening
from tiniscript.library.client import Client
from tiniscript.library.errors import TiniScriptError
from tiniscript.library.known_kits import shipped_name_of_kit
from tiniscript.link import known_ports
from tiniscript.link.connection import FOREIGN, PendingRequest, Requester, reason_of
from tiniscript.link.errors import PortError
from tiniscript.link.messages import OWNED, STATUSES, YOURS
from tiniscript.link.outcomes import POLL_INTERVAL_S, ConnectionLost, Event
from tiniscript.link.port_names import is_address, is_built_in
from tiniscript.link.requests import DeviceInfo, Reply
from tiniscript.link.statuses import status_text
from tiniscript.robots import given
from tiniscript.robots.profile import Robot
from tiniscript.virtual import directory
from tiniscript.virtual.directory import is_gone

if TYPE_CHECKING:
    from tiniscript.cli.robot.simulator import CommandSimulator
    from tiniscript.link.ports import ListedPort

T = TypeVar("T")

# verbs that stay on a port, and share it
SHARED_VERBS = ("doctor", "live", "monitor", "monitor --hold", "start", "upload")
STOP_TIMEOUT_S = 1.5  # timeout for a stop when the command ends and may have no reader
OWN_VIRTUAL_ROBOT = ""  # no port: this command starts its own virtual robot


def connect(options: Namespace, language: str) -> Connection:
    return Connection(options, inputs.robot(options, language), language)


def baud_of(options: Namespace, robot: Robot, language: str) -> int:
    default = robot.board.baud
    low, high = opening.SLOWEST_BAUD, opening.FASTEST_BAUD
    return whole_number("--baud", options.baud, default, low, high, language)


class Connection(Client):
    """The client of a command: its port, and the robot there once it has identified itself.

    It raises a CommandError where a Client raises a RobotError.
    """

    def __init__(
        self, options: Namespace, robot: Robot, language: str, is_one_of_many: bool = False
    ) -> None:
        """Connect to the port that the options name, or the last used one, or ask for one.

        `is_one_of_many`: the fleet remembers the ports, not this connection.
        """
        self.is_one_of_many = is_one_of_many
        self.options = options
        self.is_interrupted = False
        self._is_stopped_unseen = False
        self.starts_nothing = options.verb not in ("upload", "start", "live")
        is_detached = getattr(options, "detach", False)
        self.drives = (
            options.verb in ("upload", "start", "live", "set trim", "doctor --selftest")
            and not is_detached
        )
        baud = baud_of(options, robot, language)
        self._is_meeting = False
        self.simulator: CommandSimulator | None = None  # a virtual robot for this command alone
        selected_port = _select_port(options, language)
        if selected_port == OWN_VIRTUAL_ROBOT:
            from tiniscript.cli.robot.simulator import CommandSimulator

            self.simulator = CommandSimulator(options, robot, language)
            selected_port = self.simulator.port
        self.port, self.language = selected_port, language
        sentence = text("waits_for_robot", language).format(port=printable_name(selected_port))
        self.wait_notice = RepeatedWaitNotice(sentence, is_seen=not is_one_of_many)
        asked_baud = None if options.baud is None else baud
        try:
            verb = options.verb
            with self._show_wait(), convert_robot_error():
                super().__init__(
                    selected_port,
                    verb,
                    robot,
                    asked_baud,
                    language,
                    is_shared=verb in SHARED_VERBS,
                    poll=self._raise_if_interrupted,
                )
        except BaseException:
            self._end_simulator()
            raise

    def __enter__(self) -> Connection:
        return self

    def __exit__(self, error_type: type[BaseException] | None, *_: object) -> None:
        try:
            if error_type is not None and issubclass(error_type, OSError) and self.drives:
                self.stop_unseen()
            if error_type is None or issubclass(error_type, (CommandError, OSError)):
                self._hold_for_others()
        finally:
            self.close(STOP_TIMEOUT_S)
            self._end_simulator()

    def _hold_for_others(self) -> None:
        """Go on holding the port while another command drives the robot through it: the end of this
        one is no stop of that one's program."""
        if not self.holds_for_others:
            return
        self.drives = False  # whether a run of its own moves the robot
        with suppress(OSError):
            if not self.is_one_of_many:
                say_aside("holds_for_others", self.language, port=printable_name(self.port))
        try:
            with suppress(CommandError):  # the port is lost
                self.hold_for_others()
        except KeyboardInterrupt:
            if not self.stop():
                say_aside("not_confirmed", self.language, port=printable_name(self.port))
            raise

    def stop_unseen(self) -> bool:
        """Stop the robot, because the output has no reader or cannot be written. Return True if
        this is the first such call and the robot has confirmed the stop."""
        if self._is_stopped_unseen or not self.drives or self.drives_another:
            return False
        self._is_stopped_unseen = True
        is_confirmed = self.stop(STOP_TIMEOUT_S)
        key = "output_stopped" if is_confirmed else "not_confirmed"
        with suppress(OSError):
            say_aside(key, self.language, port=printable_name(self.port))
        return is_confirmed

    @property
    def is_time_over(self) -> bool:
        """Whether the time limit of the command is over."""
        return self.simulator is not None and self.simulator.is_time_over

    def _end_simulator(self) -> None:
        if self.simulator is not None:
            self.simulator.close()

    def meet(
        self, board: str = "", should_retry: Callable[[], bool] | None = None
    ) -> DeviceInfo:  # fmt: skip
        """Send HELLO until the robot answers, and remember it. Raises CommandError if none does."""
        self._is_meeting = True
        self.wait_notice.begin()
        with self._show_wait():
            device_info = super().meet(board, should_retry or (lambda: self.starts_nothing))
        self._is_meeting = False
        self.wait_notice.end_wait()
        remember_profile(self.options, self.profile, device_info.kit)
        if not self.is_one_of_many:
            self.remember(device_info.name)
            self._tell_stale_key(device_info)
        return device_info

    def wait(
        self, request: PendingRequest[T], on_wait: Callable[[], None] | None = None
    ) -> Reply[T]:
        """Wait for the outcome of a request, and say so where that takes long."""
        done_bytes = request.done_bytes

        def poll() -> None:
            nonlocal done_bytes
            if request.done_bytes != done_bytes:
                done_bytes = request.done_bytes
                self.wait_notice.restart()
            if on_wait is not None:
                on_wait()
            self.wait_notice.poll()

        if self._is_meeting:
            return super().wait(request, on_wait)
        self.wait_notice.begin()
        return super().wait(request, poll)

    def event(self, timeout_s: float = POLL_INTERVAL_S) -> tuple[int, Event] | None:
        timed_event = super().event(timeout_s)
        if timed_event is not None:
            self.wait_notice.restart()
        elif self._needs_a_reader:
            streams.raise_if_reader_gone()
        return timed_event

    @property
    def _needs_a_reader(self) -> bool:
        """Return whether the robot is stopped when the output loses its reader; a fleet checks that
        itself.
        """
        is_own = self.drives and not self.is_one_of_many and not self.drives_another
        return is_own and not self._is_stopped_unseen

    def stop(self, timeout_s: float | None = None) -> bool:
        with self._show_wait("waits_for_stop"):
            return super().stop(timeout_s)

    @contextmanager
    def _show_wait(self, key: str = "waits_for_robot") -> Iterator[None]:
        """Print the reason for a long wait, once; a fleet has a table for that."""
        is_robot = key == "waits_for_robot"
        if self.is_one_of_many or (is_robot and self.wait_notice.is_told):
            yield
            return
        with show_wait(key, self.language, self.port) as notice:
            try:
                yield
            finally:
                if is_robot and notice.is_told:
                    self.wait_notice.note_told()

    def _tell_stale_key(self, device_info: DeviceInfo) -> None:
        """Print the remedy if the robot has refused a key of this computer."""
        if device_info.values.features & (OWNED | YOURS) != OWNED:
            return
        from tiniscript.link.keys import KeyFile

        keys = KeyFile().keys_of_robot(device_info.id)
        if any(key.is_stale and not key.is_pending for key in keys):
            say_aside("key_is_stale", self.language, robot=self.name)

    def remember(self, name: str) -> None:
        """Remember the port for the next time, and the name of its robot."""
        opening.remember(self.port, name)

    @property
    def name(self) -> str:
        """The robot's name for messages: its own, else that of its profile, else its port."""
        return name_of(self.device_info, self.language)

    def text(self, key: str, **values: object) -> str:
        """Return a sentence, which may name the robot that has answered, and its port."""
        name = "" if self.connection.robot is None else self.name
        default_values = {"robot": name, "port": printable_name(self.port)}
        return text(key, self.language).format(**{**default_values, **values})

    def print_text(self, key: str, **values: object) -> None:
        """Print such a sentence."""
        print(self.text(key, **values))

    def request_or_raise(
        self, make_request: Callable[[Requester], PendingRequest[T]], key: str, *statuses: str
    ) -> Reply[T]:
        """Make a request; these refusals have the sentence `key`. Raises CommandError."""
        reply = self.request(make_request, [STATUSES[status] for status in statuses])
        if reply.status:
            raise CommandError(3, key, robot=self.name)
        return reply

    def watch(self, end_s: float | None) -> Iterator[tuple[int, Event] | None]:
        """Yield the events of any driver until `end_s`, and None now and then.

        Raises CommandError if the robot is lost.
        """
        bookkeeping = Bookkeeping()
        while end_s is None or monotonic() < end_s:
            timed_event = self.event()
            if timed_event is not None and bookkeeping.filter_event(timed_event[1]):
                continue
            if timed_event is not None and timed_event[1].name == "LOST":
                raise CommandError(3, "link_lost", port=printable_name(self.port))
            yield timed_event

    def interrupt(self) -> None:
        """Pass a Ctrl-C to the thread that waits here; Python reports it only to the main one."""
        self.is_interrupted = True

    def _raise_if_interrupted(self) -> None:
        if self.is_interrupted:
            self.is_interrupted = False
            raise KeyboardInterrupt

    def error_for_reply(self, reply: Reply[object]) -> CommandError:
        """Return the sentence for an outcome that is not OK."""
        reason = reason_of(self.connection, reply)
        if reason == "status":
            return CommandError(3, "plain", said=self.refusal_text(reply))
        if reason == FOREIGN:
            explanation, advice = self.foreign_board_sentences()
            return CommandError(
                3,
                reason,
                port=printable_name(self.port),
                what=Sentence(explanation),
                then=Sentence(advice),
            )
        return CommandError(3, reason, port=printable_name(self.port), id=f"{reply.detail:08x}")

    def refusal_text(self, reply: Reply[object]) -> str:
        """Return the meaning of a robot's refusal, and the next step."""
        meaning, advice = status_text(reply.status, reply.detail, self.language)
        if reply.status == STATUSES["WRONG_KIT"]:
            name = shipped_name_of_kit(reply.detail)
            if name is not None:
                advice = text("choose_kit", self.language).format(robot=name)
        return f"{meaning} {advice}".strip()

    def error_for_loss(self, loss: ConnectionLost) -> CommandError:
        """Return the sentence for a connection that has ended."""
        loss_error = self.robot_error_for_loss(loss)
        return CommandError(3, loss_error.key, **loss_error.values)


def name_of(info: DeviceInfo, language: str) -> str:
    """Return the name of a robot for messages: its own, else that of its profile."""
    return printable_name(info.name) or shipped_name_of_kit(info.kit) or text("robot", language)


@contextmanager
def convert_robot_error() -> Iterator[None]:
    """Convert a RobotError into an error of the command."""
    try:
        yield
    except TiniScriptError as error:
        if error.key in STATUSES:
            raise CommandError(3, "plain", said=str(error)) from None
        raise CommandError(3, error.key, **error.values) from None


def open_client(
    port: str, robot: Robot, verb: str, baud: int | None, language: str,
    timeout_s: float,
) -> Client:  # fmt: skip
    """Connect to a port through its server, or open it. Raises CommandError."""
    with convert_robot_error():
        return Client(port, verb, robot, baud, language, timeout_s, is_shared=verb in SHARED_VERBS)


def error_for_port(port: str, error: PortError) -> CommandError:
    """Return the sentence for a port that does not open."""
    robot_error = opening.port_error(port, error)
    return CommandError(3, robot_error.key, **robot_error.values)


@contextmanager
def convert_port_error(port: str) -> Iterator[None]:
    """Raise CommandError where a port does not open."""
    try:
        yield
    except PortError as error:
        raise error_for_port(port, error) from None


def remember_profile(options: Namespace, robot: Robot, kit: int) -> None:
    """Remember the profile of a file for the robots with this kit."""
    name = getattr(options, "robot", None)
    if name is None or kit != robot.kit.fingerprint or name.lower() in robots.names():
        return
    given.remember(name, kit)


def _select_port(options: Namespace, language: str) -> str:
    """Return the port of `--port`, else the last used one, else the one that the user chooses.

    A port is not chosen because a robot answers on it: it may be another group's robot. A running
    virtual robot is the user's own. OWN_VIRTUAL_ROBOT stands for a virtual robot of this command.
    """
    port: str | None = options.port
    can_start_virtual = hasattr(options, "world")
    if options.virtual:
        if port is not None:
            raise CommandError(2, "virtual_and_port")
        from tiniscript.cli.robot.simulator import running_address

        return running_address(options) or OWN_VIRTUAL_ROBOT
    for name in virtual_names() if can_start_virtual else ():
        if getattr(options, name):
            raise CommandError(2, "only_virtual", option=f"--{name}")
    if port is not None:
        return inputs.check_port(port)
    if (usable_port := opening.usable_last_port()) is not None:
        return usable_port
    last_port = known_ports.remembered_ports().last_port
    virtual_robots = (
        directory.unclaimed_robots() if can_start_virtual else directory.running_robots()
    )
    if len(virtual_robots) == 1:
        return virtual_robots[0].address
    if not asking.can_ask() or getattr(options, "asks_nothing", False):
        if last_port is not None:
            raise CommandError(3, "last_port_missing", port=printable_name(last_port))
        if virtual_robots:
            raise CommandError(
                3, "which_virtual", known=", ".join(robot.address for robot in virtual_robots)
            )
        raise CommandError(3, "which_port_or_virtual" if can_start_virtual else "which_port")
    return _ask_port(language, can_start_virtual, virtual_robots)


def describe_port(listed_port: ListedPort, language: str) -> str:
    """Return the description of a port; the system has none for a built-in one."""
    has_description = bool(listed_port.description) or not is_built_in(listed_port.port)
    return listed_port.description if has_description else text("port_built_in", language)


def describe_virtual_robot(running_robot: directory.RunningRobot, language: str) -> str:
    """Return the description of a virtual robot; a shipped world has a name in each language."""
    from tiniscript.virtual import worlds

    world = running_robot.world
    if world in worlds.names():
        world = worlds.load(world).labels[language]
    sentence = text("virtual_port", language).format(robot=running_robot.robot, world=world)
    return f"{running_robot.name}: {sentence}" if running_robot.name else sentence


def _ask_port(
    language: str, can_start_virtual: bool, virtual_robots: list[directory.RunningRobot]
) -> str:
    """Ask the person for a port, or for one of the virtual robots."""
    name_by_port = known_ports.remembered_ports().name_by_port
    from tiniscript.link import ports

    listed_ports = ports.list_ports()
    choices = [entry.port for entry in listed_ports]
    choices += [port for port in name_by_port if port not in choices and is_address(port)
                and not is_gone(port)]  # fmt: skip
    choices += [entry.address for entry in virtual_robots if entry.address not in choices]
    if not choices:
        if can_start_virtual:
            from tiniscript.cli.robot.simulator import offer_virtual_robot

            if offer_virtual_robot(language):
                return OWN_VIRTUAL_ROBOT
        raise CommandError(3, "no_ports")
    description_by_port = {entry.port: describe_port(entry, language) for entry in listed_ports}
    description_by_port |= {
        entry.address: describe_virtual_robot(entry, language) for entry in virtual_robots
    }
    say_aside("choose_port", language)
    for number, port in enumerate(choices, 1):
        details = "   ".join(filter(None, (name_by_port.get(port), description_by_port.get(port))))
        print(
            f"  {number}  {printable_name(port)}   {printable_name(details)}".rstrip(),
            file=sys.stderr,
        )
    if can_start_virtual:
        choices.append(OWN_VIRTUAL_ROBOT)
        print(f"  {len(choices)}  {text('choice_virtual', language)}", file=sys.stderr)
    while True:
        typed_line = asking.ask(text("choose_number", language))
        if not typed_line:
            raise CommandError(3, "which_port")
        answer = typed_line.strip()
        if answer and answer in choices:
            return answer
        if answer.isascii() and answer.isdigit() and 1 <= int(answer[:9]) <= len(choices):
            return choices[int(answer[:9]) - 1]
