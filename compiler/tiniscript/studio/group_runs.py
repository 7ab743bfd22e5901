"""Events of a group's robot during a run, for members who do not drive it.

They look at it some times a second. Until then, the newest place of the program waits, and values
as far as there is room; the numbers of the values show how many were left out. Runs for the
driver's page alone, such as a typed line or sensor readings, are not reported. The robot's thread
waits for nobody here. Knows no robot and no page.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from threading import Lock
from time import monotonic
from typing import NamedTuple

from tiniscript.studio.entrances import new_token
from tiniscript.studio.robot_link import Json

MAX_BYTES = 2000  # most bytes of waiting events, as JSON
_DROPPABLE_EVENTS = ("SHOW", "TEXT")
_EVENTS_OF_RUN = (*_DROPPABLE_EVENTS, "PLACE", "MISSED")
_ENDING_EVENTS = ("DONE", "FAULT", "STOPPED", "RESTARTED", "LOST")


class _Row(NamedTuple):
    driver: str  # page that receives the robot's events
    news: Json
    size: int


class GroupRuns:
    """Any thread may call it. `key` is another one after a crash, and for another group."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self.key = new_token()
        self._clock = clock
        self._lock = Lock()
        self._rows: list[_Row] = []
        self._news_count = 0
        self._program_checksum = ""  # checksum of the running program
        self._is_driver_alone = False  # whether the run is for the driver's page only
        self._first_number = 0  # number of the event that begins the run
        self._began_s = 0.0
        self._value_count = 0  # number of values in the run

    def add_news(self, driver: str, news: list[Json]) -> None:
        """Add an event of the robot that a pupil drives."""
        with self._lock:
            for news_item in news:
                for event in self._events_of(news_item):
                    self._add_event(driver, event)

    def news_after(self, position: object, token: str) -> tuple[int, list[Json]]:
        """Return the number of the newest news, and what a page has not heard that knows all until
        `position`, a key and a number. One that knows nothing hears of what runs now."""
        with self._lock:
            match position:
                case [self.key, int(number)]:
                    pass
                case _:
                    number = self._first_number - 1 if self._program_checksum else self._news_count
            rows = [row for row in self._rows if row.driver != token]
            return self._news_count, [row.news for row in rows if row.news["number"] > number]

    def _events_of(self, news_item: Json) -> Iterator[Json]:
        """Yield the messages about an event of the link, each once in the order of the runs."""
        event, program = news_item.get("event"), str(news_item.get("program", ""))
        if "connected" in news_item:
            yield {"event": "ROBOT", "robot": news_item["connected"]["robot"]}
        elif "over" in news_item:
            self._is_driver_alone = False
            yield from self._end_run({"event": "OVER"})
        elif event == "STARTED" and news_item["is_program"]:
            yield self._begin_run(program)
        elif event == "STARTED":
            self._is_driver_alone = True
            yield from self._end_run({"event": "OVER"})
        elif event in _ENDING_EVENTS:
            self._is_driver_alone = False
            yield from self._end_run(news_item)
        elif event in _EVENTS_OF_RUN and not self._is_driver_alone:
            if news_item.get("at", -1) >= 0 and program != self._program_checksum:
                # The robot's button starts a run without an earlier event.
                yield self._begin_run(program)
            if self._program_checksum:
                yield news_item

    def _begin_run(self, program: str) -> Json:
        self._program_checksum, self._is_driver_alone, self._value_count = program, False, 0
        self._first_number, self._began_s = self._news_count + 1, self._clock()
        return {"event": "STARTED", "program": program, "is_program": True}

    def _end_run(self, event: Json) -> Iterator[Json]:
        if self._program_checksum:
            self._program_checksum = ""
            yield event

    def _add_event(self, driver: str, event: Json) -> None:
        name = event["event"]
        self._news_count += 1
        news = {**event, "number": self._news_count, "ms": self._since_ms}
        if name in _DROPPABLE_EVENTS:
            self._value_count += 1
            news["nth"] = self._value_count
        if name == "PLACE":
            self._rows = [row for row in self._rows if row.news["event"] != "PLACE"]
        self._rows.append(_Row(driver, news, len(json.dumps(news))))
        while len(self._rows) > 1 and sum(row.size for row in self._rows) > MAX_BYTES:
            droppable_rows = (
                row for row in self._rows[:-1] if row.news["event"] in _DROPPABLE_EVENTS
            )
            self._rows.remove(next(droppable_rows, self._rows[0]))

    @property
    def _since_ms(self) -> int:
        return round(1000 * (self._clock() - self._began_s))
