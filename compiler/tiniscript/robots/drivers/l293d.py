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
        power="power_volts_l293d",
        needs_5v=True,
    )
    # fmt: off
    texts = {
        "need_l293d": ("motor driver chip L293D, and two motors with gears",
                       "integrado L293D para motores, y dos motorreductores"),
        "power_volts_l293d": ("The L293D keeps about 2 V for itself: a battery of 7 to 9 V (6 AA cells) suits motors for 6 V.",
                              "El L293D se queda con unos 2 V: una batería de 7 a 9 V (6 pilas AA) va bien con motores de 6 V."),
        "mind_l293d": ("L293D: the number in brackets is the chip's pin. With the notch at the top, pin 1 is the first one on the left, and 16 the first one on the right. All four GND pins go to GND.",
                       "L293D: el número entre paréntesis es el pin del integrado. Con la muesca arriba, el pin 1 es el primero de la izquierda, y el 16 el primero de la derecha. Los cuatro GND van a GND."),
    }
    # fmt: on


DRIVER = L293D()
