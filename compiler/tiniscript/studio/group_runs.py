"""What a group's robot tells while a program runs, for those of the group who do not drive it.

They look at it some times a second. Until then the newest place of the program waits, and values
as far as there is room; how many were left out they can tell from the numbers of the others. What
runs for the driver's page alone, a typed line or the readings of sensors, is not told. The robot's
thread waits for nobody here. Knows no robot and no page.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from threading import Lock
from time import monotonic
from typing import NamedTuple

from tiniscript.studio.entrances import new_token
from tiniscript.studio.robot_link import Json

MOST_BYTES = 2000  # that wait, as JSON
_MAY_MISS = ("SHOW", "TEXT")
_DURING = (*_MAY_MISS, "PLACE", "MISSED")
_ENDS = ("DONE", "FAULT", "STOPPED", "RESTARTED", "LOST")


class _Row(NamedTuple):
    driver: str  # whose page hears it from the robot
    news: Json
    size: int


class GroupRuns:
    """Any thread may call it. `key` is another one after a crash, and for another group."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self.key = new_token()
        self._clock = clock
        self._lock = Lock()
        self._rows: list[_Row] = []
        self._count = 0  # of news
        self._program = ""  # that runs, by its checksum
        self._is_aside = False  # what runs is for the driver's page alone
        self._first = 0  # number of the news with which the run begins
        self._began_s = 0.0
        self._values = 0  # of the run

    def tell(self, driver: str, news: list[Json]) -> None:
        """The robot that a pupil drives has told this."""
        with self._lock:
            for item in news:
                for event in self._heard(item):
                    self._add(driver, event)

    def after(self, known: object, token: str) -> tuple[int, list[Json]]:
        """Return the number of the newest news, and what a page has not heard that knows all until
        `known`, a key and a number. One that knows nothing hears of what runs now."""
        with self._lock:
            match known:
                case [self.key, int(number)]:
                    pass
                case _:
                    number = self._first - 1 if self._program else self._count
            rows = [row for row in self._rows if row.driver != token]
            return self._count, [row.news for row in rows if row.news["number"] > number]

    def _heard(self, item: Json) -> Iterator[Json]:
        """Yield what is told of an event of the link, each once in the order of the runs."""
        event, program = item.get("event"), str(item.get("program", ""))
        if "connected" in item:
            yield {"event": "ROBOT", "robot": item["connected"]["robot"]}
        elif "over" in item:
            self._is_aside = False
            yield from self._end({"event": "OVER"})
        elif event == "STARTED" and item["is_program"]:
            yield self._begin(program)
        elif event == "STARTED":
            self._is_aside = True
            yield from self._end({"event": "OVER"})
        elif event in _ENDS:
            self._is_aside = False
            yield from self._end(item)
        elif event in _DURING and not self._is_aside:
            if item.get("at", -1) >= 0 and program != self._program:
                yield self._begin(program)  # by the robot's button: nothing has told of that
            if self._program:
                yield item

    def _begin(self, program: str) -> Json:
        self._program, self._is_aside, self._values = program, False, 0
        self._first, self._began_s = self._count + 1, self._clock()
        return {"event": "STARTED", "program": program, "is_program": True}

    def _end(self, event: Json) -> Iterator[Json]:
        if self._program:
            self._program = ""
            yield event

    def _add(self, driver: str, event: Json) -> None:
        name = event["event"]
        self._count += 1
        news = {**event, "number": self._count, "ms": self._since_ms}
        if name in _MAY_MISS:
            self._values += 1
            news["nth"] = self._values
        if name == "PLACE":
            self._rows = [row for row in self._rows if row.news["event"] != "PLACE"]
        self._rows.append(_Row(driver, news, len(json.dumps(news))))
        while len(self._rows) > 1 and sum(row.size for row in self._rows) > MOST_BYTES:
            missed = (row for row in self._rows[:-1] if row.news["event"] in _MAY_MISS)
            self._rows.remove(next(missed, self._rows[0]))

    @property
    def _since_ms(self) -> int:
        return round(1000 * (self._clock() - self._began_s))
