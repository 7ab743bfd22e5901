"""The way to a robot: `--port` and `--baud`, the choice of a port, and who answers there.

Every trouble on that way becomes a sentence that says what to do next.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable
from contextlib import suppress
from typing import IO, TYPE_CHECKING

from tiniscript.cli import inputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options, whole_number
from tiniscript.cli.robot import shared_port
from tiniscript.cli.robot.own_kit import remember as remember_profile
from tiniscript.cli.texts.common import text
from tiniscript.library import way
from tiniscript.library.errors import RobotError

if TYPE_CHECKING:
    from tiniscript.cli.robot.event_printer import Teller
    from tiniscript.cli.robot.simulator import Company
    from tiniscript.codegen.source_map import Map
    from tiniscript.link.connection import Asked, Asks, Way
    from tiniscript.link.line import Line
    from tiniscript.link.outcomes import Event, Gone
    from tiniscript.link.ports import PortTrouble
    from tiniscript.link.requests import Reply
    from tiniscript.link.requests import Robot as Card
    from tiniscript.robots.profile import Robot

PATIENCE_MS = 6000  # for which one that has answered may be silent, or busy with saving
VIRTUAL = ""  # no port: a virtual robot that this command brings along
SLOWEST_BAUD, FASTEST_BAUD = 300, 2_000_000


def takes_port(parser: Options) -> None:
    """Add what every verb that talks to a robot has."""
    parser.add_argument("--port")
    parser.add_argument("--baud")
    parser.add_argument("--virtual", action="store_true")


def takes_robot(parser: Options) -> None:
    """Add what those have that take no program."""
    takes_port(parser)
    parser.add_argument("--robot")


def connected(options: Namespace, language: str) -> Connection:
    return Connection(options, inputs.robot(options, language), language)


def baud_of(options: Namespace, robot: Robot, language: str) -> int:
    default = robot.board.baud
    return whole_number("--baud", options.baud, default, SLOWEST_BAUD, FASTEST_BAUD, language)


class Connection:
    """The way to a port, and the robot on it once it has said who it is."""

    def __init__(
        self, options: Namespace, robot: Robot, language: str, is_one_of_many: bool = False
    ) -> None:
        """Go to the port that the options name, or the last used one, or ask for one.

        `is_one_of_many`: whoever looks after all of them remembers the ports.
        """
        self.is_one_of_many = is_one_of_many
        self.options = options
        self.is_interrupted = False
        self._is_stopped_unseen = False
        self.starts_nothing = options.verb not in ("upload", "start", "live")
        is_detached = getattr(options, "detach", False)
        self.drives = options.verb in ("upload", "start", "live", "trim") and not is_detached
        baud = baud_of(options, robot, language)
        self.language = language
        self.profile = robot
        self.company: Company | None = None  # a virtual robot that is here for this command
        found = _chosen(options, language)
        if found == VIRTUAL:
            from tiniscript.cli.robot.simulator import Company

            self.company = Company(options, robot, language)
            found = self.company.port
        self.port = found
        asked_baud = None if options.baud is None else baud
        try:
            self.line = opened_way(self.port, baud, robot, options.verb, asked_baud=asked_baud)
            self.host = shared_port.shared(self.line, self.port, baud, options.verb)
        except BaseException:
            self._end_company()
            raise

    def __enter__(self) -> Connection:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None and issubclass(kind, OSError) and self.drives:
            self.stop_unseen()
        if self.host is not None:
            self.host.close()  # before it one may begin
            if self.host.may_have_run:  # of a guest, who can no longer stop it
                from tiniscript.cli.robot.run_monitor import STOP_S, confirmed

                confirmed(self.line, STOP_S)
        self.line.close()
        self._end_company()

    def stop_unseen(self) -> bool:
        """Stop the robot, once, because nobody reads any more, or can, what it does; return whether
        it was this time, and the robot has confirmed it."""
        if self._is_stopped_unseen or not self.drives:
            return False
        self._is_stopped_unseen = True
        from tiniscript.cli.robot.run_monitor import STOP_S, confirmed

        is_confirmed = confirmed(self.line, STOP_S)
        key = "output_stopped" if is_confirmed else "not_confirmed"
        with suppress(OSError):
            said = text(key, self.language).format(port=shown(self.port))
            print(said, file=sys.stderr, flush=True)
        return is_confirmed

    @property
    def is_time_over(self) -> bool:
        """Whether the command has to end, because it was told so."""
        return self.company is not None and self.company.is_time_over

    def teller(self, is_json: bool = False, places: Map | None = None) -> Teller:
        """Return who prints events: around the picture of a virtual robot that is drawn here."""
        from tiniscript.cli.robot.event_printer import Teller

        if self.company is None:
            return Teller(self.language, is_json, places=places)
        return Teller(
            self.language, is_json, places=places, out=self.company.say, err=self.company.complain
        )

    def _end_company(self) -> None:
        if self.company is not None:
            self.company.close()

    def meet(self, board: str | None = None) -> Card:
        """Ask the robot who it is, until it answers. Raises Trouble where none does.

        `board` is what it is on, where that is not the one of its profile.
        """
        from tiniscript.link.outcomes import CANCELLED

        reply = way.met(self.line, self.port, board or self.profile.board.chip, self.wait)
        while reply.status == CANCELLED and self.starts_nothing:  # a stop came first
            reply = self.wait(way.hello(self.line, way.ANSWER_MS))
        card = self.line.robot
        if reply.status or card is None:
            raise self.trouble(reply)
        remember_profile(self.options, self.profile, card.kit)
        if not self.is_one_of_many:
            self.remember(card.name)
        return card

    def remember(self, name: str) -> None:
        """Keep the port for the next time, and what the robot on it is called."""
        way.remember(self.port, name)

    @property
    def card(self) -> Card:
        """Who the robot is; `meet` has asked."""
        assert self.line.robot is not None
        return self.line.robot

    @property
    def name(self) -> str:
        """What to call the robot: its name, else that of its profile, else its port."""
        if self.card.name:
            return shown(self.card.name)
        return robot_of_kit(self.card.kit) or text("robot", self.language)

    def ask(self, make: Callable[[Asks], Asked]) -> Reply:
        """Have something done; raise Trouble where it is not."""
        reply = self.wait(self.do(make))
        if reply.status:
            raise self.trouble(reply)
        return reply

    def give(self, make: Callable[[Asks], Asked]) -> Reply:
        """Have the robot take something; raise Trouble where it does not. Where the reply is not
        OK, it has not kept it yet."""
        from tiniscript.link.requests import TAKEN

        reply = self.wait(self.do(make))
        if reply.status and reply.status not in TAKEN:
            raise self.trouble(reply)
        return reply

    def do(self, make: Callable[[Asks], Asked]) -> Asked:
        """Have something begun, for which there is a limited time."""
        return self.line.do(way.limited(make, PATIENCE_MS))

    def wait(self, task: Asked, look: Callable[[], None] | None = None) -> Reply:
        from tiniscript.link.outcomes import Gone

        def watch() -> None:
            self._heed()
            if look is not None:
                look()

        try:
            return self.line.wait(task, watch)
        except Gone as gone:
            raise self.gone(gone) from None

    def event(self) -> tuple[int, Event] | None:
        """Return the next event and when it came (ms), or None where none comes for a moment.

        Raises Trouble where the way has ended.
        """
        from tiniscript.link.outcomes import Gone

        self._heed()
        try:
            return self.line.event()
        except Gone as gone:
            raise self.gone(gone) from None

    def interrupt(self) -> None:
        """Let the thread that waits here see a Ctrl-C, which Python shows only the first one."""
        self.is_interrupted = True

    def _heed(self) -> None:
        if self.is_interrupted:
            self.is_interrupted = False
            raise KeyboardInterrupt

    def trouble(self, reply: Reply) -> Trouble:
        """Return the sentence for an outcome that is not OK."""
        reason = way.reason_of(self.line, reply)
        if reason == "status":
            return Trouble(3, "plain", said=self.said(reply))
        return Trouble(3, reason, port=shown(self.port))

    def said(self, reply: Reply) -> str:
        """Return what a robot's refusal means, and what to do."""
        from tiniscript.link.messages import STATUSES
        from tiniscript.link.statuses import sentence

        said, advice = sentence(reply.status, reply.detail, self.language)
        if reply.status == STATUSES["WRONG_KIT"]:
            name = robot_of_kit(reply.detail)
            if name is not None:
                advice = text("choose_kit", self.language).format(robot=name)
        return f"{said} {advice}".strip()

    def gone(self, gone: Gone) -> Trouble:
        """Return the sentence for a way that has ended."""
        verb = self.line.held_by
        return Trouble(3, way.reason_of_end(self.line, gone), port=shown(self.port), verb=verb)


