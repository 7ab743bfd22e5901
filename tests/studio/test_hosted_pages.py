"""Pages and the robots that they drive: after any history of connections, ends and stops.

The robots are fake ones: they have no thread and no port.
"""

from __future__ import annotations

from random import Random
from typing import Any, cast

import pytest

from tiniscript.studio import hosting as module
from tiniscript.studio.attending import LATCH_S
from tiniscript.studio.hosting import Hosting
from tiniscript.studio.robot_link import BadRequest

Json = dict[str, Any]
PORTS, PAGES, TABS = ("COM1", "com1", "COM2", "COM3"), ("a", "b", "c"), ("s", "t")
MAX_ROBOTS = 2


class FakeAttending:
    def __init__(self, stop_count: int) -> None:
        self.stop_count = stop_count
        self.last_stop = ""
        self.is_half_made = self.has_left = False
        self.latches: list[tuple[float | None, bool]] = []
        self.stops: list[int] = []
        self.connected_again_count = 0

    def connect_again(self) -> None:
        self.connected_again_count += 1

    def latch(self, until_s: float | None = None, is_stopping: bool = True) -> None:
        self.latches.append((until_s, is_stopping))

    def stop(self, stop_count: int) -> None:
        self.stops.append(stop_count)

    def on_beat(self, *_: object) -> list[Json]:
        return [{"heard": True}]


class FakeRobot:
    """`state` is driving, parting, closing (its port) or over; one that is left parts."""

    def __init__(
        self, port: str, _: str, __: str, tab: str, connection: int, stop_count: int,
        earlier_robots: list[FakeRobot],
    ) -> None:  # fmt: skip
        self.port, self.name, self.tab, self.connection = port, "", tab, connection
        self.attending = FakeAttending(stop_count)
        self.earlier_robots = list(earlier_robots)
        self.state = "driving"
        self.is_unconfirmed = self.is_holding_port = False
        self.lets_go = self.is_joined = False

    @property
    def has_ended(self) -> bool:
        return self.state in ("closing", "over")

    @property
    def is_parting(self) -> bool:
        return self.state in ("parting", "closing")

    def leave(self, reason: str = "left", is_letting_go: bool = False) -> None:
        self.state = "parting" if self.state == "driving" else self.state
        self.lets_go = self.lets_go or is_letting_go

    def join(self, timeout_s: float) -> None:
        self.is_joined = True


def is_at(robot: FakeRobot, port: str) -> bool:
    """Return whether a robot has the port; Windows knows it by several names."""
    is_there = robot.port.upper() == port.upper()
    return is_there and robot.state != "over" and not robot.is_holding_port


