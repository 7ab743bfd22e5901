"""A class obeys its laws after any history.

Pupils come, report their work, want robots, fall silent, come back and are removed; robots are
given and taken, are unreachable, or disconnect; the teacher gives work, hands programs out to all,
and begins anew. After each step: all reported work is there, a crash loses none of the saved state,
the turn belongs to the next in the queue, and the newest handout is offered to exactly those pages
that have not said that they opened it. A class that was begun anew is as one that was just made.
"""

from __future__ import annotations

import json
from random import Random
from typing import Any

import pytest

from tests.support.class_room import FakeRobot, Room, without_ports
from tiniscript.studio.class_keeping import MAX_PUPILS
from tiniscript.studio.classroom import PLACE_S, PRESENCE_S, QUEUE_S, REST_S
from tiniscript.studio.robot_link import BadRequest

__all__ = ["without_ports"]  # a fixture
Json = dict[str, Any]
SEEDS = 20
STEPS = 80
ROBOTS = 2
NAMES = ("Ana", "Luz", "Teo", "Eva", "Ivo")
LESSONS = ("01_first_line", "02_there_and_back", "03_turns")


class Page:
    """A pupil's page: its reports, and the connection of its turn."""

    def __init__(self, name: str, token: str) -> None:
        self.name, self.token = name, token
        self.text = ""
        self.lessons: list[str] = []
        self.robot: FakeRobot | None = None
        self.heard_s = 0.0
        self.opened: list[str] = []  # keys of handouts
        self.confirmed_handout = ""  # text of the last one that the class knows to be open


