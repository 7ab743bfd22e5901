"""The driver of a robot's part: pins, firmware, sketch, wiring, sentences.

It knows what every driver must provide; the drivers themselves are the files of `drivers/`. Knows
no robot: `board_reader` asks for a driver's pins and settings, `firmware` for its C++, the sketch
for its lines, and the wiring page for its looks.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, NamedTuple, Protocol

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.ports import ESP32S
from tiniscript.robots.profile import Robot, Wiring

SIDES = ("left", "right")
DIRECTIONS = ("forward", "backward")
AT_STOP = "at_stop"  # action of a servo at a stop; other actuators are turned off
HOLD_CHOICE = 1
FULL_COUNT = 1023  # reading of the A/D converter at the highest voltage

# Rails: all that is joined to one of them is joined together.
BOARD_5V, BOARD_3V3, GROUND, MOTOR_BATTERY, SERVO_SUPPLY = "5V", "3V3", "GND", "M+", "S+"
PULL_DOWN = "10 kΩ"
FIVE_VOLTS = 5 * ONE


class PinKey(NamedTuple):
    """A pin of a driver. `fixed_number` is its number where a shield decides it, and no profile
    says it.

    People see a fixed pin as `name`: the label on the shield.
    """

    key: str
    ability: str
    is_optional: bool = False
    fixed_number: int | None = None
    name: str = ""


class Setting(NamedTuple):
    """`kind` is `yes/no`, `whole`, `number` (in thousandths) or `choice`.

    A choice is the index of its word in `words`.
    """

    key: str
    kind: str
    default: int = 0
    low: int = 0
    high: int = 1
    words: tuple[str, ...] = ()


class Terminal(NamedTuple):
    """A terminal of a part: its printed name, a rail, or a key of `wiring.texts`.

    It goes to the pin that `pin_key` of the profile names, or to a rail, or it stays free. Between
    the pin and the terminal, there may be a resistor `series_resistor`, then `ground_resistor`,
    then `far_resistor`.
    """

    name: str
    pin_key: str = ""
    rail: str = ""
    series_resistor: str = ""
    ground_resistor: str = ""
    far_resistor: str = ""


class Shape(NamedTuple):
    """The form of a part: its icon, the key of its shopping entry, its terminals from the top.

    `need_key` is empty where resistors are all. `model` is printed in its title. `motor_terminals`
    are the terminals of the left and the right motor; `note_keys` are keys of notes, `check_keys`
    of checks before switching on. `power_key` is the key of which battery suits it.
    """

    icon: str
    need_key: str
    terminals: tuple[Terminal, ...]
    model: str = ""
    motor_terminals: tuple[str, ...] = ()
    note_keys: tuple[str, ...] = ()
    check_keys: tuple[str, ...] = ()
    power_key: str = ""
    needs_5v: bool = False


class PinTexts(Protocol):
    """The pins of one robot; each text names an object of C++."""

    interrupt_vectors: list[str]  # names of interrupts, for the handlers
    counter_vectors: list[str]  # interrupt vectors of the discs, left and right

    def pin(self, pin: int | None) -> str: ...

    def pwm(self, pin: int) -> str: ...

    def servo(self, pin: int) -> str: ...

    def buzzer(self, pin: int | None) -> str: ...

    def echo(self, pin: int) -> str: ...

    def count(self, pin: int) -> str: ...


class HeaderPart:
    """The drivers' additions to a robot's header, for one chip."""

    def __init__(self, robot: Robot, pins: PinTexts) -> None:
        self.robot = robot
        self.pins = pins
        self.servo_pins: list[int] = []
        self.ultrasonic_texts: list[str] = []
        self.analog_count = 0  # channels up to the last one that is read
        self.off_lines: list[str] = []  # lines that a stop runs for actuators
        self.begin_lines: list[str] = []

    @property
    def is_esp32(self) -> bool:
        return self.robot.board.chip in ESP32S

    def analog_read(self, wiring: Wiring) -> str:
        """Return the line that puts the converter's count into `*value`."""
        channel = wiring.pins["pin"] - (CHIPS[self.robot.board.chip].first_analog or 0)
        self.analog_count = max(self.analog_count, channel + 1)
        return f"      if (!analog_read({channel}, value)) return false;"

    @staticmethod
    def map_to_range(device: Device, start_value: int, end_value: int) -> str:
        """Return `value` as the part of `start_value` to `end_value` that it is of an actuator's
        range."""
        low, high = device.low // ONE, device.high // ONE
        return f"map_to_range(value, {low}, {high}, {start_value}, {end_value})"


