"""A voltage that is a yes from a threshold on."""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    Part,
    PinKey,
    Plan,
    SensorDriver,
    Setting,
    Shape,
    module,
    photoresistor,
)
from tiniscript.robots.profile import Wiring


class Threshold(SensorDriver):
    name = "threshold"
    profile = "pin, analog; threshold of 1023, yes_is_low = true"
    used_by = "sensors yes/no"
    pins = (PinKey("pin", "analog"),)
    settings = (
        Setting("threshold", "whole", 512, 1, 1023),
        Setting("yes_is_low", "yes/no"),
    )

    def firmware(self, part: Part, device: Device, wiring: Wiring) -> list[str]:
        compare = "<" if wiring.settings["yes_is_low"] else ">="
        settled = f"      *value = *value {compare} {wiring.settings['threshold']};"
        return [part.analog_read(wiring), settled, "      return true;"]

    def sketch(
        self, plan: Plan, device: Device, wiring: Wiring, name: str, comment: str
    ) -> list[str]:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", comment)
        sign = "<" if wiring.settings["yes_is_low"] else ">="
        return [f"{name} = analogRead({pin}) {sign} {wiring.settings['threshold']};"]

    def shape(self, wiring: Wiring, device: Device | None, sensed: str, pin_volts: int) -> Shape:
        return photoresistor() if sensed == "light" else module("A0", "need_threshold")


DRIVER = Threshold()
