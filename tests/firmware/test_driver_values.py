"""Every driver has values: inputs at its pins change a reading, and settings change its pins.

This is checked on a simulated board, for each file of `robots/drivers/` that a device may have;
`test_board_devices.py` has the values. A driver with a new kind of pin has a row in FELT.
"""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from tests.machines.board import Board, simulates
from tests.support.board_states import START_MS, pulses, start_board
from tests.support.wired_robots import DEVICES, MOTORS, robot_with
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.driver import Driver, SensorDriver
from tiniscript.robots.profile import Wiring

SENSORS = [driver for driver in DEVICES if isinstance(driver, SensorDriver)]
ACTUATORS = [driver for driver in DEVICES if driver not in SENSORS]
ROBOT_WITH_ALL_DRIVERS = robot_with("l298n", DEVICES)
SHOW_PROGRAMS = {
    "number": "SI|M({0} * 10, 0);W(5)",
    "yes/no": "SI|IF({0});M(50, 0);ELSE;M(0, 0);ENDIF;W(5)",
}
SET_VALUES = {"number": ("0", "4"), "yes/no": ("FALSE", "TRUE")}  # values in a range up to 5
SET_MS = 500


def _set_analog(board: Board, wiring: Wiring, is_large: bool) -> None:
    channel = wiring.pins["pin"] - (CHIPS[board.board].first_analog or 0)
    board.set_analog(channel, 5000 if is_large else 0)


# The inputs of a sensor, small or large, by the use of its pin.
INPUTS_BY_ABILITY: dict[str, Callable[[Board, Wiring, bool], None]] = {
    "analog": _set_analog,
    "input": lambda board, wiring, is_large: board.set_level(0, wiring.pins["pin"], is_large),
    "echo": lambda board, wiring, is_large: board.set_echoes(
        wiring.pins["trigger"], wiring.pins["echo"], [5000 if is_large else 175]
    ),
}


def name_and_wiring(driver: Driver) -> tuple[str, Wiring]:
    """Return the name and the wiring of a driver's device."""
    board = ROBOT_WITH_ALL_DRIVERS.board
    wirings = board.sensors if isinstance(driver, SensorDriver) else board.actuators
    devices = (
        ROBOT_WITH_ALL_DRIVERS.kit.sensors
        if isinstance(driver, SensorDriver)
        else ROBOT_WITH_ALL_DRIVERS.kit.actuators
    )
    name = f"D{DEVICES.index(driver)}"
    return name, wirings[[device.name for device in devices].index(name)]


def names(drivers: list[Driver]) -> list[str]:
    return [f"{driver.used_by} {driver.name}" for driver in drivers]


@pytest.mark.parametrize("motors", MOTORS)
def test_every_driver_is_wired_to_simulated_pins(motors: str) -> None:
    """Therefore a new driver leaves the others the pins they need, wherever its name is in the
    list.
    """
    rng = random.Random(motors)
    for _ in range(20):
        devices = rng.sample(DEVICES * 2, len(DEVICES) * 2)
        board = robot_with(motors, devices).board
        for driver in devices:
            wirings = board.sensors if isinstance(driver, SensorDriver) else board.actuators
            for wiring in wirings:
                for pin in driver.pins if wiring.driver == driver.name else ():
                    assert simulates(board.chip, wiring.pins[pin.key], pin.ability), (pin, wiring)


@pytest.mark.sampled("driver", keep=2)
@pytest.mark.parametrize("driver", SENSORS, ids=names(list(SENSORS)))
def test_a_sensor_reads_its_simulated_input(driver: Driver) -> None:
    name, wiring = name_and_wiring(driver)
    readings = set()
    for is_large in (False, True):
        board = start_board(
            ROBOT_WITH_ALL_DRIVERS, SHOW_PROGRAMS[driver.used_by.split()[1]].format(name)
        )
        INPUTS_BY_ABILITY[driver.pins[-1].ability](board, wiring, is_large)
        readings.add(board.run_for(START_MS + 100).motors(START_MS + 95))
    assert len(readings) == 2, "its reading is the same whatever it feels"


@pytest.mark.sampled("driver")
@pytest.mark.parametrize("driver", ACTUATORS, ids=names(ACTUATORS))
def test_an_actuators_setting_appears_at_its_pins(driver: Driver) -> None:
    name, wiring = name_and_wiring(driver)
    low_value, high_value = SET_VALUES[driver.used_by.split()[1]]
    board = start_board(
        ROBOT_WITH_ALL_DRIVERS,
        f"SI|{name}({low_value});W({SET_MS / 1000});{name}({high_value});W(1)",
    )
    pins = wiring.pins.values()
    for pin in pins:
        board.watch(pin)
    board.run_for(START_MS + 2 * SET_MS)

    def pin_states(after_ms: float) -> list[tuple[str, list[int]]]:
        begins = START_MS + after_ms
        return [
            (
                "" if pulses(board, pin)[1:] else board.pin(pin, begins),
                [round(us) for ms, us in pulses(board, pin) if begins - 60 < ms < begins][:1],
            )
            for pin in pins
        ]

    assert pin_states(SET_MS - 20) != pin_states(2 * SET_MS - 20), (
        "its pins are the same whatever it is set to"
    )
