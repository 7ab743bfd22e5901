"""Everything works the second time in a studio as it did the first time, however that ended.

A page that arrives late, returns or connects again finds what a fresh one finds: after a STOP for
all no robot starts, each silence of a page stops its robot, and a connection carries any number of
requests.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from http.client import HTTPConnection
from itertools import product
from random import Random
from threading import Event
from time import sleep
from types import SimpleNamespace
from typing import Any, ClassVar, cast

import pytest

from tests.support.page_server import serves
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript.library import opening
from tiniscript.studio import hosted_robot, serving
from tiniscript.studio import hosting as hosting_of
from tiniscript.studio.attending import (
    ATTENDED_S,
    CONFIRMED,
    LATCH_S,
    LEFT_S,
    SILENT,
    Attending,
)
from tiniscript.studio.hosting import Hosting
from tiniscript.studio.robot_link import BadRequest, RobotLink

Json = dict[str, Any]
LOOK_MS = 20
BEAT_MS = 100
RUN_REQUEST = {"do": "upload", "runs": True}


class Room:
    """The clock, and the robots' actions."""

    now_ms = 0
    actions: ClassVar[list[tuple[str, int]]] = []  # actions with their times
    robots: ClassVar[list[ThreadlessRobot]] = []
    unwaited_pairs: ClassVar[list[tuple[ThreadlessRobot, ThreadlessRobot]]] = []

    @classmethod
    def clock(cls) -> float:
        return cls.now_ms / 1000


class NotingLink:
    """A robot that obeys at once, and runs until it is stopped."""

    def __init__(self) -> None:
        self.owns_run = False
        self._news: list[Json] = []

    def stop(self) -> None:
        self.owns_run = False
        Room.actions.append(("stop", Room.now_ms))
        self._news.append({"event": "STOPPED"})

    def ask(self, request: Json) -> None:
        self.owns_run = True
        Room.actions.append(("run", Room.now_ms))
        self._news.append({"id": request["id"], "ok": True})

    def news(self, timeout_s: float = 0) -> list[Json]:
        news, self._news = self._news, []
        return news


class ThreadlessRobot:
    """A connection whose steps the test controls; it takes a while until it meets its robot, and
    until its port is closed."""

    is_holding_port = is_unconfirmed = False

    def __init__(
        self, port: str, robot: str, language: str, tab: str, connection: int, stops: int,
        robots_before: list[ThreadlessRobot],
    ) -> None:  # fmt: skip
        self.name = self.port = port
        self.tab, self.connection = tab, connection
        self.attending = Attending(Room.clock, stops)
        self.link = NotingLink()
        self.has_ended = self.is_parting = False
        self._meets_ms = Room.now_ms + 300 * (connection % 4)
        self._closed_ms = 0
        Room.unwaited_pairs += [
            (self, robot)
            for robot in Room.robots
            if robot.port == port and robot.is_open and robot not in robots_before
        ]
        Room.robots.append(self)

    @property
    def is_open(self) -> bool:
        return self.is_parting or not self.has_ended

    def leave(self, is_letting_go: bool = False) -> None:
        if not self.has_ended and not self.is_parting:
            self.is_parting, self._closed_ms = True, Room.now_ms + 200

    def join(self, timeout_s: float) -> None:
        self._closed_ms = Room.now_ms
        self.step()

    def fail(self) -> None:
        """Its cable is pulled."""
        self._end("port_gone")

    def _end(self, reason: str) -> None:
        self.has_ended = True
        self._stop()
        self.attending.end()
        self.attending.queue_news([{"over": reason}])

    def _stop(self) -> None:
        if self.link.owns_run:
            self.link.stop()

    def step(self) -> None:
        if not self.has_ended and self.attending.has_left:
            self.leave()
        if self.is_parting:
            if not self.has_ended:
                self._end("left")
            self.is_parting = Room.now_ms < self._closed_ms
        elif self.has_ended:
            pass
        elif Room.now_ms >= self._meets_ms:
            self.attending.attend(cast(RobotLink, self.link), 0)


@pytest.fixture(autouse=True)
def own_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Room, "now_ms", 0)
    monkeypatch.setattr(Room, "actions", [])
    monkeypatch.setattr(Room, "robots", [])
    monkeypatch.setattr(Room, "unwaited_pairs", [])


