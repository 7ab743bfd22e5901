"""A tinibot2 on a simulated Uno, whose wheels turn discs: how far it goes, and what is stuck."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tests.support.casefile import ROOT
from tests.support.uno_with_discs import ENVIRONMENT, ROBOT, Driven
from tiniscript import compile_text
from tiniscript.bytecode.image import unpack
from tiniscript.link.requests import OK
from tiniscript.virtual.wheels import Roughness


def test_it_goes_and_turns_as_far_as_was_said(sketches: Callable[[str], Path]) -> None:
    robot = Driven(sketches(ENVIRONMENT), 1, (107.5, 92.5), Roughness(0.005))
    with robot.uno:
        assert robot.drive("F(30 CM, 60); R(90 DEG, 60)") == "DONE"
        pose = robot.pose
    assert abs(pose.x_cm - 30) <= 1.5 and abs(pose.y_cm) <= 2 and abs(pose.heading + 90) <= 6


def test_a_nano_with_discs_has_tasks(sketches: Callable[[str], Path]) -> None:
    """The reader of text has left room for them: it backs away from what comes near."""
    robot = Driven(sketches("nano_tinibot2"), 1, (100, 100), Roughness())
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
