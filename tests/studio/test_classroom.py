"""A class's rules: joining, waiting, turns, and the teacher's rights."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from random import Random
from threading import Thread
from typing import Any

import pytest

from tests.support.class_room import PUPIL_ADDRESS, FakeHosting, FakeRobot, Json, Room
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.base import files
from tiniscript.cli.commands import studio as command
from tiniscript.studio import class_keeping, classroom, recordings
from tiniscript.studio import rates as rate_of
from tiniscript.studio.class_keeping import Keeper
from tiniscript.studio.classroom import CHANGES
from tiniscript.studio.rates import Rate
from tiniscript.studio.robot_link import BadRequest


def test_a_turn_ends_after_its_time_only_if_somebody_waits() -> None:
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, True)
    robot = room.connect(ana)
    room.now_s += 500
    assert room.check_in(ana) | {"name": ""} == {
        "name": "", "place": 0, "waiting": 0, "robots": 1, "robot": "TINI", "left_s": 0,
        "hand": False,
    }  # fmt: skip
    room.check_in(luz, True)
    assert robot.leave_reason == "turn_over"
    assert room.check_in(luz)["place"] == 0
    assert room.classroom.answer(ana, PUPIL_ADDRESS, {"do": "connect"}) == {"failure": "turn_none"}


def test_a_turn_lasts_until_its_time() -> None:
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, True)
    robot = room.connect(ana)
    for _ in range(59):
        room.now_s += 1
        assert room.check_in(luz, True)["place"] == 1
        room.check_in(ana)
    assert not robot.has_ended and room.check_in(ana)["left_s"] == 1
    room.now_s += 1
    assert room.check_in(luz)["place"] == 0


def test_a_page_that_does_not_take_its_turn_loses_it() -> None:
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, True)
    room.check_in(luz, True)
    for _ in range(10):
        room.now_s += 1.01
        room.check_in(ana)  # she is present but does not connect
    assert room.check_in(luz)["place"] == 0
    assert room.check_in(ana)["place"] == -1


def test_a_page_that_missed_its_robot_keeps_the_turn_for_another_connect() -> None:
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, True)
    room.check_in(luz, True)
    robot = room.connect(ana)
    robot.is_half_made = robot.has_ended = robot.was_left = True
    assert room.check_in(luz)["place"] == 1 and room.check_in(ana)["place"] == 0
    robot = room.connect(ana)
    robot.is_half_made = robot.has_ended = robot.was_left = True
    for _ in range(10):  # no longer than one that does not connect
        room.now_s += 1.01
        room.check_in(ana)
    assert room.check_in(luz)["place"] == 0


def test_a_leaving_pupil_is_succeeded_within_three_seconds() -> None:
    """A closed page gets no turn and keeps none; a pupil who was passed over keeps the place. A
    robot that a page has left before it answered is as good as before."""
    asleep: list[FakeRobot] = []

    def wait_until_place_is_free(leave_room: Callable[[Room, str], None]) -> float:
        room = Room()
        ana, luz = room.join("Ana"), room.join("Luz")
        room.check_in(ana, True)
        room.check_in(luz, True)
        leave_room(room, ana)
        start_s = room.now_s
        while room.check_in(luz)["place"] != 0:
            room.now_s += 0.3  # about the interval of the next page's requests
            for robot in asleep:
                robot.silent_s += 0.3
        return room.now_s - start_s

    def leave_before(room: Room, ana: str) -> None:
        room.now_s += 1  # her last request

    def leave_while_it_connects(room: Room, ana: str) -> None:
        robot = room.connect(ana)
        robot.name, robot.was_left, robot.has_ended = "", True, True

    def fall_asleep(room: Room, ana: str) -> None:
        asleep.append(room.connect(ana))

    for leave_step in (leave_before, leave_while_it_connects, fall_asleep):
        assert wait_until_place_is_free(leave_step) < 2.5, leave_step.__name__
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, True)
    room.now_s += 2.5
    assert room.check_in(luz, True)["place"] == 0
    assert room.check_in(ana)["place"] == 1


def test_a_closed_page_is_passed_over_and_no_longer_waits() -> None:
    room = Room()
    ana, luz, teo = (room.join(name) for name in ("Ana", "Luz", "Teo"))
    room.check_in(ana, True)
    robot = room.connect(ana)
    room.check_in(luz, True)
    room.check_in(teo, True)
    room.now_s += 10  # Luz is silent
    assert room.check_in(teo)["place"] == 2
    robot.has_ended = True
    assert room.check_in(teo)["place"] == 0
    assert room.check_in(luz)["place"] == 1  # she is back
    room.now_s += 21
    room.classroom.tend()
    assert room.teach("class")["pupils"][1]["place"] == 0


def test_a_silent_robot_is_not_assigned_while_another_is_free() -> None:
    room = Room(2)
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, True)
    robot = room.connect(ana)
    robot.name, robot.has_ended = "", True
    room.check_in(luz, True)
    room.connect(luz)
    assert room.hosting.requests[-1]["port"] == "port1"
    assert room.check_in(ana, True)["place"] == 1
    room.now_s += 11
    assert room.check_in(ana)["place"] == 0


def test_a_port_being_released_is_assigned_to_nobody() -> None:
    room = Room()
    ana = room.join("Ana")
    room.hosting.held_ports.add("port0")
    assert room.check_in(ana, True)["place"] == 1
    room.hosting.held_ports.clear()
    assert room.check_in(ana)["place"] == 0


# -- hostile pupils


def test_no_name_reaches_another_pupils_turn() -> None:
    room = Room()
    ana, eve = room.join("Ana"), room.join("Eve")
    room.check_in(ana, True)
    room.connect(ana)
    last_page = room.hosting.requests[-1]["page"]
    assert room.classroom.answer(
        eve, PUPIL_ADDRESS, {"do": "connect", "page": last_page, "port": "port0"}
    ) == {"failure": "turn_none"}
    for action in ("beat", "leave", "stop", "stop_all"):
        room.classroom.answer(
            eve,
            PUPIL_ADDRESS,
            {"do": action, "page": last_page, "asked": [{"do": "upload", "id": 1}]},
        )
    assert last_page not in [request["page"] for request in room.hosting.requests[1:]]
    assert {request["do"] for request in room.hosting.requests[1:]} == {"beat", "leave", "stop"}
    assert room.hosting.requests[-1]["asked"] == []


@pytest.mark.parametrize(
    "action",
    ["ports", "class", "class_over", "class_text", "class_work", "class_bring", "class_give_back",
     "class_forget", "class_anew", "class_hand", "class_hand_out", "fly", None, ["stop"]],
)  # fmt: skip
def test_some_requests_are_reserved_for_the_teacher(action: object) -> None:
    room = Room()
    eve = room.join("Eve")
    with pytest.raises(BadRequest):
        room.classroom.answer(eve, PUPIL_ADDRESS, {"do": action, "erases": True, "pupil": 1})
    assert room.hosting.requests == [] and not room.classroom.has_ended


@pytest.mark.parametrize(
    "handout",
    [{}, {"text": " ", "robot": "tinibot"}, {"text": 5, "robot": "tinibot"},
     {"text": "F(1)", "robot": "x"}, {"lesson": -1}, {"lesson": 99}, {"lesson": "1"},
     {"text": "F(1);" * class_keeping.TEXT_CHARACTERS, "robot": "tinibot"}],
    ids=lambda handout: str(handout)[:40],
)  # fmt: skip
def test_what_is_no_handout_replaces_none(handout: Json) -> None:
    """A program that is too long is refused: a part of it would be another program."""
    room = Room()
    room.teach("class_hand_out", lesson=3)
    with pytest.raises(BadRequest):
        room.teach("class_hand_out", **handout)
    assert room.check_in(room.join("Ana"))["handout"]["lesson"] == 3


@pytest.mark.parametrize(
    "message",
    [{"do": "claim"}, {"do": "disown"}, {"do": "name", "name": "X"}, {"do": "trim", "trim": {}},
     {"do": "undo"}, {}, 5, {"do": ["hello"]}],
    ids=str,
)  # fmt: skip
def test_a_robot_taken_by_the_teacher_stays_the_teachers(message: object) -> None:
    room = Room()
    eve = room.join("Eve")
    room.check_in(eve, True)
    room.connect(eve)
    with pytest.raises(BadRequest):
        room.classroom.answer(
            eve, PUPIL_ADDRESS, {"do": "beat", "asked": [{"do": "hello", "id": 1}, message]}
        )
    assert [request["do"] for request in room.hosting.requests] == ["connect"]


def test_codes_cannot_be_guessed() -> None:
    room = Room()
    code, refused_count = room.classroom.code, 0
    for k in range(5000):
        guess = {"do": "join", "code": f"{k:06}", "name": "Eve"}
        refused_count += room.classroom.answer("", PUPIL_ADDRESS, guess)["failure"] == "class_wrong"
        room.now_s += 0.01
    assert refused_count <= 20 + 50 / 3 + 1
    # From that address, even the right code is refused; from others it is accepted.
    join_request = {"do": "join", "code": code, "name": "Eve"}
    assert room.classroom.answer("", PUPIL_ADDRESS, join_request) == {"failure": "class_slow"}
    assert "token" in room.classroom.answer("", "192.0.2.10", join_request)
    room.now_s += 4
    assert "token" in room.classroom.answer("", PUPIL_ADDRESS, join_request)


def test_a_code_may_be_typed_in_lower_case_with_spaces() -> None:
    room = Room()
    code = room.classroom.code.lower()
    join_fields = {"do": "join", "code": f" {code[:3]} {code[3:]}", "name": "Ana"}
    assert room.classroom.answer("", PUPIL_ADDRESS, join_fields)["name"] == "Ana"
    assert room.classroom.most_bytes("") == 1000
    assert room.classroom.most_bytes("0" * 32) == 0


@pytest.mark.parametrize(
    ("name", "shown_text"),
    [("  Ana \n Luz ", "Ana Luz"), ("Ana\u3164", "Ana"),
     ("Jose\u0301", "Jos\u00e9"), ("<b>x</b>", "<b>x</b>"), ("a\x1b[2J\u202eb", "a?[2J?b"),
     ("x" * 1000, "x" * 24 + "…"), ("ñandú 🤖", "ñandú 🤖")],
)  # fmt: skip
def test_names_are_plain_text(name: str, shown_text: str) -> None:
    room = Room()
    room.join(name)
    assert room.teach("class")["pupils"][0]["name"] == shown_text
    room.join(name)
    assert room.teach("class")["pupils"][1]["name"] == f"{shown_text} (2)"


def test_a_returning_pupil_is_not_a_second_one() -> None:
    room = Room()
    room.join("Ana")
    second_token = room.join("Ana", "198.51.100.1")

    def names() -> list[str]:
        return [pupil["name"] for pupil in room.teach("class")["pupils"]]

    room.now_s += 4
    room.join("Ana")  # the first one may be there
    assert names() == ["Ana", "Ana (2)", "Ana (3)"]
    room.now_s += 2
    room.join("Ana")
    assert names() == ["Ana (2)", "Ana (3)", "Ana"]
    room.now_s += 6
    room.check_in(second_token)
    room.join("Ana", "198.51.100.1")  # another pupil of this name, who is present
    assert names() == ["Ana (2)", "Ana (3)", "Ana", "Ana (4)"]


@pytest.mark.parametrize(
    "name",
    ["", "   ", 5, None, ["a"], "\u3164", "\u115f \u1160", "\u2800", "\u200b", "\u0301", "\x1b"],
)
def test_nobody_joins_without_a_name(name: object) -> None:
    room = Room()
    try:
        answer = room.classroom.answer(
            "", PUPIL_ADDRESS, {"do": "join", "code": room.classroom.code, "name": name}
        )
    except BadRequest:
        answer = {"failure": "class_nameless"}
    assert answer == {"failure": "class_nameless"}
    assert room.teach("class")["pupils"] == []


def test_a_full_class_reassigns_places_of_absent_pupils() -> None:
    room = Room()
    token = room.join("p0")
    room.check_in(token, True)
    room.connect(token)
    room.now_s += 1
    for k in range(1, class_keeping.MAX_PUPILS):
        room.join(f"p{k}", f"198.51.100.{k}")
    join_message = {"do": "join", "code": room.classroom.code, "name": "more"}
    room.now_s += 30
    assert room.classroom.answer("", PUPIL_ADDRESS, join_message) == {"failure": "class_full"}
    room.now_s += 31
    assert "token" in room.classroom.answer("", PUPIL_ADDRESS, join_message)
    assert len(room.teach("class")["pupils"]) == class_keeping.MAX_PUPILS
    assert room.classroom.most_bytes(token) > 0  # it is her turn


def test_a_flooding_pupil_is_refused_but_can_still_stop() -> None:
    room = Room()
    eve = room.join("Eve")
    with pytest.raises(BadRequest):
        for _ in range(200):
            room.check_in(eve)
    assert room.classroom.answer(eve, PUPIL_ADDRESS, {"do": "stop"}) == {"news": []}
    room.now_s += 1
    for _ in range(40):
        room.check_in(eve)


def test_a_huge_program_is_truncated() -> None:
    room = Room()
    eve = room.join("Eve")
    room.check_in(eve, text="x" * 150_000)
    with pytest.raises(BadRequest):
        room.check_in(eve, text=["x"])
    number = room.number("Eve")
    assert len(room.teach("class_text", pupil=number)["text"]) == class_keeping.TEXT_CHARACTERS


def test_reported_work_is_limited_and_plain() -> None:
    room = Room()
    eve = room.join("Eve")
    room.check_in(eve, lessons=["01_first_line"] * 1000, robot="liner", is_right=False, hand=True)
    pupil = room.teach("class")["pupils"][0]
    assert len(pupil["lessons"]) == class_keeping.MAX_LESSONS
    assert (pupil["is_right"], pupil["hand"] > 0) == (False, True)
    for wrong_fields in (
        {"lessons": "01"}, {"lessons": ["<b>"]}, {"lessons": ["x" * 61]}, {"lessons": [5]},
        {"robot": "x"}, {"robot": ["liner"]}, {"text": 5},
    ):  # fmt: skip
        with pytest.raises(BadRequest):
            room.check_in(eve, **wrong_fields)
    named_robot = {"name": "Pip\u202e" * 20, "colour": 3}
    room.check_in(eve, own_robot=named_robot)
    own_robot = room.teach("class")["pupils"][0]["own_robot"]
    assert (
        own_robot["colour"] == 3
        and own_robot["name"].isprintable()
        and len(own_robot["name"]) <= 17
    )
    wrong_robots: tuple[object, ...] = (
        5, [], {}, {"name": 5, "colour": 1}, {"name": "x", "colour": -1},
        {"name": "x", "colour": 10**9}, {"name": "x", "colour": "red"}, {"name": "x"},
    )  # fmt: skip
    for wrong_robot in wrong_robots:
        with pytest.raises(BadRequest):
            room.check_in(eve, own_robot=wrong_robot)
    assert room.teach("class")["pupils"][0]["own_robot"] == own_robot
    assert room.check_in(eve, is_right="x", hand="x")["hand"]
    assert not room.check_in(eve, hand=False)["hand"]
    room.check_in(eve, hand=True)
    room.teach("class_hand", pupil=room.number("Eve"))
    assert not room.check_in(eve)["hand"]


# -- the work


SENT_WORK = {"text": "F(1, 50)", "robot": "tinibot", "lessons": ["01_first_line"]}
GIVEN_WORK = {**SENT_WORK, "lessons": ("01_first_line",)}


def names_of(room: Room) -> list[str]:
    return [pupil["name"] for pupil in room.teach("class_work")["pupils"]]


def texts_of(room: Room) -> list[str]:
    return [pupil["text"] for pupil in room.teach("class_work")["pupils"]]


def key_of(room: Room, index: int = 0) -> str:
    return str(room.teach("class")["kept"][index]["key"])


def take_change(arguments: Json) -> Json:
    return {"key": arguments["key"], "text": arguments["text"]}


def test_only_the_teacher_returns_work_to_a_name() -> None:
    room = Room()
    room.teach("class_bring", name="Ana", **SENT_WORK)
    eve = room.join("Ana")  # an unknown visitor
    assert "given" not in room.check_in(eve)
    key, number = key_of(room), room.number("Ana")
    row = {"key": key, "name": "Ana", "lessons": ("01_first_line",), "given": 0, "alike": [number]}
    assert room.teach("class")["kept"] == [row]
    state = room.teach("class_give_back", key=key, pupil=number)
    assert state["kept"] == [{**row, "given": number}]
    for _ in range(2):  # an answer may be lost
        returned_work = room.check_in(eve)["given"]
        assert returned_work == {"key": key, **GIVEN_WORK}
    assert "given" not in room.check_in(eve, took=take_change(returned_work))
    assert room.teach("class")["kept"] == []
    assert room.teach("class_give_back", key=key, pupil=number)["kept"] == []  # pressed again


def test_work_is_loaded_once_and_only_while_there_is_room() -> None:
    room = Room()
    work = {"name": "Ana", **SENT_WORK}
    for wrong_fields in (
        {"name": " "}, {"name": 5}, {"name": "\u3164"}, {"text": None}, {"robot": "x"},
        {"lessons": [1]},
    ):  # fmt: skip
        with pytest.raises(BadRequest):
            room.teach("class_bring", **{**work, **wrong_fields})
    for _ in range(2):  # a file is opened twice
        for k in range(class_keeping.MAX_WORKS):
            room.teach("class_bring", **{**work, "name": f"p{k}"})
    assert len(room.teach("class")["kept"]) == class_keeping.MAX_WORKS
    with pytest.raises(BadRequest):
        room.teach("class_bring", **{**work, "name": "more"})
    join_message = {"do": "join", "code": room.classroom.code, "name": "more"}
    assert room.classroom.answer("", PUPIL_ADDRESS, join_message) == {"failure": "class_full"}
    room.teach("class_forget", key=key_of(room))
    assert "token" in room.classroom.answer("", PUPIL_ADDRESS, join_message)


def test_a_copy_is_kept_until_the_page_confirms_that_text() -> None:
    room = Room()
    room.teach("class_bring", name="Ana", **SENT_WORK)
    ana, eve = room.join("Ana"), room.join("Eve")
    key = key_of(room)
    valid_receipt = {"key": key, "text": SENT_WORK["text"]}
    room.check_in(ana, took=valid_receipt)  # it was not offered
    room.teach("class_give_back", key=key, pupil=room.number("Ana"))
    wrong_receipts: list[object] = [True, None, 5, [], {}, {"key": key}]
    wrong_receipts += [{**valid_receipt, "text": text} for text in ("F(1, 51)", None)]
    wrong_receipts += [{**valid_receipt, "key": other_key} for other_key in ("0" * 32, [key])]
    for text in wrong_receipts:
        assert room.check_in(ana, took=text)["given"]["key"] == key
    assert "given" not in room.check_in(eve, took=valid_receipt)  # another pupil cannot confirm it
    assert texts_of(room) == ["F(1, 50)"]
    # The page has it: so it is her work from then on, even before she reports it.
    assert "given" not in room.check_in(ana, took=valid_receipt)
    assert room.teach("class")["kept"] == [] and texts_of(room) == ["F(1, 50)"]
    assert room.teach("class")["pupils"][0]["lessons"] == ("01_first_line",)


def test_a_page_closed_before_receipt_loses_no_work() -> None:
    """It was returned to a closed page, and the pupil joins again from another device."""
    room = Room()
    room.teach("class_bring", name="Ana", **SENT_WORK)
    token = room.join("Ana")
    key = key_of(room)
    room.teach("class_give_back", key=key, pupil=room.number("Ana"))
    assert room.check_in(token)["given"]["key"] == key
    room.teach("class_remove", pupil=room.number("Ana"))
    second_token = room.join("Ana", "198.51.100.1")
    assert "given" not in room.check_in(second_token)
    assert room.teach("class")["kept"][0]["given"] == 0
    room.teach("class_give_back", key=key, pupil=room.number("Ana"))
    assert "given" not in room.check_in(
        second_token, took=take_change(room.check_in(second_token)["given"])
    )
    assert texts_of(room) == ["F(1, 50)"]


@pytest.mark.parametrize("turn_s", [None, 120])
def test_a_class_keeps_its_turn_length_unless_changed(turn_s: int | None) -> None:
    room = Room()
    room.teach("class_turn", seconds=300)
    state = json.loads(json.dumps(room.classroom.state_to_keep()))
    resumed_room = classroom.Classroom(FakeHosting(), [], turn_s)  # type: ignore[arg-type]
    resumed_room.resume(state)
    assert resumed_room.teach({"do": "class"})["turn_s"] == (turn_s or 300)


def test_a_crash_between_sending_and_receipt_loses_no_work(class_file: Path) -> None:
    """This holds whichever state of a class was the last one saved."""
    room = Room()
    room.teach("class_bring", name="Ana", **SENT_WORK)
    ana = room.join("Ana")
    states = [room.classroom.state_to_keep()]
    room.teach("class_give_back", key=key_of(room), pupil=room.number("Ana"))
    states.append(room.classroom.state_to_keep())
    returned_work = room.check_in(ana)["given"]
    room.check_in(ana, took=take_change(returned_work))
    states.append(room.classroom.state_to_keep())
    for k, state in enumerate(states):
        room_after = Room(0)
        room_after.classroom.resume(json.loads(json.dumps(state)))
        assert "F(1, 50)" in texts_of(room_after)
        assert ("given" in room_after.check_in(ana)) is (k == 1)
        if k == 1:  # under the same key: a page that has it does not take it again
            assert room_after.check_in(ana)["given"] == {
                **returned_work,
                "lessons": ("01_first_line",),
            }


def test_the_teacher_chooses_between_pupils_of_the_same_name() -> None:
    room = Room()
    room.teach("class_bring", name="Ana", **SENT_WORK)
    eve, ana = room.join("Ana", "192.0.2.66"), room.join("\u0410na")  # with a Cyrillic letter
    pupils = room.teach("class")["pupils"]
    assert [pupil["name"] for pupil in pupils] == ["Ana", "\u0410na (2)"]
    assert room.teach("class")["kept"][0]["alike"] == [pupil["number"] for pupil in pupils]
    room.teach("class_give_back", key=key_of(room), pupil=pupils[0]["number"])
    # The teacher has looked at it.
    room.teach("class_give_back", key=key_of(room), pupil=pupils[1]["number"])
    assert "given" not in room.check_in(eve)
    returned_work = room.check_in(ana)["given"]
    room.check_in(eve, took=take_change(returned_work), text="")
    assert texts_of(room) == ["F(1, 50)"]


def test_no_name_overwrites_the_work_of_an_absent_pupil() -> None:
    room = Room()
    ana = room.join("Jos\u00e9")
    room.check_in(ana, text="F(1, 50)")
    room.teach("class_remove", pupil=room.number("Jos\u00e9"))
    for name in ("Jos\u00e9", "Jose\u0301", "jos\u00e9", "J\u043es\u00e9"):
        eve = room.join(name, "192.0.2.66")
        room.check_in(eve, text="S")
        number = room.teach("class")["pupils"][0]["number"]
        room.teach("class_remove", pupil=number)
    assert texts_of(room) == ["F(1, 50)", *["S"] * 4]
    assert names_of(room) == [
        "Jos\u00e9", "Jos\u00e9 (2)", "Jos\u00e9 (3)", "jos\u00e9 (4)", "J\u043es\u00e9 (5)",
    ]  # fmt: skip


@pytest.mark.parametrize("places", [classroom.PLACES_PER_ADDRESS, class_keeping.MAX_PUPILS])
def test_no_number_of_names_displaces_kept_work(places: int) -> None:
    """This holds for the names of one address and, if the teacher has allowed it, of a whole
    network."""
    room = Room()
    room.teach("class_places", places=places)
    for k in range(29):
        pupil = room.join(f"p{k}", f"198.51.100.{k}")
        room.check_in(pupil, text=f"SHOW({k})")
        room.teach("class_remove", pupil=room.number(f"p{k}"))
    last_pupil = room.join("p29", "198.51.100.29")
    failures = []
    for k in range(200):
        room.check_in(last_pupil, text="SHOW(29)")
        room.now_s += classroom.PLACE_S + 1
        request = {"do": "join", "code": room.classroom.code, "name": f"eve {k}"}
        answer = room.classroom.answer("", "192.0.2.66", request)
        if "token" in answer:
            room.check_in(answer["token"], text=f"S {k}")
        failures += [answer["failure"]] if "failure" in answer else []
    assert set(texts_of(room)) >= {f"SHOW({k})" for k in range(30)}
    works = len(room.teach("class_work")["pupils"])
    assert works == min(30 + classroom.WORKS_PER_PLACE * places, class_keeping.MAX_WORKS)
    assert failures[-1] == (
        "class_crowded" if places == classroom.PLACES_PER_ADDRESS else "class_full"
    )
    if places == classroom.PLACES_PER_ADDRESS:  # other addresses still have room
        assert room.join("Luz", "198.51.100.77")


def test_a_pupil_returning_with_a_token_has_the_same_work() -> None:
    """A tab was closed, or the teacher has removed the pupil."""
    room = Room()
    ana = room.join("Ana")
    room.check_in(ana, text="F(1, 50)")

    def return_to_class(name: str = "ana", token: object = ana) -> Json:
        request = {"do": "join", "code": room.classroom.code, "name": name, "before": token}
        return room.classroom.answer("", PUPIL_ADDRESS, request)

    second_join = return_to_class()  # a second tab of the same pupil
    assert second_join["name"] == "ana (2)"
    room.teach("class_remove", pupil=room.number("ana (2)"))
    room.now_s += classroom.PLACE_S + 1
    assert return_to_class() == {"token": ana, "name": "Ana"}
    room.teach("class_remove", pupil=room.number("Ana"))
    for token in ("", None, 5, "0" * 32, [ana]):
        other_pupil = return_to_class(token=token)
        assert other_pupil["name"] == "ana (2)"
        room.teach("class_remove", pupil=room.number("ana (2)"))
    luz = return_to_class("Luz")  # the next child at this device
    assert luz["name"] == "Luz" and luz["token"] != ana
    assert texts_of(room) == ["F(1, 50)"]
    assert return_to_class() == {"token": ana, "name": "Ana"}
    assert texts_of(room) == ["F(1, 50)"] and room.teach("class")["kept"] == []
    join_message = {"do": "join", "code": "000000", "name": "Ana", "before": ana}
    assert room.classroom.answer("", PUPIL_ADDRESS, join_message) == {"failure": "class_wrong"}


def test_a_removed_pupil_finds_the_work_again() -> None:
    room = Room()
    ana = room.join("Ana")
    room.check_in(ana, text="F(1, 50)", robot="tinibot")
    room.teach("class_remove", pupil=room.number("Ana"))
    key = key_of(room)
    assert room.teach("class_text", key=key)["text"] == "F(1, 50)"
    assert names_of(room) == ["Ana"]
    second_token = room.join("Ana")
    room.teach("class_give_back", key=key, pupil=room.number("Ana (2)"))
    assert room.check_in(second_token)["given"]["text"] == "F(1, 50)"
    room.teach("class_anew")
    assert room.teach("class_work") == {"pupils": []}
    with pytest.raises(BadRequest):
        room.check_in(second_token)


# -- the file


@pytest.fixture
def class_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    file = tmp_path / "class.json"
    monkeypatch.setattr(class_keeping, "path", lambda: file)
    return file


@pytest.fixture
def keeper(class_file: Path) -> Iterator[Keeper]:
    with closing(Keeper()) as started_keeper:
        yield started_keeper


def resume_class(room: Room, keeper: Keeper) -> int:
    return command._resume_class(command._Class(room.classroom, keeper))


def test_a_crash_ends_no_class(class_file: Path, keeper: Keeper) -> None:
    """The next `tsc studio --class` has the same pupils, with their tokens, and their work."""
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, text="F(1, 50)", robot="tinibot", lessons=["01_first_line"])
    room.check_in(luz, text="S")
    room.teach("class_remove", pupil=room.number("Luz"))
    keeper.keep(room.classroom.state_to_keep())
    assert class_file.stat().st_mode & 0o077 == 0  # the file contains tokens
    when_s = class_file.stat().st_mtime_ns
    keeper.keep(room.classroom.state_to_keep())
    assert class_file.stat().st_mtime_ns == when_s
    room_after = Room(0)
    assert resume_class(room_after, keeper) == 1
    state = room_after.teach("class")
    assert (state["code"], state["goes_on"]) == (room.classroom.code, True)
    assert [robot["port"] for robot in state["robots"]] == ["port0"]
    assert room_after.check_in(ana)["name"] == "Ana"
    assert sorted(texts_of(room_after)) == sorted(texts_of(room)) == ["F(1, 50)", "S"]
    with pytest.raises(BadRequest):
        room_after.check_in(luz)
    request = {"do": "join", "code": room.classroom.code, "name": "Luz", "before": luz}
    assert room_after.classroom.answer("", PUPIL_ADDRESS, request) == {"token": luz, "name": "Luz"}
    assert not room_after.teach("class_anew")["goes_on"]
    room.teach("class_over")
    keeper.keep(room.classroom.state_to_keep())
    assert not class_file.exists() and resume_class(Room(), keeper) == 0


def test_no_crash_loses_what_the_teacher_was_told(class_file: Path, keeper: Keeper) -> None:
    """It is kept before the answer, whatever the loop of the command does meanwhile."""
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(luz, text="S")
    class_ = command._Class(room.classroom, keeper)
    for action, fields in (
        ("class_hand_out", {"lesson": 3}),
        ("class_hand_out", {"text": "F(1, 50)", "robot": "tinibot"}),
        ("class_turn", {"seconds": 70}),
        ("class_places", {"places": 7}),
        ("class_code", {}),
        ("class_robot", {"port": "port9", "gives": True}),
        ("class_bring", {"name": "Eve", "text": "B(1, 50)", "robot": "tinibot"}),
        ("class_remove", {"pupil": room.number("Luz")}),
        ("class_anew", {}),
    ):
        class_.teach({"do": action, **fields})
        assert_nothing_is_lost(room, keeper)
        if action == "class_hand_out":
            room_after = Room(0)
            resume_class(room_after, keeper)
            assert room_after.check_in(ana)["handout"] == room.check_in(ana)["handout"]
    class_.teach({"do": "class_over"})
    assert not class_file.exists()


def assert_nothing_is_lost(room: Room, keeper: Keeper) -> None:
    saved_class = keeper.read()
    assert saved_class is not None
    state = room.classroom.state_to_keep()
    assert json.loads(json.dumps(state)).items() <= saved_class.state.items()


@pytest.mark.parametrize("action", CHANGES)
def test_a_change_is_for_the_teacher_alone(action: str) -> None:
    room = Room()
    with pytest.raises(BadRequest):
        room.classroom.answer(room.join("Eve"), PUPIL_ADDRESS, {"do": action})


def test_a_damaged_class_continues_with_the_intact_parts(class_file: Path, keeper: Keeper) -> None:
    room = Room()
    token = room.join("Ana")
    room.check_in(token, text="F(1, 50)", robot="tinibot")
    keeper.keep(room.classroom.state_to_keep())
    class_data = json.loads(class_file.read_text())
    row = class_data["pupils"][0]
    bad_pupils = [
        5,
        {**row, "token": "x"},
        {**row, "name": " "},
        {**row, "address": 5},
        {"name": "Eve"},
    ]
    damaged_class = {
        **class_data,
        "pupils": [*bad_pupils, row],
        "kept": [5, {"name": "Eve"}],
        "robots": [5, ""],
    }
    odd_row = {**row, "token": [], "key": 5, "written": "\u2800", "given_to": token}
    class_file.write_text(
        json.dumps({**damaged_class, "kept": [{"name": "Eve"}, odd_row], "code": "<b>"})
    )
    room_after = Room(0)
    assert resume_class(room_after, keeper) == 1
    assert (
        room_after.check_in(token)["name"] == "Ana"
        and room_after.classroom.code != room.classroom.code
    )
    assert room_after.check_in(token)["given"]["text"] == "F(1, 50)"
    many_pupils = [{**row, "token": f"{k:032x}"} for k in range(99)]
    class_file.write_text(json.dumps({**class_data, "pupils": many_pupils, "kept": many_pupils}))
    room_after = Room(0)
    assert resume_class(room_after, keeper) == class_keeping.MAX_PUPILS
    works = len(room_after.teach("class_work")["pupils"])
    assert works == class_keeping.MAX_WORKS


def test_an_invalid_class_file_is_set_aside(class_file: Path, keeper: Keeper) -> None:
    """Another version, or a teacher, may be able to read it."""
    aside = class_file.with_name("class.unread.json")
    for data in ("", "{", "[" * 100_000, "[]", '{"form": 2}'):
        class_file.write_text(data)
        assert resume_class(Room(), keeper) == 0
        assert aside.read_text() == data and not class_file.exists()
    keeper.keep(None)
    assert not aside.exists()  # the class is over


def test_a_disk_with_room_again_is_written_to_at_once(
    class_file: Path, keeper: Keeper, monkeypatch: pytest.MonkeyPatch
) -> None:
    room = Room()
    room.check_in(room.join("Ana"), text="F(1, 50)")

    def fail_full_disk(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(class_keeping, "replace", fail_full_disk)
        for _ in range(3):
            keeper.keep(room.classroom.state_to_keep())
    assert not class_file.exists()
    keeper.keep(room.classroom.state_to_keep())  # unchanged state
    assert "F(1, 50)" in class_file.read_text()


def test_a_wrong_or_jumping_clock_loses_no_work(class_file: Path, keeper: Keeper) -> None:
    """A board without a battery begins in the past, and hears the time later."""
    room = Room()
    token = room.join("Ana")
    room.check_in(token, text="F(1, 50)")
    keeper.keep(room.classroom.state_to_keep())
    class_data = json.loads(class_file.read_text())
    for age_s in (-50 * 365 * 86_400, -10, 0, 3500):  # age of the file
        class_file.write_text(json.dumps({**class_data, "kept_s": class_data["kept_s"] - age_s}))
        room_after = Room(0)
        assert resume_class(room_after, keeper) == 1
        assert (
            room_after.check_in(token)["name"] == "Ana"
            and room_after.classroom.code == room.classroom.code
        )
    for kept_s in (class_data["kept_s"] - 3700, 5, -5, None, "x", 1e400):
        class_file.write_text(json.dumps({**class_data, "kept_s": kept_s}))
        room_after = Room(0)
        assert resume_class(room_after, keeper) == 0
        assert texts_of(room_after) == ["F(1, 50)"]
        assert (
            room_after.classroom.code != room.classroom.code
            and room_after.teach("class")["goes_on"]
        )
        keeper.keep(room_after.classroom.state_to_keep())
        assert "F(1, 50)" in class_file.read_text()  # nor does the next crash lose it
        with pytest.raises(BadRequest):
            room_after.check_in(token)
        request = {"do": "join", "code": room_after.classroom.code, "name": "Ana", "before": token}
        assert room_after.classroom.answer("", PUPIL_ADDRESS, request) == {
            "token": token,
            "name": "Ana",
        }
        assert texts_of(room_after) == ["F(1, 50)"]


def test_only_one_class_of_a_user_has_the_file(class_file: Path, keeper: Keeper) -> None:
    keeper.keep(Room().classroom.state_to_keep())
    with pytest.raises(class_keeping.ClassTaken):
        Keeper()
    assert class_file.exists()
    keeper.close()  # the command has ended
    with closing(Keeper()) as other_keeper:
        assert other_keeper.read() is not None
        keeper.keep(None)  # a closed keeper has no effect
        assert class_file.exists()


def test_a_class_runs_without_a_writable_folder(
    class_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once there is room, it gets its file, unless another class has it."""
    room = Room()

    def fail_full_disk(*_: object) -> int:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "open", fail_full_disk)
        early_keeper, late_keeper = Keeper(), Keeper()
    with closing(early_keeper), closing(late_keeper):
        early_keeper.keep(room.classroom.state_to_keep())
        assert class_file.exists()
        late_keeper.keep(None)
        assert class_file.exists()


