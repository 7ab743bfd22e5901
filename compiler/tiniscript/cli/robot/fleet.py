"""Many robots at once: a thread for each, so that none waits for another.

Knows no verb: each says what is done with one robot, and gets a `Connection` of its own for that.
"""

from __future__ import annotations

import json
import re
import sys
from argparse import Namespace
from collections import deque
from collections.abc import Callable, Mapping
from threading import Event, Thread
from time import monotonic
from typing import TYPE_CHECKING, NamedTuple

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.run_monitor import CONFIRM_S, confirmed
from tiniscript.cli.robot.targets import Post, posts
from tiniscript.cli.texts.common import text
from tiniscript.library import way

if TYPE_CHECKING:
    from tiniscript.cli.terminal.fleet_table import Roll
    from tiniscript.robots.profile import Robot

LOOK_S = 0.1
STRANGER_S = 4.0  # for which a port that nobody has named may be silent, if it never had a robot
# troubles that may only mean that there is no robot on a port that nobody has named
NOBODY = ("port_missing", "port_missing_but", "port_unreachable")
NO_ROBOT = (
    "link_silent", "link_other", "link_echo", "not_confirmed", "port_slow", "port_no_port",
    "port_broken", "port_busy", "port_forbidden", "port_forbidden_linux", "port_gone",
)  # fmt: skip


class Again(Exception):
    """The way to a robot has to be looked for again."""


class Result(NamedTuple):
    """How it went with one robot, as a sentence and as data. `is_absent`: there is none."""

    is_done: bool
    said: str
    fields: Mapping[str, object] = {}
    is_absent: bool = False


class Member:
    """One robot of many: its thread writes, all others read."""

    def __init__(self, post: Post, lines: deque[str]) -> None:
        self.post = post
        self.lines = lines  # that are printed when there is time: one thread does that for all
        self.name = post.name  # what it calls itself, once it has said so
        self.state: tuple[str, dict[str, object]] = ("crew_opening", {})
        self.value = ""  # the last that it has shown
        self.result: Result | None = None
        self.connection: Connection | None = None
        self.bug: Exception | None = None

    def tell(self, key: str, **values: object) -> None:
        """Say what happens now."""
        self.state = key, values

    def print(self, line: str) -> None:
        """Have a line printed."""
        self.lines.append(line)

    def meet(self, connection: Connection) -> None:
        """Ask the robot who it is. Raises Trouble."""
        self.tell("crew_asking")
        connection.meet()
        self.name = connection.name

    @property
    def is_absent(self) -> bool:
        return self.result is not None and self.result.is_absent

    @property
    def mark(self) -> str:
        if self.result is None:
            return ""
        return "absent" if self.is_absent else "ok" if self.result.is_done else "bad"

    def said(self, language: str) -> str:
        """Return what happens now, or how it went."""
        if self.result is not None:
            return self.result.said
        key, values = self.state
        said = text(key, language).format(**values)
        return f"{said}   {self.value}" if self.value else said

    @property
    def row(self) -> str:
        said = self.result.said if self.result is not None else ""
        name = f"{shown(self.name)} ({shown(self.post.port)})" if self.name else self.post.port
        return f"{name}: {said}"

    def as_json(self) -> str:
        assert self.result is not None
        is_done, said, fields, is_absent = self.result
        return json.dumps({
            "event": "RESULT", "port": self.post.port, "robot": self.name or None,
            "is_done": is_done, "is_absent": is_absent, "said": said, **fields,
        })  # fmt: skip


Work = Callable[[Connection, Member], Result]


def together(options: Namespace, robot: Robot, language: str, work: Work) -> int:
    """Do something with many robots, and print how it went; return the exit code.

    Ctrl-C stops all of them. Raises Trouble where there is none.
    """
    crew = Crew(posts(options), options, robot, language)
    if not crew.members:
        raise Trouble(3, "no_robots")
    crew.begin(work)
    try:
        if sys.stderr.isatty() and not options.json:
            from tiniscript.cli.terminal.fleet_table import Roll

            with Roll(crew.in_order(), language) as roll:
                crew.watch(roll)
        else:
            crew.watch(None)
    except OSError:  # nobody reads any more, or can, what the robots do
        if options.verb == "upload" and not options.detach:
            crew.interrupt()
            crew.wait(CONFIRM_S)
        raise
    finally:
        crew.remember()
    return crew.exit_code()


