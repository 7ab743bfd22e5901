"""Chips that take two PWM pins for each motor: DRV8833, L9110S."""

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
    # fmt: off
    texts = {
        "need_two_wire": ("motor driver with two wires for each motor (DRV8833, L9110S), and two motors with gears",
                          "controlador de dos cables por motor (DRV8833, L9110S), y dos motorreductores"),
        "mind_two_wire": ("Drivers with two wires have other names for their pins: VM may be VCC or +, IN1 to IN4 may be AIN1, AIN2, BIN1, BIN2 or A-1A, A-1B, B-1A, B-1B. If yours has a pin SLP, EEP or nSLEEP, join it to 5V.",
                          "Los controladores de dos cables usan otros nombres: VM puede ser VCC o +; IN1 a IN4 pueden ser AIN1, AIN2, BIN1, BIN2 o A-1A, A-1B, B-1A, B-1B. Si el tuyo tiene un pin SLP, EEP o nSLEEP, únelo a 5V."),
        "mind_two_wire_3v3": ("Drivers with two wires have other names for their pins: VM may be VCC or +, IN1 to IN4 may be AIN1, AIN2, BIN1, BIN2 or A-1A, A-1B, B-1A, B-1B. If yours has a pin SLP, EEP or nSLEEP, join it to 3V3.",
                              "Los controladores de dos cables usan otros nombres: VM puede ser VCC o +; IN1 a IN4 pueden ser AIN1, AIN2, BIN1, BIN2 o A-1A, A-1B, B-1A, B-1B. Si el tuyo tiene un pin SLP, EEP o nSLEEP, únelo a 3V3."),
        "power_volts_two_wire": ("Such a driver takes up to about 10 V (look at its page); a battery with the volts of the motors suits it.",
                                 "Un controlador así acepta hasta unos 10 V (mira su hoja); le va bien una batería con los voltios de los motores."),
    }
    # fmt: on

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