# -- the teacher


def test_the_teacher_watches_stops_and_reclaims_robots() -> None:
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, True, text="F(1, 50)")
    room.check_in(luz, True)
    robot = room.connect(ana)
    state = room.teach("class")
    assert [(pupil["name"], pupil["place"], pupil["robot"]) for pupil in state["pupils"]] == [
        ("Ana", 0, "TINI"), ("Luz", 1, ""),
    ]  # fmt: skip
    assert state["robots"] == [{"port": "port0", "name": "TINI", "pupil": "Ana", "left_s": 60}]
    for is_running in (True, False):
        robot.is_running = is_running
        rows = {pupil["name"]: pupil["is_running"] for pupil in room.teach("class")["pupils"]}
        assert rows == {"Ana": is_running, "Luz": False}
    number = room.number("Ana")
    assert room.teach("class_text", pupil=number)["text"] == "F(1, 50)"
    room.teach("class_stop", pupil=number)
    assert robot.stop_count == 1 and not robot.has_ended
    room.teach("class_next", pupil=number)
    assert robot.leave_reason == "turn_over"
    assert room.check_in(luz)["place"] == 0
    room.teach("class_remove", pupil=number)
    assert room.classroom.most_bytes(ana) == 0
    with pytest.raises(BadRequest):
        room.check_in(ana)
    room.teach("stop_all")
    assert room.hosting.requests[-1] == {"do": "stop_all"}