class Crew:
    def __init__(self, posts: list[Post], options: Namespace, robot: Robot, language: str) -> None:
        self.lines: deque[str] = deque()
        self.members = [Member(post, self.lines) for post in posts]
        self.options = options
        self.robot = robot
        self.language = language
        self.is_interrupted = False
        self._news = Event()

    def begin(self, work: Work) -> None:
        for member in self.members:
            Thread(target=self._run, args=(member, work), name="robot", daemon=True).start()

    def watch(self, roll: Roll | None) -> None:
        """Print results until all have one; Ctrl-C stops all, a second one leaves at once."""
        untold = list(self.members)
        begin_s = monotonic()
        end_s: float | None = None
        while untold and (end_s is None or monotonic() < end_s):
            if monotonic() - begin_s > STRANGER_S and all(map(_is_stranger, untold)):
                self._give_up(untold)
            try:
                if roll is not None:
                    roll.draw()
                else:
                    self._news.wait(LOOK_S)
                    self._news.clear()
            except KeyboardInterrupt:
                if self.is_interrupted:
                    return
                self.interrupt()
                end_s = monotonic() + CONFIRM_S + 1
            over = [member for member in untold if member.result is not None]
            untold = [member for member in untold if member not in over]
            for member in over:
                if member.bug is not None:
                    raise member.bug
                if roll is None:
                    self._print(member)
            self._print_lines(roll)
        if roll is not None:
            there = [member for member in self.in_order() if not member.is_absent]
            there.sort(key=lambda member: member.mark == "bad")  # what went wrong is seen last
            roll.end(member.row for member in there)
        self._print_sum()

    def wait(self, limit_s: float) -> None:
        """Wait until it is known of all how it went."""
        end_s = monotonic() + limit_s
        while monotonic() < end_s and any(member.result is None for member in self.members):
            self._news.wait(LOOK_S)
            self._news.clear()

    def interrupt(self) -> None:
        """Have every robot stopped."""
        self.is_interrupted = True
        for member in self.members:
            if member.connection is not None:
                member.connection.interrupt()

    def remember(self) -> None:
        """Keep the names of all that have answered, for the next time."""
        for member in self.members:
            connection = member.connection
            if connection is not None and connection.line.robot is not None:
                name = connection.card.name
                way.remember(member.post.port, name, is_used=False)

    def exit_code(self) -> int:
        if self.is_interrupted:
            return 2
        results = [member.result for member in self.members]
        if all(result is not None and result.is_absent for result in results):
            raise Trouble(3, "no_robots")
        is_fine = all(each is not None and (each.is_done or each.is_absent) for each in results)
        return 0 if is_fine else 3

    # -- a thread for each ------------------------------------------------------------------------

    def _run(self, member: Member, work: Work) -> None:
        try:
            self._connect(member, work)
        except Again:
            self._run(member, work)
            return
        except Trouble as trouble:
            member.result = self._failed(member, trouble)
        except Exception as bug:
            member.bug = bug
            member.result = Result(False, "")
        self._news.set()

    def _connect(self, member: Member, work: Work) -> None:
        own = Namespace(**{**vars(self.options), "port": member.post.port})
        with Connection(own, self.robot, self.language, is_one_of_many=True) as connection:
            member.connection = connection
            if self.is_interrupted:
                connection.interrupt()
            try:
                member.result = work(connection, member)
            except KeyboardInterrupt:
                member.result = self._stopped(connection)

    def _stopped(self, connection: Connection) -> Result:
        if confirmed(connection.line):
            return Result(False, text("robot_stopped", self.language))
        trouble = Trouble(3, "not_confirmed", port=shown(connection.port))
        return Result(False, _plain(trouble, self.language))

    def _failed(self, member: Member, trouble: Trouble) -> Result:
        is_absent = trouble.key in NOBODY or (trouble.key in NO_ROBOT and not member.post.is_known)
        said = _plain(trouble, self.language)
        return Result(False, said, {}, is_absent and not member.post.is_named)

    # -- what is printed --------------------------------------------------------------------------

    def _print(self, member: Member) -> None:
        self._print_lines(None)  # what it has told before
        if self.options.json:
            print(member.as_json(), flush=True)
        elif not member.is_absent:
            print(member.row, flush=True)

    def _print_lines(self, roll: Roll | None) -> None:
        while self.lines:
            line = self.lines.popleft()
            if roll is None:
                print(line, flush=True)
            else:
                roll.say(line)

    def _give_up(self, strangers: list[Member]) -> None:
        """Wait no longer for ports on which nobody has ever answered."""
        said = text("port_quiet", self.language)
        for member in strangers:
            member.result = Result(False, said, {}, is_absent=True)

    def in_order(self) -> list[Member]:
        """Return the robots by their ports, `COM9` before `COM10`."""

        def key(member: Member) -> list[tuple[int, str]]:
            parts = re.split(r"(\d+)", member.post.port)
            return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts]

        return sorted(self.members, key=key)

    def _print_sum(self) -> None:
        """Say how many it went well with, and where no robot is."""
        absent = [member for member in self.in_order() if member.is_absent]
        there = len(self.members) - len(absent)
        if self.options.json or not there:
            return
        sys.stdout.flush()
        done = sum(member.mark == "ok" for member in self.members)
        lines = [text("crew_sum", self.language).format(done=done, all=there)]
        if absent:
            ports = ", ".join(shown(member.post.port) for member in absent)
            lines.append(text("crew_absent", self.language).format(ports=ports))
        print("\n".join(lines), file=sys.stderr, flush=True)


def _is_stranger(member: Member) -> bool:
    """Whether nobody has ever answered on a port that nobody has named."""
    connection = member.connection
    has_answered = connection is not None and connection.line.robot is not None
    return not (has_answered or member.post.is_named or member.post.is_known)


def _plain(trouble: Trouble, language: str) -> str:
    return trouble.sentence(language).removeprefix("tsc: ")