@pytest.fixture
def hosting(monkeypatch: pytest.MonkeyPatch) -> Hosting:
    monkeypatch.setattr(hosting_of, "HostedRobot", ThreadlessRobot)
    monkeypatch.setattr(hosting_of, "monotonic", Room.clock)
    return Hosting()


# -- a STOP for all, and later clients


class ComingPage:
    """A page that comes, asks for runs, and goes, reloads or falls silent, as it happens."""

    def __init__(self, hosting: Hosting, name: str, rng: Random) -> None:
        self.hosting, self.name, self.rng = hosting, name, rng
        self.tab = self.port = name
        self.ports = [name]
        self.end = ""  # why its connection has ended, which it has not heard yet
        self.stops = 0  # that its tab has counted
        self._connection = self._seen_number = self._number = 0
        self._is_connected = self._is_asleep = False
        self._asked: list[Json] = []

    def _ask(self, action: str, **fields: object) -> Json:
        return self.hosting.answer({
            "do": action, "page": self.name, "tab": self.tab, "connection": self._connection,
            "port": self.port, "robot": "tinibot", "language": "en", "seen": self._seen_number,
            "stops": self.stops, **fields,
        })  # fmt: skip

    def _connect(self) -> None:
        self._connection += 1
        self.end, self.port = "", self.rng.choice(self.ports)
        self._seen_number = self._number = 0
        self._asked = []
        for _ in range(self.rng.choice((1, 2))):  # the answer was lost
            self._is_connected = self._ask("connect") == {}

    def _request_run(self) -> None:
        self._number += 1
        self._asked.append(
            {**RUN_REQUEST, "id": self._number, "stops": self.stops, "seen": self._seen_number}
        )

    def stop(self) -> None:
        self.stops += 1
        self._ask("stop")

    def leave_and_come(self) -> None:
        self._ask("leave")
        self._connect()

    @property
    def is_beating(self) -> bool:
        return self._is_connected and not self._is_asleep

    def turn(self) -> None:
        draw_number = self.rng.random()
        if not self._is_connected:
            if draw_number < 0.1:
                self._connect()
                self._request_run()  # requested at once, because a run may be under way
        elif draw_number < 0.01:
            self._ask("leave")
            self._is_connected, self.end = False, ""
        elif draw_number < 0.02:  # loaded again, under another name of its own or the same one
            self._is_connected, self._connection = False, self._connection + 3
            if self.rng.random() < 0.5:
                self.tab, self.stops = f"{self.tab}+", 0
        elif draw_number < 0.04:
            self._is_asleep, self.end = not self._is_asleep, ""
        elif draw_number < 0.3:
            self._request_run()
        if self.is_beating:
            self._beat()

    def _beat(self) -> None:
        for item in self._ask("beat", asked=self._asked[:8]).get("news", ()):
            if "over" in item:
                self._is_connected = False
                assert item["over"] == (self.end or item["over"])
            elif item["number"] > self._seen_number:
                self._seen_number = item["number"]
                self._asked = [
                    request for request in self._asked if request["id"] != item.get("id")
                ]


@pytest.mark.parametrize("seed", range(12))
def test_nothing_starts_after_a_stop_for_all_at_any_time(hosting: Hosting, seed: int) -> None:
    """Neither open pages nor new connections start anything; driving robots stop. After the latch
    time, pages drive again.
    """
    rng = Random(seed)
    pages = [ComingPage(hosting, f"page{k}", rng) for k in range(5)]
    latched_until_ms = stops = late_runs = 0
    for _ in range(3000):
        Room.now_ms += LOOK_MS
        if rng.random() < 0.005:
            hosting.answer({"do": "stop_all"})
            latched_until_ms = Room.now_ms + round(1000 * LATCH_S)
            stops += 1
        action_count_before = len(Room.actions)
        for robot in Room.robots:
            robot.step()
            assert not (robot.link.owns_run and Room.now_ms < latched_until_ms)
        if Room.now_ms % BEAT_MS == 0:
            for page in pages:
                page.turn()
        runs = [action for action, _ in Room.actions[action_count_before:] if action == "run"]
        assert not (runs and Room.now_ms < latched_until_ms), (Room.now_ms, latched_until_ms)
        late_runs += len(runs) if stops else 0
    assert stops > 3 and late_runs > 10


