"""Makes the plan of a robot: its parts, and every wire between them and the board, numbered.

Knows which pin is joined to which terminal. Does not know where things are drawn (`layout`). Text
from a profile is cut to a maximum length here; the code that writes it must escape it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.robots.boards import CHIPS, Chip
from tiniscript.robots.driver import (
    FIVE_VOLTS,
    MOTOR_BATTERY,
    SERVO_SUPPLY,
    Shape,
    Terminal,
    lamp_shape,
    switch_shape,
)
from tiniscript.robots.profile import Body, Robot
from tiniscript.robots.wiring import parts
from tiniscript.robots.wiring.texts import text

RECEIVE_PIN, TRANSMIT_PIN = 0, 1  # pins of an AVR's serial port
LAMP_PIN = 13  # an AVR board has a lamp on this pin, called L
COLOURS = ("orange", "green", "blue", "violet", "yellow", "grey", "brown")


class Wire(NamedTuple):
    """A wire from a pin of the board. `number` begins at 1, `colour` is one of COLOURS."""

    number: int
    colour: str
    pin: int
    pin_name: str


class End(NamedTuple):
    """A terminal of a part, and what comes to it: a wire, a rail, or neither."""

    name: str
    wire: Wire | None
    rail: str
    series_resistor: str
    ground_resistor: str
    far_resistor: str


class Part(NamedTuple):
    """A part. `title` is its name for people, `label` says more, or is empty.

    `is_device`: programs know it, and `title` is the word that they have for it.
    """

    title: str
    label: str
    is_device: bool
    shape: Shape
    ends: tuple[End, ...]


class Plan(NamedTuple):
    """All that is wired. `lamp` is the board's own lamp, if the robot uses it: no wire."""

    robot: str
    language: str
    chip: Chip
    baud: int
    parts: tuple[Part, ...]
    has_lamp: bool
    has_state: bool
    body: Body

    @property
    def has_radio(self) -> bool:
        """Return whether it has an HC-05; an ESP32 has its link on USB."""
        return self.chip.pin_volts == FIVE_VOLTS

    @property
    def wires(self) -> list[Wire]:
        return [end.wire for part in self.parts for end in part.ends if end.wire]

    @property
    def rails(self) -> list[str]:
        """The rails that are used, in the order of parts.RAILS."""
        used_rails = {end.rail for part in self.parts for end in part.ends}
        used_rails |= {end.name for part in self.parts for end in part.ends}
        return [rail for rail in parts.RAILS if rail in used_rails]

    @property
    def resistors(self) -> dict[str, int]:
        """Return the number of resistors of each value."""
        counts: dict[str, int] = {}
        for part in self.parts:
            for end in part.ends:
                for value in (end.series_resistor, end.ground_resistor, end.far_resistor):
                    if value:
                        counts[value] = counts.get(value, 0) + 1
        return dict(sorted(counts.items(), key=lambda item: _ohms(item[0])))


def _ohms(value: str) -> float:
    number, unit = value.split(" ")
    return float(number) * (1000 if unit == "kΩ" else 1)


class _WireCounter:
    """Numbers the wires, and gives neighbours different colours."""

    def __init__(self, chip: Chip, language: str) -> None:
        self._chip = chip
        self._language = language
        self._wire_count = 0

    def part(
        self, title: str, label: str, shape: Shape, pins: Mapping[str, int],
        is_device: bool = False,
    ) -> Part:  # fmt: skip
        ends = [self._end(terminal, pins) for terminal in shape.terminals]
        return Part(title, label, is_device, shape, tuple(ends))

    def _end(self, terminal: Terminal, pins: Mapping[str, int]) -> End:
        name, pin_key, *rail_and_resistors = terminal
        pin = pins.get(pin_key)
        wire = None
        if pin is not None:
            self._wire_count += 1
            colour = COLOURS[(self._wire_count - 1) % len(COLOURS)]
            wire = Wire(self._wire_count, colour, pin, self._chip.pin_name(pin))
        return End(text(f"terminal_{name}", self._language, name), wire, *rail_and_resistors)


