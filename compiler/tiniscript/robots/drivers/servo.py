"""A servo that goes to an angle."""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    AT_STOP,
    GROUND,
    HOLD,
    SERVO_SUPPLY,
    ActuatorDriver,
    Part,
    PinKey,
    Plan,
    Setting,
    Shape,
    Terminal,
)
from tiniscript.robots.profile import Wiring


class Servo(ActuatorDriver):
    name = "servo"
    profile = (
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
    looks = Shape(
        "servo",
        "need_servo",
        (
            Terminal("signal", "pin"),
            Terminal("plus", rail=SERVO_SUPPLY),
            Terminal("minus", rail=GROUND),
        ),
        notes=("mind_servo_supply",),
    )

    def firmware(self, part: Part, device: Device, wiring: Wiring) -> list[str]:
        part.servos.append(wiring.pins["pin"])
        pulse = part.part_of_range(device, wiring.settings["low_us"], wiring.settings["high_us"])
        number = len(part.servos) - 1
        condition = "if (is_stalled) " if wiring.settings[AT_STOP] == HOLD else ""
        part.off.append(f"{condition}servo_set({number}, 0, 0);  // {device.name}")
        return [f"      servo_set({number}, {pulse}, 0);", "      return;"]

    def sketch(
        self, plan: Plan, device: Device, wiring: Wiring, function: str, comment: str
    ) -> str:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", comment)
        number = plan.servo(pin)
        first, last = wiring.settings["low_us"], wiring.settings["high_us"]
        if wiring.settings[AT_STOP] != HOLD:
            plan.off.append(f"$servo_pulse({number}, 0, 0);")
        call = f"$servo_pulse({number}, {plan.part_of(device, first, last)}, 0);"
        return f"void {function}(long value) {{\n  {call}\n}}"


DRIVER = Servo()
