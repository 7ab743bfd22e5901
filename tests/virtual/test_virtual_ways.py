"""Moves by centimetres and degrees on virtual robots: as long as `tsc run` says."""

from __future__ import annotations

import pytest

from tests.support.virtual_robot import Talk, robot_in, trace
from tiniscript import compile_text, robots, run
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import GO, TASKS, unpack
from tiniscript.link.messages import SAVED_STORED, STATUSES
from tiniscript.robots.kinematics import START, moved

OK = STATUSES["OK"]
ALONE = "F(20 CM, 60); R(90 DEG, 60); F(45 CM, 50) UNTIL(TIME > 2)"
BESIDE = f"{ALONE}\nTASK\nW(0.3); B(4.5 CM, 100)\nEND_TASK"


def traced(text: str, name: str) -> list[str]:
    return [f"{each.ms} {each.text}" for each in run(text, robot=name).events]


@pytest.mark.parametrize("name", ["grabber", "tinibot32"])
@pytest.mark.parametrize("text", [ALONE, BESIDE])
def test_a_program_takes_as_long_as_the_profile_says(name: str, text: str) -> None:
    robot = robot_in(name=name)
    talk = Talk(robot)
    assert talk.upload(text).status == OK
    talk.wait(6000)
    assert trace(robot.take_events()) == traced(text, name)
    assert talk.until(talk.session.status()).values.saved == SAVED_STORED


@pytest.mark.parametrize("name", robots.names())
def test_a_simulated_body_goes_and_turns_as_its_kit_says(name: str) -> None:
    profile = robots.load(name)
    go_ms = profile.kit.go_ms(20_000, 60, turns=False)
    turn_ms = profile.kit.go_ms(90_000, 60, turns=True)
    assert go_ms is not None
    assert turn_ms is not None
    assert moved(profile.body, START, 60, 60, go_ms).x_cm == pytest.approx(20, abs=0.05)
    assert moved(profile.body, START, 60, -60, turn_ms).heading == pytest.approx(-90, abs=0.3)


@pytest.mark.parametrize(("text", "needs"), [(ALONE, GO), (BESIDE, GO | TASKS), ("W(0.1)", 0)])
def test_the_robot_finds_out_what_code_needs(text: str, needs: int) -> None:
    """Of a program in one frame, and of a live line: its image is the compiler's."""
    robot = robot_in(name="tinibot32")
    talk = Talk(robot)
    image = compile_text(text, robot.profile.kit).image
    assert unpack(image).needs == needs
    assert talk.upload(text, runs=False).status == OK
    talk.wait(2000)
    assert talk.until(talk.session.fetch()).values.image == image
    assert talk.until(talk.session.live(unpack(image).code)).status == OK
    talk.wait(6000)
    assert trace(robot.take_events()) == traced(text, "tinibot32")


def test_without_numbers_it_never_comes_there() -> None:
    """A profile without `speed` is not asked for such programs; whoever sends one sees a fault."""
    robot = robot_in(name="grabber")
    kit = robot.profile.kit
    assert kit.go_ms(20_000, 60, turns=False)
    slow = robots.load("grabber")._replace(kit=Kit(kit.sensors, kit.actuators))
    robot.profile = slow
    robot.power_cycle()
    talk = Talk(robot)
    talk.until(talk.session.hello())
    image = unpack(compile_text("W(0.1); F(20 CM, 60)", kit).image)
    assert talk.until(talk.session.upload(image, True, True)).status == OK
    talk.wait(3000)
    assert robot.fault == "NO_POWER"
