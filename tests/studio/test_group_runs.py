"""Events of a group's robot on pages that do not drive it."""

from __future__ import annotations

import json
from random import Random
from typing import Any

import pytest

from tiniscript.studio import group_runs
from tiniscript.studio.group_runs import GroupRuns

Json = dict[str, Any]
DRIVERS = ("ana", "luz")
END_MESSAGES: tuple[Json, ...] = (
    {"event": "DONE"},
    {"event": "STOPPED", "cause": "MESSAGE"},
    {"event": "FAULT", "fault": "STUCK", "at": 3, "program": "p"},
    {"event": "LOST"},
    {"over": "left", "said": ""},
)
# What comes late is of no run.
END_EVENTS: tuple[Json, ...] = (
    {"connected": {"robot": {"name": "TINI"}}},
    {"event": "SHOW", "value": "late", "at": -1},
    {"event": "TEXT", "text": "late"},
)


class Robot:
    """A robot that reports random runs, and the part of the reports for other members."""

    def __init__(self, rng: Random) -> None:
        self.rng = rng
        self.program = self.line = ""
        self.driver = DRIVERS[0]
        self.place: int | None = None
        self.values = self.run_count = self.connections = 0
        self.all_values: list[str] = []  # the values of all runs of programs
        self.index_by_value: dict[str, int] = {}  # index of each value in its run
        self.count = 0  # number of values in a run

    def tell(self) -> Json:
        action = self.rng.choice(("value", "value", "value", "place", "place", "text", "next"))
        if not (self.program or self.line) or action == "next":
            if self.program or self.line:
                replaces = self.rng.random() < 0.3
                return self._begin("program", "line") if replaces else self._end()
            if self.rng.random() < 0.3:
                event = self.rng.choice(END_EVENTS)
                self.connections += "connected" in event
                return event
            return self._begin("program", "line", "button")
        program = self.program or self.line
        if action == "place":
            place = self.rng.randrange(500)
            self.place = place if self.program else self.place
            return {"event": "PLACE", "at": place, "program": program}
        self.values += 1
        value = str(self.values)
        if self.program:
            self.all_values.append(value)
            self.count += 1
            self.index_by_value[value] = self.count
        if action == "text":
            return {"event": "TEXT", "text": value}
        return {"event": "SHOW", "value": value, "at": 7, "program": program}

    def _begin(self, *kinds: str) -> Json:
        """Begin a run of one of these kinds, in the place of what runs."""
        self.run_count += 1
        self.program = self.line = ""
        self.count, self.place = 0, None
        self.driver = self.rng.choice(DRIVERS)
        kind = self.rng.choice(kinds)
        program = f"{self.run_count:08x}"
        if kind == "line":
            self.line = program
            return {"event": "STARTED", "program": program, "is_program": False}
        self.program = program
        if kind == "button":
            self.place = 0
            return {"event": "PLACE", "at": 0, "program": program}
        return {"event": "STARTED", "program": program, "is_program": True}

    def _end(self) -> Json:
        self.program = self.line = ""
        self.place = None
        return self.rng.choice(END_MESSAGES)


class Page:
    """A page that looks now and then, as `news_cursor.js` has it."""

    def __init__(self, runs: GroupRuns, name: str) -> None:
        self.runs, self.name = runs, name
        self.run_key_and_count: list[Any] = ["", 0]
        self.items: list[Json] = []

    def look(self) -> list[Json]:
        known_count = self.run_key_and_count[1] if self.run_key_and_count[0] == self.runs.key else 0
        number, items = self.runs.news_after(self.run_key_and_count, self.name)
        items = [item for item in json.loads(json.dumps(items)) if item["number"] > known_count]
        self.run_key_and_count = [self.runs.key, max(known_count, number)]
        self.items += items
        return list(items)

    @property
    def values(self) -> list[str]:
        return [str(item.get("value", item.get("text"))) for item in self.items if "nth" in item]