def opened_way(
    port: str, baud: int, robot: Robot, verb: str, limit_s: float = 20,
    asked_baud: int | None = None,
) -> Way:  # fmt: skip
    """Go to a port through its holder, or open it. Raises Trouble."""

    def open_line(lock: IO[bytes] | None) -> Line:
        return way.opened_line(port, baud, robot.kit.fingerprint, limit_s, lock)

    try:
        return way.way_to(port, verb, open_line, asked_baud)
    except RobotError as error:
        raise Trouble(3, error.reason, **error.values) from None


def port_trouble(port: str, trouble: PortTrouble) -> Trouble:
    """Return the sentence for a port that does not open."""
    error = way.port_error(port, trouble)
    return Trouble(3, error.reason, **error.values)


def robot_of_kit(kit: int) -> str | None:
    from tiniscript.library.known_kits import shipped_of_kit as found

    return found(kit)


def _chosen(options: Namespace, language: str) -> str:
    """Return the port of `--port`, else the last used, else the one that the person chooses.

    Never one that merely answers: it may be another group's robot. A virtual robot that runs here
    is this person's own. VIRTUAL: one that the command brings along.
    """
    port: str | None = options.port
    can_bring = hasattr(options, "world")
    if options.virtual:
        if port is not None:
            raise Trouble(2, "virtual_and_port")
        from tiniscript.cli.robot.simulator import running_address

        return running_address(options) or VIRTUAL
    if can_bring:
        from tiniscript.cli.robot.simulator_options import refuse_real

        refuse_real(options)
    if port is not None:
        if not port.strip() or not port.isprintable():
            raise Trouble(2, "no_such_port", found=shown(port) or "''")
        return port
    from tiniscript.link import known_ports, port_names

    last = known_ports.known().last
    from tiniscript.virtual import directory

    if last is not None and port_names.is_there(last) and not directory.is_gone(last):
        return last
    virtual = directory.for_all() if can_bring else directory.running()
    if len(virtual) == 1:
        return virtual[0].address
    if not (sys.stdin.isatty() and sys.stderr.isatty()) or getattr(options, "asks_nothing", False):
        if last is not None:
            raise Trouble(3, "last_port_missing", port=shown(last))
        raise Trouble(3, "which_port_or_virtual" if can_bring else "which_port")
    return _asked(language, can_bring)


