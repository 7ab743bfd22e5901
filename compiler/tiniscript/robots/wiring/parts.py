"""The parts of a robot as a person buys them: what its drivers say, and what every robot has.

Knows no robot's pins (`plan`), no places (`layout`) and no sentences (`texts`).
"""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    BOARD_3V3,
    BOARD_5V,
    FIVE_VOLTS,
    GROUND,
    MOTOR_BATTERY,
    SERVO_SUPPLY,
    Shape,
    Terminal,
)
from tiniscript.robots.drivers import driver_of
from tiniscript.robots.profile import Place, Wiring
from tiniscript.robots.wiring.texts import has_text

BOARD_RAILS = (BOARD_5V, BOARD_3V3, GROUND)
RAILS = (BOARD_5V, BOARD_3V3, GROUND, MOTOR_BATTERY, SERVO_SUPPLY)


def shape_of(used_by: str, wiring: Wiring, device: Device | None = None,
             place: Place | None = None, pin_volts: int = FIVE_VOLTS) -> Shape:  # fmt: skip
    """Return what a wiring's part looks like. Raises LookupError for an unknown driver."""
    sees = place.sees if place else ""
    shape = driver_of(used_by, wiring).shape(wiring, device, sees, pin_volts)
    return shape if pin_volts == FIVE_VOLTS else _at_3v3(shape)


def _at_3v3(shape: Shape) -> Shape:
    """Return a part as it is joined to a board whose pins have 3.3 V.

    It gets 3.3 V, so that nothing else comes back; what needs 5 V gets them, and a divider where
    it answers with them: its middle is the pin.
    """
    if shape.needs_5v:
        ends = (
            each._replace(to_ground="2 kΩ", beyond="1 kΩ") if each.pin_key == "echo" else each
            for each in shape.terminals
        )
    else:
        ends = (
            each._replace(rail=BOARD_3V3) if each.rail == BOARD_5V else each
            for each in shape.terminals
        )
    notes = tuple(of_3v3(note) for note in shape.notes)
    return shape._replace(need=of_3v3(shape.need), terminals=tuple(ends), notes=notes)


def of_3v3(key: str) -> str:
    """Return the key of what is said of a part on such a board, where that differs."""
    return f"{key}_3v3" if has_text(f"{key}_3v3") else key


# -- what every robot has

BUZZER = Shape(
    "buzzer",
    "need_buzzer",
    (Terminal("plus", "pin", series="220 Ω"), Terminal("minus", rail=GROUND)),
)
BLUETOOTH = Shape(
    "bluetooth",
    "need_bluetooth",
    (
        Terminal("STATE", "state"),
        Terminal("RXD", "tx", series="1 kΩ", to_ground="2 kΩ"),
        Terminal("TXD", "rx"),
        Terminal("GND", rail=GROUND),
        Terminal("VCC", rail=BOARD_5V),
        Terminal("EN"),
    ),
    "HC-05",
)
BATTERY_OF_MOTORS = Shape(
    "battery",
    "need_battery",
    (Terminal("plus", rail=MOTOR_BATTERY), Terminal("minus", rail=GROUND)),
)
SUPPLY_OF_SERVOS = Shape(
    "battery",
    "need_servo_supply",
    (Terminal("plus", rail=SERVO_SUPPLY), Terminal("minus", rail=GROUND)),
)
