"""A class whose robots are stand-ins."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import pytest

from tiniscript.studio import classroom
from tiniscript.studio.classroom import Classroom

Json = dict[str, Any]
PUPIL_ADDRESS = "192.0.2.9"


@dataclasses.dataclass
class FakeRobot:
    """A connection that a test plays."""

    has_ended: bool = False
    name: str = "TINI"
    leave_reason: str = ""
    stop_count: int = 0
    was_left: bool = False
    silent_s: float = 0.0
    is_half_made: bool = False
    is_running: bool = False
    witness: Callable[[list[Json]], object] | None = None

    def leave(self, reason: str) -> None:
        self.leave_reason = reason
        self.has_ended = True

    @property
    def attending(self) -> FakeRobot:
        return self

    def latch(self) -> None:
        self.stop_count += 1


class FakeHosting:
    """Records the requests that reach robots."""

    def __init__(self) -> None:
        self.requests: list[Json] = []
        self.robots: dict[str, FakeRobot] = {}
        self.held_ports: set[str] = set()  # ports that are being left

    def answer(self, request: Json) -> Json:
        self.requests.append(request)
        if request.get("do") == "connect":
            self.robots[request["page"]] = FakeRobot()
            return {}
        return {"news": []}

    def robot_of(self, page: str) -> FakeRobot | None:
        return self.robots.get(page)

    def is_free(self, port: str) -> bool:
        return port not in self.held_ports


class Room:
    """A class with this many robots, and a clock that the test moves."""

    def __init__(self, robots: int = 1) -> None:
        self.now_s = 1000.0
        self.hosting = FakeHosting()
        ports = [f"port{k}" for k in range(robots)]
        self.classroom = Classroom(self.hosting, ports, 60, lambda: self.now_s)  # type: ignore[arg-type]

    def join(self, name: str, address: str = PUPIL_ADDRESS) -> str:
        answer = self.classroom.answer(
            "", address, {"do": "join", "code": self.classroom.code, "name": name}
        )
        return str(answer["token"])

    def check_in(self, token: str, wants_turn: bool | None = None, **fields: Any) -> Json:
        request = {"do": "here", **fields} | ({} if wants_turn is None else {"wants": wants_turn})
        return self.classroom.answer(token, PUPIL_ADDRESS, request)

    def connect(self, token: str) -> FakeRobot:
        assert (
            self.classroom.answer(token, PUPIL_ADDRESS, {"do": "connect", "page": "x", "port": "y"})
            == {}
        )
        return self.hosting.robots[self.hosting.requests[-1]["page"]]

    def teach(self, action: str, **fields: Any) -> Json:
        return self.classroom.teach({"do": action, **fields})

    def number(self, name: str) -> int:
        return next(int(pupil["number"]) for pupil in self.teach("class")["pupils"]
                    if pupil["name"] == name)  # fmt: skip


@pytest.fixture(autouse=True)
def without_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    """This computer has no ports in the tests of a file that imports this."""
    monkeypatch.setattr(classroom, "list_ports", list)
