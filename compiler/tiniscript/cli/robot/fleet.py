"""Many robots at once: a thread for each, so that none waits for another.

Knows no verb: a verb passes a function, which gets a `Connection` for each robot.
"""

from __future__ import annotations

import re
import sys
from argparse import Namespace
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from threading import Thread
from time import monotonic
from typing import TYPE_CHECKING

from tiniscript.base.bell import Bell
from tiniscript.cli import streams
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.member import Member, Result, Target, targets
from tiniscript.cli.texts import text
from tiniscript.library import opening
from tiniscript.robots.profile import Robot

if TYPE_CHECKING:
    from tiniscript.cli.terminal.fleet_table import FleetTable


POLL_INTERVAL_S = 0.1
STRANGER_TIMEOUT_S = (
    4.0  # timeout for a port that the user has not named and that never had a robot
)
# failures that may only mean that a port that the user has not named has no robot
ABSENT_REASONS = (
    "port_missing", "port_missing_but", "port_unreachable", "port_not_found", "port_not_found_but",
    "port_not_announced",
)  # fmt: skip
NO_ROBOT_REASONS = (
    "link_silent", "link_other", "link_foreign", "link_echo", "not_confirmed", "port_slow",
    "port_no_port", "port_broken", "port_busy", "port_forbidden", "port_forbidden_linux",
    "port_gone", "port_no_robot", "radio_gone", "stop_held", "stop_held_unknown",
)  # fmt: skip


class Reconnect(Exception):
    """The connection to a robot has to be opened again."""


Work = Callable[[Connection, Member], Result]


def run_together(options: Namespace, robot: Robot, language: str, work: Work) -> int:
    """Run `work` for many robots and print the results; return the exit code.

    Ctrl-C stops all of them. Raises CommandError if there is none.
    """
    fleet = Fleet(targets(options), options, robot, language)
    if not fleet.members:
        raise CommandError(3, "no_robots")
    fleet.start_work(work)
    try:
        if sys.stderr.isatty() and not options.json:
            from tiniscript.cli.terminal.fleet_table import FleetTable

            with FleetTable(fleet.sorted_members(), language) as table:
                fleet.print_until_done(table)
        else:
            fleet.print_until_done(None)
    except KeyboardInterrupt:  # an interrupt may come while printing
        fleet.interrupt_robots()
        streams.drop_unread_output()
        fleet.stop_robots()
    except OSError:  # the output has no reader, or cannot be written
        if options.verb == "upload" and not options.detach:
            fleet.stop_robots()
        raise
    finally:
        fleet.remember_names()
    return fleet.exit_code()