def test_robots_can_be_added_and_removed() -> None:
    room = Room(0)
    ana = room.join("Ana")
    assert room.check_in(ana, True)["robots"] == 0
    room.teach("class_robot", port="port7", gives=True)
    assert len(room.teach("class_robot", port="port7", gives=True)["robots"]) == 1
    assert room.check_in(ana)["place"] == 0
    robot = room.connect(ana)
    assert room.teach("class_robot", port="port7", gives=False)["robots"] == []
    assert robot.leave_reason == "turn_over"
    for port in ("", " ", "a\nb", 5, "x" * 301):
        with pytest.raises(BadRequest):
            room.teach("class_robot", port=port, gives=True)


def test_the_teacher_changes_code_and_turn_length() -> None:
    room = Room()
    old_code = room.classroom.code
    assert room.teach("class_code")["code"] == room.classroom.code != old_code
    assert room.classroom.answer(
        "", PUPIL_ADDRESS, {"do": "join", "code": old_code, "name": "Eve"}
    ) == {"failure": "class_wrong"}
    assert room.teach("class_turn", seconds=300)["turn_s"] == 300
    for seconds in (9, 3601, "300", True, None):
        with pytest.raises(BadRequest):
            room.teach("class_turn", seconds=seconds)


@pytest.mark.parametrize(("erases", "end_reason"), [(True, "erased"), (False, "kept")])
def test_the_end_of_a_class_reaches_every_page(erases: bool, end_reason: str) -> None:
    room = Room()
    ana, luz = room.join("Ana"), room.join("Luz")
    room.check_in(ana, True)
    robot = room.connect(ana)
    room.check_in(luz, True)
    room.teach("class_over", erases=erases)
    assert robot.leave_reason == "turn_over"
    room.classroom.tend()
    assert not room.classroom.has_ended
    assert room.check_in(ana) == {"over": end_reason}
    assert not room.classroom.has_ended
    assert room.check_in(luz, True) == {"over": end_reason}
    assert room.classroom.has_ended
    assert [robot["pupil"] for robot in room.teach("class")["robots"]] == [""]
    late_request = {"do": "join", "code": room.classroom.code, "name": "Teo"}
    assert room.classroom.answer("", PUPIL_ADDRESS, late_request) == {"failure": "class_over"}


