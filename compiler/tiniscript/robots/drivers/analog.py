"""A voltage that the board measures: a light sensor, a battery, a module with three pins."""

from __future__ import annotations

import re

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device
from tiniscript.base.words import lexicon_concept
from tiniscript.robots.driver import (
    FULL_COUNT,
    MOTOR_BATTERY,
    PULL_DOWN,
    DriverPlan,
    HeaderPart,
    PinKey,
    SensorDriver,
    Setting,
    Shape,
    Terminal,
    limit_lines,
    module_shape,
    photoresistor_shape,
)
from tiniscript.robots.profile import Wiring


class Analog(SensorDriver):
    """`zero` and `full` are the values at 0 V and at the highest voltage, in thousandths.

    0 and 1023 keep the raw reading.
    """

    name = "analog"
    profile_help = "pin; zero and full: what 0 V and the highest voltage mean (0 and 1023)"
    used_by = "sensors number"
    pins = (PinKey("pin", "analog"),)
    settings = (
        Setting("zero", "number", 0, -1_000_000_000, 1_000_000_000),
        Setting("full", "number", 1_023_000, -1_000_000_000, 1_000_000_000),
    )

    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        zero_value, full_value = wiring.settings["zero"], wiring.settings["full"]
        step, remainder = divmod(full_value - zero_value, FULL_COUNT)
        lowest, highest = sorted((zero_value, full_value))
        return [
            part.analog_read(wiring),
            f"      *value = analog_scaled(*value, {zero_value}, {step}, {remainder});",
            *limit_lines(device, lowest, highest),
            "      return true;",
        ]

    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, name: str, comment: str
    ) -> list[str]:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", comment)
        if self.is_count(device, wiring):
            return [f"{name} = analogRead({pin});"]
        zero_volts, full_volts = wiring.settings["zero"], wiring.settings["full"]
        step, remainder = divmod(full_volts - zero_volts, FULL_COUNT)
        lowest, highest = sorted((zero_volts, full_volts))
        value = f"{zero_volts} + $counted * {step} + ($counted * {remainder} + 511) / {FULL_COUNT}"
        if device.low <= lowest and highest <= device.high:
            return [f"long $counted = analogRead({pin});", f"{name} = {plan.value(value)};"]
        limits = f"constrain($value, {device.low}, {device.high})"
        return [
            f"long $counted = analogRead({pin});",
            f"long $value = {value};",
            f"{name} = {plan.value(limits)};",
        ]

    def is_count(self, device: Device, wiring: Wiring) -> bool:
        is_raw = (wiring.settings["zero"], wiring.settings["full"]) == (0, FULL_COUNT * ONE)
        return is_raw and device.low <= 0 and device.high >= FULL_COUNT * ONE

    def shape(
        self, wiring: Wiring, device: Device | None, sensed_kind: str, pin_volts: int
    ) -> Shape:
        if sensed_kind == "light":
            return photoresistor_shape()
        full_value = wiring.settings["full"]
        if (
            device
            and device.unit == "V"
            and wiring.settings["zero"] == 0
            and full_value > pin_volts
        ):
            return _divided_voltage(device, full_value, pin_volts)
        return module_shape("OUT", "need_analog", "mind_analog")


def _divided_voltage(device: Device, full_volts: int, pin_volts: int) -> Shape:
    """Two resistors: the lower one has the voltage of a pin when both together have `full_volts`
    thousandths."""
    upper_resistor = f"{10 * (full_volts - pin_volts) / pin_volts:g} kΩ"
    is_battery = lexicon_concept(re.split("[_0-9]", device.name)[0]) == "BATTERY"
    name = MOTOR_BATTERY if is_battery else "what_is_measured"
    source = Terminal(name, "pin", ground_resistor=PULL_DOWN, far_resistor=upper_resistor)
    return Shape("voltage", "", (source,), note_keys=("mind_voltage",))


DRIVER = Analog()
