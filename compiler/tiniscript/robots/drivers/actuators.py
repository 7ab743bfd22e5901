"""The drivers of actuators."""

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
    lamp,
)
from tiniscript.robots.profile import Wiring


class PwmActuator(ActuatorDriver):
    """A pin that is on for a part of the time: a lamp that is dimmed."""

    name = "pwm"
    profile = "pin"
    used_by = "actuators number"
    pins = (PinKey("pin", "pwm"),)
    looks = lamp(is_on_low=False)

    def firmware(self, part: Part, device: Device, wiring: Wiring) -> list[str]:
        pin, pwm = part.pins.pin(wiring.pins["pin"]), part.pins.pwm(wiring.pins["pin"])
        begin = f"begin_pwm(Pwm{pwm});" if part.is_esp32 else f"begin_output({pin}, false);"
        part.begin.append(begin)
        part.off.append(f"disconnect(Pwm{pwm});  // {device.name}")
        share = part.part_of_range(device, 0, 255)
        return [f"      connect(Pwm{pwm}, {share});", "      return;"]

    def sketch(self, plan: Plan, device: Device, wiring: Wiring, function: str, beside: str) -> str:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "OUTPUT", beside)
        plan.off.append(f"analogWrite({pin}, 0);")
        share = plan.part_of(device, 0, 255)
        return f"void {function}(long value) {{\n  analogWrite({pin}, {share});\n}}"


class Servo(ActuatorDriver):
    """A servo that goes to an angle."""

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

    def sketch(self, plan: Plan, device: Device, wiring: Wiring, function: str, beside: str) -> str:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", beside)
        number = plan.servo(pin)
        first, last = wiring.settings["low_us"], wiring.settings["high_us"]
        if wiring.settings[AT_STOP] != HOLD:
            plan.off.append(f"$servo_pulse({number}, 0, 0);")
        what = f"$servo_pulse({number}, {plan.part_of(device, first, last)}, 0);"
        return f"void {function}(long value) {{\n  {what}\n}}"


class DigitalActuator(ActuatorDriver):
    """A pin that is set high or low: a lamp."""

    name = "digital"
    profile = "pin; yes_is_low = true"
    used_by = "actuators yes/no"
    pins = (PinKey("pin", "output"),)
    settings = (Setting("yes_is_low", "yes/no"),)

    def firmware(self, part: Part, device: Device, wiring: Wiring) -> list[str]:
        pin, is_on_low = part.pins.pin(wiring.pins["pin"]), wiring.settings["yes_is_low"]
        off = "true" if is_on_low else "false"
        part.begin.append(f"begin_output({pin}, {off});")
        part.off.append(f"write({pin}, {off});  // {device.name}")
        condition = "value == 0" if is_on_low else "value != 0"
        return [f"      write({pin}, {condition});", "      return;"]

    def sketch(self, plan: Plan, device: Device, wiring: Wiring, function: str, beside: str) -> str:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "OUTPUT", beside)
        on, off = ("LOW", "HIGH") if wiring.settings["yes_is_low"] else ("HIGH", "LOW")
        plan.off.append(f"digitalWrite({pin}, {off});")
        if off == "HIGH":  # before the pin is an output, so that the part stays off
            plan.begin.insert(-1, f"digitalWrite({pin}, {off});")
        return f"void {function}(bool isOn) {{\n  digitalWrite({pin}, isOn ? {on} : {off});\n}}"

    def shape(self, wiring: Wiring, device: Device | None, sees: str, pin_volts: int) -> Shape:
        return lamp(bool(wiring.settings.get("yes_is_low")))


DRIVERS = (PwmActuator(), Servo(), DigitalActuator())