def test_the_rate_limit_remembers_a_thousand_names() -> None:
    rate = Rate(1, 0)
    assert rate.take_amount("a", 0) and not rate.take_amount("a", 0)
    for k in range(rate_of.MAX_NAMES):
        assert rate.take_amount(f"b{k}", 0)
    assert rate.take_amount("a", 0)


def test_stops_and_heartbeats_do_not_wait_for_port_names(monkeypatch: pytest.MonkeyPatch) -> None:
    """A list of ports may take seconds, and a robot drives meanwhile."""
    room = Room()
    ana = room.join("Ana")
    room.check_in(ana, True)
    room.connect(ana)
    answered_actions: list[str] = []

    def ask() -> None:
        for action in ("stop", "beat", "here"):
            room.classroom.answer(ana, PUPIL_ADDRESS, {"do": action})
            answered_actions.append(action)

    def list_slowly() -> list[Json]:
        asking = Thread(target=ask, daemon=True)
        asking.start()
        asking.join(HANG_LIMIT_S / 10)
        answered_actions.append("listed")
        return [{"port": "port9", "name": "NINE"}]

    monkeypatch.setattr(classroom, "list_ports", list_slowly)
    state = room.teach("class_robot", port="port9", gives=True)
    assert answered_actions == ["stop", "beat", "here", "listed"]
    assert [robot["name"] for robot in state["robots"]] == ["TINI", "NINE"]


