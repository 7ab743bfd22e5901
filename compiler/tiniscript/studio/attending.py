"""What a page has asked of its robot and is told of it, and what is still done for it.

A stop makes what was asked before it void. A teacher's STOP latches: whatever reaches the robot
within LATCH_S after it is refused, and so is what a page had made before it heard of the stop, when
that arrives later. Knows no port and no thread; any thread may call it.
"""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock
from time import monotonic

from tiniscript.studio.robot_link import BadRequest, Json, RobotLink

HEARD_S = 0.5  # a page that is silent for longer does not drive
LEFT_S = 3.0  # a page that is silent for longer has left
LATCH_S = 2.0  # after a teacher's STOP, for uploads that are on their way
LOOK_S = 0.02
KEPT = 1000  # news for a page that does not fetch them
ASKED, CONFIRMED, SILENT = "asked", "confirmed", "silent"  # what is known of a teacher's STOP
_MAY_MISS = ("SHOW", "TEXT", "PLACE")
_VOID = {"failure": "stopped_elsewhere"}


class Attending:
    """`last_stop`: what is known of the newest latching stop."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self.last_stop = ""
        self._clock = clock
        self._heard_s = clock()
        self._latched_until_s = float("-inf")
        self._lock = Lock()
        self._asked: list[Json] = []
        self._news: list[Json] = []
        self._count = 0  # of news
        self._wants_stop = self._is_silent = False
        self._last = 0  # number of the last request: one that comes again was lost on its way back
        self._stops = 0  # what was asked before one of them is void

    # -- the page ---------------------------------------------------------------------------------

    def on_requests(self, requests: list[Json], seen: int) -> list[Json]:
        """The page is there: take its requests; return the news after number `seen`."""
        with self._lock:
            self._heard_s = self._clock()
            for each in requests:
                number = each.get("id")
                if type(number) is int and number > self._last:
                    self._last = number
                    self._asked.append(each)
            if self.is_latched:
                self._void()
            self._news = [each for each in self._news if each["number"] > seen]
            return list(self._news)

    def stop(self, stops: int = 0) -> None:
        """Stop the robot, whatever waits. Requests with fewer `stops` were made before this one:
        they may arrive after it."""
        with self._lock:
            self._stops = max(self._stops, stops)
            self._wants_stop = True

    def latch(self, until_s: float | None = None, stops: bool = True) -> None:
        """Refuse what is asked for a while, and stop the robot."""
        with self._lock:
            self._latched_until_s = self._clock() + LATCH_S if until_s is None else until_s
            if stops:
                self._stops += 1
                self._wants_stop = True
                self.last_stop = ASKED
                self._add({"stops": self._stops})
            self._void()

    @property
    def is_latched(self) -> bool:
        return self._clock() < self._latched_until_s

    @property
    def is_attended(self) -> bool:
        return self.silent_s <= HEARD_S

    @property
    def silent_s(self) -> float:
        """For how long the page has not been heard."""
        return self._clock() - self._heard_s

    @property
    def has_left(self) -> bool:
        return self.silent_s > LEFT_S

    def tell(self, news: list[Json]) -> None:
        with self._lock:
            for each in news:
                self._add(each)

    # -- the robot --------------------------------------------------------------------------------

    def attend(self, link: RobotLink, limit_s: float = LOOK_S) -> None:
        """Pass on what waits, and tell what is new."""
        if self._wants_stop:
            self._take(link.news())  # no earlier stop confirms this one
        self.stop_if_wanted(link.stop)
        with self._lock:
            asked, self._asked = self._asked, []
        for request in asked:
            stops = request.get("stops", 0)
            if type(stops) is int and stops < self._stops:
                self.tell([{"id": request["id"], **_VOID}])
                continue
            try:
                link.ask(request)
            except BadRequest:
                self.tell([{"id": request["id"], "failure": "bad_request"}])
        self._take(link.news(limit_s))
        if self.is_attended:
            self._is_silent = False
        elif link.has_run and not self._is_silent:
            self._is_silent = True
            link.stop()

    def stop_if_wanted(self, stop: Callable[[], object]) -> None:
        if self._wants_stop:
            self._wants_stop = False
            stop()

    def end(self) -> None:
        """The connection is over: nobody confirms anything any more."""
        if self.last_stop == ASKED:
            self.last_stop = SILENT

    def _take(self, news: list[Json]) -> None:
        if self.last_stop == ASKED and not self._wants_stop:
            events = [each.get("event") for each in news]
            if "STOPPED" in events:
                self.last_stop = CONFIRMED
            elif "LOST" in events:
                self.last_stop = SILENT
        self.tell(news)

    def _void(self) -> None:
        for each in self._asked:
            if each.get("do") != "stop":
                self._add({"id": each["id"], **_VOID})
        self._asked = [each for each in self._asked if each.get("do") == "stop"]

    def _add(self, news: Json) -> None:
        self._count += 1
        self._news.append({**news, "number": self._count})
        while len(self._news) > KEPT:
            missed = next((each for each in self._news if each.get("event") in _MAY_MISS), None)
            self._news.remove(missed or self._news[0])
