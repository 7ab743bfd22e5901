"""The parts of a sketch for a kit's pins: constants, set-up, motors, readers and setters."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from tiniscript.base.kit import Device
from tiniscript.robots.driver import DriverPlan
from tiniscript.robots.drivers import actuator_of, motors_of, sensor_of
from tiniscript.robots.profile import Robot, Wiring


class SketchPlan(DriverPlan):
    """Writes the parts of a robot that the program uses."""

    def __init__(self, robot: Robot, label: Callable[[str], str], is_exact: bool) -> None:
        super().__init__(robot, is_exact)
        self.label = label
        self.functions: dict[str, str] = {}

    # -- motors

    def add_motors(self) -> None:
        wiring = self.robot.board.motors
        driver = motors_of(wiring)
        body = "\n".join(driver.sketch_lines(self, wiring))
        self.functions["motors"] = f"void $motors(int left, int right) {{\n{body}\n}}"
        self.functions["drive_motor"] = driver.drive

    # -- sensors

    def reading_type(self, sensor: int) -> str:
        """Return the C++ type of a reading."""
        device, wiring = self.robot.kit.sensors[sensor], self.robot.board.sensors[sensor]
        if device.is_yes_no:
            return "bool"
        return "$N" if self.is_exact else "int" if reads_counts(device, wiring) else "float"

    def reader_code(self, sensor: int, name: str, function: str) -> str:
        """Return the function that takes a reading; it returns the stored value."""
        device, wiring = self.robot.kit.sensors[sensor], self.robot.board.sensors[sensor]
        label = self.label(device.name)
        lines = sensor_of(device.kind, wiring).sketch_lines(self, device, wiring, name, label)
        body = "\n".join(f"  {line}" for line in (*lines, f"return {name};"))
        return f"{self.reading_type(sensor)} {function}() {{\n{body}\n}}"

    # -- actuators

    def setter_code(self, actuator: int, function: str) -> str:
        device, wiring = self.robot.kit.actuators[actuator], self.robot.board.actuators[actuator]
        label = self.label(device.name)
        return actuator_of(device.kind, wiring).sketch_lines(self, device, wiring, function, label)


def reads_counts(device: Device, wiring: Wiring) -> bool:
    """Return whether a sensor's reading is the converter's raw count."""
    return sensor_of(device.kind, wiring).is_count(device, wiring)


def is_exact_as_float(devices: Iterable[Device]) -> bool:
    """Return whether a float can represent all readings exactly to the thousandth."""
    return all(max(abs(device.low), abs(device.high)) < 2**24 for device in devices)
