"""The shield HW-130, "Motor Shield V1": four motors on two L293Ds, directions in a 74HC595.

The pins that it uses, and the bits of the 74HC595 for each input of an L293D, are from the
schematic and the header AFMotor.h of Adafruit's Motor Shield, of which it is a copy.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    GROUND,
    MOTOR_BATTERY,
    SIDES,
    DriverPlan,
    HeaderPart,
    MotorDriver,
    PinKey,
    Setting,
    Shape,
    Terminal,
)
from tiniscript.robots.profile import Wiring


class Channel(NamedTuple):
    """A motor of the shield: its PWM pin, and the bits that turn it forward and backward."""

    pwm: int
    forward: int
    backward: int


CHANNELS = {
    "M1": Channel(11, 2, 3),
    "M2": Channel(3, 1, 4),
    "M3": Channel(6, 5, 7),
    "M4": Channel(5, 0, 6),
}
NAMES = tuple(CHANNELS)
# A side of the robot has one motor or two.
CHOICES = (*NAMES, *(f"{a} {b}" for k, a in enumerate(NAMES) for b in NAMES[k + 1 :]))
REGISTER = {"latch": 12, "enable": 7, "data": 8, "clock": 4}


class Hw130(MotorDriver):
    name = "hw130"
    profile_help = (
        'left, right: one motor of M1 to M4, or two, "M1 M2" (M3 and M4); the shield has pins 4, '
        "7, 8 and 12, and of its motors M1 11, M2 3, M3 6, M4 5"
    )
    module = "motors_shift_register"
    pins = (
        *(
            PinKey(key, "output", fixed_number=pin, name=key.upper())
            for key, pin in REGISTER.items()
        ),
        *(
            PinKey(f"{side}_{name.lower()}", "pwm", True, channel.pwm, name)
            for side in SIDES
            for name, channel in CHANNELS.items()
        ),
    )
    settings = (
        *(
            Setting(side, "choice", CHOICES.index(motor), high=len(CHOICES) - 1, words=CHOICES)
            for side, motor in zip(SIDES, ("M3", "M4"), strict=True)
        ),
    )
    drive = """\
void $drive_motor(int pwmPin, int percent) {
  analogWrite(pwmPin, abs(percent) * 255L / 100);
}"""

    def choosing_key(self, key: str, settings: Mapping[str, int]) -> str:
        if key in REGISTER:
            return "driver"
        side, _, motor = key.partition("_")
        return side if motor.upper() in _motors_of_side(side, settings) else ""

    def firmware_lines(self, part: HeaderPart, wiring: Wiring) -> list[str]:
        pins = ", ".join(part.pins.pin(wiring.pins[key]) for key in REGISTER)
        lines = [f"constexpr ShiftRegister kDirections = {{{pins}}};"]
        for side in SIDES:
            motors = _motors_of_side(side, wiring.settings)
            pwms = [part.pins.pwm(CHANNELS[motor].pwm) for motor in motors]
            pwms += ["kNoPwm"] * (2 - len(pwms))
            bits = ", ".join(f"0x{bits:02x}" for bits in _bits(motors))
            lines.append(f"constexpr ShieldMotors k{side.capitalize()}Motor =")
            lines.append(f"    {{{', '.join(pwms)}, {bits}}};")
        return lines

    def sketch_lines(self, plan: DriverPlan, wiring: Wiring) -> list[str]:
        names = {key: plan.pin(f"$SHIELD_{key.upper()}_$PIN", wiring.pins[key], "OUTPUT")
                 for key in REGISTER}  # fmt: skip
        direction_terms, lines = [], []
        for side in SIDES:
            motors = _motors_of_side(side, wiring.settings)
            forward, backward = (f"0x{bits:02x}" for bits in _bits(motors))
            direction_terms.append(f"({side} < 0 ? {backward} : {forward})")
            for motor in motors:
                pwm = plan.pin(f"{motor}_$PIN", CHANNELS[motor].pwm, "OUTPUT")
                lines.append(f"  $drive_motor({pwm}, {side});")
        return [
            f"  digitalWrite({names['latch']}, LOW);",
            f"  shiftOut({names['data']}, {names['clock']}, MSBFIRST, {' | '.join(direction_terms)});",
            f"  digitalWrite({names['latch']}, HIGH);",
            *lines,
        ]

    def shape(
        self, wiring: Wiring, device: Device | None, sensed_kind: str, pin_volts: int
    ) -> Shape:
        wired_pins = [pin for pin in self.pins if pin.key in wiring.pins]
        return Shape(
            "bridge",
            "need_hw130",
            (
                *(Terminal(pin.name, pin.key) for pin in wired_pins),
                Terminal("EXT_PWR +M", rail=MOTOR_BATTERY),
                Terminal("EXT_PWR GND", rail=GROUND),
            ),
            "L293D",
            tuple(", ".join(_motors_of_side(side, wiring.settings)) for side in SIDES),
            ("mind_hw130", "mind_hw130_power"),
            ("check_hw130",),
            power_key="power_volts_bridge",
        )


def _motors_of_side(side: str, settings: Mapping[str, int]) -> list[str]:
    """Return the motors of a side, `["M1", "M2"]`."""
    return CHOICES[settings[side]].split()


def _bits(motors: list[str]) -> tuple[int, int]:
    """Return the bits of the 74HC595 that turn these motors forward, and backward."""
    return (
        sum(1 << CHANNELS[motor].forward for motor in motors),
        sum(1 << CHANNELS[motor].backward for motor in motors),
    )


DRIVER = Hw130()
