"""Chips that take two PWM pins for each motor, under any name of their pins."""

from __future__ import annotations

from tiniscript.robots.driver import (
    GROUND,
    MOTOR_BATTERY,
    PULL_DOWN,
    SIDES,
    WAYS,
    MotorDriver,
    Part,
    PinKey,
    Plan,
    Shape,
    Terminal,
    driven_line,
)
from tiniscript.robots.profile import Wiring


class TwoWire(MotorDriver):
    name = "two_wire"
    profile = "left_forward, left_backward, right_forward, right_backward, all PWM"
    module = "motors_two_wire"
    pins = tuple(PinKey(f"{side}_{way}", "pwm") for side in SIDES for way in WAYS)
    drive = """\
void $drive_motor(int forwardPin, int backwardPin, int percent) {
  analogWrite(forwardPin, percent > 0 ? percent * 255L / 100 : 0);
  analogWrite(backwardPin, percent < 0 ? -percent * 255L / 100 : 0);
}"""
    looks = Shape(
        "bridge",
        "need_two_wire",
        (
            Terminal("IN1", "left_forward", to_ground=PULL_DOWN),
            Terminal("IN2", "left_backward", to_ground=PULL_DOWN),
            Terminal("IN3", "right_forward", to_ground=PULL_DOWN),
            Terminal("IN4", "right_backward", to_ground=PULL_DOWN),
            Terminal("VM", rail=MOTOR_BATTERY),
            Terminal("GND", rail=GROUND),
        ),
        "DRV8833, L9110S",
        ("OUT1, OUT2", "OUT3, OUT4"),
        ("mind_two_wire",),
        power="power_volts_two_wire",
    )

    def firmware(self, part: Part, wiring: Wiring) -> list[str]:
        lines = []
        for side in SIDES:
            forward, backward = (part.pins.pwm(wiring.pins[f"{side}_{way}"]) for way in WAYS)
            name = f"k{side.capitalize()}Motor"
            lines.append(f"constexpr TwoWire {name} = {{{forward}, {backward}}};")
        return lines

    def sketch(self, plan: Plan, wiring: Wiring) -> list[str]:
        return [driven_line(plan, wiring, side, WAYS) for side in SIDES]


DRIVER = TwoWire()