@pytest.mark.parametrize("seed", range(20))
def test_a_port_has_one_page_and_a_page_one_robot(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever comes leaves what was there, or is told why not; the same connect is done once. What
    has come late from a connection before reaches nothing. At the end all are left."""
    rng = Random(seed)
    robots: list[FakeRobot] = []
    now_s = 100.0

    def make(*fields: Any) -> FakeRobot:
        robots.append(FakeRobot(*fields))
        return robots[-1]

    monkeypatch.setattr(module, "HostedRobot", make)
    monkeypatch.setattr(module, "MAX_ROBOTS", MAX_ROBOTS)
    monkeypatch.setattr(module, "monotonic", lambda: now_s)
    monkeypatch.setattr(module, "canonical_port", str.upper)
    hosting = Hosting()
    robot_by_page: dict[str, FakeRobot] = {}
    latched_until_s = 0.0

    def connect() -> None:
        page, port, tab = rng.choice(PAGES), rng.choice(PORTS), rng.choice(TABS)
        number = rng.randrange(6)
        for name, robot in [*robot_by_page.items()]:
            if robot.has_ended and robot.attending.has_left:  # its page is not there any more
                del robot_by_page[name]
        own = robot_by_page.get(page)
        known_count = len(robots)
        again_counts = [robot.attending.connected_again_count for robot in robots]
        rivals = [
            robot
            for robot in robots
            if robot.state == "driving" and (robot is own or is_at(robot, port))
        ]
        driving_count = sum(robot_by_page[name].state == "driving" for name in robot_by_page)
        driving_count -= sum(
            rival in rivals for rival in robot_by_page.values() if rival.state == "driving"
        )
        there = [robot for robot in robots if is_at(robot, port)]
        answer = hosting.answer(
            {"do": "connect", "page": page, "tab": tab, "connection": number, "port": port,
             "robot": "tinibot", "language": "en"}
        )  # fmt: skip
        if own is not None and own.tab == tab and number <= own.connection:
            assert answer == {} and len(robots) == known_count, "it was done already"
            again_counts[robots.index(own)] += 1
            assert [one.attending.connected_again_count for one in robots] == again_counts
        elif any(rival.tab != tab and not rival.attending.is_half_made for rival in rivals):
            assert answer == {"failure": "other_tab"} and len(robots) == known_count
            assert all(rival.state == "driving" for rival in rivals)
        else:
            assert all(rival.state == "parting" for rival in rivals), "no page refers to it"
            if driving_count >= MAX_ROBOTS:
                assert answer == {"failure": "too_many"} and len(robots) == known_count
                return
            assert answer == {} and len(robots) == known_count + 1
            new = robots[-1]
            assert (new.port, new.tab, new.connection) == (port, tab, number)
            is_same = own is not None and own.tab == tab
            assert new.attending.stop_count == (own.attending.stop_count if own and is_same else 0)
            assert new.attending.latches == [(latched_until_s, False)]
            assert {*map(id, new.earlier_robots)} == {*map(id, there)}
            robot_by_page[page] = new

    def ask() -> None:
        page, tab, number = rng.choice(PAGES), rng.choice(TABS), rng.randrange(6)
        action, stops = rng.choice(("beat", "stop", "leave")), rng.randrange(3)
        stops = -1 if action == "stop" and rng.random() < 0.2 else stops
        robot = robot_by_page.get(page)
        state = None if robot is None else robot.state
        stop_count = 0 if robot is None else len(robot.attending.stops)
        request = {"do": action, "page": page, "tab": tab, "connection": number, "stops": stops}
        if robot is not None and tab == robot.tab and stops < 0:
            with pytest.raises(BadRequest):
                hosting.answer(request)
            assert robot.attending.stops[stop_count:] == [0], "a stop stops, whatever it counts"
            return
        answer = hosting.answer(request)
        if robot is None:
            assert answer["news"][0]["over"] == "left"
            return
        is_own = (tab, number) == (robot.tab, robot.connection)
        expected_stops = [stops if tab == robot.tab else 0] * (action == "stop")
        assert robot.attending.stops[stop_count:] == expected_stops, "a stop reaches whoever drives"
        assert (answer["news"] == [{"heard": True}]) == is_own
        is_left = is_own and action == "leave" and state == "driving"
        assert robot.state == ("parting" if is_left else state)

    for _ in range(120):
        match rng.choice(("connect", "connect", "ask", "ask", "ends", "changes", "stop all")):
            case "connect":
                connect()
            case "ask":
                ask()
            case "ends" if robots:
                robot = rng.choice(robots)
                next_states = {"driving": ("parting", "closing"), "parting": ("closing", "over")}
                robot.state = rng.choice(next_states.get(robot.state, ("over",)))
                robot.attending.has_left = rng.random() < 0.5
            case "changes" if robots:
                robot = rng.choice(robots)
                robot.attending.stop_count += 1
                robot.attending.is_half_made = rng.random() < 0.3
                robot.is_holding_port = robot.state == "parting" and rng.random() < 0.3
            case "stop all":
                now_s += 1
                latch_counts = [len(robot.attending.latches) for robot in robots]
                driving = [robot for robot in robot_by_page.values() if robot.state == "driving"]
                answer = hosting.answer({"do": "stop_all"})
                latched_until_s = now_s + LATCH_S
                for robot, latch_count in zip(robots, latch_counts, strict=True):
                    new_latches = robot.attending.latches[latch_count:]
                    assert new_latches == [(None, True)] * (robot in driving)
                for robot in driving:
                    robot.attending.last_stop = "confirmed"
                assert len(answer["robots"]) == len(driving)
                states = [row["stop"] for row in hosting.answer({"do": "stops"})["robots"]]
                assert states == ["confirmed"] * len(driving)
        for page in PAGES:
            assert cast(Any, hosting.robot_of(page)) is robot_by_page.get(page)
        for port in PORTS:
            assert hosting.is_free(port) == (not any(is_at(robot, port) for robot in robots))
            driving = [one for one in robots if one.state == "driving" and is_at(one, port)]
            assert len(driving) < 2
    for robot in robots:
        robot.is_unconfirmed = robot.state != "over" and rng.random() < 0.5
    open_robots = [robot for robot in robots if robot.state != "over"]
    unconfirmed_ports = hosting.close()
    assert sorted(unconfirmed_ports) == sorted(one.port for one in robots if one.is_unconfirmed)
    assert all(robot.lets_go and robot.is_joined for robot in open_robots)
