"""Groups of a class: shared editing, limits, and one robot for the group."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from itertools import count
from pathlib import Path
from random import Random
from threading import Event, Thread
from typing import Any

import pytest

from tests.support.class_room import PUPIL_ADDRESS, Room, without_ports
from tests.support.journal_disk import before_each_write, full_disk
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript.studio import groups
from tiniscript.studio.class_keeping import MAX_PUPILS
from tiniscript.studio.classroom import Classroom
from tiniscript.studio.robot_link import BadRequest
from tiniscript.together import journal as journals
from tiniscript.together.form import data_of_change
from tiniscript.together.page import Page

__all__ = ["without_ports"]  # a fixture
Json = dict[str, Any]
NAMES = ("Ana", "Luz", "Teo", "Eva", "Ivo")
TEXT = "F(1, 80)\nLOOP(3)\nB(1, 40)\nEND_LOOP\nS\n"


class School(Room):
    """A class with room for all, and the stored data of its groups."""

    def __init__(self, folder: Path, robots: int = 1) -> None:
        super().__init__(robots)
        self.folder = folder
        self.classroom = self.anew(robots)
        self.teach("class_places", places=MAX_PUPILS)

    def anew(self, robots: int = 1) -> Classroom:
        ports = [f"port{k}" for k in range(robots)]
        return Classroom(self.hosting, ports, 60, lambda: self.now_s, self.folder)  # type: ignore[arg-type]

    def crash(self) -> None:
        kept_state = json.loads(json.dumps(self.classroom.state_to_keep()))
        self.classroom = self.anew()
        self.classroom.resume(kept_state)
        self.classroom.tidy()


class Member:
    """A pupil's page in a group."""

    def __init__(self, school: School, name: str, group: str = "Red", text: str = TEXT) -> None:
        self.school, self.name = school, name
        self.token = school.join(name)
        self.seen_count = 0
        answer = self.join(group, text)
        assert "failure" not in answer, answer
        self.page = Page.of(answer["page"], answer)

    def join(self, group: str, text: str = TEXT, old_token: str = "") -> Json:
        return self.ask("group_join", name=group, text=text, before=old_token)

    def ask(self, action: str, **fields: Any) -> Json:
        return self.school.classroom.answer(self.token, PUPIL_ADDRESS, {"do": action, **fields})

    def request(self, **fields: Any) -> Json:
        page = self.page
        seen_number = -1 if page.is_out_of_sync else page.number
        return {
            "page": page.name,
            "since": seen_number,
            "epoch": page.epoch,
            "saw": self.seen_count,
            **fields,
        }

    def send(self, **fields: Any) -> Json:
        """Send pending changes, and receive news."""
        changes = [
            data_of_change(change) for change in self.page.pending_changes[: groups.MAX_CHANGES]
        ]
        answer: Json = json.loads(
            json.dumps(self.ask("group", **self.request(changes=changes, **fields)))
        )
        assert "left" not in answer
        self.page.receive(answer)
        self.seen_count = answer["saw"]
        return answer

    def type(self, old_text: str, new_text: str) -> None:
        rows = [row.replace(old_text, new_text) for row in self.page.lines]
        assert rows != self.page.lines
        self.page.type(rows, 0)
        self.page.flush()

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.page.lines).split())


class Teacher(Member):
    """The teacher's page in a group."""

    def __init__(self, school: School, key: str, text_before: str = "") -> None:
        self.school, self.name, self.seen_count = school, "Teacher", 0
        answer = self.ask("group_visit", group=key, name=self.name, before=text_before)
        assert "failure" not in answer, answer
        self.page = Page.of(answer["page"], answer)

    def ask(self, action: str, **fields: Any) -> Json:
        return self.school.classroom.teach({"do": action, **fields})


@pytest.fixture
def school(tmp_path: Path) -> School:
    return School(tmp_path / "groups")


def test_pupils_of_a_group_have_one_program(school: School) -> None:
    # Names that look the same.
    ana, luz = Member(school, "Ana"), Member(school, "Luz", "RED", "S\n")
    assert luz.text == ana.text == "F(1, 80); LOOP(3); B(1, 40); END_LOOP; S;"
    ana.type("80", "95")
    ana.send()
    luz.type("B(1", "B(7")
    luz.send()
    ana.send()
    assert ana.text == luz.text == "F(1, 95); LOOP(3); B(7, 40); END_LOOP; S;"
    assert school.check_in(ana.token)["group"] == "Red"
    teo = school.join("Teo")
    assert school.check_in(teo)["groups"] == [{"name": "Red", "members": ["Ana", "Luz"]}]


