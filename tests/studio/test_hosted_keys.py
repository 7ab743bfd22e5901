"""Keys of a remote control through `tsc studio` reach only the robot of the person who presses.

The robots' firmware is on ptys; the pages are the tests' own.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from tests.support.asking_page import AskingPage
from tests.support.pty_robot import PtyRobot
from tests.support.waiting import until
from tiniscript import compile, robots
from tiniscript.studio.attending import ATTENDED_S
from tiniscript.studio.classroom import Classroom
from tiniscript.studio.hosting import Hosting

Json = dict[str, Any]
KIT = robots.load("tinibot").kit
STICK_PROGRAM = "SI|LOOP(FOREVER);\nM(PAD_Y, PAD_Y);\nW(0.02);\nEND_LOOP"
PUPIL_ADDRESS = "192.0.2.9"


class Hand(AskingPage):
    """A page that drives by hand."""

    number = 0

    def say(self, **request: object) -> int:
        self.number += 1
        number = max((item["number"] for item in self.news), default=0)
        full_request = {"id": self.number, "seen": number, **request}
        self.ask("beat", full_request)
        return self.number

    def hold(self, y: int) -> int:
        return self.say(do="keys", keys=0, x=0, y=y)

    def answer_to(self, number: int) -> Json:
        items: list[Json] = []

        def has_answer() -> bool:
            self.ask("beat")
            items[:] = [item for item in self.news if item.get("id") == number]
            return bool(items)

        until(has_answer, f"an answer to {number}")
        return items[0]

    def upload(self, text: str) -> Json:
        image = compile(text).image.hex()
        return self.answer_to(self.say(do="upload", image=image, robot="tinibot", runs=True))

    def drive(self, robot: PtyRobot, power: int) -> None:
        """Hold the stick until the robot does so."""

        def has_power() -> bool:
            self.hold(power)
            return power_of(robot) == power

        until(has_power, f"it has {power} %")


def power_of(robot: PtyRobot) -> int:
    motor_lines = [line for line in robot.actions if line.startswith("MOTORS")]
    return int(motor_lines[-1].split()[1]) if motor_lines else 0


@pytest.fixture
def pty_robots() -> Iterator[list[PtyRobot]]:
    with ExitStack() as stack:
        yield [stack.enter_context(PtyRobot(KIT)) for _ in range(2)]


class Class:
    def __init__(self, ports: list[str]) -> None:
        self.hosting = Hosting()
        self.room = Classroom(self.hosting, ports)

    def pupil(self, name: str) -> Hand:
        join = {"do": "join", "code": self.room.code, "name": name}
        token = self.room.answer("", PUPIL_ADDRESS, join)["token"]
        self.room.answer(token, PUPIL_ADDRESS, {"do": "here", "wants": True})
        return Hand(
            lambda request: self.room.answer(token, PUPIL_ADDRESS, {**request, "page": name}),
            "turn",
        )


@pytest.fixture
def lesson(pty_robots: list[PtyRobot]) -> Iterator[Class]:
    classroom = Class([robot.port for robot in pty_robots])
    yield classroom
    classroom.hosting.close()


def test_a_pupil_drives_only_the_assigned_robot(lesson: Class, pty_robots: list[PtyRobot]) -> None:
    ana, beto = lesson.pupil("Ana"), lesson.pupil("Beto")
    for hand in (ana, beto):
        assert hand.ask("connect") == {}
        hand.beat_until(lambda item: "connected" in item, "it is met")
        assert hand.upload(STICK_PROGRAM)["ok"]
    ana.drive(pty_robots[0], 60)
    assert power_of(pty_robots[1]) == 0
    ana.drive(pty_robots[0], 0)
    beto.drive(pty_robots[1], -40)
    assert power_of(pty_robots[0]) == 0
    ana.ask("beat")
    beto.drive(pty_robots[1], 0)


def test_a_pupil_without_a_turn_cannot_drive(lesson: Class, pty_robots: list[PtyRobot]) -> None:
    """Waiting pupils and those whose turn is over get a message."""
    ana, beto, carla = (lesson.pupil(name) for name in ("Ana", "Beto", "Carla"))
    assert ana.ask("connect") == {}
    ana.beat_until(lambda item: "connected" in item, "it is met")
    assert ana.upload(STICK_PROGRAM)["ok"]
    ana.drive(pty_robots[0], 60)
    assert carla.ask("connect") == {"failure": "turn_none"}
    word = {"do": "keys", "id": 1, "seen": 0, "keys": 0, "x": 0, "y": -80}
    assert [item["over"] for item in carla.ask("beat", word)["news"]] == ["left"]
    pupils = lesson.room.teach({"do": "class"})["pupils"]
    number = next(pupil["number"] for pupil in pupils if pupil["name"] == "Ana")
    lesson.room.teach({"do": "class_next", "pupil": number})
    until(lambda: power_of(pty_robots[0]) == 0, "it is stopped")
    moves = len(pty_robots[0].actions)
    for _ in range(5):
        ana.hold(60)
    ana.beat_until(lambda item: item.get("over") == "turn_over", "it is told")
    assert power_of(pty_robots[0]) == 0 and len(pty_robots[0].actions) == moves
    assert beto.ask("connect") == {}
    beto.beat_until(lambda item: "connected" in item, "it is met")
    assert beto.upload(STICK_PROGRAM)["ok"]
    beto.drive(pty_robots[1], 40)
    assert power_of(pty_robots[0]) == 0


def test_a_pupils_key_cannot_release_a_teachers_stop(
    lesson: Class, pty_robots: list[PtyRobot]
) -> None:
    """Earlier keys are void, and held keys start no program."""
    ana = lesson.pupil("Ana")
    assert ana.ask("connect") == {}
    ana.beat_until(lambda item: "connected" in item, "it is met")
    assert ana.upload(STICK_PROGRAM)["ok"]
    ana.drive(pty_robots[0], 60)
    lesson.room.teach({"do": "stop_all"})
    number = ana.hold(60)
    assert ana.answer_to(number)["failure"] == "stopped_elsewhere"
    until(lambda: power_of(pty_robots[0]) == 0, "it is stopped")
    for _ in range(20):
        ana.answer_to(ana.hold(60))
    assert power_of(pty_robots[0]) == 0


@pytest.fixture
def hand(pty_robots: list[PtyRobot]) -> Iterator[Hand]:
    """A page that is connected to the first of the two."""
    hosting = Hosting()
    new_hand = Hand(hosting.answer, pty_robots[0].port)
    try:
        assert new_hand.ask("connect") == {}
        new_hand.beat_until(lambda event: "connected" in event, "it is met")
        yield new_hand
    finally:
        hosting.close()


def test_a_silent_page_holds_no_keys(hand: Hand, pty_robots: list[PtyRobot]) -> None:
    """This holds even if the run is not its own, so that it continues."""
    robot = pty_robots[0]
    image = compile(STICK_PROGRAM.replace("SI|", "SB|")).image.hex()
    request_id = hand.say(do="upload", image=image, robot="tinibot", runs=False)
    assert hand.answer_to(request_id)["ok"]
    robot.push()

    def has_power_60() -> bool:
        hand.hold(60)
        return power_of(robot) == 60

    until(has_power_60, "it drives")
    until(lambda: power_of(robot) == 0, f"after {ATTENDED_S} s and a little")


def test_impossible_key_states_are_refused_and_the_next_message_is_accepted(hand: Hand) -> None:
    answer = hand.answer_to(hand.say(do="keys", keys=0, x=0, y=101))
    assert answer["failure"] == "bad_request"
    assert hand.answer_to(hand.hold(60))["ok"]
