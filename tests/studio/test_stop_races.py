"""A teacher's STOP and uploads that are on their way, in the robot's own time.

`python -m tests.studio.test_stop_races 10000` lets so many meet.
"""

from __future__ import annotations

import sys
from random import Random
from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests.support.virtual_robot import robot_in
from tiniscript import compile, robots
from tiniscript.studio import hosted_robot
from tiniscript.studio.attending import CONFIRMED, LATCH_S, SILENT, Attending
from tiniscript.studio.hosted_robot import HostedRobot
from tiniscript.studio.page_line import PageKeys, PageLine
from tiniscript.studio.robot_link import RobotLink
from tiniscript.virtual.worlds import read

BEAT_MS = 100
LOOK_MS = 20  # interval at which a thread attends to its robot
PROGRAMS = [compile(f"SI|LOOP(FOREVER);{'R(0.1, 40);' * k}END_LOOP").image.hex() for k in (1, 40)]


class Meeting:
    """A page, its robot, and a teacher."""

    def __init__(self, seed: int) -> None:
        self.rng = Random(seed)
        floor = "[floor]\nwidth_cm = 200\nheight_cm = 200\n[start]\nx_cm = 100\ny_cm = 100\n"
        self.robot = robot_in(read(floor, "floor"))
        profile = robots.load("tinibot")
        self.line = PageLine(profile.board.baud, profile.kit.fingerprint, PageKeys(b""))
        self.link = RobotLink(self.line, "en")
        self.attending = Attending(lambda: self.robot.now_ms / 1000)
        self.news: list[dict[str, Any]] = []
        self._sent = b""
        self._number = 0
        self._beat_ms = 0
        self._look_ms = 0
        # Answers under way, with their arrival times.
        self._answers_under_way: list[tuple[int, dict[str, Any]]] = []
        self.is_cut = False

    def advance(self, milliseconds: int, step_ms: int = 1) -> None:
        for _ in range(0, milliseconds, step_ms):
            now_ms = self.robot.now_ms + step_ms
            heard_bytes = self.robot.step(now_ms, b"" if self.is_cut else self._sent)
            self._sent = self.line.advance(b"" if self.is_cut else heard_bytes, now_ms)
            arrived_answers = [
                answer for arrival_ms, answer in self._answers_under_way if arrival_ms <= now_ms
            ]
            self._answers_under_way = [pair for pair in self._answers_under_way if pair[0] > now_ms]
            if arrived_answers or now_ms >= self._beat_ms:
                self._beat_ms = now_ms + BEAT_MS
                self.news += self.attending.on_beat(arrived_answers, self.newest_number)
            if now_ms >= self._look_ms:
                self._look_ms = now_ms + self.rng.randrange(1, LOOK_MS)
                self.attending.attend(self.link, 0)

    @property
    def newest_number(self) -> int:
        """The newest of the news that the page knows."""
        return max((item["number"] for item in self.news), default=0)

    def upload(self, delay_ms: int) -> int:
        """The page sends a program; return the number of the request."""
        self._number += 1
        request = {"do": "upload", "id": self._number, "image": self.rng.choice(PROGRAMS),
                   "robot": "tinibot", "runs": True, "seen": self.newest_number}  # fmt: skip
        self._answers_under_way.append((self.robot.now_ms + delay_ms, request))
        return self._number

    def answer(self, number: int) -> dict[str, Any]:
        return next((item for item in self.news if item.get("id") == number), {})

    def race(self) -> None:
        """Some uploads are before the STOP, in the middle of it, and after it."""
        late_ms = self.rng.choice((30, 400, 1900, 4000))
        numbers = []
        for _ in range(self.rng.randrange(1, 4)):
            numbers.append(self.upload(self.rng.randrange(late_ms)))
            self.advance(self.rng.choice((1, 5, 20, 60, 150)) + self.rng.randrange(10))
        self.attending.latch()
        self.advance(500)
        assert self.attending.last_stop == CONFIRMED
        stood_pose = self.robot.driving.pose_at(self.robot.now_ms)
        for _ in range(7):
            self.advance(max(1, late_ms // 5), 10)
            assert not self.robot.is_running
            assert self.robot.driving.pose_at(self.robot.now_ms) == stood_pose
        assert self.answer(numbers[-1])  # an older one that arrives later counts as lost


def race(count: int, seed: int) -> None:
    meeting = Meeting(seed)
    meeting.advance(2000)
    meeting.attending.on_beat([], 0)
    for _ in range(count):
        meeting.race()
        meeting.advance(round(1000 * LATCH_S), 10)


@pytest.mark.parametrize("seed", range(4))
def test_a_stop_latches_whatever_is_in_transit(seed: int) -> None:
    race(10, seed)


def test_a_page_drives_again_after_a_stop() -> None:
    meeting = Meeting(5)
    meeting.upload(0)
    meeting.advance(1500)
    assert meeting.robot.is_running
    meeting.attending.latch()
    meeting.advance(round(1000 * LATCH_S) - 200)
    early_request = meeting.upload(0)
    meeting.advance(300)
    assert meeting.answer(early_request)["failure"] == "stopped_elsewhere"
    late_request = meeting.upload(0)
    meeting.advance(1500)
    assert meeting.answer(late_request)["ok"] and meeting.robot.is_running


def test_a_robot_that_misses_a_stop_is_reported() -> None:
    meeting = Meeting(6)
    meeting.upload(0)
    meeting.advance(1500)
    meeting.is_cut = True
    meeting.attending.latch()
    meeting.advance(7000)
    assert meeting.attending.last_stop == SILENT


class LateLink:
    """A robot that confirms a stop after some polls, or never; its earlier reports wait."""

    owns_run = True

    def __init__(self, rng: Random) -> None:
        self.now_ms = 0
        self._rng = rng
        self._news: list[dict[str, Any]] = []
        self._confirms_ms = float("inf")

    def tell(self) -> None:
        """Report stops of other clients, and the events between them."""
        names = self._rng.choices(("STOPPED", "STARTED", "SHOW"), k=self._rng.randrange(6))
        self._news += [{"event": name} for name in names]

    def delay_confirmation(self, confirms_after_ms: float) -> None:
        self._late_ms = confirms_after_ms

    def stop(self) -> None:
        self._confirms_ms = self.now_ms + self._late_ms

    def news(self, timeout_s: float = 0) -> list[dict[str, Any]]:
        self.now_ms += round(1000 * timeout_s)
        if self.now_ms >= self._confirms_ms:
            self._confirms_ms = float("inf")
            self._news.append({"event": "STOPPED"})
        news, self._news = self._news, []
        return news


@pytest.mark.parametrize("end", ["latch", "part"])
@pytest.mark.parametrize("seed", range(10))
def test_no_earlier_stop_confirms_the_newest_one(
    monkeypatch: pytest.MonkeyPatch, seed: int, end: str
) -> None:
    """This holds for any number of stops, from any source, confirmed or not."""
    rng = Random(seed)
    link = LateLink(rng)
    attending = Attending(lambda: link.now_ms / 1000)
    monkeypatch.setattr(hosted_robot, "monotonic", lambda: link.now_ms / 1000)
    hosted_simple_namespace = SimpleNamespace(attending=attending, is_unconfirmed=False)
    for _ in range(5):
        link.tell()
        late_ms = rng.choice((0, 40, 1000, float("inf")))
        link.delay_confirmation(late_ms)
        if end == "part":
            HostedRobot._part_from_robot(
                cast(HostedRobot, hosted_simple_namespace), cast(RobotLink, link)
            )
            is_confirmed = not hosted_simple_namespace.is_unconfirmed
        else:
            attending.latch()
            for _ in range(200):
                attending.attend(cast(RobotLink, link))
            is_confirmed = attending.last_stop == CONFIRMED
        assert is_confirmed == (late_ms < float("inf")), late_ms
        link.tell()


@pytest.mark.parametrize("seed", range(10))
def test_the_outcome_of_a_stop_is_final_once_its_connection_has_ended(seed: int) -> None:
    """A cable may be pulled at any time: no page waits in vain."""
    rng = Random(seed)
    link = LateLink(rng)
    attending = Attending(lambda: link.now_ms / 1000)
    hosted = SimpleNamespace(attending=attending, has_ended=False)
    for _ in range(3):
        link.tell()
        link.delay_confirmation(rng.choice((40, 200, float("inf"))))
        attending.latch()
        for _ in range(rng.randrange(20)):
            attending.attend(cast(RobotLink, link))
    known_stop = attending.last_stop
    HostedRobot._end(cast(HostedRobot, hosted), "port_gone")
    assert attending.last_stop == (CONFIRMED if known_stop == CONFIRMED else SILENT)


if __name__ == "__main__":
    expected_count = int(sys.argv[1])
    for start in range(0, expected_count, 100):
        race(min(100, expected_count - start), start)
        print(f"{min(expected_count, start + 100)} races, none drives", flush=True)
