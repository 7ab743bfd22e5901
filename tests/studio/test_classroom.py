"""A class's rules: who joins, who waits, whose turn it is, and what only the teacher may do."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from tests.support.waiting import HANGS_S
from tiniscript.cli.commands import studio as command
from tiniscript.studio import class_keeping, classroom
from tiniscript.studio import classroom as rate_of
from tiniscript.studio.classroom import Classroom, Rate
from tiniscript.studio.robot_link import BadRequest

Json = dict[str, Any]
HERE = "192.0.2.9"


@dataclasses.dataclass
class FakeRobot:
    """A connection that a test plays."""

    has_ended: bool = False
    name: str = "TINI"
    left: str = ""
    stopped: int = 0
    was_left: bool = False
    silent_s: float = 0.0

    def leave(self, why: str) -> None:
        self.left = why
        self.has_ended = True

    @property
    def attending(self) -> FakeRobot:
        return self

    def latch(self) -> None:
        self.stopped += 1


class FakeHosting:
    """Notes what reaches robots."""

    def __init__(self) -> None:
        self.asked: list[Json] = []
        self.robots: dict[str, FakeRobot] = {}
        self.held: set[str] = set()  # ports that are being left

    def answer(self, request: Json) -> Json:
        self.asked.append(request)
        if request.get("do") == "connect":
            self.robots[request["page"]] = FakeRobot()
            return {}
        return {"news": []}

    def robot_of(self, page: str) -> FakeRobot | None:
        return self.robots.get(page)

    def is_free(self, port: str) -> bool:
        return port not in self.held


class Room:
    """A class with so many robots, whose clock a test moves."""

    def __init__(self, robots: int = 1) -> None:
        self.now_s = 1000.0
        self.hosting = FakeHosting()
        ports = [f"port{k}" for k in range(robots)]
        self.made = Classroom(self.hosting, ports, 60, lambda: self.now_s)  # type: ignore[arg-type]

    def joins(self, name: str, address: str = HERE) -> str:
        answer = self.made.answer("", address, {"do": "join", "code": self.made.code, "name": name})
        return str(answer["token"])

    def here(self, token: str, wants: bool | None = None, **more: Any) -> Json:
        request = {"do": "here", **more} | ({} if wants is None else {"wants": wants})
        return self.made.answer(token, HERE, request)

    def connects(self, token: str) -> FakeRobot:
        assert self.made.answer(token, HERE, {"do": "connect", "page": "x", "port": "y"}) == {}
        return self.hosting.robots[self.hosting.asked[-1]["page"]]

    def teaches(self, do: str, **more: Any) -> Json:
        return self.made.teach({"do": do, **more})

    def number(self, name: str) -> int:
        return next(int(each["number"]) for each in self.teaches("class")["pupils"]
                    if each["name"] == name)  # fmt: skip


def test_a_turn_ends_after_its_time_only_if_somebody_waits() -> None:
    room = Room()
    ana, luz = room.joins("Ana"), room.joins("Luz")
    room.here(ana, True)
    robot = room.connects(ana)
    room.now_s += 500
    assert room.here(ana) | {"name": ""} == {
        "name": "", "place": 0, "waiting": 0, "robots": 1, "robot": "", "left_s": 0,
        "hand": False,
    }  # fmt: skip
    room.here(luz, True)
    assert robot.left == "turn_over"
    assert room.here(luz)["place"] == 0
    assert room.made.answer(ana, HERE, {"do": "connect"}) == {"failure": "turn_none"}


def test_a_turn_lasts_until_its_time() -> None:
    room = Room()
    ana, luz = room.joins("Ana"), room.joins("Luz")
    room.here(ana, True)
    robot = room.connects(ana)
    for _ in range(59):
        room.now_s += 1
        assert room.here(luz, True)["place"] == 1
        room.here(ana)
    assert not robot.has_ended and room.here(ana)["left_s"] == 1
    room.now_s += 1
    assert room.here(luz)["place"] == 0


def test_a_page_that_does_not_take_its_turn_loses_it() -> None:
    room = Room()
    ana, luz = room.joins("Ana"), room.joins("Luz")
    room.here(ana, True)
    room.here(luz, True)
    for _ in range(10):
        room.now_s += 1.01
        room.here(ana)  # is there, and does not connect
    assert room.here(luz)["place"] == 0
    assert room.here(ana)["place"] == -1


def test_who_leaves_in_whatever_way_is_followed_within_three_seconds() -> None:
    """A page that was closed gets no turn and keeps none; who was passed over keeps the place. A
    robot that a page has left before it answered is as good as before."""
    asleep: list[FakeRobot] = []

    def waited(leaves: Callable[[Room, str], None]) -> float:
        room = Room()
        ana, luz = room.joins("Ana"), room.joins("Luz")
        room.here(ana, True)
        room.here(luz, True)
        leaves(room, ana)
        began_s = room.now_s
        while room.here(luz)["place"] != 0:
            room.now_s += 0.3  # as often as the next one's page asks
            for robot in asleep:
                robot.silent_s += 0.3
        return room.now_s - began_s

    def leaves_before(room: Room, ana: str) -> None:
        room.now_s += 1  # its last word

    def leaves_while_it_connects(room: Room, ana: str) -> None:
        robot = room.connects(ana)
        robot.name, robot.was_left, robot.has_ended = "", True, True

    def sleeps(room: Room, ana: str) -> None:
        asleep.append(room.connects(ana))

    for way in (leaves_before, leaves_while_it_connects, sleeps):
        assert waited(way) < 2.5, way.__name__
    room = Room()
    ana, luz = room.joins("Ana"), room.joins("Luz")
    room.here(ana, True)
    room.now_s += 2.5
    assert room.here(luz, True)["place"] == 0
    assert room.here(ana)["place"] == 1


def test_a_page_that_is_gone_is_passed_over_and_waits_no_more() -> None:
    room = Room()
    ana, luz, teo = (room.joins(name) for name in ("Ana", "Luz", "Teo"))
    room.here(ana, True)
    robot = room.connects(ana)
    room.here(luz, True)
    room.here(teo, True)
    room.now_s += 10  # Luz is silent
    assert room.here(teo)["place"] == 2
    robot.has_ended = True
    assert room.here(teo)["place"] == 0
    assert room.here(luz)["place"] == 1  # she is back
    room.now_s += 21
    room.made.tend()
    assert room.teaches("class")["pupils"][1]["place"] == 0


def test_a_robot_that_is_silent_rests_while_another_is_free() -> None:
    room = Room(2)
    ana, luz = room.joins("Ana"), room.joins("Luz")
    room.here(ana, True)
    robot = room.connects(ana)
    robot.name, robot.has_ended = "", True
    room.here(luz, True)
    room.connects(luz)
    assert room.hosting.asked[-1]["port"] == "port1"
    assert room.here(ana, True)["place"] == 1
    room.now_s += 11
    assert room.here(ana)["place"] == 0


def test_a_port_that_is_being_left_is_given_to_nobody() -> None:
    room = Room()
    ana = room.joins("Ana")
    room.hosting.held.add("port0")
    assert room.here(ana, True)["place"] == 1
    room.hosting.held.clear()
    assert room.here(ana)["place"] == 0


# -- hostile pupils


def test_another_turn_is_reached_by_no_name() -> None:
    room = Room()
    ana, eve = room.joins("Ana"), room.joins("Eve")
    room.here(ana, True)
    room.connects(ana)
    own = room.hosting.asked[-1]["page"]
    assert room.made.answer(eve, HERE, {"do": "connect", "page": own, "port": "port0"}) == {
        "failure": "turn_none"
    }
    for do in ("beat", "leave", "stop", "stop_all"):
        room.made.answer(eve, HERE, {"do": do, "page": own, "asked": [{"do": "upload", "id": 1}]})
    assert own not in [each["page"] for each in room.hosting.asked[1:]]
    assert {each["do"] for each in room.hosting.asked[1:]} == {"beat", "leave", "stop"}
    assert room.hosting.asked[-1]["asked"] == []


@pytest.mark.parametrize(
    "do",
    ["ports", "class", "class_over", "class_text", "class_work", "class_bring", "class_give_back",
     "class_forget", "class_anew", "class_hand", "fly", None, ["stop"]],
)  # fmt: skip
def test_what_only_the_teacher_may_ask(do: object) -> None:
    room = Room()
    eve = room.joins("Eve")
    with pytest.raises(BadRequest):
        room.made.answer(eve, HERE, {"do": do, "erases": True, "pupil": 1})
    assert room.hosting.asked == [] and not room.made.has_ended


@pytest.mark.parametrize(
    "asked",
    [{"do": "claim"}, {"do": "disown"}, {"do": "name", "name": "X"}, {"do": "trim", "trim": {}},
     {"do": "undo"}, {}, 5, {"do": ["hello"]}],
    ids=str,
)  # fmt: skip
def test_a_robot_stays_the_teachers(asked: object) -> None:
    room = Room()
    eve = room.joins("Eve")
    room.here(eve, True)
    room.connects(eve)
    with pytest.raises(BadRequest):
        room.made.answer(eve, HERE, {"do": "beat", "asked": [{"do": "hello", "id": 1}, asked]})
    assert [each["do"] for each in room.hosting.asked] == ["connect"]


def test_codes_are_not_guessed() -> None:
    room = Room()
    code, right = room.made.code, 0
    for k in range(5000):
        guess = {"do": "join", "code": f"{k:06}", "name": "Eve"}
        right += room.made.answer("", HERE, guess)["failure"] == "class_wrong"
        room.now_s += 0.01
    assert right <= 20 + 50 / 3 + 1
    # Not even the right one, from there; from elsewhere it is.
    known = {"do": "join", "code": code, "name": "Eve"}
    assert room.made.answer("", HERE, known) == {"failure": "class_slow"}
    assert "token" in room.made.answer("", "192.0.2.10", known)
    room.now_s += 4
    assert "token" in room.made.answer("", HERE, known)


def test_a_code_may_be_written_small_and_apart() -> None:
    room = Room()
    code = room.made.code.lower()
    given = {"do": "join", "code": f" {code[:3]} {code[3:]}", "name": "Ana"}
    assert room.made.answer("", HERE, given)["name"] == "Ana"
    assert room.made.most_bytes("") == 1000
    assert room.made.most_bytes("0" * 32) == 0


@pytest.mark.parametrize(
    ("name", "shown"),
    [("  Ana \n Luz ", "Ana Luz"), ("<b>x</b>", "<b>x</b>"), ("a\x1b[2J\u202eb", "a?[2J?b"),
     ("x" * 1000, "x" * 24 + "…"), ("ñandú 🤖", "ñandú 🤖")],
)  # fmt: skip
def test_names_are_plain(name: str, shown: str) -> None:
    room = Room()
    room.joins(name)
    assert room.teaches("class")["pupils"][0]["name"] == shown
    room.joins(name)
    assert room.teaches("class")["pupils"][1]["name"] == f"{shown} (2)"


def test_who_comes_back_to_a_computer_is_not_a_second_one() -> None:
    room = Room()
    room.joins("Ana")
    second = room.joins("Ana", "198.51.100.1")

    def names() -> list[str]:
        return [each["name"] for each in room.teaches("class")["pupils"]]

    room.now_s += 4
    room.joins("Ana")  # the first one may be there
    assert names() == ["Ana", "Ana (2)", "Ana (3)"]
    room.now_s += 2
    room.joins("Ana")
    assert names() == ["Ana (2)", "Ana (3)", "Ana"]
    room.now_s += 6
    room.here(second)
    room.joins("Ana", "198.51.100.1")  # another one, and here
    assert names() == ["Ana (2)", "Ana (3)", "Ana", "Ana (4)"]


@pytest.mark.parametrize("name", ["", "   ", 5, None, ["a"]])
def test_nobody_joins_without_a_name(name: object) -> None:
    room = Room()
    try:
        answer = room.made.answer("", HERE, {"do": "join", "code": room.made.code, "name": name})
    except BadRequest:
        answer = {"failure": "class_nameless"}
    assert answer == {"failure": "class_nameless"}
    assert room.teaches("class")["pupils"] == []


def test_a_full_class_gives_away_the_places_of_who_has_gone() -> None:
    room = Room()
    first = room.joins("p0")
    room.here(first, True)
    room.connects(first)
    room.now_s += 1
    for k in range(1, class_keeping.MOST_PUPILS):
        room.joins(f"p{k}", f"198.51.100.{k}")
    more = {"do": "join", "code": room.made.code, "name": "more"}
    room.now_s += 30
    assert room.made.answer("", HERE, more) == {"failure": "class_full"}
    room.now_s += 31
    assert "token" in room.made.answer("", HERE, more)
    assert len(room.teaches("class")["pupils"]) == class_keeping.MOST_PUPILS
    assert room.made.most_bytes(first) > 0  # it is her turn


def test_a_pupil_who_asks_without_end_is_refused_but_stops() -> None:
    room = Room()
    eve = room.joins("Eve")
    with pytest.raises(BadRequest):
        for _ in range(200):
            room.here(eve)
    assert room.made.answer(eve, HERE, {"do": "stop"}) == {"news": []}
    room.now_s += 1
    for _ in range(40):
        room.here(eve)


def test_a_huge_program_is_cut() -> None:
    room = Room()
    eve = room.joins("Eve")
    room.here(eve, text="x" * 150_000)
    with pytest.raises(BadRequest):
        room.here(eve, text=["x"])
    number = room.number("Eve")
    assert len(room.teaches("class_text", pupil=number)["text"]) == class_keeping.TEXT_CHARACTERS


def test_what_a_page_tells_of_its_work_is_small_and_plain() -> None:
    room = Room()
    eve = room.joins("Eve")
    room.here(eve, lessons=["01_first_line"] * 1000, robot="liner", is_right=False, hand=True)
    pupil = room.teaches("class")["pupils"][0]
    assert len(pupil["lessons"]) == class_keeping.MOST_LESSONS
    assert (pupil["is_right"], pupil["hand"] > 0) == (False, True)
    for wrong in (
        {"lessons": "01"}, {"lessons": ["<b>"]}, {"lessons": ["x" * 61]}, {"lessons": [5]},
        {"robot": "x"}, {"robot": ["liner"]}, {"text": 5},
    ):  # fmt: skip
        with pytest.raises(BadRequest):
            room.here(eve, **wrong)
    assert room.here(eve, is_right="x", hand="x")["hand"]
    assert not room.here(eve, hand=False)["hand"]
    room.here(eve, hand=True)
    room.teaches("class_hand", pupil=room.number("Eve"))
    assert not room.here(eve)["hand"]


def test_a_name_gets_its_work_from_the_teacher_alone() -> None:
    room = Room()
    work = {"name": "Ana", "text": "F(1, 50)", "robot": "tinibot", "lessons": ["01_first_line"]}
    room.teaches("class_bring", **work)
    eve = room.joins("Ana")  # whoever that is
    assert "given" not in room.here(eve)
    assert room.teaches("class")["kept"] == [{"name": "Ana", "lessons": ("01_first_line",)}]
    room.teaches("class_give_back")
    given = {"text": "F(1, 50)", "robot": "tinibot", "lessons": ("01_first_line",)}
    for _ in range(2):  # an answer may be lost
        assert room.here(eve)["given"] == given
    assert "given" not in room.here(eve, took=True)
    assert room.teaches("class")["kept"] == []
    for wrong in ({"name": " "}, {"name": 5}, {"text": None}, {"robot": "x"}, {"lessons": [1]}):
        with pytest.raises(BadRequest):
            room.teaches("class_bring", **{**work, **wrong})
    for k in range(class_keeping.MOST_PUPILS):
        room.teaches("class_bring", **{**work, "name": f"p{k}"})
    with pytest.raises(BadRequest):
        room.teaches("class_bring", **{**work, "name": "more"})
    room.here(eve, text="S")
    room.teaches("class_remove", pupil=room.number("Ana"))
    assert len(room.teaches("class")["kept"]) == class_keeping.MOST_PUPILS


def test_who_was_removed_finds_the_work_again() -> None:
    room = Room()
    ana = room.joins("Ana")
    room.here(ana, text="F(1, 50)", robot="tinibot")
    room.teaches("class_remove", pupil=room.number("Ana"))
    assert [each["name"] for each in room.teaches("class_work")["pupils"]] == ["Ana"]
    again = room.joins("Ana")
    room.teaches("class_give_back")
    assert room.here(again)["given"]["text"] == "F(1, 50)"
    room.teaches("class_anew")
    assert room.teaches("class_work") == {"pupils": []}
    with pytest.raises(BadRequest):
        room.here(again)


def test_a_crash_ends_no_class(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The next `tsc studio --class` has the same pupils, with their tokens, and their work."""
    file = tmp_path / "class.json"
    monkeypatch.setattr(class_keeping, "path", lambda: file)
    room = Room()
    ana, luz = room.joins("Ana"), room.joins("Luz")
    room.here(ana, text="F(1, 50)", robot="tinibot", lessons=["01_first_line"])
    room.here(luz, text="S")
    room.teaches("class_remove", pupil=room.number("Luz"))
    newest = command._keep(room.made, "")
    assert file.stat().st_mode & 0o077 == 0  # it has tokens
    when_s = file.stat().st_mtime_ns
    assert command._keep(room.made, newest) == newest and file.stat().st_mtime_ns == when_s
    after = Room(0)
    assert command._go_on(after.made) == 1
    state = after.teaches("class")
    assert (state["code"], state["goes_on"]) == (room.made.code, True)
    assert [each["port"] for each in state["robots"]] == ["port0"]
    assert after.here(ana)["name"] == "Ana"
    assert after.teaches("class_work") == room.teaches("class_work")
    with pytest.raises(BadRequest):
        after.here(luz)
    assert not after.teaches("class_anew")["goes_on"]
    room.teaches("class_over")
    assert command._keep(room.made, newest) == "" and not file.exists()
    assert command._go_on(Room().made) == 0


