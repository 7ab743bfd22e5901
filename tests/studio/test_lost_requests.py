"""Requests of a page to `tsc studio` that are lost, late or repeated, on a test clock.

A press of STOP stops the robot once, by the first request that arrives after it; a run that the
page asks for later is not undone. Robots are counted stops, their threads the test's own steps.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import ClassVar, cast

import pytest

from tests.support.asking_page import AskingPage, Json
from tests.support.node import in_node
from tests.support.pty_robot import PtyRobot
from tests.support.waiting import until
from tiniscript import robots
from tiniscript.studio import classroom
from tiniscript.studio import hosting as hosting_of
from tiniscript.studio.attending import Attending
from tiniscript.studio.classroom import Classroom
from tiniscript.studio.hosting import Hosting
from tiniscript.studio.robot_link import RobotLink

BEAT_MS = 100
LOOK_MS = 20
RUN_REQUEST = {"do": "upload", "runs": True}


class CountedLink:
    """A robot that obeys at once."""

    owns_run = False

    def __init__(self, note_action: Callable[[str, int], None]) -> None:
        self._note_action = note_action
        self._news: list[Json] = []

    def stop(self) -> None:
        self._note_action("stop", 0)

    def ask(self, request: Json) -> None:
        self._note_action("run", request["stops"])
        self._news.append({"id": request["id"], "ok": True})

    def news(self, timeout_s: float = 0) -> list[Json]:
        news, self._news = self._news, []
        return news


class SteppedRobot:
    """A connection without a thread and a port."""

    is_holding_port = False

    def __init__(
        self, port: str, robot: str, language: str, tab: str, connection: int, stops: int,
        stepped_robots_before: list[SteppedRobot],
    ) -> None:  # fmt: skip
        self.port, self.tab, self.connection, self.before = (
            port,
            tab,
            connection,
            stepped_robots_before,
        )
        self.attending = Attending(lambda: World.now_ms / 1000, stops)
        self.link = CountedLink(self._note)
        self.has_ended = self.is_parting = False

    def _note(self, action: str, stops: int) -> None:
        World.actions.append(
            (action, self.attending.stop_count if action == "stop" else stops, World.now_ms)
        )

    def leave(self) -> None:
        self.is_parting = True

    def step(self) -> None:
        if self.is_parting or self.attending.has_left:
            self.has_ended, self.is_parting = True, False
        else:
            self.attending.attend(cast(RobotLink, self.link), 0)


class World:
    """The shared state: the clock, and the robots' actions."""

    now_ms = 0
    actions: ClassVar[list[tuple[str, int, int]]] = []


@pytest.fixture
def stepped_hosting(monkeypatch: pytest.MonkeyPatch) -> Iterator[Hosting]:
    monkeypatch.setattr(World, "now_ms", 0)
    monkeypatch.setattr(World, "actions", [])
    monkeypatch.setattr(hosting_of, "HostedRobot", SteppedRobot)
    yield Hosting()


class TornPage:
    """A page that behaves like `host.js`, with torn requests and answers."""

    def __init__(self, hosting: Hosting, rng: Random, ask: Callable[[Json], Json]) -> None:
        self.hosting, self.rng, self.ask = hosting, rng, ask
        self.presses: list[int] = []  # times of the presses
        self.heard_presses: list[int] = []  # presses sent with a beat that the robot has heard
        self._connection = self._seen_number = self._stops = self._number = 0
        self._asked: list[Json] = []
        self._answers_under_way: list[tuple[int, Json]] = []
        self.is_connected = False

    def connect(self) -> None:
        self._connection += 1
        self._seen_number = self._stops = self._number = 0
        self._asked, self.is_connected = [], False

    def press_stop(self) -> None:
        self.presses.append(World.now_ms)
        if self.is_connected:
            self._stops = len(self.presses)
            self._send("stop")

    def press_run(self) -> None:
        if self.is_connected:
            self._number += 1
            request = {
                **RUN_REQUEST,
                "id": self._number,
                "stops": len(self.presses),
                "seen": self._seen_number,
            }
            self._asked.append(request)

    def _send(self, action: str, **fields: object) -> None:
        request = {"do": action, "page": "me", "connection": self._connection, "port": "p",
                   "robot": "tinibot", "language": "en", "seen": self._seen_number,
                   "stops": self._stops, **fields}  # fmt: skip
        times = self.rng.choice((0, 1, 1, 1, 2))
        self._answers_under_way += [(World.now_ms + self.rng.choice((1, 10, 700, 2500)), request)
                            for _ in range(times)]  # fmt: skip

    def beat(self) -> None:
        if self.is_connected:
            self._send("beat", asked=list(self._asked[:8]))
        else:
            self._send("connect")

    def arrive(self) -> None:
        due = [
            request for arrival_ms, request in self._answers_under_way if arrival_ms <= World.now_ms
        ]
        self._answers_under_way = [
            pair for pair in self._answers_under_way if pair[0] > World.now_ms
        ]
        for request in due:
            answer = self.ask(request)
            is_own = request["connection"] == self._connection
            robot = cast(SteppedRobot, self.hosting.robot_of("me"))
            if is_own and robot and request["do"] == "beat" and request["stops"]:
                self.heard_presses.append(request["stops"])
            if not is_own or self.rng.random() < 0.4:
                continue  # the answer is lost
            if request["do"] == "connect":
                self.is_connected = answer == {}
            for item in answer.get("news", ()):
                if "over" in item:
                    self.is_connected = False
                elif item["number"] > self._seen_number:
                    self._seen_number = item["number"]
                    self._asked = [
                        request for request in self._asked if request["id"] != item.get("id")
                    ]


