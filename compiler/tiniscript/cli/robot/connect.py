"""The way to a robot: `--port` and `--baud`, the choice of a port, and who answers there.

Every trouble on that way becomes a sentence that says what to do next.
"""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Callable
from contextlib import suppress
from time import sleep
from typing import IO, TYPE_CHECKING

from tiniscript.cli import inputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options, whole_number
from tiniscript.cli.robot import shared_port
from tiniscript.cli.robot.own_kit import remember as remember_profile
from tiniscript.cli.texts.common import text

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

ANSWER_MS = 6000  # for which a robot is asked through the air who it is
# At a cable it is asked for less, and twice: an Uno that was reset takes 1.4 s.
CABLE_ANSWER_MS = 2000
# A Mega that was reset begins after 0.9 s. What it hears before that keeps it in its bootloader
# until it has heard nothing for 4.2 s.
QUIET_S = {"mega": 1.2}  # by board
LONG_QUIET_S = 4.5
PATIENCE_MS = 6000  # for which one that has answered may be silent, or busy with saving
PSEUDO = ("/dev/pts/", "/dev/ttys")  # pseudo-terminals
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

        reply = asked(self.line, self.port, board or self.profile.board.chip, self.wait)
        while reply.status == CANCELLED and self.starts_nothing:  # a stop came first
            reply = self.wait(hello(self.line, ANSWER_MS))
        card = self.line.robot
        if reply.status or card is None:
            raise self.trouble(reply)
        remember_profile(self.options, self.profile, card.kit)
        if not self.is_one_of_many:
            self.remember(card.name)
        return card

    def remember(self, name: str) -> None:
        """Keep the port for the next time, and what the robot on it is called."""
        remember(self.port, name)

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

        def limited(session: Asks) -> Asked:
            task = make(session)
            task.limit_ms = PATIENCE_MS
            return task

        return self.line.do(limited)

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
        from tiniscript.link.outcomes import CANCELLED, LOST

        if reply.status == CANCELLED:
            return Trouble(3, "stopped_elsewhere", port=shown(self.port))
        if reply.status != LOST:
            return Trouble(3, "plain", said=self.said(reply))
        if self.line.robot is not None:
            return Trouble(3, "link_lost", port=shown(self.port))
        if self.line.is_echoed:
            return Trouble(3, "link_echo", port=shown(self.port))
        key = "link_other" if self.line.heard else "link_silent"
        return Trouble(3, key, port=shown(self.port))

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
        if gone.is_holder:
            return Trouble(3, "holder_ended", port=shown(self.port), verb=self.line.held_by)
        if self.line.heard and self.line.robot is None:  # said so, and hung up
            return Trouble(3, "port_busy", port=shown(self.port))
        return Trouble(3, "port_gone", port=shown(self.port))


def opened_way(
    port: str, baud: int, robot: Robot, verb: str, limit_s: float = 20,
    asked_baud: int | None = None,
) -> Way:  # fmt: skip
    """Go to a port through its holder, or open it. Raises Trouble."""

    def open_line(lock: IO[bytes] | None) -> Line:
        return opened_line(port, baud, robot, limit_s, lock)

    return shared_port.way_to(port, verb, open_line, asked_baud)


def opened_line(
    port: str, baud: int, robot: Robot, limit_s: float = 20, lock: IO[bytes] | None = None
) -> Line:
    """Open a port, with a session for this kit on it. Raises Trouble."""
    from tiniscript.link.line import Line
    from tiniscript.link.ports import PortTrouble, opened
    from tiniscript.link.session import Session

    try:
        device = opened(port, baud, limit_s)
    except PortTrouble as trouble:
        if lock is not None:
            lock.close()
        raise port_trouble(port, trouble) from None
    session = Session(int.from_bytes(os.urandom(4), "little"), baud, robot.kit.fingerprint)
    return Line(device, session, lock)


def port_trouble(port: str, trouble: PortTrouble) -> Trouble:
    """Return the sentence for a port that does not open."""
    from tiniscript.link import ports

    key = f"port_{trouble.reason}"
    if trouble.reason == ports.FORBIDDEN and sys.platform.startswith("linux"):
        key = "port_forbidden_linux"
    if trouble.reason == ports.MISSING:
        known = ", ".join(each.port for each in ports.listed())
        if known:
            return Trouble(3, "port_missing_but", port=shown(port), known=shown(known))
    return Trouble(3, key, port=shown(port), why=shown(trouble.why))


def asked(line: Way, port: str, board: str, wait: Callable[[Asked], Reply]) -> Reply:
    """Ask who is there, but not so early that a board stays in its bootloader."""
    if not line.held_by:  # else the port is open already
        from tiniscript.link import ports

        if not ports.is_radio(port):
            sleep(QUIET_S.get(board, 0.0))
            reply = wait(hello(line, CABLE_ANSWER_MS))
            if line.heard:
                return reply
            sleep(LONG_QUIET_S)
            return wait(hello(line, CABLE_ANSWER_MS))
    return wait(hello(line, ANSWER_MS))


def hello(line: Way, limit_ms: int) -> Asked:
    """Begin a session. It is asked again until the robot answers: a reset takes it a while."""

    def make(session: Asks) -> Asked:
        task = session.hello()
        task.limit_ms = limit_ms
        return task

    return line.do(make)


def remember(port: str, name: str, is_used: bool = True) -> None:
    """Keep a port and what the robot on it is called. A virtual robot has no next time."""
    from tiniscript.link import known_ports
    from tiniscript.link.port_names import is_address

    if is_address(port) or port.startswith(PSEUDO):
        from tiniscript.virtual import directory

        if directory.is_virtual(port):
            return
    known_ports.remember(port, name, is_used)


def robot_of_kit(kit: int) -> str | None:
    from tiniscript.cli.images import robot_of_kit as found

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
