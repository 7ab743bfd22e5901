"""A pin that reads high or low: a switch, or a module with its own threshold."""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    DriverPlan,
    HeaderPart,
    PinKey,
    SensorDriver,
    Setting,
    Shape,
    module_shape,
    switch_shape,
)
from tiniscript.robots.profile import Wiring


class DigitalSensor(SensorDriver):
    name = "digital"
    profile_help = "pin; pull_up = true, yes_is_low = true"
    used_by = "sensors yes/no"
    pins = (PinKey("pin", "input"),)
    settings = (Setting("pull_up", "yes/no"), Setting("yes_is_low", "yes/no"))

    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        pin = part.pins.pin(wiring.pins["pin"])
        if wiring.settings["pull_up"]:
            part.begin_lines.append(f"begin_pull_up({pin});")
        elif part.is_esp32:  # an AVR's pin is an input after a reset
            part.begin_lines.append(f"begin_input({pin});")
        low = "!" if wiring.settings["yes_is_low"] else ""
        return [f"      *value = {low}is_high({pin});", "      return true;"]

    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, name: str, comment: str
    ) -> list[str]:
        mode = "INPUT_PULLUP" if wiring.settings["pull_up"] else "INPUT"
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], mode, comment)
        level = "LOW" if wiring.settings["yes_is_low"] else "HIGH"
        return [f"{name} = digitalRead({pin}) == {level};"]

    def shape(
        self, wiring: Wiring, device: Device | None, sensed_kind: str, pin_volts: int
    ) -> Shape:
        if wiring.settings["pull_up"]:
            return switch_shape()
        return module_shape("D0", "need_digital", "mind_digital")


DRIVER = DigitalSensor()
