"""What a kit's pins need in a sketch: constants, what is set up, motors, readers and setters."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

from tiniscript.fixed_point import ONE
from tiniscript.kit import Device
from tiniscript.robots.boards import AT_STOP, CHIPS, HOLD
from tiniscript.robots.firmware import BRIDGES, FARTHEST
from tiniscript.robots.profile import Robot, Wiring

FULL_COUNT = 1023  # of the converter
_SIDES = ("LEFT", "RIGHT")
_ONE_PIN = ("analog", "digital", "threshold")  # drivers of sensors


class Parts(NamedTuple):
    """Lines of the sketch; `$words` stand for names. `constants` are pins, and comments."""

    constants: list[str]
    begin: list[str]
    off: list[str]  # what a stop turns off besides the motors
    functions: dict[str, str]
    servo_pins: list[str]


class Plan:
    """Writes what the program uses of a robot."""

    def __init__(self, robot: Robot, label: Callable[[str], str], is_exact: bool) -> None:
        self.robot = robot
        self.label = label
        self.is_exact = is_exact
        self.chip = CHIPS[robot.board.chip]
        self.parts = Parts([], [], [], {}, [])

    def pin(self, name: str, number: int, mode: str = "", beside: str = "") -> str:
        """Add a pin, and return what it is called."""
        note = f"  // {beside}" if beside else ""
        self.parts.constants.append(f"const int {name} = {self.chip.pin_name(number)};{note}")
        if mode:
            self.parts.begin.append(f"pinMode({name}, {mode});")
        return name

    # -- motors

    def motors(self) -> None:
        driver, pins, settings = self.robot.board.motors
        lines = []
        for side in _SIDES:
            low, word = side.lower(), f"${side}"
            if driver == "servos":
                pin = self.pin(f"{word}_$PIN", pins[f"{low}_pin"])
                sign = "-" if settings[f"{low}_reversed"] else ""
                wheel = self.servo(pin)
                still = settings[f"{low}_still_us"]
                lines.append(f"  $drive_motor({wheel}, {sign}{low}, {still});")
                continue
            keys = ("pwm", "forward", "backward") if driver in BRIDGES else ("forward", "backward")
            names = [
                self.pin(f"{word}_${key.upper()}_$PIN", pins[f"{low}_{key}"], "OUTPUT")
                for key in keys
            ]
            lines.append(f"  $drive_motor({', '.join(names)}, {low});")
        if "standby" in pins:
            self.pin("$STANDBY_$PIN", pins["standby"], "OUTPUT")
            lines.insert(0, "  digitalWrite($STANDBY_$PIN, left != 0 || right != 0 ? HIGH : LOW);")
        body = "\n".join(lines)
        self.parts.functions["motors"] = f"void $motors(int left, int right) {{\n{body}\n}}"
        self.parts.functions["drive_motor"] = _DRIVES["bridge" if driver in BRIDGES else driver]

    def servo(self, pin: str) -> int:
        self.parts.servo_pins.append(pin)
        return len(self.parts.servo_pins) - 1

    # -- sensors

    def kind(self, sensor: int) -> str:
        """Return the C++ type of a reading."""
        device, wiring = self.robot.kit.sensors[sensor], self.robot.board.sensors[sensor]
        if device.is_yes_no:
            return "bool"
        return "$N" if self.is_exact else "int" if is_count(device, wiring) else "float"

    def reader(self, sensor: int, name: str, function: str) -> str:
        """Return the function that takes a reading; it returns what it has kept."""
        device, wiring = self.robot.kit.sensors[sensor], self.robot.board.sensors[sensor]
        beside = self.label(device.name)
        if wiring.driver == "hc_sr04":
            lines = self.distance(device, wiring, name, beside)
        elif wiring.driver not in _ONE_PIN:
            raise _untold(wiring.driver)
        else:
            mode = ""
            if wiring.driver == "digital":
                mode = "INPUT_PULLUP" if wiring.settings["pull_up"] else "INPUT"
            pin = self.pin(f"{device.name}_$PIN", wiring.pins["pin"], mode, beside)
            if wiring.driver == "digital":
                level = "LOW" if wiring.settings["yes_is_low"] else "HIGH"
                lines = [f"{name} = digitalRead({pin}) == {level};"]
            elif wiring.driver == "threshold":
                sign = "<" if wiring.settings["yes_is_low"] else ">="
                lines = [f"{name} = analogRead({pin}) {sign} {wiring.settings['threshold']};"]
            elif is_count(device, wiring):
                lines = [f"{name} = analogRead({pin});"]
            else:
                lines = self.scaled(device, wiring, name, pin)
        body = "\n".join(f"  {line}" for line in (*lines, f"return {name};"))
        return f"{self.kind(sensor)} {function}() {{\n{body}\n}}"

    def value(self, thousandths: str) -> str:
        return f"$exactly({thousandths})" if self.is_exact else f"({thousandths}) / 1000.0"

    def scaled(self, device: Device, wiring: Wiring, name: str, pin: str) -> list[str]:
        zero, full = wiring.settings["zero"], wiring.settings["full"]
        step, rest = divmod(full - zero, FULL_COUNT)
        lowest, highest = sorted((zero, full))
        value = f"{zero} + $counted * {step} + ($counted * {rest} + 511) / {FULL_COUNT}"
        if device.low <= lowest and highest <= device.high:
            return [f"long $counted = analogRead({pin});", f"{name} = {self.value(value)};"]
        limits = f"constrain($value, {device.low}, {device.high})"
        return [
            f"long $counted = analogRead({pin});",
            f"long $value = {value};",
            f"{name} = {self.value(limits)};",
        ]

    def distance(self, device: Device, wiring: Wiring, name: str, beside: str) -> list[str]:
        trigger = f"{device.name}_$TRIGGER_$PIN"
        self.pin(trigger, wiring.pins["trigger"], "OUTPUT", beside)
        echo = self.pin(f"{device.name}_$ECHO_$PIN", wiring.pins["echo"], "INPUT")
        drivers = [each.driver for each in self.robot.board.sensors]
        first, again, last = [], "", []
        if drivers.count("hc_sr04") > 1:
            first = ["static unsigned long $own_ping = -60;"]
            again = " && millis() - $own_ping < 58"
            last = ["$own_ping = $last_ping;"]
        farthest = min(FARTHEST, device.high)
        return [
            *first,
            f"if (millis() - $last_ping < 30{again}) return {name};",
            f"long $value = $ping_ms({trigger}, {echo}) * 4390UL >> 8;",
            *last,
            f"{name} = {self.value(f'constrain($value, {max(0, device.low)}, {farthest})')};",
        ]

    # -- actuators

    def setter(self, actuator: int, function: str) -> str:
        device, wiring = self.robot.kit.actuators[actuator], self.robot.board.actuators[actuator]
        beside = self.label(device.name)
        if wiring.driver == "servo":
            pin = self.pin(f"{device.name}_$PIN", wiring.pins["pin"], "", beside)
            number = self.servo(pin)
            first, last = wiring.settings["low_us"], wiring.settings["high_us"]
            if wiring.settings[AT_STOP] != HOLD:
                self.parts.off.append(f"$servo_pulse({number}, 0, 0);")
            what = f"$servo_pulse({number}, {_part(device, first, last)}, 0);"
            return f"void {function}(long value) {{\n  {what}\n}}"
        if wiring.driver not in ("pwm", "digital"):
            raise _untold(wiring.driver)
        pin = self.pin(f"{device.name}_$PIN", wiring.pins["pin"], "OUTPUT", beside)
        if wiring.driver == "pwm":
            self.parts.off.append(f"analogWrite({pin}, 0);")
            part = _part(device, 0, 255)
            return f"void {function}(long value) {{\n  analogWrite({pin}, {part});\n}}"
        on, off = ("LOW", "HIGH") if wiring.settings["yes_is_low"] else ("HIGH", "LOW")
        self.parts.off.append(f"digitalWrite({pin}, {off});")
        if off == "HIGH":  # before the pin is an output, so that the part stays off
            self.parts.begin.insert(-1, f"digitalWrite({pin}, {off});")
        return f"void {function}(bool isOn) {{\n  digitalWrite({pin}, isOn ? {on} : {off});\n}}"


def _part(device: Device, first: int, last: int) -> str:
    return f"$part_of(value, {device.low // ONE}, {device.high // ONE}, {first}, {last})"


def _untold(driver: str) -> NotImplementedError:
    return NotImplementedError(f"sketch/wiring.py does not say what a sketch does: {driver}")


def is_count(device: Device, wiring: Wiring) -> bool:
    """Whether a reading is what the converter counts."""
    if wiring.driver != "analog":
        return False
    is_plain = (wiring.settings["zero"], wiring.settings["full"]) == (0, FULL_COUNT * ONE)
    return is_plain and device.low <= 0 and device.high >= FULL_COUNT * ONE


def is_small(devices: Iterable[Device]) -> bool:
    """Whether a float tells all readings apart, thousandth by thousandth."""
    return all(max(abs(each.low), abs(each.high)) < 2**24 for each in devices)


_DRIVES = {
    "bridge": """\
void $drive_motor(int pwmPin, int forwardPin, int backwardPin, int percent) {
  digitalWrite(forwardPin, percent > 0 ? HIGH : LOW);
  digitalWrite(backwardPin, percent < 0 ? HIGH : LOW);
  analogWrite(pwmPin, abs(percent) * 255L / 100);
}""",
    "two_wire": """\
void $drive_motor(int forwardPin, int backwardPin, int percent) {
  analogWrite(forwardPin, percent > 0 ? percent * 255L / 100 : 0);
  analogWrite(backwardPin, percent < 0 ? -percent * 255L / 100 : 0);
}""",
    "servos": """\
void $drive_motor(byte servo, int percent, unsigned int stillUs) {
  if (percent != 0) {
    $servo_pulse(servo, stillUs + percent * 51 / 10, 0);
  } else if ($pulse_us[servo] != 0 && $pulses_left[servo] == 0) {
    $servo_pulse(servo, stillUs, 50);
  }
}""",
}