@pytest.mark.parametrize("seed", range(12))
def test_earlier_users_of_a_port_do_not_affect_later_ones(hosting: Hosting, seed: int) -> None:
    """A new connection waits for all that still have the port, and is made once. A STOP for all
    stops those that drive, and the result of each is soon known. A page's STOP stops its robot even
    after a reload. A page learns why its connection has ended, whoever connects meanwhile, and at
    the end no connection is left open."""
    rng = Random(seed)
    pages = [ComingPage(hosting, f"page{k}", rng) for k in range(4)]
    for page in pages:
        page.ports = ["first", "second", "third"]
    stopped_ms = 0
    for _ in range(2500):
        Room.now_ms += LOOK_MS
        for robot in Room.robots:
            robot.step()
        driving = [robot for robot in Room.robots if not robot.has_ended and not robot.is_parting]
        for page in pages:
            page_robots = [robot for robot in driving if robot.tab == page.tab and page.is_beating]
            if page_robots and rng.random() < 0.01:
                page_robots[-1].fail()
                page.end = "port_gone"
                driving.remove(page_robots[-1])
        if rng.random() < 0.005:
            states = hosting.answer({"do": "stop_all"})["robots"]
            assert sorted(state["name"] for state in states) == sorted(
                robot.name for robot in driving
            )
            stopped_ms = Room.now_ms
        if Room.now_ms > stopped_ms + 2000:
            states = hosting.answer({"do": "stops"})["robots"]
            assert {state["stop"] for state in states} <= {CONFIRMED, SILENT}
        if Room.now_ms % BEAT_MS == 0:
            for page in pages:
                page.turn()
            page = rng.choice(pages)
            driven_robot = cast(ThreadlessRobot | None, hosting.robot_of(page.name))
            if driven_robot is not None and rng.random() < 0.1:
                page.stop()
                driven_robot.step()
                assert not driven_robot.link.owns_run
        assert not Room.unwaited_pairs
    assert stopped_ms and len(Room.robots) > 20
    assert len({(robot.tab, robot.connection) for robot in Room.robots}) == len(Room.robots)
    for page in pages:
        page.leave_and_come()
    hosting.close()
    assert not any(robot.is_open for robot in Room.robots)


# -- a page that is silent, and is heard again


@pytest.mark.parametrize("seed", range(20))
def test_each_silence_of_a_page_stops_its_robot_once(seed: int) -> None:
    """However often it was silent before, and whether it drove then; one that is heard goes on."""
    rng = Random(seed)
    attending, link = Attending(Room.clock), NotingLink()
    number = 0
    silences = 0
    for _ in range(150):
        is_heard, lasts_ms = rng.random() < 0.5, rng.choice((100, 400, 800, 2000))
        starts_drive, is_stopped = rng.random() < 0.6, rng.random() < 0.2
        if is_heard and starts_drive:
            number += 1
            attending.on_beat([{**RUN_REQUEST, "id": number, "stops": 0, "seen": 0}], 0)
            attending.attend(cast(RobotLink, link), 0)
        if is_stopped:
            attending.stop()
            attending.attend(cast(RobotLink, link), 0)
        for _ in range(0, lasts_ms, LOOK_MS):
            Room.now_ms += LOOK_MS
            if is_heard:
                attending.on_beat([], 0)
            was_driving, call_count = link.owns_run, len(Room.actions)
            is_silent = attending.silent_s > ATTENDED_S
            attending.attend(cast(RobotLink, link), 0)
            assert link.owns_run == (was_driving and not is_silent)
            stops = [action for action, _ in Room.actions[call_count:]]
            assert stops == (["stop"] if was_driving and is_silent else [])
            silences += len(stops)
    assert silences > 3 and ATTENDED_S < LEFT_S


# -- a robot that is left more than once


class HeldClient:
    """Another command drives the robot through it until all its clients have left."""

    has_emptied: ClassVar[Event] = Event()
    is_held: ClassVar[bool | None] = None
    holds_for_others = True

    def __init__(self, *_: object, **__: object) -> None:
        self.connection = SimpleNamespace(
            holder_verb="upload",
            enable_place_events=lambda: None,
            event=lambda timeout_s: sleep(timeout_s),
        )

    def meet(self, should_retry: object) -> SimpleNamespace:
        return SimpleNamespace(name="TINI")

    def hold_for_others(self, goes_on: Callable[[], bool]) -> None:
        assert HeldClient.has_emptied.wait(HANG_LIMIT_S)
        HeldClient.is_held = goes_on()

    def close(self, owns_run: bool) -> None:
        """Do nothing, because no run of the page is affected."""


