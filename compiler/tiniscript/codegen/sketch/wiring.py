"""What a kit's pins need in a sketch: constants, what is set up, motors, readers and setters."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.drivers import actuator_of, motors_of, sensor_of
from tiniscript.robots.profile import Robot, Wiring


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
        wiring = self.robot.board.motors
        driver = motors_of(wiring)
        body = "\n".join(driver.sketch(self, wiring))
        self.parts.functions["motors"] = f"void $motors(int left, int right) {{\n{body}\n}}"
        self.parts.functions["drive_motor"] = driver.drive

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
        lines = sensor_of(device.kind, wiring).sketch(self, device, wiring, name, beside)
        body = "\n".join(f"  {line}" for line in (*lines, f"return {name};"))
        return f"{self.kind(sensor)} {function}() {{\n{body}\n}}"

    def value(self, thousandths: str) -> str:
        return f"$exactly({thousandths})" if self.is_exact else f"({thousandths}) / 1000.0"

    # -- actuators

    def setter(self, actuator: int, function: str) -> str:
        device, wiring = self.robot.kit.actuators[actuator], self.robot.board.actuators[actuator]
        beside = self.label(device.name)
        return actuator_of(device.kind, wiring).sketch(self, device, wiring, function, beside)

    @staticmethod
    def part_of(device: Device, first: int, last: int) -> str:
        """Return `value` as the part of `first` to `last` that it is of an actuator's range."""
        return f"$part_of(value, {device.low // ONE}, {device.high // ONE}, {first}, {last})"


def is_count(device: Device, wiring: Wiring) -> bool:
    """Whether a sensor's reading is what the converter counts."""
    return sensor_of(device.kind, wiring).is_count(device, wiring)


def is_small(devices: Iterable[Device]) -> bool:
    """Whether a float tells all readings apart, thousandth by thousandth."""
    return all(max(abs(each.low), abs(each.high)) < 2**24 for each in devices)