class Fleet:
    def __init__(
        self, targets: list[Target], options: Namespace, robot: Robot, language: str
    ) -> None:
        self.lines: deque[str] = deque()
        self.members = [Member(target, self.lines) for target in targets]
        self.options = options
        self.robot = robot
        self.language = language
        self.is_interrupted = False
        self._result_bell = Bell()
        self._attend: Callable[[], None] = getattr(options, "attend", lambda: None)

    def start_work(self, work: Work) -> None:
        self._attend()
        for member in self.members:
            Thread(target=self._work_on, args=(member, work), name="robot", daemon=True).start()

    def print_until_done(self, table: FleetTable | None) -> None:
        """Print results until all have one; Ctrl-C stops all, a second one leaves at once."""
        unfinished_members = list(self.members)
        begin_s = monotonic()
        end_s: float | None = None
        while unfinished_members and (end_s is None or monotonic() < end_s):
            self._attend()
            if monotonic() - begin_s > STRANGER_TIMEOUT_S and all(
                map(_is_stranger, unfinished_members)
            ):
                self._give_up(unfinished_members)
            try:
                if table is not None:
                    table.draw()
                else:
                    self._result_bell.wait(POLL_INTERVAL_S)
                self._raise_if_reader_gone()
                self._print_results(unfinished_members, table)
            except KeyboardInterrupt:
                if self.is_interrupted:
                    return
                self.interrupt_robots()
                streams.drop_unread_output()
                end_s = monotonic() + opening.CONFIRM_TIMEOUT_S + 1
        if table is not None:
            present_members = [member for member in self.sorted_members() if not member.is_absent]
            present_members.sort(
                key=lambda member: member.mark == "bad"
            )  # failures are printed last
            table.end(member.result_line for member in present_members)
        self._print_summary()

    def _raise_if_reader_gone(self) -> None:
        """Raise BrokenPipeError if robots drive and the output has no reader."""
        is_driving = self.options.verb == "upload" and not self.options.detach
        if is_driving and not self.is_interrupted:
            streams.raise_if_reader_gone()

    def _print_results(self, unfinished_members: list[Member], table: FleetTable | None) -> None:
        """Print the results that are new, and take those robots out of `unfinished_members`."""
        for member in [member for member in unfinished_members if member.result is not None]:
            if member.bug is not None:
                raise member.bug
            if table is None:
                self._print_result(member)
            unfinished_members.remove(member)
        self._print_lines(table)

    def stop_robots(self) -> None:
        """Stop every robot, and wait until they have confirmed; a second Ctrl-C ends the wait."""
        self.interrupt_robots()
        with suppress(KeyboardInterrupt):
            self.wait_for_results(opening.CONFIRM_TIMEOUT_S)

    def wait_for_results(self, timeout_s: float) -> None:
        """Wait until all robots have a result."""
        end_s = monotonic() + timeout_s
        while monotonic() < end_s and any(member.result is None for member in self.members):
            self._attend()
            self._result_bell.wait(POLL_INTERVAL_S)

    def interrupt_robots(self) -> None:
        """Stop every robot."""
        self.is_interrupted = True
        for member in self.members:
            if member.connection is not None:
                member.connection.interrupt()

    def remember_names(self) -> None:
        """Remember the names of all robots that have answered."""
        for member in self.members:
            connection = member.connection
            if connection is not None and connection.connection.robot is not None:
                name = connection.device_info.name
                opening.remember(member.target.port, name, is_used=False)

    def exit_code(self) -> int:
        if self.is_interrupted:
            return 2
        results = [member.result for member in self.members]
        if all(result is not None and result.is_absent for result in results):
            raise CommandError(3, "no_robots")
        is_fine = all(
            result is not None and (result.is_done or result.is_absent) for result in results
        )
        return 0 if is_fine else 3

    # -- a thread for each ------------------------------------------------------------------------

    def _work_on(self, member: Member, work: Work) -> None:
        try:
            try:
                self._connect(member, work)
            except CommandError as error:
                member.result = self._failure_result(member, error)
        except Reconnect:
            self._work_on(member, work)
            return
        except Exception as bug:
            member.bug = bug
            member.result = Result(False, "")
        self._result_bell.ring()

    def _connect(self, member: Member, work: Work) -> None:
        member_options = Namespace(**{**vars(self.options), "port": member.target.port})
        with Connection(
            member_options, self.robot, self.language, is_one_of_many=True
        ) as connection:
            member.connection = connection
            if self.is_interrupted:
                connection.interrupt()
            try:
                member.result = work(connection, member)
            except KeyboardInterrupt:
                member.result = self._stop_result(connection)

    def _stop_result(self, connection: Connection) -> Result:
        if connection.stop():
            return Result(False, text("robot_stopped", self.language))
        error = CommandError(3, "not_confirmed", port=printable_name(connection.port))
        return Result(False, error.plain_sentence(self.language))

    def _failure_result(self, member: Member, error: CommandError) -> Result:
        target = member.target
        is_absent = error.key in ABSENT_REASONS or (
            error.key in NO_ROBOT_REASONS and not target.is_known
        )
        sentence = error.plain_sentence(self.language)
        return Result(False, sentence, {}, is_absent and not target.is_named)

    # -- output -----------------------------------------------------------------------------------

    def _print_result(self, member: Member) -> None:
        self._print_lines(None)  # lines from before
        if self.options.json:
            print(member.as_json(), flush=True)
        elif not member.is_absent:
            print(member.result_line, flush=True)

    def _print_lines(self, table: FleetTable | None) -> None:
        while self.lines:
            line = self.lines.popleft()
            if table is None:
                print(line, flush=True)
            else:
                table.print_line(line)

    def _give_up(self, strangers: list[Member]) -> None:
        """Give up the ports on which no robot has ever answered."""
        sentence = text("port_quiet", self.language)
        for member in strangers:
            if member.result is None:
                member.result = Result(False, sentence, {}, is_absent=True)

    def sorted_members(self) -> list[Member]:
        """Return the robots by their ports, `COM9` before `COM10`."""

        def key(member: Member) -> list[tuple[int, str]]:
            parts = re.split(r"(\d+)", member.target.port)
            return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts]

        return sorted(self.members, key=key)

    def _print_summary(self) -> None:
        """Print the number of successes, and the ports without a robot."""
        absent_members = [member for member in self.sorted_members() if member.is_absent]
        present_count = len(self.members) - len(absent_members)
        if self.options.json or not present_count:
            return
        sys.stdout.flush()
        done_count = sum(member.mark == "ok" for member in self.members)
        lines = [text("crew_sum", self.language).format(done=done_count, all=present_count)]
        if absent_members:
            ports = ", ".join(printable_name(member.target.port) for member in absent_members)
            lines.append(text("crew_absent", self.language).format(ports=ports))
        print("\n".join(lines), file=sys.stderr, flush=True)


def _is_stranger(member: Member) -> bool:
    """Return whether the port was not named by the user and no robot has ever answered on it."""
    connection = member.connection
    has_answered = connection is not None and connection.connection.robot is not None
    return not (has_answered or member.target.is_named or member.target.is_known)