@pytest.mark.parametrize(
    "lets_go_values", [bits for k in (1, 2, 3) for bits in product((0, 1), repeat=k)]
)
def test_a_released_port_is_held_for_nobody(
    monkeypatch: pytest.MonkeyPatch, lets_go_values: tuple[int, ...]
) -> None:
    """It does not matter who else releases it, before or after: a page, the end of a turn, or the
    studio's end."""
    monkeypatch.setattr(hosted_robot, "Client", HeldClient)
    monkeypatch.setattr(hosted_robot, "robot_data", lambda robot: {})
    monkeypatch.setattr(opening, "remember", lambda *_: None)
    monkeypatch.setattr(HeldClient, "has_emptied", Event())
    monkeypatch.setattr(HeldClient, "is_held", None)
    robot = hosted_robot.HostedRobot("p", "tinibot", "en")
    until(lambda: robot.name != "", "it is met")
    for lets_go in lets_go_values:
        robot.leave(is_letting_go=bool(lets_go))
    HeldClient.has_emptied.set()
    robot.join(HANG_LIMIT_S)
    assert HeldClient.is_held == (not any(lets_go_values))
    assert robot.has_ended and not robot.is_parting


# -- many requests on one connection

BEAT_REQUEST = b'{"do": "beat"}'
PAGE_FILES = {"index.html": serving.File(b"<!doctype html>", serving.TYPES[".html"]),
        "main.js": serving.File(b"0", serving.TYPES[".js"], '"tag"')}  # fmt: skip
STRANGE_ERROR = "a letter from a page of the class before"
# Bytes of padding in a head; the last one is too large.
PADDINGS = (0, 3000, 9000, 12_000, serving.HEAD_BYTES)


def answer_beat(request: Json) -> Json:
    if request != {"do": "beat"}:
        raise BadRequest
    return {"news": []}


@pytest.fixture
def server() -> Iterator[serving.Server]:
    with serves(serving.Server(PAGE_FILES, 0, answer_beat)) as server:
        yield server


@pytest.fixture
def ask(server: serving.Server) -> Callable[[HTTPConnection, str, int], tuple[int, bytes, bool]]:
    """Return a function for one request of the page; it returns the answer, and whether the
    connection ends.
    """
    token = server.entrances.token

    def ask_server(
        connection: HTTPConnection, request: str, padding: int
    ) -> tuple[int, bytes, bool]:
        headers = {"Origin": f"http://{serving.HOST}:{server.server_port}"}
        headers["X-Padding"] = " " + "x " * (padding // 2)
        if request.startswith("/"):
            connection.request("GET", request, None, headers)
        else:
            body = request.encode()
            shown_token = "" if request == STRANGE_ERROR else token
            connection.request(
                "POST",
                serving.ROBOTS_PATH,
                body,
                {**headers, serving.TOKEN_HEADER: shown_token},
            )
        response = connection.getresponse()
        data = response.read()
        return response.status, data, response.will_close

    return ask_server


@pytest.mark.parametrize("seed", range(6))
def test_a_request_is_answered_like_the_first_of_a_connection(
    server: serving.Server, ask: Callable[[HTTPConnection, str, int], tuple[int, bytes, bool]],
    seed: int,
) -> None:  # fmt: skip
    """The kind and the number of earlier requests there do not matter."""
    rng = Random(seed)
    httpconnection = HTTPConnection(serving.HOST, server.server_port, timeout=HANG_LIMIT_S)
    max_requests = request_count = 0
    for _ in range(40):
        is_odd = rng.random() < 0.06
        request = rng.choice(
            ("/nothing", "{}", STRANGE_ERROR)
            if is_odd
            else ("/", "/main.js", BEAT_REQUEST.decode())
        )
        padding = rng.choice(PADDINGS if is_odd else PADDINGS[:-1])
        new_connection = HTTPConnection(serving.HOST, server.server_port, timeout=HANG_LIMIT_S)
        expected = ask(new_connection, request, padding)
        new_connection.close()
        assert ask(httpconnection, request, padding) == expected, (request, padding)
        request_count += 1
        max_requests = max(max_requests, request_count)
        if expected[2]:
            httpconnection.close()
            request_count = 0
    httpconnection.close()
    assert max_requests > 4
