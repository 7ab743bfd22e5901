"""A voltage that is a yes from a threshold on."""

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
    photoresistor_shape,
)
from tiniscript.robots.profile import Wiring


class Threshold(SensorDriver):
    name = "threshold"
    profile_help = "pin, analog; threshold of 1023, yes_is_low = true"
    used_by = "sensors yes/no"
    pins = (PinKey("pin", "analog"),)
    settings = (
        Setting("threshold", "whole", 512, 1, 1023),
        Setting("yes_is_low", "yes/no"),
    )

    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        operator = "<" if wiring.settings["yes_is_low"] else ">="
        comparison = f"      *value = *value {operator} {wiring.settings['threshold']};"
        return [part.analog_read(wiring), comparison, "      return true;"]

    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, name: str, comment: str
    ) -> list[str]:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", comment)
        operator = "<" if wiring.settings["yes_is_low"] else ">="
        return [f"{name} = analogRead({pin}) {operator} {wiring.settings['threshold']};"]

    def shape(
        self, wiring: Wiring, device: Device | None, sensed_kind: str, pin_volts: int
    ) -> Shape:
        return (
            photoresistor_shape()
            if sensed_kind == "light"
            else module_shape("A0", "need_threshold")
        )


DRIVER = Threshold()
