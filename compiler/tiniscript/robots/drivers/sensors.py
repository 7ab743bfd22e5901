"""The drivers of sensors."""

from __future__ import annotations

import re

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device
from tiniscript.base.words import concept_of
from tiniscript.robots.driver import (
    BOARD_5V,
    FULL_COUNT,
    GROUND,
    MOTOR_BATTERY,
    PULL_DOWN,
    Part,
    PinKey,
    Plan,
    SensorDriver,
    Setting,
    Shape,
    Terminal,
    switch,
)
from tiniscript.robots.profile import Wiring


def in_limits(device: Device, low: int, high: int) -> list[str]:
    """Return the line that keeps values from `low` to `high` in the device's range."""
    if device.low <= low and high <= device.high:
        return []
    return [f"      *value = in_limits(*value, {device.low}, {device.high});"]


def module(output: str, need: str, *notes: str) -> Shape:
    """Return the shape of a sensor on a small board with three pins."""
    terminals = (
        Terminal("VCC", rail=BOARD_5V),
        Terminal(output, "pin"),
        Terminal("GND", rail=GROUND),
    )
    return Shape("module", need, terminals, notes=notes)


def photoresistor() -> Shape:
    terminals = (Terminal("leg_1", rail=BOARD_5V), Terminal("leg_2", "pin", to_ground=PULL_DOWN))
    return Shape("light", "need_light", terminals, notes=("mind_light",))


class Analog(SensorDriver):
    """A voltage that the board measures: a light sensor, a battery, a module with three pins.

    `zero` and `full` are the values at 0 V and at the highest voltage, in thousandths.

    0 and 1023 keep the raw reading.
    """

    name = "analog"
    profile = "pin; zero and full: what 0 V and the highest voltage mean (0 and 1023)"
    used_by = "sensors number"
    pins = (PinKey("pin", "analog"),)
    settings = (
        Setting("zero", "number", 0, -1_000_000_000, 1_000_000_000),
        Setting("full", "number", 1_023_000, -1_000_000_000, 1_000_000_000),
    )

    def firmware(self, part: Part, device: Device, wiring: Wiring) -> list[str]:
        zero, full = wiring.settings["zero"], wiring.settings["full"]
        step, rest = divmod(full - zero, FULL_COUNT)
        lowest, highest = sorted((zero, full))
        return [
            part.analog_read(wiring),
            f"      *value = analog_scaled(*value, {zero}, {step}, {rest});",
            *in_limits(device, lowest, highest),
            "      return true;",
        ]

    def sketch(
        self, plan: Plan, device: Device, wiring: Wiring, name: str, beside: str
    ) -> list[str]:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", beside)
        if self.is_count(device, wiring):
            return [f"{name} = analogRead({pin});"]
        zero, full = wiring.settings["zero"], wiring.settings["full"]
        step, rest = divmod(full - zero, FULL_COUNT)
        lowest, highest = sorted((zero, full))
        value = f"{zero} + $counted * {step} + ($counted * {rest} + 511) / {FULL_COUNT}"
        if device.low <= lowest and highest <= device.high:
            return [f"long $counted = analogRead({pin});", f"{name} = {plan.value(value)};"]
        limits = f"constrain($value, {device.low}, {device.high})"
        return [
            f"long $counted = analogRead({pin});",
            f"long $value = {value};",
            f"{name} = {plan.value(limits)};",
        ]

    def is_count(self, device: Device, wiring: Wiring) -> bool:
        is_plain = (wiring.settings["zero"], wiring.settings["full"]) == (0, FULL_COUNT * ONE)
        return is_plain and device.low <= 0 and device.high >= FULL_COUNT * ONE

    def shape(self, wiring: Wiring, device: Device | None, sees: str, pin_volts: int) -> Shape:
        if sees == "light":
            return photoresistor()
        full = wiring.settings["full"]
        if device and device.unit == "V" and wiring.settings["zero"] == 0 and full > pin_volts:
            return _divided_voltage(device, full, pin_volts)
        return module("OUT", "need_analog", "mind_analog")


def _divided_voltage(device: Device, full: int, pin_volts: int) -> Shape:
    """Two resistors: the lower one has what a pin takes when the whole has `full` thousandths."""
    upper = f"{10 * (full - pin_volts) / pin_volts:g} kΩ"
    is_battery = concept_of(re.split("[_0-9]", device.name)[0]) == "BATTERY"
    name = MOTOR_BATTERY if is_battery else "what_is_measured"
    source = Terminal(name, "pin", to_ground=PULL_DOWN, beyond=upper)
    return Shape("voltage", "", (source,), notes=("mind_voltage",))


