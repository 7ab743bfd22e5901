"""Chips that take two PWM pins for each motor, under any name of their pins."""

from __future__ import annotations

from tiniscript.robots.driver import (
    DIRECTIONS,
    GROUND,
    MOTOR_BATTERY,
    PULL_DOWN,
    SIDES,
    DriverPlan,
    HeaderPart,
    MotorDriver,
    PinKey,
    Shape,
    Terminal,
    motor_line,
)
from tiniscript.robots.profile import Wiring


class TwoWire(MotorDriver):
    name = "two_wire"
    profile_help = "left_forward, left_backward, right_forward, right_backward, all PWM"
    module = "motors_two_wire"
    pins = tuple(PinKey(f"{side}_{way}", "pwm") for side in SIDES for way in DIRECTIONS)
    drive = """\
void $drive_motor(int forwardPin, int backwardPin, int percent) {
  analogWrite(forwardPin, percent > 0 ? percent * 255L / 100 : 0);
  analogWrite(backwardPin, percent < 0 ? -percent * 255L / 100 : 0);
}"""
    fixed_shape = Shape(
        "bridge",
        "need_two_wire",
        (
            Terminal("IN1", "left_forward", ground_resistor=PULL_DOWN),
            Terminal("IN2", "left_backward", ground_resistor=PULL_DOWN),
            Terminal("IN3", "right_forward", ground_resistor=PULL_DOWN),
            Terminal("IN4", "right_backward", ground_resistor=PULL_DOWN),
            Terminal("VM", rail=MOTOR_BATTERY),
            Terminal("GND", rail=GROUND),
        ),
        "DRV8833/L9110S",
        ("OUT1, OUT2", "OUT3, OUT4"),
        ("mind_two_wire",),
        power_key="power_volts_two_wire",
    )

    def firmware_lines(self, part: HeaderPart, wiring: Wiring) -> list[str]:
        lines = []
        for side in SIDES:
            forward, backward = (
                part.pins.pwm(wiring.pins[f"{side}_{direction}"]) for direction in DIRECTIONS
            )
            name = f"k{side.capitalize()}Motor"
            lines.append(f"constexpr TwoWire {name} = {{{forward}, {backward}}};")
        return lines

    def sketch_lines(self, plan: DriverPlan, wiring: Wiring) -> list[str]:
        return [motor_line(plan, wiring, side, DIRECTIONS) for side in SIDES]


DRIVER = TwoWire()
