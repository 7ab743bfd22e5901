"""Two servos that turn without end, one for each wheel."""

from __future__ import annotations

from tiniscript.robots.driver import (
    GROUND,
    SERVO_SUPPLY,
    SIDES,
    DriverPlan,
    HeaderPart,
    MotorDriver,
    PinKey,
    Setting,
    Shape,
    Terminal,
)
from tiniscript.robots.profile import Wiring

_STILL_SETTING = Setting("left_still_us", "whole", 1500, 1000, 2000)


class Servos(MotorDriver):
    name = "servos"
    profile_help = (
        "left_pin, right_pin of servos that turn without end; left_reversed, right_reversed, "
        "left_still_us, right_still_us"
    )
    module = "motors_servos"
    pins = tuple(PinKey(f"{side}_pin", "servo") for side in SIDES)
    settings = (
        Setting("left_reversed", "yes/no"),
        Setting("right_reversed", "yes/no", 1),
        _STILL_SETTING,
        _STILL_SETTING._replace(key="right_still_us"),
    )
    drive = """\
void $drive_motor(byte servo, int percent, unsigned int stillUs) {
  if (percent != 0) {
    $servo_pulse(servo, stillUs + percent * 51 / 10, 0);
  } else if ($pulse_us[servo] != 0 && $pulses_left[servo] == 0) {
    $servo_pulse(servo, stillUs, 50);
  }
}"""
    fixed_shape = Shape(
        "servo",
        "need_servos",
        (
            Terminal("left_signal", "left_pin"),
            Terminal("left_plus", rail=SERVO_SUPPLY),
            Terminal("left_minus", rail=GROUND),
            Terminal("right_signal", "right_pin"),
            Terminal("right_plus", rail=SERVO_SUPPLY),
            Terminal("right_minus", rail=GROUND),
        ),
        note_keys=("mind_servo_supply", "mind_servos"),
    )

    def firmware_lines(self, part: HeaderPart, wiring: Wiring) -> list[str]:
        lines = []
        for number, side in enumerate(SIDES):
            part.servo_pins.append(wiring.pins[f"{side}_pin"])
            still_us, name = wiring.settings[f"{side}_still_us"], f"k{side.capitalize()}Motor"
            is_reversed = "true" if wiring.settings[f"{side}_reversed"] else "false"
            lines.append(
                f"constexpr TurningServo {name} = {{{number}, {still_us}, {is_reversed}}};"
            )
        return lines

    def sketch_lines(self, plan: DriverPlan, wiring: Wiring) -> list[str]:
        lines = []
        for side in SIDES:
            servo_number = plan.servo(plan.pin(f"${side.upper()}_$PIN", wiring.pins[f"{side}_pin"]))
            sign = "-" if wiring.settings[f"{side}_reversed"] else ""
            still_us = wiring.settings[f"{side}_still_us"]
            lines.append(f"  $drive_motor({servo_number}, {sign}{side}, {still_us});")
        return lines


DRIVER = Servos()