@pytest.mark.parametrize("seed", range(50))
def test_each_member_gets_each_run_in_order(seed: int) -> None:
    """Whatever a robot reports, and however rarely a page polls, events arrive once, begins and
    ends alternate, the newest place is the robot's, and missing values can be counted.
    """
    rng = Random(seed)
    runs, robot = GroupRuns(lambda: 0.0), Robot(rng)
    page, drivers = Page(runs, "teo"), [Page(runs, name) for name in DRIVERS]
    page.look()
    max_count = rng.choice((1, 5, 60))
    connections: list[Json] = []
    values_by_driver: dict[str, list[str]] = {name: [] for name in DRIVERS}
    for _ in range(200):
        for _ in range(rng.randint(1, max_count)):
            count_before = len(robot.all_values)
            news = robot.tell()
            values_by_driver[robot.driver] += robot.all_values[count_before:]
            runs.add_news(robot.driver, [news])
            assert len(runs._rows) == 1 or waiting_bytes(runs) <= group_runs.MAX_BYTES
        items = page.look()
        places = [item["at"] for item in items if item["event"] == "PLACE"]
        assert len(places) <= 1
        if robot.place is not None:
            assert last_place(page) == robot.place
        assert is_running(page) == bool(robot.program)
        connections += [item["robot"] for item in items if item["event"] == "ROBOT"]
        for driver in drivers:
            driver.look()
    numbers = [item["number"] for item in page.items]
    assert numbers == sorted(set(numbers))
    assert begin_and_end_by_turns(page)
    assert is_part(page.values, robot.all_values)
    assert count_missed_values(page) + len(page.values) == count_values(page)
    for driver in drivers:
        assert not set(driver.values) & set(values_by_driver[driver.name])
    for row in page.items:
        value = str(row.get("value", row.get("text")))
        assert "nth" not in row or row["nth"] == robot.index_by_value[value]
    if max_count == 1:
        assert page.values == robot.all_values
        assert len(connections) == robot.connections


def waiting_bytes(runs: GroupRuns) -> int:
    return sum(len(json.dumps(row.news)) for row in runs._rows)


def is_running(page: Page) -> bool:
    """Return whether a program runs as far as the page knows."""
    names = [item["event"] for item in page.items]
    end_names = {"OVER", *(end.get("event", "OVER") for end in END_MESSAGES)}
    return next(
        (name == "STARTED" for name in reversed(names) if name in {"STARTED", *end_names}), False
    )


def last_place(page: Page) -> int:
    return next(int(item["at"]) for item in reversed(page.items) if item["event"] == "PLACE")


def begin_and_end_by_turns(page: Page) -> bool:
    """No value and no place is outside a run."""
    is_running = False
    for item in page.items:
        if item["event"] == "STARTED":
            is_running = True
        elif item["event"] in ("SHOW", "TEXT", "PLACE"):
            if not is_running:
                return False
        else:
            is_running = False
    return True


def is_part(texts: list[str], all_of_them: list[str]) -> bool:
    """Return whether they are a subsequence."""
    texts_left = iter(all_of_them)
    return all(text in texts_left for text in texts)


def count_missed_values(page: Page) -> int:
    """Return the page's count of missed values, as in `panel.js`."""
    count = number = 0
    for item in page.items:
        if item["event"] == "STARTED":
            number = 0
        if "nth" in item:
            count += item["nth"] - number - 1
            number = item["nth"]
    return count


def count_values(page: Page) -> int:
    """Return the number of values in its runs up to the newest one heard."""
    numbers: list[int] = []
    for item in page.items:
        if item["event"] == "STARTED":
            numbers.append(0)
        if "nth" in item:
            numbers[-1] = item["nth"]
    return sum(numbers)


def test_a_new_member_gets_only_the_current_run() -> None:
    runs = GroupRuns(lambda: 0.0)
    started_event = {"event": "STARTED", "program": "a", "is_program": True}
    value = {"event": "SHOW", "value": "5"}
    runs.add_news("ana", [started_event, value, {"event": "DONE"}])
    assert Page(runs, "teo").look() == []
    runs.add_news("ana", [started_event, value, {"event": "PLACE", "at": 4, "program": "a"}])
    heard_events = [item["event"] for item in Page(runs, "eva").look()]
    assert heard_events == ["STARTED", "SHOW", "PLACE"]
    new_runs = GroupRuns(lambda: 0.0)
    new_runs.add_news("ana", [started_event])
    page = Page(runs, "luz")
    page.look()
    page.runs = new_runs  # after a crash of the class
    assert [item["event"] for item in page.look()] == ["STARTED"]


@pytest.mark.parametrize("claimed_state", [None, 5, [], ["x", 1], ["x"], {"a": 1}, [[], {}]])
def test_false_claims_of_a_page_do_no_harm(claimed_state: object) -> None:
    runs = GroupRuns(lambda: 0.0)
    runs.add_news("ana", [{"event": "STARTED", "program": "a", "is_program": True}])
    assert [item["event"] for item in runs.news_after(claimed_state, "teo")[1]] == ["STARTED"]


def test_events_have_the_time_of_their_run() -> None:
    clock_s = [10.0]
    runs = GroupRuns(lambda: clock_s[0])
    runs.add_news("ana", [{"event": "STARTED", "program": "a", "is_program": True}])
    clock_s[0] += 0.25
    runs.add_news("ana", [{"event": "SHOW", "value": "5"}])
    assert [item["ms"] for item in Page(runs, "teo").look()] == [0, 250]
