"""Robots with any drivers, wired to pins that are free."""

from __future__ import annotations

from tests.machines.board import simulates
from tests.support.texts import LANGUAGES
from tiniscript import robots
from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import NUMBER, Device, Kit
from tiniscript.robots.boards import ABILITIES, CHIPS, Chip
from tiniscript.robots.driver import Driver
from tiniscript.robots.drivers import DRIVERS
from tiniscript.robots.profile import Place, Robot, Wiring


def pins_of(robot: Robot) -> set[int]:
    """Return every pin that the robot's [board] names."""
    board = robot.board
    discs = [board.discs] if board.discs else []
    wirings = (board.motors, *discs, *board.sensors, *board.actuators)
    pins = {pin for wiring in wirings for pin in wiring.pins.values()}
    single = (board.start_button, board.buzzer, board.status_led, board.bluetooth_state)
    return pins | {pin for pin in single if pin is not None}


def wire_driver(driver: Driver, chip: Chip, used_pins: set[int], is_whole: bool = True) -> Wiring:
    """Wire a driver to the first pins that fit. `is_whole`: including optional parts.

    Pins that a simulated board has come first, and of these the pins that can do the least: they
    leave to each driver the pins that only it needs, in whatever order the drivers come.
    """
    pins = {}
    settings = {setting.key: setting.default for setting in driver.settings}
    for key, need, is_optional, fixed, _ in driver.pins:
        if fixed is not None:
            if driver.choosing_key(key, settings):
                pins[key] = fixed
                used_pins.add(fixed)
            continue
        if is_optional and not is_whole:
            continue
        free = [pin for pin in chip.digital_pins | chip.analog_pins if pin not in used_pins]
        pins[key] = min(
            (pin for pin in free if chip.has_ability(pin, need)),
            key=lambda pin: (
                not simulates(chip.name, pin, need),
                sum(chip.has_ability(pin, ability) for ability in ABILITIES),
                -pin % 7,  # all over the board
                pin,
            ),
        )
        used_pins.add(pins[key])
    return Wiring(driver.name, pins, settings)


def robot_with(motors: str, devices: list[Driver], chip_name: str = "mega", is_whole: bool = True,
               label: str = "something") -> Robot:  # fmt: skip
    """Return a robot that has these drivers, on pins all over its board."""
    chip, tinibot = CHIPS[chip_name], robots.load("tinibot")
    used_pins = {0, 1, 2, 11, 13}
    motors_wiring = wire_driver(DRIVERS["motors", motors], chip, used_pins, is_whole)
    parts: dict[str, list[tuple[Device, Wiring]]] = {"sensors": [], "actuators": []}
    for number, driver in enumerate(devices):
        table, kind = driver.used_by.split()
        device = Device(f"D{number}", kind, "", 0, 5 * ONE if kind == NUMBER else 1)
        parts[table].append((device, wire_driver(driver, chip, used_pins)))
    kit = Kit(
        tuple(device for device, _ in parts["sensors"]),
        tuple(device for device, _ in parts["actuators"]),
    )
    board = tinibot.board._replace(
        chip=chip_name,
        motors=motors_wiring,
        sensors=tuple(wiring for _, wiring in parts["sensors"]),
        actuators=tuple(wiring for _, wiring in parts["actuators"]),
        bluetooth_state=None,
        status_led=13,
    )
    names = list(kit.names)
    labels = {language: {"robot": label, **dict.fromkeys(names, label)} for language in LANGUAGES}
    body = tinibot.body._replace(places={"D0": Place(0, 0, 0, "light")})
    return Robot("many", kit, board, body, labels)


def with_discs(chip: str, name: str) -> Robot:
    """Return a robot with discs of a driver."""
    robot = robots.load("tinibot32" if chip == "esp32dev" else "tinibot2", chip)
    robot = robot._replace(board=robot.board._replace(discs=None))
    used_pins = set(pins_of(robot))
    return robot._replace(
        board=robot.board._replace(
            discs=wire_driver(DRIVERS["discs", name], CHIPS[chip], used_pins)
        )
    )


DEVICES = [driver for (used_by, _), driver in DRIVERS.items() if " " in used_by]
DISCS = [name for used_by, name in DRIVERS if used_by == "discs"]
MOTORS = [name for used_by, name in DRIVERS if used_by == "motors"]