class DriverPlan:
    """The drivers' additions to a sketch: lines in which `$words` are replaced by names."""

    def __init__(self, robot: Robot, is_exact: bool) -> None:
        self.robot = robot
        self.is_exact = is_exact
        self.constant_lines: list[str] = []  # pins, and comments
        self.begin_lines: list[str] = []
        self.off_lines: list[str] = []  # code that a stop runs, besides the motors'
        self.servo_pins: list[str] = []

    def pin(self, name: str, number: int, mode: str = "", comment: str = "") -> str:
        """Add a pin, and return its name."""
        comment_text = f"  // {comment}" if comment else ""
        text = CHIPS[self.robot.board.chip].pin_name(number)
        self.constant_lines.append(f"const int {name} = {text};{comment_text}")
        if mode:
            self.begin_lines.append(f"pinMode({name}, {mode});")
        return name

    def servo(self, pin: str) -> int:
        self.servo_pins.append(pin)
        return len(self.servo_pins) - 1

    def value(self, thousandths: str) -> str:
        return f"$exactly({thousandths})" if self.is_exact else f"({thousandths}) / 1000.0"

    @staticmethod
    def part_of(device: Device, start_value: int, end_value: int) -> str:
        """Return `value` as the part of `start_value` to `end_value` that it is of an actuator's
        range."""
        low, high = device.low // ONE, device.high // ONE
        return f"$part_of(value, {low}, {high}, {start_value}, {end_value})"


class Driver(ABC):
    """`used_by` is the table of [board] and the kind of the device: `sensors number`.

    `profile_help` tells the author of a profile its keys: `tinibot.toml` lists them.

    `fixed_shape` is its shape, where that is always the same; the catalogue `wiring` has the
    sentences by the keys that its shape has.
    """

    name: ClassVar[str]
    used_by: ClassVar[str]
    profile_help: ClassVar[str]
    pins: ClassVar[tuple[PinKey, ...]]
    settings: ClassVar[tuple[Setting, ...]] = ()
    fixed_shape: ClassVar[Shape]

    def choosing_key(self, key: str, settings: Mapping[str, int]) -> str:
        """Return the key of the profile that makes it use a fixed pin, or an empty text if none
        does."""
        return "driver"

    def shape(
        self, wiring: Wiring, device: Device | None, sensed_kind: str, pin_volts: int
    ) -> Shape:
        """Return the form of the part; `sensed_kind` is that of its place in the robot's body."""
        return self.fixed_shape


class MotorDriver(Driver):
    """Drives both motors. `module` is the firmware's, `drive` the sketch's `$drive_motor`."""

    used_by = "motors"
    module: ClassVar[str]
    drive: ClassVar[str]

    @abstractmethod
    def firmware_lines(self, part: HeaderPart, wiring: Wiring) -> list[str]:
        """Return the constants of both motors in the robot's header."""

    @abstractmethod
    def sketch_lines(self, plan: DriverPlan, wiring: Wiring) -> list[str]:
        """Return the lines of a sketch that drive both motors, by `left` and `right`."""


class DiscDriver(Driver):
    """A slotted disc on each wheel, whose edges are counted. `has_two_channels`: channels, and a
    direction.

    The wheels are as far apart as the robot's body says.
    """

    used_by = "discs"
    pins: ClassVar[tuple[PinKey, ...]] = (PinKey("left", "count"), PinKey("right", "count"))
    settings = (
        Setting("holes", "whole", 20, 8, 60),
        Setting("wheel_cm", "number", 6_500, 3 * ONE, 30 * ONE),  # the diameter
    )
    has_two_channels: ClassVar[bool] = False

    def edges(self, wiring: Wiring, wheel_base_cm: float) -> tuple[int, int]:
        """Return a wheel's distance between edges, and the robot's rotation: 64ths of
        thousandths.
        """
        wheel_step = math.pi * wiring.settings["wheel_cm"] / (2 * wiring.settings["holes"]) * 64
        return round(wheel_step), round(wheel_step * 360 / (math.pi * wheel_base_cm))

    def firmware_lines(self, part: HeaderPart, wiring: Wiring, wheel_base_cm: float) -> list[str]:
        """Return the constants of both discs in the robot's header."""
        cm, degrees = self.edges(wiring, wheel_base_cm)
        lines = [
            f"constexpr Discs kDiscs = {{{cm}, {degrees}, {str(self.has_two_channels).lower()}}};"
        ]
        for side in SIDES:
            second_pin = part.pins.pin(wiring.pins.get(f"{side}_b"))
            count_pin = part.pins.count(wiring.pins[side])
            lines.append(
                f"constexpr Disc k{side.capitalize()}Disc = {{{count_pin}, {second_pin}}};"
            )
        return lines