class History:
    """Acts by chance, and looks at everything that can be seen after each act."""

    def __init__(self, rng: Random) -> None:
        self.rng = rng
        self.room = Room(ROBOTS)
        self.room.teach("class_places", places=MAX_PUPILS)
        self.pages: dict[str, Page] = {}
        self.gone_pages: dict[str, Page] = {}  # pages whose work is kept, by name
        self.brought_texts: set[str] = set()
        self.texts = 0
        self.failed_s: dict[str, float] = {}  # time of each robot's last failed search, by port
        self.handout = ""  # text of the newest one
        self.order: list[str] = []  # last seen order of waiting pupils

    def state(self) -> Json:
        return self.room.teach("class")

    def answer(self, sender: Page, action: str, **fields: Any) -> Json | None:
        """Send a request as a page; None if it was removed."""
        try:
            answer = self.room.classroom.answer(sender.token, "192.0.2.9", {"do": action, **fields})
        except BadRequest:
            self.leave(sender)
            return None
        sender.heard_s = self.room.now_s
        return answer

    def leave(self, page: Page) -> None:
        self.pages.pop(page.name, None)
        if page.text:
            self.gone_pages[page.name] = page

    # -- events

    def act(self) -> None:
        ways = (self.come, self.tell, self.tell, self.tell, self.change_wishes, self.change_wishes,
                self.connect, self.connect, self.end_connection, self.pass_time, self.pass_time,
                self.remove_pupil, self.give_work_back, self.give_or_take_robot, self.call_next,
                self.bring_work, self.hand_out)  # fmt: skip
        self.rng.choice(ways)()

    def come(self) -> None:
        name = self.rng.choice(NAMES)
        if name in self.pages:
            return
        page_before = self.gone_pages.get(name)
        request = {"do": "join", "code": self.room.classroom.code, "name": name}
        if page_before is not None:
            request["before"] = page_before.token
        answer = self.room.classroom.answer("", "192.0.2.9", request)
        page = self.gone_pages.pop(name) if page_before is not None else Page(name, answer["token"])
        assert answer == {"token": page.token, "name": name}
        page.heard_s = self.room.now_s
        self.pages[name] = page

    def somebody(self) -> Page | None:
        return self.rng.choice(list(self.pages.values())) if self.pages else None

    def tell(self) -> None:
        page = self.somebody()
        if page is None:
            return
        self.texts += 1
        text = f"W({self.texts})"
        lessons = sorted({*page.lessons, self.rng.choice(LESSONS)})
        fields: Json = self.rng.choice(({"text": text}, {"lessons": lessons}, {}))
        answer = self.answer(page, "here", **fields)
        if answer is None:
            return
        page.text = fields.get("text", page.text)
        page.lessons = fields.get("lessons", page.lessons)
        self.open_handout(page, answer)
        returned_work = answer.get("given")
        if returned_work and self.rng.random() < 0.7:
            receipt = {"key": returned_work["key"], "text": returned_work["text"]}
            version_before = self.version(page)
            if self.answer(page, "here", took=receipt) is not None:
                page.text = returned_work["text"]
                page.lessons = sorted({*returned_work["lessons"], *page.lessons})
                assert (
                    self.version(page) > version_before
                )  # otherwise the teacher sees the previous program
                self.brought_texts.discard(page.text)
                for name in [
                    name
                    for name, page_gone in self.gone_pages.items()
                    if page_gone.text == page.text
                ]:
                    del self.gone_pages[name]

    def open_handout(self, page: Page, answer: Json) -> None:
        """Open a handout, once; what the page says of it may be lost."""
        handout = answer.get("handout")
        assert (handout["text"] if handout else "") == self.offered(page)
        if handout is None or self.rng.random() < 0.3:
            return
        if handout["key"] not in page.opened:
            page.opened.append(handout["key"])
        confirmed_key = self.rng.choice(page.opened[-2:])  # that of an earlier one may arrive late
        is_heard = self.rng.random() < 0.7 and self.answer(page, "here", opened=confirmed_key)
        if is_heard and confirmed_key == handout["key"]:
            page.confirmed_handout = handout["text"]

    def offered(self, page: Page) -> str:
        """Return the text of the handout that a page has to be offered."""
        return "" if page.confirmed_handout == self.handout else self.handout

    def hand_out(self) -> None:
        self.texts += 1
        self.handout = f"H({self.texts})"
        state = self.room.teach("class_hand_out", text=self.handout, robot="tinibot")
        assert state["handout"] == {"lesson": 0, "opened": 0}

    def version(self, page: Page) -> int:
        rows = self.state()["pupils"]
        return next(int(row["version"]) for row in rows if row["name"] == page.name)

    def change_wishes(self) -> None:
        page = self.somebody()
        if page is not None:
            self.answer(page, "here", wants=self.rng.random() < 0.8,
                        hand=self.rng.choice((True, False)))  # fmt: skip

    def connect(self) -> None:
        page = self.somebody()
        if page is None:
            return
        answer = self.answer(page, "connect", page="x", port="y")
        if answer == {}:
            page.robot = self.room.hosting.robots[self.room.hosting.requests[-1]["page"]]

    def end_connection(self) -> None:
        """A connection ends by itself: the robot has met its page, or none."""
        driving = [page for page in self.pages.values() if page.robot and not page.robot.has_ended]
        if not driving:
            return
        page = self.rng.choice(driving)
        assert page.robot is not None
        page.robot.has_ended = True
        page.robot.was_left = self.rng.random() < 0.5
        page.robot.name = self.rng.choice(("", "TINI"))
        if not page.robot.name and not page.robot.was_left:
            ports = [robot["port"] for robot in self.raw_robots() if robot["pupil"] == page.name]
            self.failed_s |= dict.fromkeys(ports, self.room.now_s)

    def rows(self) -> list[Json]:
        """The pupils as they are, without a look at the turns."""
        return self.room.classroom._state()["pupils"]  # type: ignore[no-any-return]

    def raw_robots(self) -> list[Json]:
        return self.room.classroom._state()["robots"]  # type: ignore[no-any-return]

    def pass_time(self) -> None:
        for _ in range(self.rng.choice((1, 3, 8, 30))):
            self.room.now_s += 1
            for page in list(self.pages.values()):
                if self.rng.random() < 0.8:
                    self.answer(page, "here")

    def remove_pupil(self) -> None:
        page = self.somebody()
        if page is None or self.rng.random() < 0.5:
            return
        driven_fake_robot = page.robot if self.has_turn(page) else None
        self.room.teach("class_remove", pupil=self.room.number(page.name))
        assert driven_fake_robot is None or driven_fake_robot.has_ended
        self.leave(page)

    def has_turn(self, page: Page) -> bool:
        return any(row["name"] == page.name and row["robot"] for row in self.rows())

    def give_work_back(self) -> None:
        kept_work, page = self.state()["kept"], self.somebody()
        if kept_work and page is not None:
            key = self.rng.choice(kept_work)["key"]
            self.room.teach("class_give_back", key=key, pupil=self.room.number(page.name))

    def give_or_take_robot(self) -> None:
        port = f"port{self.rng.randrange(ROBOTS)}"
        gives = self.rng.random() < 0.6
        holder = next((robot["pupil"] for robot in self.raw_robots() if robot["port"] == port), "")
        self.room.teach("class_robot", port=port, gives=gives)
        if not gives:
            self.failed_s.pop(port, None)
        if not gives and holder in self.pages:
            robot = self.pages[holder].robot
            assert robot is None or robot.has_ended  # the class controls only its own robots

    def call_next(self) -> None:
        page = self.somebody()
        if page is not None:
            self.room.teach("class_next", pupil=self.room.number(page.name))

    def bring_work(self) -> None:
        self.texts += 1
        text = f"S({self.texts})"
        self.room.teach("class_bring", name="Old", text=text, robot="", lessons=[LESSONS[0]])
        self.brought_texts.add(text)

    # -- invariants

    def check_invariants(self) -> None:
        state = self.state()
        self.check_no_work_is_lost()
        self.check_turns(state)
        self.check_crash_loses_nothing(state)

    def check_no_work_is_lost(self) -> None:
        """Return each page's newest program, and those of pupils who left, as many times as they
        were made."""
        texts = {
            page.text for page in (*self.pages.values(), *self.gone_pages.values()) if page.text
        }
        texts_there = {pupil["text"] for pupil in self.room.teach("class_work")["pupils"]}
        present_names = {row["name"] for row in self.rows()}
        assert texts | self.brought_texts <= texts_there, (texts | self.brought_texts) - texts_there
        for page in self.pages.values():
            if page.name in present_names and page.text:
                number = self.room.number(page.name)
                work = self.room.teach("class_text", pupil=number)
                assert (work["text"], sorted(work["lessons"])) == (page.text, page.lessons)

    def check_turns(self, state: Json) -> None:
        now_s = self.room.now_s
        heard_s = {page.name: page.heard_s for page in self.pages.values()}
        queued_pupils = sorted((row for row in state["pupils"] if row["place"]),
                         key=lambda row: row["place"])  # fmt: skip
        assert [row["place"] for row in queued_pupils] == list(range(1, len(queued_pupils) + 1))
        for row in queued_pupils:
            assert not row["robot"], "who has a turn waits for another one"
            assert row["silent_s"] <= QUEUE_S + 1, "who is silent keeps others waiting"
        names = [row["name"] for row in queued_pupils]
        stayed = [name for name in self.order if name in names]
        kept_order = [name for name in names if name in stayed]
        assert kept_order == stayed or self.had_turn, (kept_order, stayed)
        self.order = names
        self.had_turn = any(row["robot"] for row in state["pupils"])
        is_somebody_next = any(now_s - heard_s.get(name, 0) <= PRESENCE_S for name in names)
        for robot in state["robots"]:
            rests = now_s < self.failed_s.get(robot["port"], float("-inf")) + REST_S
            assert robot["pupil"] or rests or not is_somebody_next, "a robot stands idle"
            assert not (robot["pupil"] and rests and robot["left_s"] == 60), "it rests"

    had_turn = False

    def check_crash_loses_nothing(self, state: Json) -> None:
        """Check that a class resumes after a crash with the same pupils, work, robots and
        settings.
        """
        kept_state = json.loads(json.dumps(self.room.classroom.state_to_keep()))
        room_after = Room(0)
        assert room_after.classroom.resume(kept_state) == len(state["pupils"])
        resumed_class = room_after.teach("class")
        for name in ("code", "turn_s", "places"):
            assert resumed_class[name] == state[name], name
        states = [
            [(row["name"], *row["lessons"]) for row in work["pupils"]]
            for work in (resumed_class, state)
        ]
        assert states[0] == states[1]
        assert [row["port"] for row in resumed_class["robots"]] == [
            row["port"] for row in state["robots"]
        ]
        works = [
            sorted(map(str, room.teach("class_work")["pupils"])) for room in (room_after, self.room)
        ]
        assert works[0] == works[1]
        kept_rows = [
            sorted((row["name"], numbers(work).get(row["given"], "")) for row in work["kept"])
            for work in (resumed_class, state)
        ]
        assert kept_rows[0] == kept_rows[1], "what was given is given to nobody"
        assert resumed_class["handout"] == state["handout"]
        for page in self.gone_pages.values():  # who returns gets it only if it is not open there
            request = {"do": "join", "code": state["code"], "name": page.name, "before": page.token}
            assert room_after.classroom.answer("", "192.0.2.9", request)["token"] == page.token
        for page in (*self.pages.values(), *self.gone_pages.values()):
            handout = room_after.check_in(page.token).get("handout", {"text": ""})
            assert handout["text"] == self.offered(page)
        next_lesson = Room(0)  # it has handed out nothing yet
        next_lesson.classroom.resume(kept_state, is_same_lesson=False)
        code = next_lesson.teach("class_places", places=MAX_PUPILS)["code"]
        for page in (*self.pages.values(), *self.gone_pages.values()):
            request = {"do": "join", "code": code, "name": page.name, "before": page.token}
            token = next_lesson.classroom.answer("", "192.0.2.9", request)["token"]
            assert "handout" not in next_lesson.check_in(token)


