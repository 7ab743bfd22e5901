"""A page as `tsc studio` or a class sees it: what it asks, and the news that it gets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.support.command import FOREVER
from tests.support.waiting import until
from tiniscript import compile

Json = dict[str, Any]


class AskingPage:
    """A page of `tsc studio`, or a pupil's, with a robot behind a pty."""

    def __init__(self, answer: Callable[[Json], Json], port: str) -> None:
        self.answer = answer
        self.port = port
        self.news: list[Json] = []
        self._number = 0

    def asks(self, do: str, *asked: Json, connection: int = 1, **more: object) -> Json:
        seen = max((each["number"] for each in self.news), default=0)
        request = {"do": do, "page": "me", "connection": connection, "port": self.port,
                   "robot": "tinibot", "language": "en", "seen": seen, "asked": list(asked),
                   **more}  # fmt: skip
        answer = self.answer(request)
        self.news += [each for each in answer.get("news", ()) if each["number"] > seen]
        return answer

    def beats_until(self, is_so: Callable[[Json], object], what: str, **more: Any) -> None:
        def looks() -> bool:
            self.asks("beat", **more)
            return any(is_so(each) for each in self.news)

        until(looks, what)

    def run(self, stops: int) -> Json:
        self._number += 1
        seen = max(each["number"] for each in self.news)
        return {"do": "upload", "id": self._number, "image": compile(FOREVER).image.hex(),
                "robot": "tinibot", "runs": True, "stops": stops, "seen": seen}  # fmt: skip
