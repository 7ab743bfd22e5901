"""The drivers: each file describes one. `robots/driver.py` describes the content of such a file."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

from tiniscript.robots.driver import ActuatorDriver, DiscDriver, Driver, MotorDriver, SensorDriver
from tiniscript.robots.profile import Wiring


def _load() -> dict[tuple[str, str], Driver]:
    """Return the drivers of this folder, by the table and kind of [board] that uses them."""
    drivers: list[Driver] = [
        import_module(f"{__name__}.{module.name}").DRIVER for module in iter_modules(__path__)
    ]
    return {(driver.used_by, driver.name): driver for driver in drivers}


DRIVERS = _load()


def drivers_for(used_by: str) -> tuple[str, ...]:
    """Return the names of the drivers that fit, `("analog", "hc_sr04")`."""
    return tuple(name for use, name in DRIVERS if use == used_by)


def driver_of(used_by: str, wiring: Wiring) -> Driver:
    """Return the driver of a wiring. Raises LookupError if no file has it."""
    driver = DRIVERS.get((used_by, wiring.driver))
    if driver is None:
        raise LookupError(f"robots/drivers has no driver {wiring.driver} for {used_by}")
    return driver


def motors_of(wiring: Wiring) -> MotorDriver:
    """Return the driver of a robot's motors. Raises LookupError if no file has it."""
    driver = driver_of("motors", wiring)
    assert isinstance(driver, MotorDriver)
    return driver


def discs_of(wiring: Wiring) -> DiscDriver:
    """Return the driver of the discs on a robot's wheels. Raises LookupError if there is none."""
    driver = driver_of("discs", wiring)
    assert isinstance(driver, DiscDriver)
    return driver


def sensor_of(kind: str, wiring: Wiring) -> SensorDriver:
    """Return the driver of a sensor of a kind. Raises LookupError if no file has it."""
    driver = driver_of(f"sensors {kind}", wiring)
    assert isinstance(driver, SensorDriver)
    return driver


def actuator_of(kind: str, wiring: Wiring) -> ActuatorDriver:
    """Return the driver of an actuator of a kind. Raises LookupError if no file has it."""
    driver = driver_of(f"actuators {kind}", wiring)
    assert isinstance(driver, ActuatorDriver)
    return driver