def plan_of(robot: Robot, language: str) -> Plan:
    """Return the plan of a robot, in a language. The robot's chip is one that has firmware."""
    kit, board, body = robot.kit, robot.board, robot.body
    chip = CHIPS[board.chip]
    counter = _WireCounter(chip, language)

    def label_of(key: str) -> str:
        return text(key, language)

    wired_parts = []
    motor_shape = parts.shape_of("motors", board.motors, pin_volts=chip.pin_volts)
    title, label = motor_shape.model, label_of("part_motors")
    if not motor_shape.model:
        title, label = label_of("part_servos"), ""
    wired_parts.append(counter.part(title, label, motor_shape, board.motors.pins))
    if board.discs:
        disc_shape = parts.shape_of("discs", board.discs, pin_volts=chip.pin_volts)
        wired_parts.append(
            counter.part(disc_shape.model, label_of("part_discs"), disc_shape, board.discs.pins)
        )
    groups = (
        ("sensors", kit.sensors, board.sensors),
        ("actuators", kit.actuators, board.actuators),
    )
    for used_by, devices, wirings in groups:
        for device, wiring in zip(devices, wirings, strict=True):
            place = body.places.get(device.name)
            shape = parts.shape_of(
                f"{used_by} {device.kind}", wiring, device, place, chip.pin_volts
            )
            if any(terminal.rail == SERVO_SUPPLY for terminal in motor_shape.terminals):
                shape = _with_servo_supply(shape)
            label = robot.labels[language][device.name]
            label = "" if label == device.name else label
            wired_parts.append(counter.part(device.name, label, shape, wiring.pins, is_device=True))
    wired_parts.append(
        counter.part(label_of("part_button"), "SB", switch_shape(), {"pin": board.start_button})
    )
    if board.buzzer is not None:
        buzzer_pins = {"pin": board.buzzer}
        wired_parts.append(counter.part(label_of("part_buzzer"), "BEEP", parts.BUZZER, buzzer_pins))
    has_radio = chip.pin_volts == FIVE_VOLTS
    has_lamp = has_radio and board.status_led == LAMP_PIN
    if board.status_led is not None and not has_lamp:
        pin = {"pin": board.status_led}
        wired_parts.append(
            counter.part(label_of("part_lamp"), "", lamp_shape(is_lit_by_low=False), pin)
        )
    radio_pins = {"rx": RECEIVE_PIN, "tx": TRANSMIT_PIN}
    if board.bluetooth_state is not None:
        radio_pins["state"] = board.bluetooth_state
    if has_radio:
        wired_parts.append(counter.part("HC-05", "Bluetooth", parts.BLUETOOTH, radio_pins))
    rails = {end.rail for part in wired_parts for end in part.ends}
    rails |= {end.name for part in wired_parts for end in part.ends}
    for rail, key, supply in (
        (MOTOR_BATTERY, "part_battery", parts.BATTERY_OF_MOTORS),
        (SERVO_SUPPLY, "part_servo_supply", parts.SUPPLY_OF_SERVOS),
    ):
        if rail in rails:
            wired_parts.append(counter.part(label_of(key), label_of(f"{key}_volts"), supply, {}))
    return Plan(
        robot.labels[language]["robot"], language, chip, board.baud, tuple(wired_parts), has_lamp,
        board.bluetooth_state is not None, body,
    )  # fmt: skip


def _with_servo_supply(shape: Shape) -> Shape:
    """Driving servos share one supply: a battery sensor measures that supply."""
    terminals = (
        terminal._replace(name=SERVO_SUPPLY) if terminal.name == MOTOR_BATTERY else terminal
        for terminal in shape.terminals
    )
    return shape._replace(terminals=tuple(terminals))
