"""A disc on each wheel and a sensor with two channels: it sees which way the wheel turns."""

from __future__ import annotations

from tiniscript.robots.driver import BOARD_5V, GROUND, DiscDriver, PinKey, Shape, Terminal


class TwoChannel(DiscDriver):
    name = "two_channel"
    pins = (*DiscDriver.pins, PinKey("left_b", "input"), PinKey("right_b", "input"))
    has_two = True
    looks = Shape(
        "disc",
        "need_two_channel",
        (
            Terminal("left_a", "left"),
            Terminal("left_b", "left_b"),
            Terminal("right_a", "right"),
            Terminal("right_b", "right_b"),
            Terminal("VCC", rail=BOARD_5V),
            Terminal("GND", rail=GROUND),
        ),
        "A, B",
        notes=("mind_two_channel", "mind_no_text"),
        checks=("check_slotted",),
    )
    # fmt: off
    texts = {
        "need_two_channel": ("2 × encoder with two channels (A and B), on the wheels or the motors",
                             "2 × encoder de dos canales (A y B), en las ruedas o en los motores"),
        "terminal_left_a": ("A left", "A izq."),
        "terminal_left_b": ("B left", "B izq."),
        "terminal_right_a": ("A right", "A der."),
        "terminal_right_b": ("B right", "B der."),
        "mind_two_channel": ("Encoders: if a wheel counts back while it goes forward, exchange its A and B. `holes` is the pulses of A in one turn of the wheel.",
                             "Encoders: si una rueda cuenta hacia atrás cuando avanza, intercambia su A y su B. `holes` son los pulsos de A en una vuelta de la rueda."),
    }
    # fmt: on


DRIVER = TwoChannel()
