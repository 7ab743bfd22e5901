"""A simulated Uno that is a tinibot2: its motors turn wheels, whose discs change its pins.

Wheels, motors and discs are those of the virtual robot (`virtual/wheels.py`), the firmware is the
one that goes onto the board. `pose` has the path of the wheels.
"""

from __future__ import annotations

from pathlib import Path

from tests.machines.wired import Wired
from tests.support.images import image_of
from tiniscript import robots
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.robots.drivers import discs_of
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.driving import Driving
from tiniscript.virtual.wheels import Roughness, Wheels
from tools.uno import Uno
from tools.uno.log import Event

ROBOT = robots.load("tinibot2", "uno")
ENVIRONMENT = "uno_tinibot2"  # environment in vm_arduino/platformio.ini
FULL_PWM = 255  # PWM value of 100 %


class DrivenUno(Wired):
    """An Uno on an endless floor, whose motors have `motors` percent of their speed."""

    def __init__(
        self, firmware: Path, seed: int, motors: tuple[float, float], rough: Roughness
    ) -> None:
        board = ROBOT.board
        assert board.discs
        uno = Uno(firmware, baud=board.baud, resets_on_open=False, tells_sleep=False)
        super().__init__(uno, Session(seed, board.baud, ROBOT.kit.fingerprint))
        self._motors = motors
        self._simulation = Driving(ROBOT.body, (), Pose(0, 0, 0))
        self.wheels = Wheels(
            ROBOT.body,
            board.discs,
            discs_of(board.discs).has_two_channels,
            rough,
            seed,
            self._simulation.set_motors,
        )
        self._discs = [f"D{board.discs.pins[side]}" for side in ("left", "right")]
        self._levels = [False, False]
        self._noticed_count = 0  # events of the board
        self._pins: dict[str, Event] = {}  # last event of each pin
        for name in self._discs:
            uno.drive(name, False)
        uno.run_ms(300)

    @property
    def pose(self) -> Pose:
        self.wheels.go_on(self.now_ms)
        return self._simulation.advance_to(self.now_ms)

    def run(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            super().run(1)
            for event in self.uno.events[self._noticed_count :]:
                self._noticed_count += 1
                if event.kind == "pin":
                    self._pins[event["pin"]] = event
            left, right = self._motors
            powers = self._power("left") * left / 100, self._power("right") * right / 100
            self.wheels.set(self.now_ms, *powers)
            for number, wheel in enumerate(self.wheels.wheels):
                is_high = wheel.counted_edges % 2 == 1
                if is_high != self._levels[number]:
                    self._levels[number] = is_high
                    self.uno.drive(self._discs[number], is_high)

    def _power(self, side: str) -> float:
        """Return the power of a motor, in percent."""
        pins = ROBOT.board.motors.pins
        pwm = self._pins[f"D{pins[f'{side}_pwm']}"]
        is_high: int = pwm["value"] if pwm["is"] == "pwm" else FULL_PWM * (pwm["is"] == "high")
        is_backward = self._pins[f"D{pins[f'{side}_backward']}"]["is"] == "high"
        return (-is_high if is_backward else is_high) * 100 / FULL_PWM

    def drive(self, text: str, timeout_ms: int = 20_000) -> str:
        """Run a program to its end and a little longer; return the cause of its end."""
        image = image_of(text, ROBOT.kit)
        assert self.until(self.session.hello()) == OK
        assert self.until(self.session.upload(image)) == OK
        for _ in range(timeout_ms // 10):
            self.run(10)
            for event in self.session.events():
                if event.name in ("DONE", "FAULT"):
                    self.run(500)
                    return event.name
        raise AssertionError(f"not over after {timeout_ms} ms")