def test_a_damaged_class_goes_on_with_what_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "class.json"
    monkeypatch.setattr(class_keeping, "path", lambda: file)
    room = Room()
    token = room.joins("Ana")
    room.here(token, text="F(1, 50)", robot="tinibot")
    command._keep(room.made, "")
    whole = json.loads(file.read_text())
    for data in ("", "{", "[" * 100_000, "[]", json.dumps({**whole, "form": 2}),
                 json.dumps({**whole, "kept_s": whole["kept_s"] - 3700})):  # fmt: skip
        file.write_text(data)
        assert command._go_on(Room().made) == 0
    row = whole["pupils"][0]
    bad = [5, {**row, "token": "x"}, {**row, "name": " "}, {**row, "address": 5}, {"name": "Eve"}]
    damaged = {**whole, "pupils": [*bad, row], "kept": [5, {"name": "Eve"}], "robots": [5, ""]}
    file.write_text(json.dumps({**damaged, "code": "<b>"}))
    after = Room(0)
    assert command._go_on(after.made) == 1
    assert after.here(token)["name"] == "Ana" and after.made.code != room.made.code
    file.write_text(
        json.dumps({**whole, "pupils": [{**row, "token": f"{k:032x}"} for k in range(99)]})
    )
    assert command._go_on(Room().made) == class_keeping.MOST_PUPILS


