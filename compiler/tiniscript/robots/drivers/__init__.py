"""The drivers, with all that is known of each. `robots/driver.py` says what that is."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from tiniscript.robots.driver import ActuatorDriver, DiscDriver, Driver, MotorDriver, SensorDriver
from tiniscript.robots.drivers import actuators, discs, motors, sensors
from tiniscript.robots.profile import Wiring

# By the table and kind of [board] that uses each.
DRIVERS: dict[tuple[str, str], Driver] = {
    (driver.used_by, driver.name): driver
    for driver in (*motors.DRIVERS, *discs.DRIVERS, *sensors.DRIVERS, *actuators.DRIVERS)
}
D = TypeVar("D", bound=Driver)


def drivers_for(used_by: str) -> tuple[str, ...]:
    """Return the names of the drivers that fit, `("analog", "hc_sr04")`."""
    return tuple(name for use, name in DRIVERS if use == used_by)


def _of(drivers: Iterable[D], used_by: str, wiring: Wiring) -> D:
    """Return the driver of a wiring. Raises LookupError where there is none."""
    for each in drivers:
        if (each.used_by, each.name) == (used_by, wiring.driver):
            return each
    raise LookupError(f"robots/drivers has no driver {wiring.driver} for {used_by}")


def driver_of(used_by: str, wiring: Wiring) -> Driver:
    return _of(DRIVERS.values(), used_by, wiring)


def motors_of(wiring: Wiring) -> MotorDriver:
    return _of(motors.DRIVERS, "motors", wiring)


def discs_of(wiring: Wiring) -> DiscDriver:
    return _of(discs.DRIVERS, "discs", wiring)


def sensor_of(kind: str, wiring: Wiring) -> SensorDriver:
    return _of(sensors.DRIVERS, f"sensors {kind}", wiring)


def actuator_of(kind: str, wiring: Wiring) -> ActuatorDriver:
    return _of(actuators.DRIVERS, f"actuators {kind}", wiring)
