"""A page as `tsc studio` or a class sees it: its requests, and the news that it gets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.support.command import FOREVER
from tests.support.waiting import until
from tiniscript import compile

Json = dict[str, Any]


class AskingPage:
    """A page of `tsc studio`, or a pupil's, with a robot on a pty."""

    def __init__(self, answer: Callable[[Json], Json], port: str) -> None:
        self.answer = answer
        self.port = port
        self.news: list[Json] = []
        self._number = 0

    def ask(self, action: str, *requests: Json, connection: int = 1, **fields: object) -> Json:
        number = max((item["number"] for item in self.news), default=0)
        request = {"do": action, "page": "me", "connection": connection, "port": self.port,
                   "robot": "tinibot", "language": "en", "seen": number, "asked": list(requests),
                   **fields}  # fmt: skip
        answer = self.answer(request)
        self.news += [item for item in answer.get("news", ()) if item["number"] > number]
        return answer

    def beat_until(
        self, is_reached: Callable[[Json], object], description: str, **fields: Any
    ) -> None:
        def has_arrived() -> bool:
            self.ask("beat", **fields)
            return any(is_reached(item) for item in self.news)

        until(has_arrived, description)

    def run(self, stops: int) -> Json:
        self._number += 1
        number = max(item["number"] for item in self.news)
        return {"do": "upload", "id": self._number, "image": compile(FOREVER).image.hex(),
                "robot": "tinibot", "runs": True, "stops": stops, "seen": number}  # fmt: skip