# -- the teacher


def test_the_teacher_sees_stops_and_takes_back() -> None:
    room = Room()
    ana, luz = room.joins("Ana"), room.joins("Luz")
    room.here(ana, True, text="F(1, 50)")
    room.here(luz, True)
    robot = room.connects(ana)
    state = room.teaches("class")
    assert [(each["name"], each["place"], each["robot"]) for each in state["pupils"]] == [
        ("Ana", 0, "port0"), ("Luz", 1, ""),
    ]  # fmt: skip
    assert state["robots"] == [{"port": "port0", "name": "", "pupil": "Ana", "left_s": 60}]
    number = room.number("Ana")
    assert room.teaches("class_text", pupil=number)["text"] == "F(1, 50)"
    room.teaches("class_stop", pupil=number)
    assert robot.stopped == 1 and not robot.has_ended
    room.teaches("class_next", pupil=number)
    assert robot.left == "turn_over"
    assert room.here(luz)["place"] == 0
    room.teaches("class_remove", pupil=number)
    assert room.made.most_bytes(ana) == 0
    with pytest.raises(BadRequest):
        room.here(ana)
    room.teaches("stop_all")
    assert room.hosting.asked[-1] == {"do": "stop_all"}


def test_robots_come_and_go() -> None:
    room = Room(0)
    ana = room.joins("Ana")
    assert room.here(ana, True)["robots"] == 0
    room.teaches("class_robot", port="port7", gives=True)
    assert len(room.teaches("class_robot", port="port7", gives=True)["robots"]) == 1
    assert room.here(ana)["place"] == 0
    robot = room.connects(ana)
    assert room.teaches("class_robot", port="port7", gives=False)["robots"] == []
    assert robot.left == "turn_over"
    for port in ("", " ", "a\nb", 5, "x" * 301):
        with pytest.raises(BadRequest):
            room.teaches("class_robot", port=port, gives=True)


