"""Prints the flash that each motor driver takes on an Uno, next to the size of `tinibot` with it.

Builds tinibot with PlatformIO as `firmware_size` does, in a copy of the project, once for each
driver, with its distance sensor if no shield has pins. If a firmware does not fit, `tsc firmware`
builds it without tasks.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

from tiniscript import robots
from tiniscript.flash import building
from tiniscript.robots import firmware
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.drivers import DRIVERS, drivers_for
from tiniscript.robots.profile import Robot, Wiring
from tools.bench import page
from tools.bench.firmware_size import PROJECT, measure

OWN_DRIVER = "l298n"  # tinibot's driver
ENVIRONMENT = "uno"
DRIVERS_IN_ORDER = sorted(drivers_for("motors"), key=lambda name: name != OWN_DRIVER)
ROWS = [f"`{name}`" for name in DRIVERS_IN_ORDER]
SHIELD_SENSOR_PINS = {"trigger": 16, "echo": 17}  # A2, A3


def motor_wiring(name: str, robot: Robot) -> Wiring:
    """Return the motors of a driver, on the first pins that fit and are free."""
    chip, driver = CHIPS[robot.board.chip], DRIVERS["motors", name]
    settings = {setting.key: setting.default for setting in driver.settings}
    used_pins = {*chip.link_pins, 11, 13, robot.board.start_button}
    pins = {}
    for key, ability, _, fixed_number, _ in driver.pins:
        if fixed_number is None:
            usable_pins = (
                pin
                for pin in sorted(chip.digital_pins)
                if chip.has_ability(pin, ability) and pin not in used_pins
            )
            pins[key] = next(usable_pins)
            used_pins.add(pins[key])
        elif driver.choosing_key(key, settings):
            pins[key] = fixed_number
    return Wiring(name, pins, settings)


def flash_with(name: str, project: Path, environment: str = ENVIRONMENT) -> int:
    """Return the bytes of the firmware of a tinibot with these motors."""
    tinibot = robots.load("tinibot")
    *lights, distance = tinibot.board.sensors
    sensors = (*lights, distance._replace(pins=SHIELD_SENSOR_PINS))
    motors = motor_wiring(name, tinibot)
    board = tinibot.board._replace(motors=motors, sensors=sensors, bluetooth_state=None)
    changed_robot = tinibot._replace(board=board)
    header_path = project / "src" / "boards" / "kits" / "own.h"
    header_path.write_text(firmware.header([changed_robot], "a benchmark."), encoding="utf-8")
    return measure(environment, project).flash


def main() -> int:
    rows = []
    with tempfile.TemporaryDirectory() as name:
        project = Path(name) / "vm_arduino"
        shutil.copytree(PROJECT, project, ignore=shutil.ignore_patterns(".pio", "own.h"))
        first_flash = 0
        for driver in DRIVERS_IN_ORDER:
            try:
                flash, note = flash_with(driver, project), ""
            except RuntimeError as error:
                if "greater than maximum allowed" not in str(error):
                    print(error, file=sys.stderr)
                    return 2
                smaller_environment, _ = building.SMALLER_FIRMWARE[ENVIRONMENT]
                flash = flash_with(driver, project, smaller_environment)
                note = "without tasks"
            first_flash = first_flash or flash
            difference_text = f"{flash - first_flash:+,}" if not note else ""
            rows.append([f"`{driver}`", f"{flash:,}", difference_text, note])
    page.show("driver_size", rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
