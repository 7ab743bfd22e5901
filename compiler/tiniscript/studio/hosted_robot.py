"""A robot on a port of this computer, which a page drives through `tsc studio`.

A thread of its own has the connection, shares it with other commands, and stops the robot when the
page has not been heard for a while (`attending`): a page that hangs, sleeps or was closed drives
nothing. From then on the link's thread does not ping for the page's run either, whatever this
thread does.
Knows no HTTP.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from threading import Thread
from time import monotonic

from tiniscript import robots
from tiniscript.library import opening
from tiniscript.library.client import Client
from tiniscript.library.errors import RobotError, TiniScriptError
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import ConnectionLost
from tiniscript.link.port_connection import PortConnection
from tiniscript.studio.attending import POLL_INTERVAL_S, Attending
from tiniscript.studio.robot_link import RobotLink, robot_data

PARTING_TIMEOUT_S = 8.0  # time to confirm a stop and close a port
VERB = "studio"  # the name that other commands show for the process that holds the port


class HostedRobot:
    """Call from any thread. It ends by itself when the page has left, or the port is lost.

    `is_unconfirmed`: the robot has not confirmed the stop at the end of what the page has started.
    """

    def __init__(
        self, port: str, robot: str, language: str, tab: str = "", connection: int = 0,
        stop_count: int = 0, earlier_robots: Sequence[HostedRobot] = (),
    ) -> None:  # fmt: skip
        """`robot` is the profile of the page's programs.

        `tab` and `connection` are the page's name of itself and its count of connections;
        `stop_count`: how many times that one has pressed STOP before, as far as it is done. The
        port is free when `earlier_robots` have closed it.
        """
        self.port = port
        self.tab = tab
        self.connection = connection
        self.has_ended = self.is_unconfirmed = False
        self.name = ""  # name of the robot, once it has answered
        self.attending = Attending(stop_count=stop_count)
        self._earlier_robots = earlier_robots
        self._profile = robots.load(robot)
        self._language = language
        self._is_leaving = self._is_letting_go = False
        self.is_holding_port = False  # whether another command drives the robot through this port
        self._leave_reason = "left"
        self._link: RobotLink | None = None
        self._thread = Thread(target=self._run, name="studio robot", daemon=True)
        self._thread.start()

    def leave(self, reason: str = "left", is_letting_go: bool = False) -> None:
        """Stop what the page has started, and close the port: once no other command drives the
        robot through it, or at once where it `is_letting_go`."""
        self._leave_reason = reason
        self._is_letting_go = self._is_letting_go or is_letting_go
        self._is_leaving = True

    @property
    def is_running(self) -> bool:
        """Return whether a run that the page has started may be running."""
        link = self._link
        return link is not None and not self.has_ended and link.owns_run

    @property
    def is_parting(self) -> bool:
        """Return whether a stop has to be confirmed, or the port to be closed."""
        return (self.has_ended or self._is_leaving) and self._thread.is_alive()

    @property
    def was_left(self) -> bool:
        """Return whether the page has left it, whatever the robot does."""
        return self._is_leaving or self.attending.has_left

    def join(self, timeout_s: float) -> None:
        self._thread.join(timeout_s)

    @property
    def is_attended(self) -> bool:
        return not self._is_leaving and self.attending.is_attended

    # -- the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        self._wait_for_port()
        if self.was_left:
            self._end(self._leave_reason)
            return
        try:
            client = Client(
                self.port, VERB, self._profile, language=self._language,
                is_latched=lambda: self.attending.is_latched,
                poll=lambda: self.attending.stop_if_wanted(client.connection.stop),
            )  # fmt: skip
        except RobotError as failure:
            self._end(failure.key, str(failure))
            return
        try:
            self._link = link = RobotLink(client.connection, self._language)
            self._ping_while_attended(client, link)
            if self._meet(client):
                while not self.was_left:
                    self.attending.attend(link)
                self._part_from_robot(link)
                self._end(self._leave_reason if self._is_leaving else "unheard")
                self.is_holding_port = client.holds_for_others
                with suppress(RobotError):  # the port is lost, and the page knows
                    client.hold_for_others(lambda: not self._is_letting_go)
        except ConnectionLost as connection_lost:
            error = client.robot_error_for_loss(connection_lost)
            self._end(error.key, str(error))
        except RobotError as error:
            self._end(error.key, str(error))
        except Exception as bug:
            self._end("bug", str(bug))
            raise
        finally:
            self.has_ended = True
            client.close(must_stop_run=self._link is not None and self._link.owns_run)

    def _wait_for_port(self) -> None:
        """Wait for those before, as long as their stops may take."""
        end_s = monotonic() + PARTING_TIMEOUT_S
        for earlier_robot in self._earlier_robots:
            while (
                earlier_robot.is_parting
                and not earlier_robot.is_holding_port
                and monotonic() < end_s
                and not self.was_left
            ):
                earlier_robot.join(POLL_INTERVAL_S)
        self._earlier_robots = ()

    def _ping_while_attended(self, client: Client, link: RobotLink) -> None:
        """Ping the robot unless another command attends to it."""
        if client.connection.holder_verb:
            return
        assert isinstance(client.connection, PortConnection)
        session = client.connection.session
        session.sends_heartbeat = lambda: (
            self.is_attended or (session.is_running and not link.owns_run)
        )

    def _meet(self, client: Client) -> bool:
        """Say hello to the robot; return whether it has answered."""
        connection = client.connection
        try:
            robot = client.meet(should_retry=lambda: not self.was_left)
        except TiniScriptError as failure:
            if connection.has_ended:
                raise
            # Failures that are no status have their own sentence on the page.
            self._end(failure.key, str(failure) if failure.key in STATUSES else "")
            return False
        opening.remember(self.port, robot.name)
        self.name = robot.name
        self.attending.queue_news(
            [{"connected": robot_data(robot), "held_by": connection.holder_verb}]
        )
        return True

    def _part_from_robot(self, link: RobotLink) -> None:
        """Stop what the page has started, and tell it of that before it hears that it is over."""
        if not link.owns_run:
            return
        self.attending.queue_news(
            [*link.news(), {"event": "STOPPING"}]
        )  # no earlier stop confirms this
        link.stop()
        self.is_unconfirmed = True
        end_s = monotonic() + opening.CONFIRM_TIMEOUT_S
        events: list[str | None] = []
        while monotonic() < end_s and "LOST" not in events:
            news = link.news(POLL_INTERVAL_S)
            self.attending.queue_news(news)
            events = [news_item.get("event") for news_item in news]
            if "STOPPED" in events:
                self.is_unconfirmed = False
                return

    def _end(self, reason: str, message: str = "") -> None:
        self.has_ended = True
        self.attending.end()
        self.attending.queue_news([{"over": reason, "said": message}])