def test_a_new_code_and_another_turn() -> None:
    room = Room()
    old = room.made.code
    assert room.teaches("class_code")["code"] == room.made.code != old
    assert room.made.answer("", HERE, {"do": "join", "code": old, "name": "Eve"}) == {
        "failure": "class_wrong"
    }
    assert room.teaches("class_turn", seconds=300)["turn_s"] == 300
    for seconds in (9, 3601, "300", True, None):
        with pytest.raises(BadRequest):
            room.teaches("class_turn", seconds=seconds)


@pytest.mark.parametrize(("erases", "over"), [(True, "erased"), (False, "kept")])
def test_the_end_reaches_every_page(erases: bool, over: str) -> None:
    room = Room()
    ana, luz = room.joins("Ana"), room.joins("Luz")
    room.here(ana, True)
    robot = room.connects(ana)
    room.here(luz, True)
    room.teaches("class_over", erases=erases)
    assert robot.left == "turn_over"
    room.made.tend()
    assert not room.made.has_ended
    assert room.here(ana) == {"over": over}
    assert not room.made.has_ended
    assert room.here(luz, True) == {"over": over}
    assert room.made.has_ended
    assert [each["pupil"] for each in room.teaches("class")["robots"]] == [""]
    late = {"do": "join", "code": room.made.code, "name": "Teo"}
    assert room.made.answer("", HERE, late) == {"failure": "class_over"}


