"""A pin that is set high or low: a lamp."""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    ActuatorDriver,
    DriverPlan,
    HeaderPart,
    PinKey,
    Setting,
    Shape,
    lamp_shape,
)
from tiniscript.robots.profile import Wiring


class DigitalActuator(ActuatorDriver):
    name = "digital"
    profile_help = "pin; yes_is_low = true"
    used_by = "actuators yes/no"
    pins = (PinKey("pin", "output"),)
    settings = (Setting("yes_is_low", "yes/no"),)

    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        pin, is_switched_by_low = part.pins.pin(wiring.pins["pin"]), wiring.settings["yes_is_low"]
        off_level = "true" if is_switched_by_low else "false"
        part.begin_lines.append(f"begin_output({pin}, {off_level});")
        part.off_lines.append(f"write({pin}, {off_level});  // {device.name}")
        condition = "value == 0" if is_switched_by_low else "value != 0"
        return [f"      write({pin}, {condition});", "      return;"]

    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, function: str, comment: str
    ) -> str:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "OUTPUT", comment)
        on_level, off_level = ("LOW", "HIGH") if wiring.settings["yes_is_low"] else ("HIGH", "LOW")
        plan.off_lines.append(f"digitalWrite({pin}, {off_level});")
        if off_level == "HIGH":  # set before the pin becomes an output, so that the part stays off
            plan.begin_lines.insert(-1, f"digitalWrite({pin}, {off_level});")
        return f"void {function}(bool isOn) {{\n  digitalWrite({pin}, isOn ? {on_level} : {off_level});\n}}"

    def shape(
        self, wiring: Wiring, device: Device | None, sensed_kind: str, pin_volts: int
    ) -> Shape:
        return lamp_shape(bool(wiring.settings.get("yes_is_low")))


DRIVER = DigitalActuator()
