"""The chip L293D, with two motors."""

from __future__ import annotations

from tiniscript.robots.driver import (
    BOARD_5V,
    GROUND,
    MOTOR_BATTERY,
    PULL_DOWN,
    Bridge,
    Shape,
    Terminal,
)


class L293D(Bridge):
    name = "l293d"
    fixed_shape = Shape(
        "bridge",
        "need_l293d",
        (
            Terminal("EN1 (1)", "left_pwm", ground_resistor=PULL_DOWN),
            Terminal("IN1 (2)", "left_forward"),
            Terminal("IN2 (7)", "left_backward"),
            Terminal("IN3 (10)", "right_forward"),
            Terminal("IN4 (15)", "right_backward"),
            Terminal("EN2 (9)", "right_pwm", ground_resistor=PULL_DOWN),
            Terminal("VCC2 (8)", rail=MOTOR_BATTERY),
            Terminal("VCC1 (16)", rail=BOARD_5V),
            Terminal("GND (4 5 12 13)", rail=GROUND),
        ),
        "L293D",
        ("OUT (3), (6)", "OUT (11), (14)"),
        ("mind_l293d",),
        power_key="power_volts_bridge",
        needs_5v=True,
    )


DRIVER = L293D()
