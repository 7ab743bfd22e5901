"""A tinibot2 on a simulated Uno, whose wheels turn discs: how far it goes, and what is stuck."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.uno import needed
from tests.support.casefile import ROOT
from tests.support.platformio import firmware, shared
from tests.support.uno_with_discs import ENVIRONMENT, ROBOT, Driven
from tiniscript import compile_text
from tiniscript.bytecode.image import unpack
from tiniscript.link.names import fault_name
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.virtual.wheels import Roughness


@pytest.fixture(scope="module")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needed()
    return firmware(ENVIRONMENT, tmp_path_factory.mktemp("sketch"), shared(tmp_path_factory))


def test_it_goes_and_turns_as_far_as_was_said(sketch: Path) -> None:
    robot = Driven(sketch, 1, (107.5, 92.5), Roughness(0.005))
    with robot.uno:
        assert robot.drive("F(30 CM, 60); R(90 DEG, 60)") == "DONE"
        pose = robot.pose
    assert abs(pose.x_cm - 30) <= 1.5 and abs(pose.y_cm) <= 2 and abs(pose.heading + 90) <= 6


def test_a_wheel_whose_disc_tells_nothing_is_stuck(sketch: Path) -> None:
    robot = Driven(sketch, 2, (100, 100), Roughness())
    robot.wheels.both[1].is_seen = False
    with robot.uno:
        assert robot.drive("F(30 CM, 60)") == "FAULT"
        assert robot.until(status := robot.session.status()) == OK
        assert status.outcome and fault_name(status.outcome.values.fault) == "STUCK_RIGHT"
        assert not any(wheel.wanted for wheel in robot.wheels.both)


@pytest.mark.parametrize("how", ["UNTIL", "S", "client", "lost link"])
def test_what_ends_a_move_early_ends_it_at_once(how: str, sketch: Path) -> None:
    """On the chip, too: both motors are off, and no correction drives them again."""
    text = {"UNTIL": "F(200 CM, 40) UNTIL(TIME > 0.6); SHOW(1); W(1)",
            "S": "F(200 CM, 40); W(1)\nTASK\nW(0.6); S\nEND_TASK"}  # fmt: skip
    robot = Driven(sketch, 1, (107.5, 92.5), Roughness(0.005))
    with robot.uno:
        image = unpack(compile_text(text.get(how, "F(200 CM, 40)"), ROBOT.kit).image)
        assert robot.until(robot.session.hello()) == OK
        assert robot.until(robot.session.upload(image)) == OK
        robot.run(500)
        assert all(wheel.wanted for wheel in robot.wheels.both)
        if how == "client":
            robot.session.stop(robot.now_ms)
        elif how == "lost link":
            robot.session = Session(2, ROBOT.board.baud, 0)  # which says nothing
            robot.run(1000)
        robot.run(140)
        assert not any(wheel.wanted for wheel in robot.wheels.both)
        for _ in range(40):
            robot.run(20)
            assert not any(wheel.wanted for wheel in robot.wheels.both)
        assert 3 < robot.pose.x_cm < 40
        if how == "client":  # nor does the next program go on with it
            image = unpack(compile_text("W(1)", ROBOT.kit).image)
            assert robot.until(robot.session.upload(image)) == OK
            for _ in range(20):
                robot.run(20)
                assert not any(wheel.wanted for wheel in robot.wheels.both)


def test_a_nano_with_discs_has_tasks(tmp_path_factory: pytest.TempPathFactory) -> None:
    """The reader of text has left room for them: it backs away from what comes near."""
    needed()
    nano = firmware("nano_tinibot2", tmp_path_factory.mktemp("nano"), shared(tmp_path_factory))
    robot = Driven(nano, 1, (100, 100), Roughness())
    pins = ROBOT.board.sensors[2].pins
    eye = f"D{pins['trigger']}", f"D{pins['echo']}"
    text = (ROOT / "examples" / "away.ts").read_text(encoding="utf-8")
    with robot.uno:
        robot.uno.sonar(*eye, 50)
        assert robot.until(robot.session.hello()) == OK
        image = unpack(compile_text(text, ROBOT.kit).image)
        assert robot.until(robot.session.upload(image)) == OK
        seen = []
        for distance_cm, milliseconds in ((50, 500), (9, 300), (50, 500), (50, 500)):
            robot.uno.sonar(*eye, distance_cm)
            robot.run(milliseconds)
            seen.append(
                tuple((wheel.wanted > 0) - (wheel.wanted < 0) for wheel in robot.wheels.both)
            )
    assert seen == [(1, 1), (-1, -1), (1, -1), (1, 1)]
