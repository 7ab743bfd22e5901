"""A servo that goes to an angle."""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    AT_STOP,
    GROUND,
    HOLD_CHOICE,
    SERVO_SUPPLY,
    ActuatorDriver,
    DriverPlan,
    HeaderPart,
    PinKey,
    Setting,
    Shape,
    Terminal,
)
from tiniscript.robots.profile import Wiring


class Servo(ActuatorDriver):
    name = "servo"
    profile_help = (
        'pin; low_us and high_us: the pulse at the ends of its range; at_stop = "release", or '
        '"hold" where it shall stay as it is when a program is stopped'
    )
    used_by = "actuators number"
    pins = (PinKey("pin", "servo"),)
    settings = (
        Setting("low_us", "whole", 1000, 500, 2500),
        Setting("high_us", "whole", 2000, 500, 2500),
        Setting(AT_STOP, "choice", words=("release", "hold")),
    )
    fixed_shape = Shape(
        "servo",
        "need_servo",
        (
            Terminal("signal", "pin"),
            Terminal("plus", rail=SERVO_SUPPLY),
            Terminal("minus", rail=GROUND),
        ),
        note_keys=("mind_servo_supply",),
    )

    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        part.servo_pins.append(wiring.pins["pin"])
        pulse = part.map_to_range(device, wiring.settings["low_us"], wiring.settings["high_us"])
        number = len(part.servo_pins) - 1
        condition = "if (is_stalled) " if wiring.settings[AT_STOP] == HOLD_CHOICE else ""
        part.off_lines.append(f"{condition}servo_set({number}, 0, 0);  // {device.name}")
        return [f"      servo_set({number}, {pulse}, 0);", "      return;"]

    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, function: str, comment: str
    ) -> str:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", comment)
        number = plan.servo(pin)
        low_us, high_us = wiring.settings["low_us"], wiring.settings["high_us"]
        if wiring.settings[AT_STOP] != HOLD_CHOICE:
            plan.off_lines.append(f"$servo_pulse({number}, 0, 0);")
        call = f"$servo_pulse({number}, {plan.part_of(device, low_us, high_us)}, 0);"
        return f"void {function}(long value) {{\n  {call}\n}}"


DRIVER = Servo()