def check_stops_kept(page: TornPage) -> None:
    """Check this for all events so far."""
    newest = 0
    accepted_count = 0
    for action, stops, _ in World.actions:
        if action == "stop":
            assert stops > newest, "once for each press"
            assert stops > accepted_count, "what was started later goes on"
            newest = stops
        else:
            assert stops >= newest, "it was asked for before"
            accepted_count = max(accepted_count, stops)
    for number in page.heard_presses:
        stop_times_ms = [time_ms for action, _, time_ms in World.actions
                 if action == "stop" and time_ms >= page.presses[number - 1]]  # fmt: skip
        assert stop_times_ms or accepted_count >= number, (
            f"press {number} was told, and stopped nothing"
        )


@pytest.mark.sampled("seed", keep=20)
@pytest.mark.parametrize("seed", range(60))
def test_each_press_of_stop_stops_once_whatever_is_lost(
    stepped_hosting: Hosting, seed: int
) -> None:
    rng = Random(seed)
    page = TornPage(stepped_hosting, rng, stepped_hosting.answer)
    page.connect()
    for _ in range(1500):
        World.now_ms += LOOK_MS
        page.arrive()
        robot = cast(SteppedRobot | None, stepped_hosting.robot_of("me"))
        if robot is not None:
            robot.step()
            if robot.has_ended:
                page.is_connected = False
        check_stops_kept(page)
        if World.now_ms % BEAT_MS == 0:
            page.beat()
        draw_number = rng.random()
        if draw_number < 0.01:
            page.press_stop()
        elif draw_number < 0.03:
            page.press_run()
        elif draw_number < 0.032 or (not page.is_connected and draw_number < 0.05):
            page.connect()
    kinds = {action for action, _, _ in World.actions}
    assert kinds == {"stop", "run"}  # both kinds of requests were lost


@pytest.mark.parametrize("runs", [True, False])
def test_a_stop_of_the_previous_connection_works_unless_a_run_followed_it(
    stepped_hosting: Hosting, runs: bool
) -> None:
    def send_request(action: str, connection: int, *requests: Json, **fields: object) -> None:
        stepped_hosting.answer(
            {
                "do": action,
                "page": "me",
                "connection": connection,
                "port": "p",
                "seen": 0,
                "robot": "tinibot",
                "language": "en",
                "asked": [*requests],
                **fields,
            }
        )
        cast(SteppedRobot, stepped_hosting.robot_of("me")).step()

    send_request("connect", 1)
    send_request("beat", 1)
    send_request("connect", 2)  # a press before it is still on its way
    if runs:
        send_request("beat", 2, {**RUN_REQUEST, "id": 1, "stops": 1, "seen": 0})
        send_request("beat", 2)
    send_request("stop", 1, stops=1)
    send_request("stop", 1, stops=1)
    assert [action for action, _, _ in World.actions] == ["run" if runs else "stop"]


PAGE_SCRIPT = Path(__file__).with_name("lost_requests_in_node.mjs")


