"""A robot of a group that one pupil runs and another one stops: in any order of arrival, no robot
drives on.

`python -m tests.studio.test_group_races 100` lets so many meet.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import partial
from random import Random
from threading import Thread
from typing import Any

import pytest

from tests.support.command import FOREVER
from tests.support.pty_robot import PtyRobot
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript import compile, robots
from tiniscript.studio.attending import LATCH_S
from tiniscript.studio.classroom import Classroom
from tiniscript.studio.hosting import Hosting

Json = dict[str, Any]
BEAT_S = 0.1
LATE_S = 1.5  # most delay of a request
WATCH_S = 0.6  # time for which the robot is watched
PROGRAM = compile(FOREVER).image.hex()
PUPILS = ("Ana", "Luz", "Teo")


class Mate:
    """A pupil's page, which beats while it drives; its requests may be late."""

    def __init__(self, group: Group, name: str) -> None:
        self.group, self.name = group, name
        answer = group.room.answer("", name, {"do": "join", "code": group.room.code, "name": name})
        self.token = answer["token"]
        text = FOREVER + "\n"
        assert "group" in self.ask("group_join", name="Red", text=text)
        self.presses = self.ids = self.connection = self.newest_number = self.saw_stops = 0
        self.requests: list[Json] = []
        self.is_connected = False
        self.thread = Thread(target=self._beat, daemon=True)
        self.thread.start()

    def ask(self, action: str, **fields: Any) -> Json:
        return self.group.room.answer(self.token, self.name, {"do": action, **fields})

    def drive(self, action: str, **fields: Any) -> Json:
        return self.ask(action, page=self.name, connection=self.connection, seen=self.newest_number,
                        stops=self.presses, **fields)  # fmt: skip

    def _beat(self) -> None:
        while not self.group.is_over:
            time.sleep(BEAT_S)
            self.saw_stops = self.ask("here").get("stops", 0)
            if not self.is_connected:
                continue
            requests, self.requests = self.requests, []
            for news in self.drive("beat", asked=requests)["news"]:
                self.newest_number = max(self.newest_number, news["number"])
                if news.get("over"):
                    self.is_connected = False

    def connect(self, saw_stops: int) -> None:
        self.connection += 1
        self.newest_number = 0
        port = self.group.robot.port
        answer = self.drive("connect", port=port, robot="tinibot", language="en",
                            saw_stops=saw_stops)  # fmt: skip
        self.is_connected = "failure" not in answer

    def request_run(self, stops: int, number: int) -> None:
        """Ask for a run, which was pressed after this many presses of STOP and this much news."""
        self.ids += 1
        self.requests.append({"do": "upload", "id": self.ids, "image": PROGRAM, "robot": "tinibot",
                           "runs": True, "stops": stops, "seen": number})  # fmt: skip

    def stop(self) -> None:
        if self.is_connected:
            self.drive("stop")
        self.ask("stop", page="group", group_stops=self.presses)


class Group:
    """Three pupils, who have one turn of one robot."""

    def __init__(self, robot: PtyRobot, seed: int) -> None:
        self.robot = robot
        self.rng = Random(seed)
        self.hosting = Hosting()
        self.room = Classroom(self.hosting, [robot.port])
        self.is_over = False
        self.late_threads: list[Thread] = []
        self.mates = [Mate(self, name) for name in PUPILS]

    def begin(self) -> None:
        self.mates[0].ask("here", wants=True)
        until(lambda: self.mates[0].ask("here")["place"] == 0, "it is their turn")

    def act_later(self, act: Callable[[], None], max_delay_s: float = LATE_S) -> None:
        delay_s = self.rng.random() * max_delay_s

        def act_late() -> None:
            time.sleep(delay_s)
            act()

        self.late_threads.append(Thread(target=act_late, daemon=True))
        self.late_threads[-1].start()

    def let_drive(self, mate: Mate) -> None:
        """Let a pupil drive, whoever is driving."""
        end_s = time.monotonic() + HANG_LIMIT_S
        while not self.robot.moves:
            assert time.monotonic() < end_s, "it never drives"
            if not mate.is_connected:
                mate.connect(mate.saw_stops)
            time.sleep(0.3)
            mate.request_run(mate.presses, mate.newest_number)
            time.sleep(0.7)

    def race(self) -> None:
        """Let one pupil drive; then some press Run, and one presses STOP after them."""
        driver, *other_mates = self.rng.sample(self.mates, 3)
        self.let_drive(driver)
        for mate in self.rng.sample(other_mates, self.rng.randrange(3)):
            act_pressed = partial(self._take_over, mate, mate.presses, mate.saw_stops)
            self.act_later(act_pressed)
        if self.rng.random() < 0.5:
            self.act_later(partial(driver.request_run, driver.presses, driver.newest_number))
        time.sleep(self.rng.random() * LATE_S)
        stopper = self.rng.choice(self.mates)
        stopper.presses += 1
        for _ in range(self.rng.randrange(1, 4)):
            self.act_later(stopper.stop, 0.2)
        self.join_threads()
        until(lambda: not self.robot.moves, "the robot stands", 3)
        end_s = time.monotonic() + WATCH_S
        while time.monotonic() < end_s:
            assert not self.robot.moves, "it drives on"
            time.sleep(0.01)
        time.sleep(LATCH_S)

    def _take_over(self, mate: Mate, stops: int, saw_stops: int) -> None:
        """Take the robot over, as a press of Run does, and then send the program."""
        mate.connect(saw_stops)
        number = mate.newest_number
        time.sleep(self.rng.random() * 0.3)
        mate.request_run(stops, number)

    def join_threads(self) -> None:
        for thread in self.late_threads:
            thread.join(HANG_LIMIT_S)
        self.late_threads.clear()

    def end(self) -> None:
        self.is_over = True
        for mate in self.mates:
            mate.thread.join(HANG_LIMIT_S)
        self.hosting.close()


def race(count: int, seed: int) -> None:
    with PtyRobot(robots.load("tinibot").kit) as robot:
        group = Group(robot, seed)
        try:
            group.begin()
            for _ in range(count):
                group.race()
        finally:
            group.end()


@pytest.mark.parametrize("seed", range(2))
def test_any_pupils_stop_wins_in_every_order(seed: int) -> None:
    race(3, seed)


def main() -> None:
    count = int(sys.argv[1])
    for seed in range(count // 10):
        race(10, seed)
        print(f"{10 * (seed + 1)} races: none drives on", flush=True)


if __name__ == "__main__":
    main()