class SensorDriver(Driver):
    @abstractmethod
    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        """Return the lines that put a reading into `*value` and return whether there was one.

        For a number, `*value` holds thousandths, and meanwhile the converter's count.
        """

    @abstractmethod
    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, name: str, comment: str
    ) -> list[str]:
        """Return the lines of a sketch that put a reading into `name`."""

    def is_count(self, device: Device, wiring: Wiring) -> bool:
        """Return whether a reading is the converter's raw count."""
        return False


class ActuatorDriver(Driver):
    @abstractmethod
    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        """Return the lines that set it to `value`."""

    @abstractmethod
    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, function: str, comment: str
    ) -> str:
        """Return the function of a sketch that sets it."""


# -- shared by several drivers


def limit_lines(device: Device, low: int, high: int) -> list[str]:
    """Return the line that keeps values from `low` to `high` in the device's range."""
    if device.low <= low and high <= device.high:
        return []
    return [f"      *value = in_limits(*value, {device.low}, {device.high});"]


def module_shape(output: str, need_key: str, *notes: str) -> Shape:
    """Return the shape of a sensor on a small board with three pins."""
    terminals = (
        Terminal("VCC", rail=BOARD_5V),
        Terminal(output, "pin"),
        Terminal("GND", rail=GROUND),
    )
    return Shape("module", need_key, terminals, note_keys=notes)


def photoresistor_shape() -> Shape:
    terminals = (
        Terminal("leg_1", rail=BOARD_5V),
        Terminal("leg_2", "pin", ground_resistor=PULL_DOWN),
    )
    return Shape("light", "need_light", terminals, note_keys=("mind_light",))


def switch_shape() -> Shape:
    return Shape(
        "switch", "need_switch", (Terminal("leg_1", "pin"), Terminal("leg_2", rail=GROUND))
    )


def lamp_shape(is_lit_by_low: bool) -> Shape:
    """Return the shape of an LED, which shines while its pin is high, or low."""
    if is_lit_by_low:
        terminals = (
            Terminal("long_leg", rail=BOARD_5V),
            Terminal("short_leg", "pin", series_resistor="220 Ω"),
        )
    else:
        terminals = (
            Terminal("long_leg", "pin", series_resistor="220 Ω"),
            Terminal("short_leg", rail=GROUND),
        )
    return Shape("lamp", "need_lamp", terminals, note_keys=("mind_lamp",))


class Bridge(MotorDriver):
    """A chip that takes PWM and two directions for each motor."""

    module = "motors_bridge"
    profile_help = "left_pwm, left_forward, left_backward and the same for right"
    keys: ClassVar[tuple[str, ...]] = ("pwm", *DIRECTIONS)  # keys of each side
    pins = tuple(
        PinKey(f"{side}_{key}", need)
        for side in SIDES
        for key, need in (("pwm", "pwm"), ("forward", "output"), ("backward", "output"))
    )
    drive = """\
void $drive_motor(int pwmPin, int forwardPin, int backwardPin, int percent) {
  digitalWrite(forwardPin, percent > 0 ? HIGH : LOW);
  digitalWrite(backwardPin, percent < 0 ? HIGH : LOW);
  analogWrite(pwmPin, abs(percent) * 255L / 100);
}"""

    def firmware_lines(self, part: HeaderPart, wiring: Wiring) -> list[str]:
        lines = []
        for side in SIDES:
            pwm = part.pins.pwm(wiring.pins[f"{side}_pwm"])
            forward, backward = (
                part.pins.pin(wiring.pins.get(f"{side}_{direction}")) for direction in DIRECTIONS
            )
            lines.append(f"constexpr Bridge k{side.capitalize()}Motor =")
            lines.append(f"    {{{pwm}, {forward}, {backward}}};")
        standby = part.pins.pin(wiring.pins.get("standby"))
        return [*lines, f"constexpr Pin kStandby = {standby};"]

    def sketch_lines(self, plan: DriverPlan, wiring: Wiring) -> list[str]:
        lines = [motor_line(plan, wiring, side, self.keys) for side in SIDES]
        if "standby" in wiring.pins:
            plan.pin("$STANDBY_$PIN", wiring.pins["standby"], "OUTPUT")
            standby_level = "left != 0 || right != 0 ? HIGH : LOW"
            lines.insert(0, f"  digitalWrite($STANDBY_$PIN, {standby_level});")
        return lines


def motor_line(plan: DriverPlan, wiring: Wiring, side: str, keys: tuple[str, ...]) -> str:
    """Return the line of a sketch that drives one motor by pins with these keys."""
    names = [
        plan.pin(f"${side.upper()}_${key.upper()}_$PIN", wiring.pins[f"{side}_{key}"], "OUTPUT")
        for key in keys
    ]
    return f"  $drive_motor({', '.join(names)}, {side});"
