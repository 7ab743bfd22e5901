"""A slotted disc on each wheel and a sensor with one channel, as a FC-03 has."""

from __future__ import annotations

from tiniscript.robots.driver import BOARD_5V, GROUND, DiscDriver, Shape, Terminal


class Slotted(DiscDriver):
    name = "slotted"
    looks = Shape(
        "disc",
        "need_slotted",
        (
            Terminal("left_d0", "left"),
            Terminal("right_d0", "right"),
            Terminal("VCC", rail=BOARD_5V),
            Terminal("GND", rail=GROUND),
        ),
        "FC-03",
        notes=("mind_slotted", "mind_no_text"),
        checks=("check_slotted",),
    )


DRIVER = Slotted()