def _asked(language: str, can_bring: bool) -> str:
    """Let the person choose a port."""
    from tiniscript.link import known_ports, ports
    from tiniscript.link.port_names import is_address
    from tiniscript.virtual.directory import is_gone

    names = known_ports.known().names
    found = ports.listed()
    choices = [each.port for each in found]
    choices += [port for port in names if port not in choices and is_address(port)
                and not is_gone(port)]  # fmt: skip
    if not choices:
        if can_bring:
            from tiniscript.cli.robot.simulator import offered

            if offered(language):
                return VIRTUAL
        raise Trouble(3, "no_ports")
    about = {each.port: each.description for each in found}
    print(text("choose_port", language), file=sys.stderr)
    for number, port in enumerate(choices, 1):
        more = "   ".join(filter(None, (names.get(port), about.get(port))))
        print(f"  {number}  {shown(port)}   {shown(more)}".rstrip(), file=sys.stderr)
    if can_bring:
        choices.append(VIRTUAL)
        print(f"  {len(choices)}  {text('choice_virtual', language)}", file=sys.stderr)
    while True:
        print(text("choose_number", language).format(high=len(choices)), end="", file=sys.stderr,
              flush=True)  # fmt: skip
        answer = sys.stdin.readline()
        if not answer:
            raise Trouble(3, "which_port")
        answer = answer.strip()
        if answer and answer in choices:
            return answer
        if answer.isascii() and answer.isdigit() and 1 <= int(answer[:9]) <= len(choices):
            return choices[int(answer[:9]) - 1]
