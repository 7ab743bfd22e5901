"""The drivers of motors: one turns both wheels."""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    BOARD_5V,
    GROUND,
    MOTOR_BATTERY,
    PULL_DOWN,
    SERVO_SUPPLY,
    SIDES,
    WAYS,
    MotorDriver,
    Part,
    PinKey,
    Plan,
    Setting,
    Shape,
    Terminal,
)
from tiniscript.robots.profile import Wiring


class Bridge(MotorDriver):
    """A chip that takes PWM and two directions for each motor."""

    module = "motors_bridge"
    profile = "left_pwm, left_forward, left_backward and the same for right"
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

    def firmware(self, part: Part, wiring: Wiring) -> list[str]:
        lines = []
        for side in SIDES:
            pwm = part.pins.pwm(wiring.pins[f"{side}_pwm"])
            forward, backward = (part.pins.pin(wiring.pins[f"{side}_{way}"]) for way in WAYS)
            lines.append(f"constexpr Bridge k{side.capitalize()}Motor =")
            lines.append(f"    {{{pwm}, {forward}, {backward}}};")
        standby = part.pins.pin(wiring.pins.get("standby"))
        return [*lines, f"constexpr Pin kStandby = {standby};"]

    def sketch(self, plan: Plan, wiring: Wiring) -> list[str]:
        lines = [driven_line(plan, wiring, side, ("pwm", *WAYS)) for side in SIDES]
        if "standby" in wiring.pins:
            plan.pin("$STANDBY_$PIN", wiring.pins["standby"], "OUTPUT")
            is_on = "left != 0 || right != 0 ? HIGH : LOW"
            lines.insert(0, f"  digitalWrite($STANDBY_$PIN, {is_on});")
        return lines


def driven_line(plan: Plan, wiring: Wiring, side: str, keys: tuple[str, ...]) -> str:
    """Return the line of a sketch that drives one motor by pins with these keys."""
    names = [
        plan.pin(f"${side.upper()}_${key.upper()}_$PIN", wiring.pins[f"{side}_{key}"], "OUTPUT")
        for key in keys
    ]
    return f"  $drive_motor({', '.join(names)}, {side});"


class L293D(Bridge):
    """The chip L293D, with two motors."""

    name = "l293d"
    looks = Shape(
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
        power="power_volts_bridge",
        needs_5v=True,
    )


class L298N(Bridge):
    """The module L298N, with two motors."""

    name = "l298n"
    looks = Shape(
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
        ("check_jumpers",),
        "power_volts_bridge",
    )


_STILL = Setting("left_still_us", "whole", 1500, 1000, 2000)


class Servos(MotorDriver):
    """Two servos that turn without end, one for each wheel."""

    name = "servos"
    profile = (
        "left_pin, right_pin of servos that turn without end; left_reversed, right_reversed, "
        "left_still_us, right_still_us"
    )
    module = "motors_servos"
    pins = tuple(PinKey(f"{side}_pin", "servo") for side in SIDES)
    settings = (
        Setting("left_reversed", "yes/no"),
        Setting("right_reversed", "yes/no", 1),
        _STILL,
        _STILL._replace(key="right_still_us"),
    )
    drive = """\
void $drive_motor(byte servo, int percent, unsigned int stillUs) {
  if (percent != 0) {
    $servo_pulse(servo, stillUs + percent * 51 / 10, 0);
  } else if ($pulse_us[servo] != 0 && $pulses_left[servo] == 0) {
    $servo_pulse(servo, stillUs, 50);
  }
}"""
    looks = Shape(
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

    def firmware(self, part: Part, wiring: Wiring) -> list[str]:
        lines = []
        for number, side in enumerate(SIDES):
            part.servos.append(wiring.pins[f"{side}_pin"])
            still, name = wiring.settings[f"{side}_still_us"], f"k{side.capitalize()}Motor"
            reverse = "true" if wiring.settings[f"{side}_reversed"] else "false"
            lines.append(f"constexpr TurningServo {name} = {{{number}, {still}, {reverse}}};")
        return lines

    def sketch(self, plan: Plan, wiring: Wiring) -> list[str]:
        lines = []
        for side in SIDES:
            wheel = plan.servo(plan.pin(f"${side.upper()}_$PIN", wiring.pins[f"{side}_pin"]))
            sign = "-" if wiring.settings[f"{side}_reversed"] else ""
            still = wiring.settings[f"{side}_still_us"]
            lines.append(f"  $drive_motor({wheel}, {sign}{side}, {still});")
        return lines


class TB6612(Bridge):
    """The module TB6612FNG, with two motors; one of its pins may be standby."""

    name = "tb6612"
    profile = f"{Bridge.profile}; standby, if it is wired"
    pins = (*Bridge.pins, PinKey("standby", "output", True))

    def shape(self, wiring: Wiring, device: Device | None, sees: str, pin_volts: int) -> Shape:
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
            power="power_volts_tb6612",
        )


class TwoWire(MotorDriver):
    """Chips that take two PWM pins for each motor: DRV8833, L9110S."""

    name = "two_wire"
    profile = "left_forward, left_backward, right_forward, right_backward, all PWM"
    module = "motors_two_wire"
    pins = tuple(PinKey(f"{side}_{way}", "pwm") for side in SIDES for way in WAYS)
    drive = """\
void $drive_motor(int forwardPin, int backwardPin, int percent) {
  analogWrite(forwardPin, percent > 0 ? percent * 255L / 100 : 0);
  analogWrite(backwardPin, percent < 0 ? -percent * 255L / 100 : 0);
}"""
    looks = Shape(
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
        power="power_volts_two_wire",
    )

    def firmware(self, part: Part, wiring: Wiring) -> list[str]:
        lines = []
        for side in SIDES:
            forward, backward = (part.pins.pwm(wiring.pins[f"{side}_{way}"]) for way in WAYS)
            name = f"k{side.capitalize()}Motor"
            lines.append(f"constexpr TwoWire {name} = {{{forward}, {backward}}};")
        return lines

    def sketch(self, plan: Plan, wiring: Wiring) -> list[str]:
        return [driven_line(plan, wiring, side, WAYS) for side in SIDES]


DRIVERS = (L293D(), L298N(), Servos(), TB6612(), TwoWire())