def test_who_has_asked_is_forgotten_after_a_thousand_others() -> None:
    rate = Rate(1, 0)
    assert rate.take("a", 0) and not rate.take("a", 0)
    for k in range(rate_of.MOST_NAMES):
        assert rate.take(f"b{k}", 0)
    assert rate.take("a", 0)


def test_no_stop_and_no_beat_waits_for_the_names_of_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    """A list of ports may take seconds, and a robot drives meanwhile."""
    room = Room()
    ana = room.joins("Ana")
    room.here(ana, True)
    room.connects(ana)
    answered: list[str] = []

    def ask() -> None:
        for do in ("stop", "beat", "here"):
            room.made.answer(ana, HERE, {"do": do})
            answered.append(do)

    def slow() -> list[Json]:
        asking = Thread(target=ask, daemon=True)
        asking.start()
        asking.join(HANGS_S / 10)
        answered.append("listed")
        return [{"port": "port9", "name": "NINE"}]

    monkeypatch.setattr(classroom, "listed", slow)
    state = room.teaches("class_robot", port="port9", gives=True)
    assert answered == ["stop", "beat", "here", "listed"]
    assert [each["name"] for each in state["robots"]] == ["", "NINE"]


def test_an_address_has_three_places_at_once_unless_the_teacher_allows_more() -> None:
    """Whoever has read the code on the board fills no class with pupils that nobody is."""
    room = Room()

    def enters(name: str, address: str = HERE) -> Json:
        request = {"do": "join", "code": room.made.code, "name": name}
        return room.made.answer("", address, request)

    tokens = [room.joins(f"p{k}") for k in range(classroom.PLACES)]
    assert enters("more") == {"failure": "class_crowded"}
    assert "token" in enters("other", "192.0.2.10")
    room.now_s += classroom.PLACE_S + 1  # the first one's page was closed, and is opened again
    for token in tokens[1:]:
        room.here(token)
    assert "token" in enters("again")
    with pytest.raises(BadRequest):
        room.here(tokens[0])
    assert enters("more") == {"failure": "class_crowded"}
    for places in (1, 60):
        assert room.teaches("class_places", places=places)["places"] == places
    assert "token" in enters("more")
    for wrong in (0, 61, "4", None):
        with pytest.raises(BadRequest):
            room.teaches("class_places", places=wrong)
