"""The module TB6612FNG, with two motors; one of its pins may be standby."""

from __future__ import annotations

from tiniscript.kit import Device
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
    pins = (*Bridge.pins, PinKey("standby", "output", True))
    # fmt: off
    texts = {
        "need_tb6612": ("motor driver module TB6612FNG, and two motors with gears",
                        "módulo de motores TB6612FNG, y dos motorreductores"),
        "power_volts_tb6612": ("The TB6612 takes from 4.5 to 13.5 V; a battery with the volts of the motors suits it.",
                               "El TB6612 acepta de 4.5 a 13.5 V; le va bien una batería con los voltios de los motores."),
        "mind_tb6612_standby": ("TB6612: while STBY is low it drives no motor. The firmware raises it only to drive.",
                                "TB6612: mientras STBY está en bajo no mueve ningún motor. El firmware lo sube solo para mover los motores."),
        "mind_tb6612_no_standby": ("TB6612: STBY goes to 5V, or it drives no motor.",
                                   "TB6612: STBY va a 5V; si no, no mueve ningún motor."),
        "mind_tb6612_no_standby_3v3": ("TB6612: STBY goes to 3V3, or it drives no motor.",
                                       "TB6612: STBY va a 3V3; si no, no mueve ningún motor."),
        "mind_tb6612_3v3": ("TB6612: the battery goes to VM. VCC goes to the 3V3 of the board, never to the battery.",
                            "TB6612: la batería va a VM. VCC va a los 3V3 de la placa, nunca a la batería."),
        "mind_tb6612": ("TB6612: the battery goes to VM. VCC goes to the 5V of the board, never to the battery.",
                        "TB6612: la batería va a VM. VCC va a los 5V de la placa, nunca a la batería."),
    }
    # fmt: on

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


DRIVER = TB6612()