def test_an_address_has_at_most_three_places_unless_allowed() -> None:
    """Someone who has read the code on the board cannot fill the class with fake pupils."""
    room = Room()

    def enter(name: str, address: str = PUPIL_ADDRESS) -> Json:
        request = {"do": "join", "code": room.classroom.code, "name": name}
        return room.classroom.answer("", address, request)

    tokens = [room.join(f"p{k}") for k in range(classroom.PLACES_PER_ADDRESS)]
    assert enter("more") == {"failure": "class_crowded"}
    assert "token" in enter("other", "192.0.2.10")
    room.now_s += classroom.PLACE_S + 1  # the first one's page was closed, and is opened again
    for token in tokens[1:]:
        room.check_in(token)
    assert "token" in enter("again")
    with pytest.raises(BadRequest):
        room.check_in(tokens[0])
    assert enter("more") == {"failure": "class_crowded"}
    for places in (1, 60):
        assert room.teach("class_places", places=places)["places"] == places
    assert "token" in enter("more")
    for wrong_count in (0, 61, "4", None):
        with pytest.raises(BadRequest):
            room.teach("class_places", places=wrong_count)


@pytest.mark.parametrize("seed", range(5))
def test_the_teacher_gets_each_change_and_a_raised_hand_keeps_its_place(seed: int) -> None:
    """Repeated reports of pages do not matter: only changed work gets a new version, and a raised
    hand keeps its place."""
    rng, room = Random(seed), Room()
    tokens = [room.join(name) for name in ("Ana", "Ben", "Eve")]
    works, hands = dict.fromkeys(tokens, ""), list[str]()
    views = room.teach("class")["pupils"]
    for _ in range(60):
        token, text = rng.choice(tokens), rng.choice(("", "F(1)", "F(2)"))
        is_up = rng.random() < 0.7
        room.classroom.answer(token, PUPIL_ADDRESS, {"do": "here", "text": text, "hand": is_up})
        pupils = room.teach("class")["pupils"]
        for pupil_token, old_view, new_view in zip(tokens, views, pupils, strict=True):
            is_other = pupil_token == token and works[pupil_token] != text
            assert (new_view["version"] != old_view["version"]) == is_other
        views, works[token] = pupils, text
        hands = [pupil_token for pupil_token in hands if pupil_token != token or is_up]
        hands += [token] * (is_up and token not in hands)
        raised_hands = [pupil for pupil in pupils if pupil["hand"]]
        raised_hands.sort(key=lambda pupil: pupil["hand"])
        assert [tokens[pupils.index(pupil)] for pupil in raised_hands] == hands


