"""A page's requests and its stops at a robot, after any history of what either of both does."""

from __future__ import annotations

from random import Random
from typing import Any, cast

import pytest

from tiniscript.studio.attending import ATTENDED_S, LATCH_S, LEFT_S, Attending
from tiniscript.studio.robot_link import BadRequest, RobotLink

Json = dict[str, Any]
STEP_COUNT = 250


class Link:
    """A robot that does what it is asked, refuses it, or calls it no request."""

    def __init__(self, rng: Random) -> None:
        self.owns_run = False
        self.stop_count = 0
        self.asked: list[Json] = []
        self.open_requests: list[Json] = []
        self._rng = rng
        self._news: list[Json] = []

    def stop(self) -> None:
        self.stop_count += 1

    def ask(self, request: Json) -> None:
        if request["do"] == "nonsense":
            raise BadRequest
        self.asked.append(request)
        self.open_requests.append(request)

    def answer_some(self) -> list[Json]:
        """Answer some requests; return those that were accepted."""
        accepted = []
        while self.open_requests and self._rng.random() < 0.6:
            request = self.open_requests.pop(0)
            is_accepted = self._rng.random() < 0.5
            result = {"ok": True} if is_accepted else {"failure": "BUSY"}
            self._news.append({"id": request["id"], **result})
            accepted += [request] * is_accepted
        return accepted

    def news(self, timeout_s: float = 0) -> list[Json]:
        news, self._news = self._news, []
        return news


class Page:
    """A page that loses answers: then it sends its requests once more."""

    def __init__(self, rng: Random) -> None:
        self.stop_count = 0
        self.made_requests: list[Json] = []
        self.heard_news: dict[int, Json] = {}
        self._rng = rng
        self._unheard_requests: list[Json] = []

    @property
    def seen_number(self) -> int:
        return max(self.heard_news, default=0)

    def make_requests(self) -> list[Json]:
        for _ in range(self._rng.choice((0, 0, 1, 2))):
            action = self._rng.choice(("upload", "upload", "start", "live", "stop", "nonsense"))
            request = {
                "id": len(self.made_requests) + 1,
                "do": action,
                "runs": self._rng.random() < 0.7,
                "stops": self.stop_count,
                "seen": self.seen_number,
            }
            self.made_requests.append(request)
            self._unheard_requests.append(request)
        return list(self._unheard_requests)

    def hear(self, news: list[Json]) -> None:
        self._unheard_requests = []
        self.heard_news |= {item["number"]: item for item in news}


@pytest.mark.parametrize("seed", range(20))
def test_each_request_has_one_end_and_each_stop_stops_once(seed: int) -> None:
    """No request is done twice, or after a stop that its page has pressed or not heard of; each has
    one answer. Who falls silent stops the robot once, and again after it was heard again."""
    rng = Random(seed)
    now_s = began_s = 100.0
    attending, link, page = Attending(lambda: now_s), Link(rng), Page(rng)
    heard_s, was_heard, is_told = began_s, False, False
    wants_stop, done_stops, latched_until_s, latch_number = False, 0, 0.0, 0
    refused_ids = set[int]()
    first_beat = rng.randrange(12)  # the answer to its connect may come late, or never
    for step in range(STEP_COUNT):
        is_over = step > STEP_COUNT - 8  # time for what is under way
        actions = (
            *("wait", "connect", "look"),
            *(("beat",) * 6 + ("look",) * 3 + ("stop", "press") if step >= first_beat else ()),
            *(("latch",) if step % 8 == 0 else ()),
        )
        match "beat" if is_over else rng.choice(actions):
            case "wait":
                now_s += rng.choice((0.1, ATTENDED_S + 0.1, LATCH_S, LEFT_S + 0.1))
                link.owns_run = rng.random() < 0.7
            case "press":
                page.stop_count += 1
            case "connect":
                attending.connect_again()
                heard_s = heard_s if was_heard else now_s
            case "stop":
                number = rng.choice((0, page.stop_count))
                attending.stop(number)
                if not number or number > done_stops:
                    wants_stop, done_stops = True, max(done_stops, number)
            case "latch":
                attending.latch()
                wants_stop, latched_until_s = True, now_s + LATCH_S
                latch_number = attending._news_count
            case "beat":
                requests = [] if is_over else page.make_requests()
                news = attending.on_beat(requests, page.seen_number, page.stop_count)
                heard_s, was_heard = now_s, True
                if page.stop_count > done_stops:
                    wants_stop, done_stops = True, page.stop_count
                if now_s < latched_until_s:
                    refused_ids |= {item["id"] for item in requests if item["do"] != "stop"}
                numbers = [item["number"] for item in news]
                assert numbers == [page.seen_number + k for k in range(1, len(news) + 1)]
                if is_over or rng.random() < 0.8:
                    page.hear(news)
        if rng.random() < 0.7 or is_over:
            accepted, stop_count, asked_count = link.answer_some(), link.stop_count, len(link.asked)
            expected_stops = int(wants_stop)
            if now_s - heard_s <= ATTENDED_S:
                is_told = False
            elif link.owns_run and not is_told:
                expected_stops, is_told = expected_stops + 1, True
            attending.attend(cast(RobotLink, link), 0)
            wants_stop = False
            assert link.stop_count - stop_count == expected_stops
            for request in link.asked[asked_count:]:
                assert request["stops"] >= done_stops, "somebody has pressed STOP since"
                assert request["seen"] >= latch_number, "its page had not heard of the stop"
                assert request["id"] not in refused_ids, "it has come too soon after the stop"
            started = [
                item
                for item in accepted
                if item["do"] in ("live", "start") or (item["do"] == "upload" and item["runs"])
            ]
            done_stops = max([done_stops, *(item["stops"] for item in started)])
        assert attending.stop_count == done_stops
        assert attending.is_latched == (now_s < latched_until_s)
        assert attending.is_half_made == (not was_heard and now_s - heard_s > ATTENDED_S)
        assert attending.has_left == (now_s - heard_s > LEFT_S)
    page.hear(attending.on_beat([], page.seen_number))
    ends = [item["id"] for item in page.heard_news.values() if "id" in item]
    open_ids = [request["id"] for request in link.open_requests]
    assert sorted(ends + open_ids) == [item["id"] for item in page.made_requests]
    asked_ids = [request["id"] for request in link.asked]
    assert len(asked_ids) == len({*asked_ids}) > 0
