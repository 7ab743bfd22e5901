"""The module L9110S (HG7881), with two motors: two PWM pins for each."""

from __future__ import annotations

from tiniscript.robots.driver import GROUND, MOTOR_BATTERY, PULL_DOWN, Shape, Terminal
from tiniscript.robots.drivers.two_wire import TwoWire


class L9110S(TwoWire):
    name = "l9110s"
    fixed_shape = Shape(
        "bridge",
        "need_l9110s",
        (
            Terminal("A-IA", "left_forward", ground_resistor=PULL_DOWN),
            Terminal("A-IB", "left_backward", ground_resistor=PULL_DOWN),
            Terminal("B-IA", "right_forward", ground_resistor=PULL_DOWN),
            Terminal("B-IB", "right_backward", ground_resistor=PULL_DOWN),
            Terminal("VCC", rail=MOTOR_BATTERY),
            Terminal("GND", rail=GROUND),
        ),
        "L9110S",
        ("MOTOR A", "MOTOR B"),
        ("mind_l9110s",),
        power_key="power_volts_l9110s",
    )


DRIVER = L9110S()