FARTHEST = 400 * ONE  # reading without an echo


class HcSr04(SensorDriver):
    """The ultrasonic sensor HC-SR04. Its distances are thousandths of a centimetre."""

    name = "hc_sr04"
    profile = "trigger, echo; in cm"
    used_by = "sensors number"
    pins = (PinKey("trigger", "output"), PinKey("echo", "echo"))
    looks = Shape(
        "sonar",
        "need_hc_sr04",
        (
            Terminal("VCC", rail=BOARD_5V),
            Terminal("TRIG", "trigger"),
            Terminal("ECHO", "echo"),
            Terminal("GND", rail=GROUND),
        ),
        "HC-SR04",
        notes=("mind_hc_sr04",),
        needs_5v=True,
    )

    def firmware(self, part: Part, device: Device, wiring: Wiring) -> list[str]:
        trigger = part.pins.pin(wiring.pins["trigger"])
        part.begin.append(f"begin_output({trigger}, false);")
        part.ultrasonics.append(f"{{{trigger}, {part.pins.echo(wiring.pins['echo'])}}}")
        return [
            f"      if (!ultrasonic_read({len(part.ultrasonics) - 1}, value)) return false;",
            *in_limits(device, 0, FARTHEST),
            "      return true;",
        ]

    def sketch(
        self, plan: Plan, device: Device, wiring: Wiring, name: str, beside: str
    ) -> list[str]:
        trigger = f"{device.name}_$TRIGGER_$PIN"
        plan.pin(trigger, wiring.pins["trigger"], "OUTPUT", beside)
        echo = plan.pin(f"{device.name}_$ECHO_$PIN", wiring.pins["echo"], "INPUT")
        drivers = [each.driver for each in plan.robot.board.sensors]
        first, again, last = [], "", []
        if drivers.count(self.name) > 1:
            first = ["static unsigned long $own_ping = -60;"]
            again = " && millis() - $own_ping < 58"
            last = ["$own_ping = $last_ping;"]
        farthest = min(FARTHEST, device.high)
        return [
            *first,
            f"if (millis() - $last_ping < 30{again}) return {name};",
            f"long $value = $ping_ms({trigger}, {echo}) * 4390UL >> 8;",
            *last,
            f"{name} = {plan.value(f'constrain($value, {max(0, device.low)}, {farthest})')};",
        ]


class DigitalSensor(SensorDriver):
    """A pin that reads high or low: a switch, or a module with its own threshold."""

    name = "digital"
    profile = "pin; pull_up = true, yes_is_low = true"
    used_by = "sensors yes/no"
    pins = (PinKey("pin", "input"),)
    settings = (Setting("pull_up", "yes/no"), Setting("yes_is_low", "yes/no"))

    def firmware(self, part: Part, device: Device, wiring: Wiring) -> list[str]:
        pin = part.pins.pin(wiring.pins["pin"])
        if wiring.settings["pull_up"]:
            part.begin.append(f"begin_pull_up({pin});")
        elif part.is_esp32:  # an AVR's pin is an input after a reset
            part.begin.append(f"begin_input({pin});")
        low = "!" if wiring.settings["yes_is_low"] else ""
        return [f"      *value = {low}is_high({pin});", "      return true;"]

    def sketch(
        self, plan: Plan, device: Device, wiring: Wiring, name: str, beside: str
    ) -> list[str]:
        mode = "INPUT_PULLUP" if wiring.settings["pull_up"] else "INPUT"
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], mode, beside)
        level = "LOW" if wiring.settings["yes_is_low"] else "HIGH"
        return [f"{name} = digitalRead({pin}) == {level};"]

    def shape(self, wiring: Wiring, device: Device | None, sees: str, pin_volts: int) -> Shape:
        if wiring.settings["pull_up"]:
            return switch()
        return module("D0", "need_digital", "mind_digital")


class Threshold(SensorDriver):
    """A voltage that is a yes from a threshold on."""

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
        self, plan: Plan, device: Device, wiring: Wiring, name: str, beside: str
    ) -> list[str]:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", beside)
        sign = "<" if wiring.settings["yes_is_low"] else ">="
        return [f"{name} = analogRead({pin}) {sign} {wiring.settings['threshold']};"]

    def shape(self, wiring: Wiring, device: Device | None, sees: str, pin_volts: int) -> Shape:
        return photoresistor() if sees == "light" else module("A0", "need_threshold")


DRIVERS = (Analog(), HcSr04(), DigitalSensor(), Threshold())
