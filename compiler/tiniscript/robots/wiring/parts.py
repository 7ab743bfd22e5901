"""The parts of a robot for a buyer: those of its drivers, and those of every robot.

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
    """Return the form of a wiring's part. Raises LookupError for an unknown driver."""
    sensed_kind = place.sees if place else ""
    shape = driver_of(used_by, wiring).shape(wiring, device, sensed_kind, pin_volts)
    return shape if pin_volts == FIVE_VOLTS else _adapt_to_3v3(shape)


def _adapt_to_3v3(shape: Shape) -> Shape:
    """Return a part as it is joined to a board whose pins have 3.3 V.

    A part gets 3.3 V, so that no higher voltage comes back. A part that needs 5 V gets 5 V, and a
    divider if it answers with 5 V: the pin is at its middle.
    """
    if shape.needs_5v:
        terminals = (
            terminal._replace(ground_resistor="2 kΩ", far_resistor="1 kΩ")
            if terminal.pin_key == "echo"
            else terminal
            for terminal in shape.terminals
        )
    else:
        terminals = (
            terminal._replace(rail=BOARD_3V3) if terminal.rail == BOARD_5V else terminal
            for terminal in shape.terminals
        )
    notes = tuple(key_for_3v3(note) for note in shape.note_keys)
    return shape._replace(
        need_key=key_for_3v3(shape.need_key), terminals=tuple(terminals), note_keys=notes
    )


def key_for_3v3(key: str) -> str:
    """Return the key of the sentence about a part on such a board, if that differs."""
    return f"{key}_3v3" if has_text(f"{key}_3v3") else key


# -- what every robot has

BUZZER = Shape(
    "buzzer",
    "need_buzzer",
    (Terminal("plus", "pin", series_resistor="220 Ω"), Terminal("minus", rail=GROUND)),
)
BLUETOOTH = Shape(
    "bluetooth",
    "need_bluetooth",
    (
        Terminal("STATE", "state"),
        Terminal("RXD", "tx", series_resistor="1 kΩ", ground_resistor="2 kΩ"),
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


_WAVE_PATH = '<path d="M-12,0 l4,-7 l6,14 l6,-14 l4,7" fill="none"/>'

ICONS = {
    "bridge": '<rect x="-17" y="-17" width="34" height="34" rx="2"/>'
    '<path d="M-9,-17 v12 M-3,-17 v12 M3,-17 v12 M9,-17 v12" fill="none"/>'
    '<circle cx="0" cy="7" r="5"/>',
    "servo": '<rect x="-22" y="-8" width="34" height="22" rx="2"/>'
    '<circle cx="2" cy="-8" r="6"/><rect x="-1" y="-17" width="25" height="6" rx="3"/>',
    "light": '<circle cx="2" cy="5" r="13"/><g transform="translate(2 5) scale(0.8)">'
    f"{_WAVE_PATH}</g>"
    '<path d="M-24,-16 l10,8 m-6,0 h6 v-6 M-10,-19 l8,9 m-6,-1 l6,1 l0,-6" fill="none"/>',
    "module": '<rect x="-22" y="-13" width="44" height="26" rx="2"/>'
    '<circle cx="-10" cy="0" r="6"/><rect x="2" y="-6" width="12" height="12"/>',
    "voltage": '<rect x="-5" y="-18" width="10" height="14"/><rect x="-5" y="4" width="10" '
    'height="14"/><path d="M0,-4 v8 M0,0 h14" fill="none"/>',
    "sonar": '<rect x="-24" y="-13" width="48" height="26" rx="2"/>'
    '<circle cx="-12" cy="0" r="9"/><circle cx="12" cy="0" r="9"/>'
    '<circle cx="-12" cy="0" r="3"/><circle cx="12" cy="0" r="3"/>',
    "switch": '<rect x="-16" y="-6" width="32" height="18" rx="2"/>'
    '<rect x="-8" y="-14" width="16" height="8"/>'
    '<path d="M-16,3 h-8 M16,3 h8" fill="none"/>',
    "lamp": '<path d="M-12,-11 v22 l20,-11 z M8,-11 v22 M-20,0 h8 M8,0 h10" />'
    '<path d="M8,-13 l8,-5 m-5,0 h5 v5" fill="none"/>',
    "disc": '<circle cx="0" cy="0" r="17"/><circle cx="0" cy="0" r="11" stroke-dasharray="4 3"/>'
    '<circle cx="0" cy="0" r="3"/>',
    "buzzer": '<circle cx="0" cy="0" r="16"/><circle cx="0" cy="0" r="4"/>'
    '<path d="M-12,-7 h6 M-9,-10 v6" fill="none"/>',
    "bluetooth": '<rect x="-15" y="-17" width="30" height="34" rx="2"/>'
    '<path d="M-10,-11 h6 v5 h5 v-5 h5 v5 h4" fill="none"/>'
    '<rect x="-9" y="0" width="18" height="11"/>',
    "battery": '<rect x="-22" y="-10" width="40" height="20" rx="3"/>'
    '<rect x="18" y="-4" width="4" height="8"/>'
    '<path d="M8,-4 v8 M4,0 h8 M-16,0 h8" fill="none"/>',
}
