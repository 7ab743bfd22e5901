"""The module DRV8833, with two motors: two PWM pins for each."""

from __future__ import annotations

from tiniscript.robots.driver import (
    BOARD_5V,
    GROUND,
    MOTOR_BATTERY,
    PULL_DOWN,
    Shape,
    Terminal,
)
from tiniscript.robots.drivers.two_wire import TwoWire


class DRV8833(TwoWire):
    name = "drv8833"
    fixed_shape = Shape(
        "bridge",
        "need_drv8833",
        (
            Terminal("IN1", "left_forward", ground_resistor=PULL_DOWN),
            Terminal("IN2", "left_backward", ground_resistor=PULL_DOWN),
            Terminal("IN3", "right_forward", ground_resistor=PULL_DOWN),
            Terminal("IN4", "right_backward", ground_resistor=PULL_DOWN),
            Terminal("EEP", rail=BOARD_5V),
            Terminal("VCC", rail=MOTOR_BATTERY),
            Terminal("GND", rail=GROUND),
            Terminal("ULT"),
        ),
        "DRV8833",
        ("OUT1, OUT2", "OUT3, OUT4"),
        ("mind_drv8833",),
        power_key="power_volts_drv8833",
    )


DRIVER = DRV8833()