def test_each_request_of_a_page_is_answered_once_whatever_is_lost() -> None:
    """No event follows its end, and no beat comes sooner than it may. If a few in a row are lost,
    each is still done once, and the page's next connection is like that of a fresh page.
    """
    rows = [json.loads(line) for line in in_node(PAGE_SCRIPT, "400")]
    assert len(rows) == 400
    wild = [row["first"]["isThere"] for row in rows if row["isWild"]]
    assert sum(wild) < 0.8 * len(wild)  # some requests are lost
    assert sum(len(row["held"]) for row in rows) > len(rows) / 2
    for row in rows:
        for part in (row["first"], row["second"]):
            assert set(part["ends"]) == {1} and part["over"] == part["met"] == 1, row
            assert part["isGone"] and part["isQuiet"] and part["timers"] == 0, row
            assert part["tooSoon"] == 0, row
            assert set(part["heard"]) <= {"STOPPED"}, row
            assert len(part["heard"]) <= part["presses"], row
        assert len(set(row["made"])) == len(row["made"]), row
        # A remote control's word is sent at most once, and none after a newer one.
        assert set(row["first"]["words"] + row["second"]["words"]) <= {1}, row
        for words in (row["held"], row["said"]):
            assert words == sorted(set(words)), row
        if not row["isWild"]:
            first_ask = row["first"]
            assert first_ask["isThere"] and len(row["made"]) == len(first_ask["ends"]), row
            assert bool(first_ask["heard"]) == bool(first_ask["presses"]), row
        # No press is lost: each press of STOP stops.
        assert len(row["second"]["heard"]) == row["second"]["presses"], row
        assert (row["second"], row["secondDone"]) == (row["fresh"], row["freshDone"]), row


@pytest.fixture
def robot() -> Iterator[PtyRobot]:
    with PtyRobot(robots.load("tinibot").kit) as pty_robot:
        yield pty_robot


@pytest.fixture(params=["page", "pupil"])
def asker(
    request: pytest.FixtureRequest, robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> Iterator[AskingPage]:
    """Return a client that has met its robot, and may ask at every look of a test."""
    monkeypatch.setattr(classroom, "REQUEST_RATE", (1e9, 1e9))
    hosting = Hosting()
    if request.param == "page":
        page = AskingPage(hosting.answer, robot.port)
    else:
        room = Classroom(hosting, [robot.port])
        join = {"do": "join", "code": room.code, "name": "Ana"}
        token = room.answer("", "192.0.2.9", join)["token"]
        room.answer(token, "192.0.2.9", {"do": "here", "wants": True})
        page = AskingPage(lambda request: room.answer(token, "192.0.2.9", request), "turn")
    assert page.ask("connect") == {}
    page.beat_until(lambda item: "connected" in item, "it is met")
    yield page
    hosting.close()


def test_a_heartbeat_delivers_a_lost_stop_but_no_old_stop_ends_a_run(
    asker: AskingPage, robot: PtyRobot
) -> None:
    def has_news(stops: int) -> bool:
        return "news" in asker.ask("beat", stops=stops)

    def start_drive(stops: int) -> None:
        asker.ask("beat", asker.run(stops), stops=stops)
        until(lambda: has_news(stops) and robot.moves, "it drives")

    def count_stops() -> int:
        return sum(item.get("event") == "STOPPED" for item in asker.news)

    def wait_for_stop(count: int) -> None:
        until(lambda: has_news(1) and count_stops() == count, "it has stopped")
        assert not robot.moves

    start_drive(0)
    asker.ask("beat", stops=1)
    wait_for_stop(1)
    start_drive(1)
    start_count = len(robot.received)
    asker.ask("stop", stops=1)  # late, or a repeated beat
    for _ in range(10):
        asker.ask("beat", stops=1)
    assert robot.moves and b"\0" * 4 not in robot.received[start_count:]
    # Another tab, and a page without a count, always stop.
    other_tab = {"page": "other"} if asker.port == "turn" else {"tab": "other"}
    other_requests: list[Json] = [{"stops": 1, **other_tab}, {"stops": 0}]
    for count, other_fields in enumerate(other_requests, start=2):
        asker.ask("stop", **other_fields)
        wait_for_stop(count)
        start_drive(1)


def test_a_connect_with_a_lost_answer_is_repeated(asker: AskingPage, robot: PtyRobot) -> None:
    """The same one is offered, or the page's next one takes over its port; a late one has no
    effect.
    """

    def connect_twice(connection: int) -> None:
        asker.news.clear()
        assert asker.ask("connect", connection=connection) == {}
        assert asker.ask("connect", connection=connection) == {}
        asker.beat_until(lambda item: "connected" in item, "it is met", connection=connection)
        [connected_item] = [item for item in asker.news if "connected" in item]
        assert connected_item["held_by"] == ""  # not held by the previous page

    connect_twice(2)
    connect_twice(3)
    assert asker.ask("connect", connection=2) == {}
    asker.news.clear()
    for _ in range(5):
        asker.ask("beat", connection=3)
    assert not any("over" in item for item in asker.news)
    assert asker.ask("beat", connection=2)["news"][0]["over"] == "left"