def numbers(state: Json) -> dict[int, str]:
    return {row["number"]: row["name"] for row in state["pupils"]}


@pytest.mark.parametrize("part", range(4))
def test_a_class_keeps_its_invariants_after_any_history(part: int) -> None:
    for seed in range(part, SEEDS, 4):
        history = History(Random(seed))
        for _ in range(STEPS):
            history.act()
            history.check_invariants()


def test_a_restarted_class_equals_a_new_one() -> None:
    for seed in range(SEEDS):
        history = History(Random(1000 + seed))
        for _ in range(history.rng.randrange(STEPS)):
            history.act()
        old_pages = list(history.pages.values())
        driven_fake_robots = [
            page.robot for page in old_pages if page.robot and history.has_turn(page)
        ]
        room = history.room
        code, settings = room.classroom.code, {}
        old_settings = room.teach("class")
        anew = room.teach("class_anew")
        assert anew["code"] != code and all(
            robot.has_ended for robot in driven_fake_robots if robot
        )
        new_class = Room(0).teach("class")
        settings = {
            "code": anew["code"],
            "turn_s": old_settings["turn_s"],
            "places": old_settings["places"],
        }
        ports = [{**robot, "pupil": "", "left_s": 0} for robot in old_settings["robots"]]
        name_by_port = {robot["port"]: robot["name"] for robot in anew["robots"]}
        assert anew == new_class | settings | {
            "robots": [{**port, "name": name_by_port[port["port"]]} for port in ports]
        }
        assert room.teach("class_work")["pupils"] == []
        for page in old_pages:
            with pytest.raises(BadRequest):
                room.check_in(page.token)
            with pytest.raises(BadRequest):
                room.classroom.answer(page.token, "192.0.2.9", {"do": "connect"})
        answer = room.classroom.answer("", "192.0.2.9", {
            "do": "join", "code": anew["code"], "name": "Ana",
            "before": old_pages[0].token if old_pages else "",
        })  # fmt: skip
        assert answer["name"] == "Ana" and answer["token"] not in {page.token for page in old_pages}
        assert room.check_in(answer["token"])["hand"] is False
        room.now_s += PLACE_S