# -- the newest run of a pupil ---------------------------------------------------------------------


def ask_for_run(room: Room, pupil: int, is_asked: bool = False) -> Any:
    return room.classroom.teach({"do": "class_run", "pupil": pupil, "asks": is_asked})["run"]


def give_run_part(
    room: Room, token: str, run_number: int, start: int, part: str, is_last: bool
) -> None:
    request = {"do": "run", "asked": run_number, "from": start, "part": part, "is_last": is_last}
    room.classroom.answer(token, PUPIL_ADDRESS, request)


def test_the_teacher_gets_the_newest_run_of_the_requested_pupil() -> None:
    room = Room()
    ana, ben = room.join("Ana"), room.join("Ben")
    assert "run" not in room.check_in(ana)
    assert ask_for_run(room, 1, True) is None
    run_number = room.check_in(ana)["run"]
    assert "run" not in room.check_in(ben)
    give_run_part(room, ben, run_number, 0, "nobody has asked", True)
    give_run_part(room, ana, run_number + 1, 0, "another question", True)
    assert ask_for_run(room, 1) is None
    give_run_part(room, ana, run_number, 0, "one, ", False)
    assert ask_for_run(room, 1) is None and room.check_in(ana)["run"] == run_number
    give_run_part(room, ana, run_number, 5, "two", True)
    assert "run" not in room.check_in(ana)
    assert ask_for_run(room, 1) == "one, two"
    assert ask_for_run(room, 1, True) is None
    assert room.check_in(ana)["run"] > run_number, "it is asked anew"
    give_run_part(room, ana, room.check_in(ana)["run"], 0, "half of an", False)
    assert ask_for_run(room, 1, True) is None
    give_run_part(room, ana, room.check_in(ana)["run"], 0, "newer", True)
    assert ask_for_run(room, 1) == "newer", "what is asked anew begins anew"
    assert ask_for_run(room, 9, True) == "", "who has gone has none"
    assert "class_run" not in json.dumps(room.classroom.state_to_keep())


