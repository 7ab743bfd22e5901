"""Boards that take PWM and one direction pin for each motor, and make the second of the first.

The one of ELEGOO's Smart Robot Car V4 does so with a TB6612FNG.
"""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    BOARD_5V,
    GROUND,
    MOTOR_BATTERY,
    PULL_DOWN,
    SIDES,
    Bridge,
    PinKey,
    Shape,
    Terminal,
)
from tiniscript.robots.profile import Wiring


class PwmDir(Bridge):
    """A pin for forward that is high turns the motor forward, and backward while it is low."""

    name = "pwm_dir"
    profile_help = (
        "left_pwm, left_forward and the same for right: high is forward, low is backward; "
        "standby, if it is wired"
    )
    keys = ("pwm", "forward")
    pins = (
        *(
            PinKey(f"{side}_{key}", need)
            for side in SIDES
            for key, need in (("pwm", "pwm"), ("forward", "output"))
        ),
        PinKey("standby", "output", True),
    )
    drive = """\
void $drive_motor(int pwmPin, int forwardPin, int percent) {
  digitalWrite(forwardPin, percent > 0 ? HIGH : LOW);
  analogWrite(pwmPin, abs(percent) * 255L / 100);
}"""

    def shape(
        self, wiring: Wiring, device: Device | None, sensed_kind: str, pin_volts: int
    ) -> Shape:
        has_standby = "standby" in wiring.pins
        enable = "" if has_standby else PULL_DOWN
        standby = [Terminal("STBY", "standby", ground_resistor=PULL_DOWN)] if has_standby else []
        return Shape(
            "bridge",
            "need_pwm_dir",
            (
                Terminal("PWMA", "left_pwm", ground_resistor=enable),
                Terminal("DIRA", "left_forward"),
                *standby,
                Terminal("DIRB", "right_forward"),
                Terminal("PWMB", "right_pwm", ground_resistor=enable),
                Terminal("VM", rail=MOTOR_BATTERY),
                Terminal("VCC", rail=BOARD_5V),
                Terminal("GND", rail=GROUND),
            ),
            "PWM/DIR",
            ("AO1, AO2", "BO1, BO2"),
            ("mind_pwm_dir",),
            power_key="power_volts_pwm_dir",
        )


DRIVER = PwmDir()
