"""The module L298N, with two motors."""

from __future__ import annotations

from tiniscript.robots.driver import GROUND, MOTOR_BATTERY, PULL_DOWN, Bridge, Shape, Terminal


class L298N(Bridge):
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
        "power_volts_l298n",
    )
    # fmt: off
    texts = {
        "need_l298n": ("motor driver module L298N, and two motors with gears",
                       "módulo de motores L298N, y dos motorreductores"),
        "power_volts_l298n": ("The L298N keeps about 2 V for itself: a battery of 7 to 9 V (6 AA cells) suits motors for 6 V.",
                              "El L298N se queda con unos 2 V: una batería de 7 a 9 V (6 pilas AA) va bien con motores de 6 V."),
        "mind_l298n_enable": ("L298N: take off the two small jumpers at ENA and ENB. With them the motors have full power always.",
                              "L298N: quita los dos puentes pequeños de ENA y ENB. Con ellos los motores tienen siempre toda la potencia."),
        "mind_l298n_5v": ("L298N: leave the jumper beside +12V in its place and its 5V free: the module makes these 5 V for itself. Only with a battery under 7 V: take that jumper off and join 5V of the module to 5V of the board. Over 12 V do the same.",
                          "L298N: deja en su lugar el puente junto a +12V y libre su 5V: el módulo hace esos 5 V para sí mismo. Solo con una batería de menos de 7 V: quita ese puente y une el 5V del módulo con 5V de la placa. Con más de 12 V haz lo mismo."),
        "check_jumpers": ("The jumpers at ENA and ENB are off.", "ENA y ENB están sin sus puentes."),
    }
    # fmt: on


DRIVER = L298N()
