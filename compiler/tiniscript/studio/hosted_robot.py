"""A robot on a port of this computer, which a page drives through `tsc studio`.

A thread of its own has the connection, shares it with other commands, and stops the robot when the
page has not been heard for HEARD_S: a page that hangs, sleeps or was closed drives nothing. From
then on the link's thread does not ping for the page's run either, whatever this thread does.
Knows no HTTP.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from threading import Lock, Thread
from time import monotonic
from typing import IO, TYPE_CHECKING, TypeVar

from tiniscript import robots
from tiniscript.library import opening
from tiniscript.library.errors import RobotError
from tiniscript.studio.robot_link import BadRequest, Json, RobotLink, about

if TYPE_CHECKING:
    from tiniscript.link.connection import LinkConnection, PendingRequest
    from tiniscript.link.line import Line
    from tiniscript.link.payloads import HelloReply
    from tiniscript.link.requests import Reply
    from tiniscript.sharing.server import Server

T = TypeVar("T")

VERB = "studio"  # the name that other commands show for the process that holds the port
HEARD_S = 0.5  # a page that is silent for longer does not drive
LEFT_S = 3.0  # a page that is silent for longer has left
LOOK_S = 0.02
KEPT = 1000  # news for a page that does not fetch them
_MAY_MISS = ("SHOW", "TEXT", "PLACE")


class HostedRobot:
    """Call from any thread. It ends by itself when the page has left, or the port is gone."""

    def __init__(self, port: str, robot: str, language: str) -> None:
        """`robot` is the profile of the page's programs."""
        self.port = port
        self.has_ended = False
        self.why_ended = ""
        self.name = ""  # of the robot, once it has answered
        self.heard_s = monotonic()
        self._profile = robots.load(robot)
        self._language = language
        self._lock = Lock()
        self._asked: list[Json] = []
        self._news: list[Json] = []
        self._count = 0  # of news
        self._wants_stop = self._leaves = self._is_silent = False
        self._why = "left"
        self._last = 0  # number of the last request: one that comes again was lost on its way back
        self._stops = 0  # that the page has asked for: what it asked before is void
        self._link: RobotLink | None = None
        self._thread = Thread(target=self._run, name="studio robot", daemon=True)
        self._thread.start()

    def hear(self, requests: list[Json], seen: int) -> list[Json]:
        """The page is there: take its requests; return the news after number `seen`."""
        with self._lock:
            self.heard_s = monotonic()
            for each in requests:
                number = each.get("id")
                if type(number) is int and number > self._last:
                    self._last = number
                    self._asked.append(each)
            self._news = [each for each in self._news if each["number"] > seen]
            return list(self._news)

    def stop(self, stops: int = 0) -> None:
        """Stop the robot, whatever waits. Requests with fewer `stops` were made before this one:
        they may arrive after it."""
        self._stops = max(self._stops, stops)
        self._wants_stop = True

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
        return not self._leaves and monotonic() - self.heard_s <= HEARD_S

    # -- the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        from tiniscript.link.outcomes import Gone

        try:
            line = opening.connection_to(self.port, VERB, self._open, language=self._language)
        except RobotError as failure:
            self._end(failure.reason, str(failure))
            return
        server = None
        try:
            self._link = link = RobotLink(line, self._language)
            server = self._shared(line, link)
            if self._meet(line):
                while not self._has_left():
                    self._attend(link)
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
            return Server(line, self.port, self._profile.board.baud, VERB)
        return None

    def _meet(self, line: LinkConnection) -> bool:
        """Say hello to the robot; return whether it has answered."""
        from tiniscript.link.outcomes import CANCELLED

        def wait(request: PendingRequest[HelloReply]) -> Reply[HelloReply]:
            return line.wait(request, look=lambda: self._stop_if_wanted(line.stop))

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
        self._tell([{"connected": about(robot), "held_by": line.held_by}])
        return True

    def _attend(self, link: RobotLink) -> None:
        self._stop_if_wanted(link.stop)
        with self._lock:
            asked, self._asked = self._asked, []
        for request in asked:
            stops = request.get("stops", 0)
            if type(stops) is int and stops < self._stops:
                self._tell([{"id": request["id"], "failure": "stopped_elsewhere"}])
                continue
            try:
                link.ask(request)
            except BadRequest:
                self._tell([{"id": request["id"], "failure": "bad_request"}])
        self._tell(link.news(LOOK_S))
        if self.is_attended:
            self._is_silent = False
        elif link.has_run and not self._is_silent:
            self._is_silent = True
            link.stop()

    def _stop_if_wanted(self, stop: Callable[[], None]) -> None:
        if self._wants_stop:
            self._wants_stop = False
            stop()

    def _has_left(self) -> bool:
        return self._leaves or monotonic() - self.heard_s > LEFT_S

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

    def _tell(self, news: list[Json]) -> None:
        with self._lock:
            for each in news:
                self._count += 1
                self._news.append({**each, "number": self._count})
            while len(self._news) > KEPT:
                missed = next((each for each in self._news if each.get("event") in _MAY_MISS), None)
                self._news.remove(missed or self._news[0])

    def _end(self, reason: str, said: str = "") -> None:
        self.why_ended = reason
        self.has_ended = True
        self._tell([{"over": reason, "said": said}])
