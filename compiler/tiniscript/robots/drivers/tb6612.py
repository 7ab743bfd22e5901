"""The module TB6612FNG, with two motors; one of its pins may be standby."""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    BOARD_5V,
    GROUND,
    MOTOR_BATTERY,
    PULL_DOWN,
    Bridge,
    PinKey,
    Shape,
    Terminal,
)
from tiniscript.robots.profile import Wiring


class TB6612(Bridge):
    name = "tb6612"
    profile_help = f"{Bridge.profile_help}; standby, if it is wired"
    pins = (*Bridge.pins, PinKey("standby", "output", True))

    def shape(
        self, wiring: Wiring, device: Device | None, sensed_kind: str, pin_volts: int
    ) -> Shape:
        has_standby = "standby" in wiring.pins
        enable = "" if has_standby else PULL_DOWN
        standby = (
            Terminal("STBY", "standby", ground_resistor=PULL_DOWN)
            if has_standby
            else Terminal("STBY", rail=BOARD_5V)
        )
        return Shape(
            "bridge",
            "need_tb6612",
            (
                Terminal("PWMA", "left_pwm", ground_resistor=enable),
                Terminal("AIN1", "left_forward"),
                Terminal("AIN2", "left_backward"),
                standby,
                Terminal("BIN1", "right_forward"),
                Terminal("BIN2", "right_backward"),
                Terminal("PWMB", "right_pwm", ground_resistor=enable),
                Terminal("VM", rail=MOTOR_BATTERY),
                Terminal("VCC", rail=BOARD_5V),
                Terminal("GND", rail=GROUND),
            ),
            "TB6612",
            ("AO1, AO2", "BO1, BO2"),
            ("mind_tb6612_standby" if has_standby else "mind_tb6612_no_standby", "mind_tb6612"),
            power_key="power_volts_tb6612",
        )


DRIVER = TB6612()
