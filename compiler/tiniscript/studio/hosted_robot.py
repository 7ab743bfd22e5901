"""A robot on a port of this computer, which a page drives through `tsc studio`.

A thread of its own has the connection, shares it with other commands, and stops the robot when the
page has not been heard for a while (`attending`): a page that hangs, sleeps or was closed drives
nothing. From then on the link's thread does not ping for the page's run either, whatever this
thread does.
Knows no HTTP.
"""

from __future__ import annotations

from contextlib import suppress
from threading import Thread
from typing import IO, TYPE_CHECKING

from tiniscript import robots
from tiniscript.library import opening
from tiniscript.library.errors import RobotError
from tiniscript.studio.attending import Attending
from tiniscript.studio.robot_link import RobotLink, about

if TYPE_CHECKING:
    from tiniscript.link.connection import LinkConnection, PendingRequest
    from tiniscript.link.line import Line
    from tiniscript.link.payloads import HelloReply
    from tiniscript.link.requests import Reply
    from tiniscript.sharing.server import Server

VERB = "studio"  # the name that other commands show for the process that holds the port


class HostedRobot:
    """Call from any thread. It ends by itself when the page has left, or the port is gone."""

    def __init__(self, port: str, robot: str, language: str) -> None:
        """`robot` is the profile of the page's programs."""
        self.port = port
        self.has_ended = False
        self.why_ended = ""
        self.name = ""  # of the robot, once it has answered
        self.attending = Attending()
        self._profile = robots.load(robot)
        self._language = language
        self._leaves = False
        self._why = "left"
        self._link: RobotLink | None = None
        self._thread = Thread(target=self._run, name="studio robot", daemon=True)
        self._thread.start()

    def leave(self, why: str = "left") -> None:
        """Stop what the page has started, and close the port."""
        self._why = why
        self._leaves = True

    @property
    def is_parting(self) -> bool:
        """Whether a stop is still to be confirmed, or the port to be closed."""
        return self.has_ended and self._thread.is_alive()

    def join(self, limit_s: float) -> None:
        self._thread.join(limit_s)

    @property
    def is_attended(self) -> bool:
        return not self._leaves and self.attending.is_attended

    # -- the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        from tiniscript.link.outcomes import Gone

        try:
            line = opening.connection_to(self.port, VERB, self._open, language=self._language)
        except RobotError as failure:
            self._end(failure.key, str(failure))
            return
        server = None
        try:
            self._link = link = RobotLink(line, self._language)
            server = self._shared(line, link)
            if self._meet(line):
                while not self._has_left():
                    self.attending.attend(link)
                self._end(self._why)
        except Gone as gone:
            reason = opening.reason_of_end(line, gone, self.port)
            values = {"port": opening.shown(self.port), "verb": line.held_by}
            self._end(reason, str(RobotError(reason, self._language, values)))
        except Exception as bug:
            self._end("bug", str(bug))
            raise
        finally:
            self._part(line, server)

    def _open(self, address: str, lock: IO[bytes] | None) -> Line:
        board, kit = self._profile.board, self._profile.kit.fingerprint
        return opening.opened_line(
            address, board.baud, kit, lock=lock, language=self._language, port=self.port
        )

    def _shared(self, line: LinkConnection, link: RobotLink) -> Server | None:
        """Share the port, so that other commands can stop the robot meanwhile."""
        if line.held_by:
            return None
        from tiniscript.link.line import Line
        from tiniscript.sharing.server import Server

        assert isinstance(line, Line)
        session = line.session
        # What another command has started is for that command to attend to.
        session.may_beat = lambda: self.is_attended or (session.is_running and not link.has_run)
        with suppress(OSError):
            is_latched = lambda: self.attending.is_latched  # noqa: E731
            return Server(line, self.port, self._profile.board.baud, VERB, is_latched)
        return None

    def _meet(self, line: LinkConnection) -> bool:
        """Say hello to the robot; return whether it has answered."""
        from tiniscript.link.outcomes import CANCELLED

        def wait(request: PendingRequest[HelloReply]) -> Reply[HelloReply]:
            return line.wait(request, look=lambda: self.attending.stop_if_wanted(line.stop))

        reply = opening.met(line, self.port, self._profile.board.chip, wait)
        while reply.status == CANCELLED and not self._has_left():  # a stop came first
            reply = wait(opening.hello(line, opening.ANSWER_MS))
        robot = line.robot
        if reply.status or robot is None:
            reason = opening.reason_of(line, reply)
            said = ""
            if reason == "status":
                from tiniscript.link.statuses import name_of, sentence

                reason = name_of(reply.status)
                said = " ".join(sentence(reply.status, reply.detail, self._language)).strip()
            self._end(reason, said)
            return False
        opening.remember(self.port, robot.name)
        self.name = robot.name
        self.attending.tell([{"connected": about(robot), "held_by": line.held_by}])
        return True

    def _has_left(self) -> bool:
        return self._leaves or self.attending.has_left

    def _part(self, line: LinkConnection, server: Server | None) -> None:
        """Stop what the page, or a command that shares the port, has started; close the port."""
        self.has_ended = True
        try:
            has_run = self._link is not None and self._link.has_run
            if server is not None:
                has_run = has_run or server.has_run
                server.close()
            if has_run and not line.has_ended:
                opening.confirmed(line)
        finally:
            line.close()

    def _end(self, reason: str, said: str = "") -> None:
        self.why_ended = reason
        self.has_ended = True
        self.attending.end()
        self.attending.tell([{"over": reason, "said": said}])
