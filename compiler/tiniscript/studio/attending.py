"""What a page has asked of its robot and is told of it, and what is still done for it.

A page counts the times that its user presses STOP, and the count rides in every beat: a request
that is lost, late or repeated loses no stop, and each number stops the robot once. It stops nothing
only where a run that the page has asked for after it is accepted already. A stop without a number,
as anybody else's is, always stops.

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
    """`last_stop`: what is known of the newest latching stop. `stops`: the page's newest one that
    has nothing to stop any more. `witness`, if there is one, hears the news, too; it must not let
    the robot wait."""

    def __init__(self, clock: Callable[[], float] = monotonic, stops: int = 0) -> None:
        self.last_stop = ""
        self.stops = stops
        self.witness: Callable[[list[Json]], object] | None = None
        self._clock = clock
        self._heard_s = clock()
        self._latched_until_s = float("-inf")
        self._lock = Lock()
        self._asked: list[Json] = []
        self._news: list[Json] = []
        self._count = 0  # of news
        self._wants_stop = self._is_silent = False
        self._last = 0  # number of the last request: one that comes again was lost on its way back
        self._latched = 0  # number of the news that tells of the newest latching stop
        self._runs: dict[int, int] = {}  # that are asked for, with the stops before them
        self._was_heard = False

    # -- the page ---------------------------------------------------------------------------------

    def on_beat(self, requests: list[Json], seen: int, stops: int = 0) -> list[Json]:
        """The page is there: take its stops and its requests; return the news after number `seen`.

        `stops` is 0 where nobody has pressed STOP yet.
        """
        with self._lock:
            self._heard_s = self._clock()
            self._was_heard = True
            if stops > self.stops:
                self._stop(stops)
            for request in requests:
                number = request.get("id")
                if type(number) is int and number > self._last:
                    self._last = number
                    self._asked.append(request)
            if self.is_latched:
                self._void()
            self._news = [item for item in self._news if item["number"] > seen]
            return list(self._news)

    def connect_again(self) -> None:
        """The page asks for it anew: it has not got the answer."""
        if not self._was_heard:
            self._heard_s = self._clock()

    def stop(self, stops: int = 0) -> None:
        """Stop the robot, whatever waits, except where that was done for this number; one without a
        number always stops."""
        with self._lock:
            if not stops or stops > self.stops:
                self._stop(stops)

    def latch(self, until_s: float | None = None, stops: bool = True) -> None:
        """Refuse what is asked for a while, and stop the robot."""
        with self._lock:
            self._latched_until_s = self._clock() + LATCH_S if until_s is None else until_s
            if stops:
                self._wants_stop = True
                self.last_stop = ASKED
                self._add({"stopped": True})
                self._latched = self._count
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
    def is_half_made(self) -> bool:
        """Whether its page does not know of it: that was told it, and the answer was lost."""
        return not self._was_heard and not self.is_attended

    @property
    def has_left(self) -> bool:
        return self.silent_s > LEFT_S

    def tell(self, news: list[Json]) -> None:
        with self._lock:
            for item in news:
                self._add(item)
        witness = self.witness
        if witness is not None:
            witness(news)

    # -- the robot --------------------------------------------------------------------------------

    def attend(self, link: RobotLink, limit_s: float = LOOK_S) -> None:
        """Pass on what waits, and tell what is new."""
        if self._wants_stop:
            self._apply_news(link.news())  # no earlier stop confirms this one
        self.stop_if_wanted(link.stop)
        with self._lock:
            asked, self._asked = self._asked, []
        for request in asked:
            stops = _count(request, "stops")
            if stops < self.stops or _count(request, "seen") < self._latched:
                self.tell([{"id": request["id"], **_VOID}])
                continue
            if _runs(request):
                self._runs[request["id"]] = stops
            try:
                link.ask(request)
            except BadRequest:
                self._runs.pop(request["id"], None)
                self.tell([{"id": request["id"], "failure": "bad_request"}])
        self._apply_news(link.news(limit_s))
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

    def _stop(self, stops: int) -> None:
        self.stops = max(self.stops, stops)
        self._wants_stop = True

    def _apply_news(self, news: list[Json]) -> None:
        with self._lock:
            for item in news:
                stops = self._runs.pop(item["id"], 0) if "id" in item else 0
                if item.get("ok"):
                    self.stops = max(self.stops, stops)
        if self.last_stop == ASKED and not self._wants_stop:
            events = [item.get("event") for item in news]
            if "STOPPED" in events:
                self.last_stop = CONFIRMED
            elif "LOST" in events:
                self.last_stop = SILENT
        self.tell(news)

    def _void(self) -> None:
        for item in self._asked:
            if item.get("do") != "stop":
                self._add({"id": item["id"], **_VOID})
        self._asked = [item for item in self._asked if item.get("do") == "stop"]

    def _add(self, news: Json) -> None:
        self._count += 1
        self._news.append({**news, "number": self._count})
        while len(self._news) > KEPT:
            missed = next((item for item in self._news if item.get("event") in _MAY_MISS), None)
            self._news.remove(missed or self._news[0])


def _count(request: Json, name: str) -> int:
    result = request.get(name)
    return result if type(result) is int else 0


def _runs(request: Json) -> bool:
    do = request.get("do")
    return do in ("live", "start") or (do == "upload" and request.get("runs") is True)