def test_others_see_a_pupils_cursor_and_typing(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    ana.send(at="i.3", writes=True)
    [pupil] = luz.send()["others"]
    assert pupil == {"name": "Ana", "mark": 0, "at": "i.3", "writes": True}
    assert luz.send()["others"][0]["mark"] != luz.ask("group", **ana.request())
    assert {member["mark"] for member in ana.send()["others"]} == {1}
    for place in ("x" * 30, "a b", 5, None):
        with pytest.raises(BadRequest):
            ana.send(at=place)


def test_a_group_has_four_places_and_silent_pupils_lose_theirs(school: School) -> None:
    members = [Member(school, f"P{k}") for k in range(groups.MAX_MEMBERS)]
    late_token = school.join("Late")
    request = {"do": "group_join", "name": "Red", "text": ""}
    assert school.classroom.answer(late_token, PUPIL_ADDRESS, request) == {"failure": "group_full"}
    school.now_s += groups.ABSENCE_S + 1
    for member in members[1:]:
        member.send()
    assert school.classroom.answer(late_token, PUPIL_ADDRESS, request)["group"] == "Red"
    assert members[0].ask("group", **members[0].request()) == {"left": True}


def test_only_a_program_can_start_a_group(school: School) -> None:
    token = school.join("Ana")

    def begin_group(name: str, text: str) -> Json:
        request = {"do": "group_join", "name": name, "text": text}
        return school.classroom.answer(token, PUPIL_ADDRESS, request)

    assert begin_group("Red", "LOOP(3)\n") == {"failure": "group_mistakes"}
    assert begin_group("Red", "S\n" * 10_000) == {"failure": "group_long"}
    assert begin_group("Red", f"// {'x' * 3000}\n") == {"failure": "group_long"}
    assert begin_group(" ", TEXT) == {"failure": "group_nameless"}
    assert school.teach("class")["groups"] == []
    for k in range(groups.MAX_FOUNDED):
        assert begin_group(f"Group {k}", TEXT)["group"] == f"Group {k}"
        change = {"uid": "m1:1", "ops": [{"do": "delete", "ids": ["i.1"]}]}
        school.classroom.answer(token, PUPIL_ADDRESS,
                           {"do": "group", "page": "m1", "since": 0, "epoch": "",
                            "changes": [change]})  # fmt: skip
    assert begin_group("One more", TEXT) == {"failure": "group_many"}


def test_an_unchanged_group_ends_with_its_last_pupil(school: School) -> None:
    ana = Member(school, "Ana")
    ana.ask("group_leave")
    assert school.teach("class")["groups"] == []
    assert not list(school.folder.iterdir())
    luz = Member(school, "Luz")
    luz.type("80", "95")
    luz.send()
    luz.ask("group_leave")
    assert len(school.teach("class")["groups"]) == 1
    assert "F(1, 95)" in Member(school, "Teo", text="S\n").text  # a new member gets the program


def test_a_waiting_page_is_notified_at_once_and_delays_nobody(
    school: School, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(groups, "MAX_HELD_S", 10 * HANG_LIMIT_S)
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    ana.send()
    luz.send()
    answers: list[Json] = []
    waiting_thread = start_thread(
        lambda: answers.append(ana.ask("group", **ana.request(waits=True)))
    )
    until(lambda: hold_count_of(school, ana) > 0, "the page waits")
    assert school.check_in(luz.token)["group"] == "Red"  # the class is not held
    luz.type("80", "95")
    luz.send()
    waiting_thread.join(HANG_LIMIT_S)
    assert "F(1, 95)" in json.dumps(answers)


def test_a_page_holds_one_request(school: School, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(groups, "MAX_HELD_S", 10 * HANG_LIMIT_S)
    ana = Member(school, "Ana")
    ana.send()
    threads = []
    for k in range(5):
        threads.append(start_thread(lambda: ana.ask("group", **ana.request(waits=True))))
        until(partial(has_held, school, ana, k + 1), "the page waits")
    for thread in threads[:-1]:
        thread.join(HANG_LIMIT_S)
        assert not thread.is_alive()
    ana.ask("group_leave")
    threads[-1].join(HANG_LIMIT_S)
    assert not threads[-1].is_alive()


def test_a_held_request_ends(school: School, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(groups, "MAX_HELD_S", 0.05)
    ana = Member(school, "Ana")
    ana.send()
    assert ana.ask("group", **ana.request(waits=True))["changes"] == []


def test_a_waiting_page_gets_robot_events_without_delaying_the_robot(
    school: School, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(groups, "MAX_HELD_S", 10 * HANG_LIMIT_S)
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    school.check_in(ana.token, True)
    robot = school.connect(ana.token)
    ana.send()
    luz.send()
    answers: list[Json] = []
    waiting_thread = start_thread(
        lambda: answers.append(luz.ask("group", **luz.request(waits=True)))
    )
    until(lambda: hold_count_of(school, luz) > 0, "the page waits")
    group = school.classroom._groups.group_of(luz.token)
    assert group is not None and robot.witness is not None
    started_event = {"event": "STARTED", "program": "a", "is_program": True}
    with (
        group.condition,
        school.classroom._lock,
        school.classroom._groups._lock,
    ):  # one of them is busy with these
        telling = start_thread(lambda: robot.witness([started_event]))  # type: ignore[misc]
        telling.join(HANG_LIMIT_S)
        assert not telling.is_alive()
    waiting_thread.join(HANG_LIMIT_S)
    assert [run["event"] for run in answers[0]["runs"]] == ["STARTED"]
    assert "runs" not in ana.ask("group", **ana.request())  # her page has it from the robot


def test_only_the_drivers_group_gets_the_robots_events(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    eva = Member(school, "Eva", "Blue")
    school.check_in(ana.token, True)
    robot = school.connect(ana.token)

    def has_value(member: Member, value: str) -> bool:
        text = json.dumps(member.send(ran=["", 0]))
        return f'"{value}"' in text

    def show_value(value: str) -> None:
        started_event = {"event": "STARTED", "program": "a", "is_program": True}
        if robot.witness is not None:
            robot.witness([started_event, {"event": "SHOW", "value": value}])

    show_value("one")
    assert has_value(luz, "one") and not has_value(eva, "one")
    ana.join("Blue")
    show_value("two")
    assert has_value(eva, "two") and not has_value(luz, "two")
    assert not has_value(luz, "STARTED")  # the run is over for them
    ana.ask("group_leave")
    show_value("three")
    assert not has_value(eva, "three") and not has_value(luz, "three")
    ana.join("Red")
    show_value("four")
    other_robot = school.connect(luz.token)
    show_value("five")  # the stop at the end of her run
    assert has_value(luz, "five")
    assert other_robot.witness is not None


def start_thread(function: Callable[[], object]) -> Thread:
    thread = Thread(target=function, daemon=True)
    thread.start()
    return thread


def has_held(school: School, member: Member, count: int) -> bool:
    return hold_count_of(school, member) == count


def hold_count_of(school: School, member: Member) -> int:
    group = school.classroom._groups.group_of(member.token)
    assert group is not None
    return group.member_by_token[member.token].hold_count


def test_the_amount_that_a_pupil_sends_is_limited(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    burst_count, per_s = groups.CHANGE_RATE
    for k in range(round(burst_count) + 20):
        ana.type("F(", "B(") if k % 2 == 0 else ana.type("B(1, 8", "F(1, 8")
    answers = [ana.send() for _ in range(4)]
    assert answers[-1].get("slow") is True
    assert len(ana.page.pending_changes) >= 20
    luz.type("S;", "BEEP(1, 440);")
    assert "slow" not in luz.send()  # rates are counted for each pupil
    school.now_s += 60 / per_s
    ana.send()
    ana.send()
    assert not ana.page.pending_changes
    text = "".join(f"// {k} {'x' * 900}\n" for k in range(80))
    ana.page.type((text + TEXT).split("\n"), 0)
    ana.page.flush()
    assert not ana.page.pending_changes  # the page itself makes no program that is too long
    large_change = {
        "uid": f"{ana.page.name}:{ana.page.change_count + 1}",
        "ops": [
            {"do": "insert", "at": ["root", ""], "nodes": [{"id": "m1.9", "text": "S", "x": text}]}
        ],
    }
    answer = ana.ask("group", **ana.request(changes=[large_change]))
    assert answer["refused"][-1] == [large_change["uid"], "too_long"]


def test_nobody_sends_as_another_page(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    luz.type("80", "95")
    forged = [data_of_change(change) for change in luz.page.pending_changes]
    wrong_changes: list[Any] = [forged, [5], [{"uid": "x"}], "no", [{}] * 51]
    for changes in wrong_changes:
        with pytest.raises(BadRequest):
            ana.ask("group", **ana.request(changes=changes))
    for fields in ({"since": "0"}, {"since": -2}, {"epoch": 5}, {"saw": None}):
        with pytest.raises(BadRequest):
            ana.ask("group", **{**ana.request(), **fields})
    assert ana.ask("group", **{**ana.request(), "page": luz.page.name}) == {"left": True}


def test_a_hostile_pupil_affects_only_the_own_group(school: School) -> None:
    """Each message is refused or makes a valid program; other groups, and the class, do not
    notice."""
    rng = Random(3)
    eve = Member(school, "Eve", "Bad")
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    values: list[Any] = [
        None,
        -1,
        2**40,
        "",
        "m1",
        "m1:1",
        "root",
        [],
        {},
        [[]],
        "x" * 5000,
        True,
        [{"uid": "m1:1", "ops": [{}]}],
        [{"uid": "m1:2", "ops": "x"}],
        [{"uid": "m1:1", "ops": [{"do": "delete", "ids": ["i.1", "i.2"]}]}],
    ]
    fields = ("page", "since", "epoch", "saw", "changes", "at", "writes", "name", "text", "before")
    for k in range(400):
        request = eve.request(do=rng.choice(("group", "group", "group_join", "group_leave")))
        for field in rng.sample(fields, rng.randint(0, 3)):
            request[field] = rng.choice(values)
        with suppress(BadRequest):
            school.classroom.answer(eve.token, PUPIL_ADDRESS, json.loads(json.dumps(request)))
        if k % 50 == 0:
            old_power, new_power = ("80", "95") if "80" in ana.text else ("95", "80")
            ana.type(old_power, new_power)
            ana.send()
            luz.send()
            assert ana.text == luz.text and new_power in luz.text
        school.now_s += 0.1
    assert school.check_in(luz.token)["group"] == "Red"
    assert {group["name"] for group in school.teach("class")["groups"]} >= {"Red"}


def test_groups_continue_after_a_crash_without_loss(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    ana.type("80", "95")
    ana.send()
    luz.type("B(1", "B(7")  # text not sent yet
    [group] = school.teach("class")["groups"]
    text_before = school.teach("class_text", group=group["key"])
    for _ in range(2):
        school.crash()
        assert school.teach("class_text", group=group["key"]) == text_before
    luz.send()
    ana.send()
    assert ana.text == luz.text == "F(1, 95); LOOP(3); B(7, 40); END_LOOP; S;"
    teo = Member(school, "Teo", text="S\n")
    assert teo.page.name not in (ana.page.name, luz.page.name)
    answer = ana.join("Red", old_token=ana.page.name)  # her page is loaded again
    assert answer["page"] == ana.page.name
    assert luz.join("Red", old_token=ana.page.name)["page"] not in (ana.page.name, teo.page.name)


@pytest.mark.parametrize("seed", range(10))
def test_groups_continue_after_crashes_whenever_the_disk_was_full(
    school: School, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """A second crash loses no more than the first one, and all that is typed then is taken."""
    rng, is_full, numbers = Random(seed), False, count(100)
    monkeypatch.setattr(journals, "MAX_BYTES", 1500)

    before_each_write(monkeypatch, lambda: full_disk() if is_full else None)
    members = [Member(school, "Ana"), Member(school, "Luz"), Member(school, "Teo", "Blue")]

    def type_and_send(member: Member) -> None:
        member.send()
        old_line = rng.choice([row for row in member.page.lines if "0)" in row])
        new_line = re.sub(r"\(\d+", f"({next(numbers)}", old_line)
        member.type(old_line, new_line)
        member.send()
        [group] = [row for row in school.teach("class")["groups"]
                   if school.number(member.name) in row["pupils"]]  # fmt: skip
        assert new_line in school.teach("class_text", group=group["key"])["text"].split("\n")

    def texts() -> list[str]:
        keys = [group["key"] for group in school.teach("class")["groups"]]
        return [school.teach("class_text", group=key)["text"] for key in keys]

    for _ in range(40):
        is_full = rng.random() < (0.7 if is_full else 0.2)
        type_and_send(rng.choice(members))
        school.now_s += 1
        if rng.random() < 0.2:
            school.crash()
            texts_then = texts()
            school.crash()
            assert texts() == texts_then and len(texts_then) == 2


def test_a_group_survives_another_lesson_without_its_pupils(school: School) -> None:
    ana = Member(school, "Ana")
    ana.type("80", "95")
    ana.send()
    kept_state = json.loads(json.dumps(school.classroom.state_to_keep()))
    school.classroom = school.anew()
    school.classroom.resume(kept_state, is_same_lesson=False)
    assert [group["pupils"] for group in school.teach("class")["groups"]] == [[]]
    assert "F(1, 95)" in Member(school, "Luz", text="S\n").text


@pytest.mark.parametrize("end", ["class_over", "class_anew"])
def test_groups_end_with_their_class(school: School, end: str) -> None:
    ana = Member(school, "Ana")
    ana.type("80", "95")
    ana.send()
    (school.folder / "0.journal").write_text("of a class that has gone")
    school.classroom.tidy()
    assert len(list(school.folder.iterdir())) == 1
    groups_there = school.classroom._groups
    school.teach(end, erases=True)
    assert not list(school.folder.iterdir())
    assert groups_there.answer(ana.token, ana.request()) == {"left": True}


def test_the_teacher_sees_a_group_as_one_entry_and_its_program(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    [group_seen] = school.teach("class")["groups"]
    assert group_seen["pupils"] == [school.number("Ana"), school.number("Luz")]
    ana.type("80", "95")
    ana.send()
    assert "F(1, 95);" in school.teach("class_text", group=group_seen["key"])["text"]
    [group] = school.classroom._groups.all()
    assert school.classroom._groups.history(group)[-1]["who"] == "Ana"
    school.teach("class_remove", pupil=school.number("Ana"))
    [group_seen] = school.teach("class")["groups"]
    assert group_seen["pupils"] == [school.number("Luz")]
    assert luz.send()["others"] == []


def test_the_teacher_joins_and_leaves_a_group(school: School) -> None:
    members = [Member(school, f"P{k}") for k in range(groups.MAX_MEMBERS)]
    [group] = school.teach("class")["groups"]
    teacher = Teacher(school, group["key"])
    assert teacher.page.lines == members[0].page.lines
    [teacher_row] = [
        member for member in members[0].send()["others"] if member["name"] == "Teacher"
    ]
    marks = {member["mark"] for member in teacher.send()["others"]}
    assert marks == set(range(groups.MARK_COUNT)) and teacher_row["mark"] not in marks
    teacher.type("80", "95")
    teacher.send(at="i.3", writes=True)
    members[1].send()
    assert "F(1, 95)" in members[1].text
    assert school.teach("class_text", group=group["key"])["history"] == ["Teacher: → F(1, 95)"]
    assert school.teach("class")["groups"][0]["pupils"] == group["pupils"]
    [shown_group] = school.check_in(school.join("Late"))["groups"]
    assert shown_group["members"] == [member.name for member in members]
    teacher.ask("group_leave")
    assert len(members[0].send()["others"]) == groups.MAX_MEMBERS - 1
    assert teacher.ask("group", **teacher.request()) == {"left": True}


def test_the_teacher_takes_no_pupils_place(school: School) -> None:
    ana = Member(school, "Ana")
    [group] = school.teach("class")["groups"]
    teacher = Teacher(school, group["key"])
    for k in range(groups.MAX_MEMBERS - 1):
        Member(school, f"P{k}")
    late_token = school.join("Late")
    request = {"do": "group_join", "name": "Red", "text": ""}
    assert school.classroom.answer(late_token, PUPIL_ADDRESS, request) == {"failure": "group_full"}
    assert teacher.send()["others"][0]["name"] == ana.name


@pytest.mark.parametrize("seed", range(20))
def test_a_participating_teacher_has_no_share_in_the_robot(tmp_path: Path, seed: int) -> None:
    """Whatever the teacher's page does there, turns, places and robots are as without it."""
    rng = Random(seed)
    schools = [School(tmp_path / str(k), robots=2) for k in range(2)]
    members_by_school = [[Member(school, name, name) for name in NAMES] for school in schools]
    for _ in range(40):
        action, k = rng.choice(("wish", "connect", "join", "leave", "stop")), rng.randrange(5)
        name, wants_turn = rng.choice(NAMES), rng.random() < 0.8
        for school, members in zip(schools, members_by_school, strict=True):
            member = members[k]
            school.now_s += 1
            if action == "wish":
                school.check_in(member.token, wants_turn)
            elif action == "connect" and school.check_in(member.token)["place"] == 0:
                school.connect(member.token)
            elif action == "join":
                member.join(name)
            elif action == "leave":
                member.ask("group_leave")
            elif action == "stop":
                member.ask("stop", group_stops=school.now_s)
        shown_groups = schools[0].teach("class")["groups"]
        if shown_groups:
            teacher = Teacher(schools[0], rng.choice(shown_groups)["key"])
            teacher.send(at="i.1", writes=True)
            if rng.random() < 0.3:
                teacher.ask("group_leave")
        checks = [[school.check_in(member.token) for member in members]
                for school, members in zip(schools, members_by_school, strict=True)]  # fmt: skip
        assert checks[0] == checks[1]
        requests_by_school = [
            [request["do"] for request in school.hosting.requests] for school in schools
        ]
        assert requests_by_school[0] == requests_by_school[1]
        assert schools[0].teach("class")["robots"] == schools[1].teach("class")["robots"]


def test_a_teacher_with_a_silent_page_counts_as_absent(school: School) -> None:
    ana = Member(school, "Ana")
    [group] = school.teach("class")["groups"]
    teacher = Teacher(school, group["key"])
    assert [member["name"] for member in ana.send()["others"]] == ["Teacher"]
    school.now_s += groups.ABSENCE_S + 1
    assert ana.send()["others"] == []
    assert teacher.ask("group", **teacher.request()) == {"left": True}
    second_teacher = Teacher(school, group["key"], teacher.page.name)
    assert second_teacher.page.name == teacher.page.name
    assert [member["name"] for member in ana.send()["others"]] == ["Teacher"]


def test_a_watching_teacher_is_invisible_and_cannot_be_impersonated(school: School) -> None:
    ana = Member(school, "Ana")
    [group] = school.teach("class")["groups"]
    sends_before = ana.send()
    for _ in range(3):
        school.teach("class_text", group=group["key"])
    sends_after = ana.send()
    assert (sends_before["others"], sends_before["saw"]) == (
        sends_after["others"],
        sends_after["saw"],
    )
    with pytest.raises(BadRequest):
        ana.ask("group_visit", group=group["key"], name="Teacher")
    for wrong_group in (None, 5, "", "x" * 32):
        request = {"do": "group_visit", "group": wrong_group, "name": "Teacher"}
        assert school.classroom.teach(request) == {"failure": "group_gone"}
    with pytest.raises(BadRequest):
        school.classroom.teach({"do": "group_visit", "group": group["key"], "name": None})
    school.teach("class_over")
    request = {"do": "group_visit", "group": group["key"], "name": "Teacher"}
    assert school.classroom.teach(request) == {"failure": "class_over"}


# -- one robot for the group ----------------------------------------------------------------------


def test_a_group_has_one_place_in_the_queue_and_one_turn(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    teo, eva = school.join("Teo"), school.join("Eva")
    school.check_in(teo, True)
    school.connect(teo)
    school.check_in(eva, True)
    assert school.check_in(luz.token, True)["place"] == 2
    assert school.check_in(ana.token, True)["place"] == 2  # the same one
    assert school.check_in(teo)["waiting"] == 2
    school.check_in(eva, False)
    school.teach("class_next", pupil=school.number("Teo"))
    school.now_s += 1
    assert school.check_in(ana.token)["place"] == 0
    assert school.check_in(luz.token)["place"] == 0
    assert school.check_in(teo)["waiting"] == 0
    ana.ask("group_leave")
    places = {school.check_in(token)["place"] for token in (ana.token, luz.token)}
    assert places == {0, -1}


@pytest.mark.parametrize("seed", range(10))
def test_a_group_keeps_the_earliest_place_of_its_pupils(school: School, seed: int) -> None:
    """Whoever joins whom, and whoever of them waited first."""
    rng = Random(seed)
    driver = school.join("Teo")
    school.check_in(driver, True)
    school.connect(driver)
    tokens = [school.join(name) for name in NAMES if name != "Teo"]
    for token in rng.sample(tokens, k=rng.randint(2, len(tokens))):
        school.check_in(token, True)
    pupils = school.classroom._pupil_by_token
    for token in rng.choices(tokens, k=6):
        numbers = {
            pupil.token: pupil.queue_number
            for pupil in pupils.values()
            if pupil.queue_number is not None
        }
        fields = {"do": "group_join", "name": rng.choice(("Red", "Blue")), "text": ""}
        school.classroom.answer(token, PUPIL_ADDRESS, fields)
        mates = school.classroom._mates(pupils[token])
        waiting_numbers = [numbers[mate.token] for mate in mates if mate.token in numbers]
        kept_numbers = [mate.queue_number for mate in mates if mate.queue_number is not None]
        assert kept_numbers == sorted(waiting_numbers)[:1]


@pytest.mark.parametrize("seed", range(20))
def test_a_group_waits_once_or_drives_one_robot(tmp_path: Path, seed: int) -> None:
    """This holds whoever joins, leaves, waits or drives, in any order."""
    rng, school = Random(seed), School(tmp_path, robots=2)
    members = [Member(school, name, name) for name in NAMES]
    for step in range(60):
        member = rng.choice(members)
        action = rng.choice(("wish", "wish", "connect", "join", "leave", "next"))
        if action == "wish":
            wants_turn = rng.random() < 0.8
            place = school.check_in(member.token, wants_turn)["place"]
            assert wants_turn or place < 1, "who wants none waits no more, and no one of the group"
        elif action == "connect" and school.check_in(member.token)["place"] == 0:
            with suppress(BadRequest):
                school.connect(member.token)
        elif action == "join":
            member.join(rng.choice(("Red", "Blue", "Green")))
        elif action == "leave":
            member.ask("group_leave")
        elif action == "next":
            school.now_s += rng.choice((1, 70))
            school.teach("class_next", pupil=school.number(member.name))
        classroom = school.classroom
        for pupil in classroom._pupil_by_token.values():
            mates = classroom._mates(pupil)
            turns = [turn for turn in map(classroom._turn, mates) if turn is not None]
            waiting_mates = [mate for mate in mates if mate.queue_number is not None]
            assert len(turns) + len(waiting_mates) <= 1, f"step {step}: {action} {member.name}"


def test_each_member_of_a_group_may_drive_and_stop(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    eve = school.join("Eve")
    school.check_in(ana.token, True)
    school.check_in(luz.token)
    robot = school.connect(ana.token)
    assert "driver" not in school.check_in(ana.token)
    assert school.check_in(luz.token)["driver"] == "Ana"
    luz.ask("stop", group_stops=1)
    luz.ask("stop", group_stops=1)  # sent again, as the answer was lost
    assert robot.stop_count == 1
    luz.ask("stop", group_stops=2)
    luz.ask("stop")  # whatever it counts
    assert robot.stop_count == 3
    school.classroom.answer(eve, PUPIL_ADDRESS, {"do": "stop"})
    assert robot.stop_count == 3
    assert school.classroom.answer(eve, PUPIL_ADDRESS, {"do": "connect"}) == {
        "failure": "turn_none"
    }
    other_robot = school.connect(luz.token)
    assert (robot.leave_reason, other_robot.has_ended) == ("group_other", False)
    assert school.check_in(ana.token)["driver"] == "Luz"
    ana.ask("stop")
    assert (other_robot.stop_count, robot.stop_count) == (1, 3)


@pytest.mark.parametrize("seed", range(100))
def test_a_stop_wins_in_every_order_of_arrival(school: School, seed: int) -> None:
    """It may arrive at any point in connections and runs of others, and a page that was opened
    again counts from 1: no robot that was there keeps driving."""
    rng = Random(seed)
    members = [Member(school, name) for name in ("Ana", "Luz", "Teo")]
    school.check_in(members[0].token, True)
    for member in members:
        school.check_in(member.token)
    school.connect(members[0].token)
    presses = dict.fromkeys(members, 0)
    for _ in range(20):
        member = rng.choice(members)
        turn = school.classroom._turn_of(
            school.classroom._mates(school.classroom._pupil_by_token[member.token])
        )
        assert turn is not None and turn.pupil is not None
        robot = school.hosting.robots[turn.pupil.hosting_page]
        stops_before = robot.stop_count
        deed = rng.choice(("stop", "stop", "connect", "beat", "reload"))
        if deed == "connect":
            if turn.pupil.token != member.token:
                request = {"do": "connect", "page": "x", "port": "y"}
                early_request = {
                    **request,
                    "saw_stops": turn.stop_number - 1,
                }  # the button was pressed before a STOP
                refusal = {"failure": "stopped_elsewhere"}
                assert (
                    school.classroom.answer(member.token, PUPIL_ADDRESS, early_request) == refusal
                )
                assert turn.pupil.token != member.token
                school.connect(member.token)
                assert robot.leave_reason == "group_other"  # leaving stops its run
        elif deed == "beat":
            member.ask("beat", page="x", asked=[{"do": "start", "id": 1}])
        elif deed == "reload":
            member.join("Red", old_token=member.page.name)
            presses[member] = 0
        else:
            presses[member] += 1
            member.ask("stop", group_stops=presses[member], stops=presses[member])
            is_own = turn.pupil.token == member.token
            last_request = school.hosting.requests[-1]
            assert (last_request["do"], last_request["page"]) == ("stop", page_of(school, member))
            assert is_own or robot.stop_count == stops_before + 1


def page_of(school: School, member: Member) -> str:
    return school.classroom._pupil_by_token[member.token].hosting_page


def test_threads_of_pages_end_with_the_same_program(school: School) -> None:
    """As with HTTP, each page has a held request, and one for sending."""
    members = [Member(school, f"P{k}", f"G{k % 2}") for k in range(6)]
    is_over, rng = Event(), Random(4)
    failed_base_exceptions: list[BaseException] = []

    def listen(member: Member) -> None:
        try:
            seen_number = saw_count = 0
            while not is_over.is_set():
                request = {**member.request(waits=True), "since": seen_number, "saw": saw_count}
                answer = member.ask("group", **request)
                seen_number, saw_count = answer.get("n", seen_number), answer.get("saw", saw_count)
        except BaseException as error:
            failed_base_exceptions.append(error)

    threads = [start_thread(partial(listen, member)) for member in members]
    for k in range(300):
        member = rng.choice(members)
        rows = member.page.lines[:]
        rows.insert(rng.randint(0, len(rows)), f"W({1000 + k})")
        if len(rows) > 12:
            del rows[rng.randrange(len(rows))]
        member.page.type(rows, 0)
        member.page.leave()
        member.page.give_up()
        member.send()
        school.now_s += 1
    for _ in range(2):
        for member in members:
            member.send()
    is_over.set()
    for member in members:
        member.ask("group_leave")
    for thread in threads:
        thread.join(HANG_LIMIT_S)
    assert not failed_base_exceptions
    for k in (0, 1):
        assert len({member.page.base.checksum() for member in members[k::2]}) == 1
    assert members[0].text != members[1].text


def test_the_teacher_sees_all_changes_and_authors_even_of_absent_pupils(school: School) -> None:
    ana, luz = Member(school, "Ana"), Member(school, "Luz")
    ana.type("80", "95")
    ana.send()
    luz.send()
    luz.page.type([*luz.page.lines[:1], "BEEP(1, 440);", *luz.page.lines[1:]], 0)
    luz.page.flush()
    luz.send()
    luz.page.type([], 0)
    luz.page.flush()
    luz.send()
    luz.ask("group_leave")
    [group] = school.teach("class")["groups"]
    lines = school.teach("class_text", group=group["key"])
    assert lines["history"] == ["Luz: − 5", "Luz: + BEEP(1, 440)", "Ana: → F(1, 95)"]
    assert [school.classroom._pupil_number(ana.token)] == group["pupils"]