@pytest.mark.parametrize(
    "wrong_fields",
    [
        {"part": 1}, {"part": None}, {"from": 1}, {"from": -1}, {"from": "0"}, {"is_last": 1},
        {"part": "x" * (recordings.MAX_BYTES + 1)},
    ],
)  # fmt: skip
def test_mismatched_parts_of_a_run_are_refused(wrong_fields: Json) -> None:
    room = Room()
    ana = room.join("Ana")
    ask_for_run(room, 1, True)
    run_number = room.check_in(ana)["run"]
    valid_part = {"do": "run", "asked": run_number, "from": 0, "part": "x", "is_last": True}
    with pytest.raises(BadRequest):
        room.classroom.answer(ana, PUPIL_ADDRESS, {**valid_part, **wrong_fields})
    room.classroom.answer(ana, PUPIL_ADDRESS, valid_part)
    with pytest.raises(BadRequest):
        room.classroom.answer(ana, PUPIL_ADDRESS, {**valid_part, "from": 1})
    assert ask_for_run(room, 1) == "x"


@pytest.mark.parametrize("seed", range(10))
def test_what_was_kept_last_is_read_whatever_was_kept_before(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A class may be over, and the next one the same; a disk may be full, and a computer crash."""
    rng, expected, is_full = Random(seed), None, False
    replace_file = files.replace

    def replace(*fields: Any, **named_fields: Any) -> None:
        if is_full:
            raise OSError(28, "No space left on device")
        replace_file(*fields, **named_fields)

    monkeypatch.setattr(class_keeping, "replace", replace)
    class_keeping.forget()
    keeper = Keeper()
    for _ in range(30):
        is_full = rng.random() < 0.3
        state = rng.choice(({"code": "1"}, {"code": "2"}, None))
        keeper.keep(state)
        if state is None or not is_full:
            expected = state
        if rng.random() < 0.2:
            keeper.close()
            keeper = Keeper()
        found = keeper.read()
        assert (None if found is None else found.state["code"]) == (expected and expected["code"])
    keeper.close()
