"""The requests and events of a page about its robot, and the pending work for it.

A page counts the times that its user presses STOP, and the count rides in every beat: a request
that is lost, late or repeated loses no stop, and each number stops the robot once. It stops nothing
only where a run that the page has asked for after it is accepted already. A stop without a number,
such as another user's, always stops.

A stop makes what was asked before it void. A teacher's STOP latches: whatever reaches the robot
within LATCH_S after it is refused, and so is what a page had made before it heard of the stop, when
that arrives later. Knows no port and no thread; any thread may call it.
"""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock
from time import monotonic

from tiniscript.studio.robot_link import BadRequest, Json, RobotLink

ATTENDED_S = 0.5  # a page that is silent for longer does not drive
LEFT_S = 3.0  # a page that is silent for longer has left
LATCH_S = 2.0  # time after a teacher's STOP in which uploads under way are refused
POLL_INTERVAL_S = 0.02
MAX_PENDING_NEWS = 1000  # news for a page that does not fetch them
ASKED, CONFIRMED, SILENT = "asked", "confirmed", "silent"  # states of a teacher's STOP
_DROPPABLE_EVENTS = ("SHOW", "TEXT", "PLACE")
_VOID_ANSWER = {"failure": "stopped_elsewhere"}


class Attending:
    """`last_stop`: the state of the newest latching stop. `stop_count`: the page's newest one with
    nothing left to stop. `witness`, if present, hears the events, too; it must not delay the robot.
    """

    def __init__(self, clock: Callable[[], float] = monotonic, stop_count: int = 0) -> None:
        self.last_stop = ""
        self.stop_count = stop_count
        self.witness: Callable[[list[Json]], object] | None = None
        self._clock = clock
        self._heard_s = clock()
        self._latched_until_s = float("-inf")
        self._lock = Lock()
        self._requests: list[Json] = []
        self._news: list[Json] = []
        self._news_count = 0
        self._wants_stop = self._is_silent = False
        self._last_request_number = 0  # a repeated request means that its answer was lost
        self._latch_news_number = 0  # number of the news about the newest latching stop
        # Requested stops, with the number of stops before each.
        self._stop_counts: dict[int, int] = {}
        self._was_heard = False

    # -- the page ---------------------------------------------------------------------------------

    def on_beat(self, requests: list[Json], seen_number: int, stop_count: int = 0) -> list[Json]:
        """The page is there: take its stops and its requests; return the news after `seen_number`.

        `stop_count` is 0 if nobody has pressed STOP yet.
        """
        with self._lock:
            self._heard_s = self._clock()
            self._was_heard = True
            if stop_count > self.stop_count:
                self._stop_run(stop_count)
            for request in requests:
                number = request.get("id")
                if type(number) is int and number > self._last_request_number:
                    self._last_request_number = number
                    self._requests.append(request)
            if self.is_latched:
                self._void_requests()
            self._news = [
                news_item for news_item in self._news if news_item["number"] > seen_number
            ]
            return list(self._news)

    def connect_again(self) -> None:
        """The page asks for it anew: it has not got the answer."""
        if not self._was_heard:
            self._heard_s = self._clock()

    def stop(self, stop_count: int = 0) -> None:
        """Stop the robot, whatever waits, except where that was done for this number; one without a
        number always stops."""
        with self._lock:
            if not stop_count or stop_count > self.stop_count:
                self._stop_run(stop_count)

    def latch(self, until_s: float | None = None, is_stopping: bool = True) -> None:
        """Refuse requests for a while, and stop the robot."""
        with self._lock:
            self._latched_until_s = self._clock() + LATCH_S if until_s is None else until_s
            if is_stopping:
                self._wants_stop = True
                self.last_stop = ASKED
                self._add_news({"stopped": True})
                self._latch_news_number = self._news_count
            self._void_requests()

    @property
    def is_latched(self) -> bool:
        return self._clock() < self._latched_until_s

    @property
    def is_attended(self) -> bool:
        return self.silent_s <= ATTENDED_S

    @property
    def silent_s(self) -> float:
        """Return the time since the page was last heard."""
        return self._clock() - self._heard_s

    @property
    def is_half_made(self) -> bool:
        """Return whether the page does not know its robot because the answer was lost."""
        return not self._was_heard and not self.is_attended

    @property
    def has_left(self) -> bool:
        return self.silent_s > LEFT_S

    def queue_news(self, news: list[Json]) -> None:
        with self._lock:
            for news_item in news:
                self._add_news(news_item)
        witness = self.witness
        if witness is not None:
            witness(news)

    # -- the robot --------------------------------------------------------------------------------

    def attend(self, link: RobotLink, timeout_s: float = POLL_INTERVAL_S) -> None:
        """Pass on waiting requests, and report new events."""
        if self._wants_stop:
            self._apply_news(link.news())  # no earlier stop confirms this one
        self.stop_if_wanted(link.stop)
        with self._lock:
            requests, self._requests = self._requests, []
        for request in requests:
            stop_count = _number_in(request, "stops")
            if (
                stop_count < self.stop_count
                or _number_in(request, "seen") < self._latch_news_number
            ):
                self.queue_news([{"id": request["id"], **_VOID_ANSWER}])
                continue
            if _starts_run(request):
                self._stop_counts[request["id"]] = stop_count
            try:
                link.ask(request)
            except BadRequest:
                self._stop_counts.pop(request["id"], None)
                self.queue_news([{"id": request["id"], "failure": "bad_request"}])
        self._apply_news(link.news(timeout_s))
        if self.is_attended:
            self._is_silent = False
        elif link.owns_run and not self._is_silent:
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

    def _stop_run(self, stop_count: int) -> None:
        self.stop_count = max(self.stop_count, stop_count)
        self._wants_stop = True

    def _apply_news(self, news: list[Json]) -> None:
        with self._lock:
            for news_item in news:
                stop_count = self._stop_counts.pop(news_item["id"], 0) if "id" in news_item else 0
                if news_item.get("ok"):
                    self.stop_count = max(self.stop_count, stop_count)
        if self.last_stop == ASKED and not self._wants_stop:
            events = [news_item.get("event") for news_item in news]
            if "STOPPED" in events:
                self.last_stop = CONFIRMED
            elif "LOST" in events:
                self.last_stop = SILENT
        self.queue_news(news)

    def _void_requests(self) -> None:
        for request in self._requests:
            if request.get("do") != "stop":
                self._add_news({"id": request["id"], **_VOID_ANSWER})
        self._requests = [request for request in self._requests if request.get("do") == "stop"]

    def _add_news(self, news: Json) -> None:
        self._news_count += 1
        self._news.append({**news, "number": self._news_count})
        while len(self._news) > MAX_PENDING_NEWS:
            droppable = next(
                (
                    news_item
                    for news_item in self._news
                    if news_item.get("event") in _DROPPABLE_EVENTS
                ),
                None,
            )
            self._news.remove(droppable or self._news[0])


def _number_in(request: Json, name: str) -> int:
    number = request.get(name)
    return number if type(number) is int else 0


def _starts_run(request: Json) -> bool:
    action = request.get("do")
    return action in ("live", "start") or (action == "upload" and request.get("runs") is True)
