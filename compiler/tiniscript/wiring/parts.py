"""The parts of a robot as a person buys them: their terminals, and what each is joined to.

Every driver of `robots.boards` has its shape here. Knows no robot's pins (`plan`), no places
(`layout`) and no sentences (`texts`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from tiniscript.fixed_point import ONE
from tiniscript.kit import Device
from tiniscript.robots.profile import Place, Wiring
from tiniscript.wiring.texts import TEXTS

# Rails: all that is joined to one of them is joined together.
BOARD_5V, BOARD_3V3, GROUND, MOTOR_BATTERY, SERVO_SUPPLY = "5V", "3V3", "GND", "M+", "S+"
BOARD_RAILS = (BOARD_5V, BOARD_3V3, GROUND)
RAILS = (BOARD_5V, BOARD_3V3, GROUND, MOTOR_BATTERY, SERVO_SUPPLY)

PULL_DOWN = "10 kΩ"
NEEDS_5V = ("need_hc_sr04", "need_l293d")
FIVE_VOLTS = 5 * ONE


class Terminal(NamedTuple):
    """A terminal of a part: what is printed on it, a rail, or a key of `texts.TERMINALS`.

    It goes to the pin that `pin_key` of the profile names, or to a rail, or it stays free.
    Between the pin and the terminal may be a resistor `series`, then one `to_ground`, then one
    `beyond`.
    """

    name: str
    pin_key: str = ""
    rail: str = ""
    series: str = ""
    to_ground: str = ""
    beyond: str = ""


class Shape(NamedTuple):
    """What a part is: its icon, the key of what to buy, its terminals from top to bottom.

    `need` is empty where resistors are all. `model` is printed in its title. `motors` are the
    terminals of the left and the right motor; `notes` are keys of what to mind.
    """

    icon: str
    need: str
    terminals: tuple[Terminal, ...]
    model: str = ""
    motors: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def shape_of(used_by: str, wiring: Wiring, device: Device | None = None,
             place: Place | None = None, pin_volts: int = FIVE_VOLTS) -> Shape:  # fmt: skip
    """Return what stands for a driver of `boards.DRIVERS`; KeyError where nothing does."""
    sees = place.sees if place else ""
    if SHAPES[used_by, wiring.driver] is _analog:
        shape = _analog(wiring, device, sees, pin_volts)
    else:
        shape = SHAPES[used_by, wiring.driver](wiring, device, sees)
    return shape if pin_volts == FIVE_VOLTS else _at_3v3(shape)


def _at_3v3(shape: Shape) -> Shape:
    """Return a part as it is joined to a board whose pins have 3.3 V.

    It gets 3.3 V, so that nothing else comes back; what needs 5 V gets them, and a divider where
    it answers with them: its middle is the pin.
    """
    if shape.need in NEEDS_5V:
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
    return f"{key}_3v3" if f"{key}_3v3" in TEXTS else key


# -- motors


def _l298n(wiring: Wiring, *_: object) -> Shape:
    return Shape(
        "bridge",
        "need_l298n",
        (
            Terminal("ENA", "left_pwm", to_ground=PULL_DOWN),
            Terminal("IN1", "left_forward"),
            Terminal("IN2", "left_backward"),
            Terminal("IN3", "right_forward"),
            Terminal("IN4", "right_backward"),
            Terminal("ENB", "right_pwm", to_ground=PULL_DOWN),
            Terminal("+12V", rail=MOTOR_BATTERY),
            Terminal("GND", rail=GROUND),
            Terminal("5V"),
        ),
        "L298N",
        ("OUT1, OUT2", "OUT3, OUT4"),
        ("mind_l298n_enable", "mind_l298n_5v"),
    )


def _l293d(wiring: Wiring, *_: object) -> Shape:
    return Shape(
        "bridge",
        "need_l293d",
        (
            Terminal("EN1 (1)", "left_pwm", to_ground=PULL_DOWN),
            Terminal("IN1 (2)", "left_forward"),
            Terminal("IN2 (7)", "left_backward"),
            Terminal("IN3 (10)", "right_forward"),
            Terminal("IN4 (15)", "right_backward"),
            Terminal("EN2 (9)", "right_pwm", to_ground=PULL_DOWN),
            Terminal("VCC2 (8)", rail=MOTOR_BATTERY),
            Terminal("VCC1 (16)", rail=BOARD_5V),
            Terminal("GND (4 5 12 13)", rail=GROUND),
        ),
        "L293D",
        ("OUT (3), (6)", "OUT (11), (14)"),
        ("mind_l293d",),
    )


def _tb6612(wiring: Wiring, *_: object) -> Shape:
    has_standby = "standby" in wiring.pins
    enable = "" if has_standby else PULL_DOWN
    standby = (
        Terminal("STBY", "standby", to_ground=PULL_DOWN)
        if has_standby
        else Terminal("STBY", rail=BOARD_5V)
    )
    return Shape(
        "bridge",
        "need_tb6612",
        (
            Terminal("PWMA", "left_pwm", to_ground=enable),
            Terminal("AIN1", "left_forward"),
            Terminal("AIN2", "left_backward"),
            standby,
            Terminal("BIN1", "right_forward"),
            Terminal("BIN2", "right_backward"),
            Terminal("PWMB", "right_pwm", to_ground=enable),
            Terminal("VM", rail=MOTOR_BATTERY),
            Terminal("VCC", rail=BOARD_5V),
            Terminal("GND", rail=GROUND),
        ),
        "TB6612",
        ("AO1, AO2", "BO1, BO2"),
        ("mind_tb6612_standby" if has_standby else "mind_tb6612_no_standby", "mind_tb6612"),
    )


def _two_wire(wiring: Wiring, *_: object) -> Shape:
    return Shape(
        "bridge",
        "need_two_wire",
        (
            Terminal("IN1", "left_forward", to_ground=PULL_DOWN),
            Terminal("IN2", "left_backward", to_ground=PULL_DOWN),
            Terminal("IN3", "right_forward", to_ground=PULL_DOWN),
            Terminal("IN4", "right_backward", to_ground=PULL_DOWN),
            Terminal("VM", rail=MOTOR_BATTERY),
            Terminal("GND", rail=GROUND),
        ),
        "DRV8833, L9110S",
        ("OUT1, OUT2", "OUT3, OUT4"),
        ("mind_two_wire",),
    )


def _servos(wiring: Wiring, *_: object) -> Shape:
    return Shape(
        "servo",
        "need_servos",
        (
            Terminal("left_signal", "left_pin"),
            Terminal("left_plus", rail=SERVO_SUPPLY),
            Terminal("left_minus", rail=GROUND),
            Terminal("right_signal", "right_pin"),
            Terminal("right_plus", rail=SERVO_SUPPLY),
            Terminal("right_minus", rail=GROUND),
        ),
        notes=("mind_servo_supply", "mind_servos"),
    )


# -- sensors


def _light(pin: str) -> Shape:
    return Shape(
        "light",
        "need_light",
        (Terminal("leg_1", rail=BOARD_5V), Terminal("leg_2", pin, to_ground=PULL_DOWN)),
        notes=("mind_light",),
    )


def _module(output: str, need: str, notes: tuple[str, ...] = ()) -> Shape:
    terminals = (
        Terminal("VCC", rail=BOARD_5V),
        Terminal(output, "pin"),
        Terminal("GND", rail=GROUND),
    )
    return Shape("module", need, terminals, notes=notes)


def _analog(wiring: Wiring, device: Device | None, sees: str, pin_volts: int = FIVE_VOLTS) -> Shape:
    if sees == "light":
        return _light("pin")
    full = wiring.settings["full"]
    if device and device.unit == "V" and wiring.settings["zero"] == 0 and full > pin_volts:
        return _divided_voltage(device, full, pin_volts)
    return _module("OUT", "need_analog", ("mind_analog",))


def _divided_voltage(device: Device, full: int, pin_volts: int) -> Shape:
    """Two resistors: the lower one has what a pin takes when the whole has `full` thousandths."""
    upper = f"{10 * (full - pin_volts) / pin_volts:g} kΩ"
    is_battery = device.name.startswith(("BATTER", "BATER"))
    name = MOTOR_BATTERY if is_battery else "what_is_measured"
    source = Terminal(name, "pin", to_ground=PULL_DOWN, beyond=upper)
    return Shape("voltage", "", (source,), notes=("mind_voltage",))


def _hc_sr04(wiring: Wiring, *_: object) -> Shape:
    return Shape(
        "sonar",
        "need_hc_sr04",
        (
            Terminal("VCC", rail=BOARD_5V),
            Terminal("TRIG", "trigger"),
            Terminal("ECHO", "echo"),
            Terminal("GND", rail=GROUND),
        ),
        "HC-SR04",
        notes=("mind_hc_sr04",),
    )


def _digital_sensor(wiring: Wiring, device: Device | None, sees: str) -> Shape:
    if wiring.settings["pull_up"]:
        return SWITCH
    return _module("D0", "need_digital", ("mind_digital",))


def _threshold(wiring: Wiring, device: Device | None, sees: str) -> Shape:
    return _light("pin") if sees == "light" else _module("A0", "need_threshold")


# -- actuators


def _servo(wiring: Wiring, *_: object) -> Shape:
    return Shape(
        "servo",
        "need_servo",
        (
            Terminal("signal", "pin"),
            Terminal("plus", rail=SERVO_SUPPLY),
            Terminal("minus", rail=GROUND),
        ),
        notes=("mind_servo_supply",),
    )


def _lamp(wiring: Wiring, *_: object) -> Shape:
    if wiring.settings.get("yes_is_low"):
        terminals = (
            Terminal("long_leg", rail=BOARD_5V),
            Terminal("short_leg", "pin", series="220 Ω"),
        )
    else:
        terminals = (
            Terminal("long_leg", "pin", series="220 Ω"),
            Terminal("short_leg", rail=GROUND),
        )
    return Shape("lamp", "need_lamp", terminals, notes=("mind_lamp",))


# -- what every robot has

SWITCH = Shape(
    "switch",
    "need_switch",
    (Terminal("leg_1", "pin"), Terminal("leg_2", rail=GROUND)),
)
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

SHAPES: dict[tuple[str, str], Callable[[Wiring, Device | None, str], Shape]] = {
    ("motors", "l298n"): _l298n,
    ("motors", "l293d"): _l293d,
    ("motors", "tb6612"): _tb6612,
    ("motors", "two_wire"): _two_wire,
    ("motors", "servos"): _servos,
    ("sensors number", "analog"): _analog,
    ("sensors number", "hc_sr04"): _hc_sr04,
    ("sensors yes/no", "digital"): _digital_sensor,
    ("sensors yes/no", "threshold"): _threshold,
    ("actuators number", "servo"): _servo,
    ("actuators number", "pwm"): _lamp,
    ("actuators yes/no", "digital"): _lamp,
}
