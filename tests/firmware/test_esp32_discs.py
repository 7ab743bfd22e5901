"""An ESP32 with discs, on a simulated chip: the counts of its pulse counter, and the distances.

Wheels, motors and discs are those of the virtual robot. The pulse counter is
`vm_arduino/extras/esp32/simulated_counter.cpp`, which refuses the same calls as Espressif's; none
of this has run on a chip.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.esp32 import STAND_INS_FOLDER, Esp32Robot, flags_of
from tests.machines.host import missing
from tests.support.esp32_builds import BOARD, complaints
from tests.support.images import image_of
from tests.support.wired_robots import with_discs
from tiniscript import robots
from tiniscript.link.outcomes import Event
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.robots import firmware
from tiniscript.robots.drivers import discs_of
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import Robot
from tiniscript.virtual.driving import Driving
from tiniscript.virtual.wheels import Roughness, Wheels

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")
# Its wheels turn it according to their places, like those of a tinibot2.
BODY = robots.load("tinibot2").body
SLOTTED = with_discs("esp32dev", "slotted")._replace(body=BODY)
TWO_CHANNELS = with_discs("esp32dev", "two_channel")._replace(body=BODY)
KINDS = pytest.mark.parametrize("profile", [SLOTTED, TWO_CHANNELS], ids=["slotted", "two_channel"])
SETTLES_US = 100  # a line, before the other channel changes
LONGEST_US = 12  # longest pulse that the filter removes: 1023 / 80 MHz is 12.8


class Driven:
    """A robot on an endless floor, whose motors have `motors` percent of their speed."""

    def __init__(self, profile: Robot, motors: tuple[float, float], major: int = 2) -> None:
        board = profile.board
        assert board.discs
        self.has_two = discs_of(board.discs).has_two_channels
        self.robot = Esp32Robot(profile, major=major)
        self.session = Session(1, board.baud, profile.kit.fingerprint)
        self._kit = profile.kit
        self._pins = board.discs.pins
        self._motors = motors
        self._driving = Driving(profile.body, (), Pose(0, 0, 0))
        self.wheels = Wheels(profile.body, board.discs, self.has_two, Roughness(0.005), 1,
                             self._driving.set_motors)  # fmt: skip
        self._counted = [0, 0]
        self.robot.edges(*((0, pin, False) for pin in self._pins.values()))
        self.robot.wait(300)

    @property
    def pose(self) -> Pose:
        self.wheels.go_on(self.robot.now_ms)
        return self._driving.advance_to(self.robot.now_ms)

    def run(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            self.robot.talk(self.session, 1)
            driven_text = next(
                (d for d in reversed(self.robot.did) if " MOTORS " in d), "0 MOTORS 0 0"
            )
            powers = zip(map(int, driven_text.split()[2:]), self._motors, strict=True)
            self.wheels.set(self.robot.now_ms, *(power * part / 100 for power, part in powers))
            for number, side in enumerate(("left", "right")):
                wheel = self.wheels.wheels[number]
                while self._counted[number] != wheel.counted_edges:
                    self._step(
                        number, side, 1 if wheel.counted_edges > self._counted[number] else -1
                    )

    def _step(self, number: int, side: str, step: int) -> None:
        self._counted[number] += step
        is_high = self._counted[number] % 2 == 1
        second = [(0, self._pins[f"{side}_b"], is_high == (step < 0))] if self.has_two else []
        self.robot.edges(*second, (SETTLES_US, self._pins[side], is_high))

    def drive(self, text: str, limit_ms: int = 8000) -> Event:
        """Run a program to its end and a little longer; return the cause of its end."""
        image = image_of(text, self._kit)
        assert self.robot.until(self.session, self.session.hello()) == OK
        assert self.robot.until(self.session, self.session.upload(image)) == OK
        for _ in range(limit_ms // 10):
            self.run(10)
            for event in self.session.events():
                if event.name in ("DONE", "FAULT"):
                    self.run(500)
                    return event
        raise AssertionError(f"not over after {limit_ms} ms")


def pulses(pin: int, count: int, high_us: int, low_us: int = 400) -> list[tuple[int, int, bool]]:
    return [change for _ in range(count) for change in ((low_us, pin, True), (high_us, pin, False))]


def counting_robot(profile: Robot) -> tuple[Esp32Robot, dict[str, int]]:
    assert profile.board.discs
    robot, pins = Esp32Robot(profile), dict(profile.board.discs.pins)
    robot.edges(*((100, pin, False) for pin in pins.values()))
    return robot, pins


@pytest.mark.long
@pytest.mark.sampled("profile", "major")
@KINDS
@pytest.mark.parametrize("major", [2, 3])
def test_moves_and_turns_have_the_requested_length(profile: Robot, major: int) -> None:
    driven_robot = Driven(profile, (107.5, 92.5), major)
    assert driven_robot.drive("F(20 CM, 60); R(90 DEG, 60)").name == "DONE"
    pose = driven_robot.pose
    assert abs(pose.x_cm - 20) <= 1.5 and abs(pose.y_cm) <= 2 and abs(pose.heading + 90) <= 6


@pytest.mark.sampled("number")
@pytest.mark.parametrize("number", [0, 1])
def test_an_unplugged_disc_is_reported_as_a_fault_of_its_wheel(number: int) -> None:
    driven_robot = Driven(SLOTTED, (100, 100))
    driven_robot.wheels.wheels[number].has_working_sensor = False
    event = driven_robot.drive("F(20 CM, 60)")
    assert event.name == "FAULT" and event.fault == (5, 6)[number]
    assert not any(wheel.wanted_speed for wheel in driven_robot.wheels.wheels)


def test_a_full_counter_wraps_around() -> None:
    """It does so at its limit, while no one reads it, and in the middle of a move, where the driver
    clears it."""
    driven_robot = Driven(SLOTTED, (100, 100))
    assert SLOTTED.board.discs
    pins = [SLOTTED.board.discs.pins[side] for side in ("left", "right")]
    robot = driven_robot.robot
    robot.edges(*pulses(pins[0], 17_000, 20, 20))
    edges_before = robot.edges()
    robot.edges(*pulses(pins[0], 7_370, 20, 20), *pulses(pins[1], 16_380, 20, 20))
    edges_after = robot.edges()
    counted = [(b - a) % 2**16 for a, b in zip(edges_before, edges_after, strict=True)]
    assert counted == [14_740, 32_760]
    assert driven_robot.drive("F(20 CM, 60)").name == "DONE"
    assert abs(driven_robot.pose.x_cm - 20) <= 1.5


def test_edges_count_and_glitches_do_not() -> None:
    robot, pins = counting_robot(SLOTTED)
    start_edges = robot.edges()
    robot.edges(*pulses(pins["left"], 10, LONGEST_US), *pulses(pins["right"], 10, 1))
    assert robot.edges() == start_edges
    counts = robot.edges(*pulses(pins["left"], 10, LONGEST_US + 1), *pulses(pins["right"], 3, 50))
    assert [(b - a) % 2**16 for a, b in zip(start_edges, counts, strict=True)] == [20, 6]


def test_two_channels_count_backwards() -> None:
    """The cases are those of an Uno in `test_board_discs.py`."""
    robot, pins = counting_robot(TWO_CHANNELS)
    a, b = pins["left"], pins["left_b"]
    states = [(True, False), (True, True), (False, True), (False, False)]
    start_edges = robot.edges()[0]

    def count_steps(steps: list[int]) -> int:
        changes = (
            (SETTLES_US, pin, level)
            for k in steps
            for pin, level in zip((a, b), states[k % 4], strict=True)
        )
        return (robot.edges(*changes)[0] - start_edges) % 2**16

    assert count_steps([k % 4 for k in range(16)]) == 8
    assert count_steps([(2 - k) % 4 for k in range(10)]) == 3


@pytest.mark.sampled("pins")
@pytest.mark.parametrize("pins", [{"left": 34, "right": 35}, {"left": 36, "right": 39}])
def test_input_only_pins_count_edges(pins: dict[str, int]) -> None:
    """Input-only pins have no pull-up, but the sensor has its own."""
    discs = SLOTTED.board.discs
    assert discs
    profile = SLOTTED._replace(
        board=SLOTTED.board._replace(discs=discs._replace(pins=pins), sensors=()),
        kit=SLOTTED.kit._replace(sensors=()),
    )
    robot, _ = counting_robot(profile)
    start_edges = robot.edges()
    counts = robot.edges(*pulses(pins["left"], 4, 50), *pulses(pins["right"], 2, 50))
    assert [(b - a) % 2**16 for a, b in zip(start_edges, counts, strict=True)] == [8, 4]


@KINDS
@pytest.mark.parametrize("major", [2, 3])
def test_the_sketch_compiles_for_both_cores(profile: Robot, major: int, tmp_path: Path) -> None:
    own_header = tmp_path / "own.h"
    own_header.write_text(firmware.header([profile], "a test."), encoding="utf-8")
    flags = (
        f'-Dtiniscript_own="{own_header}"',
        *flags_of("esp32dev", major),
        f"-I{STAND_INS_FOLDER / 'core'}",
    )
    for standard in ("gnu++11", "gnu++23"):
        assert complaints(BOARD / "discs.cpp", *flags, standard=standard) == ""
