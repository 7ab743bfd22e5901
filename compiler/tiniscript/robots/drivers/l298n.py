"""The module L298N, with two motors."""

from __future__ import annotations

from tiniscript.robots.driver import GROUND, MOTOR_BATTERY, PULL_DOWN, Bridge, Shape, Terminal


class L298N(Bridge):
    name = "l298n"
    fixed_shape = Shape(
        "bridge",
        "need_l298n",
        (
            Terminal("ENA", "left_pwm", ground_resistor=PULL_DOWN),
            Terminal("IN1", "left_forward"),
            Terminal("IN2", "left_backward"),
            Terminal("IN3", "right_forward"),
            Terminal("IN4", "right_backward"),
            Terminal("ENB", "right_pwm", ground_resistor=PULL_DOWN),
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


DRIVER = L298N()
