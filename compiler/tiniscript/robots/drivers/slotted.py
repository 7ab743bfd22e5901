"""A slotted disc on each wheel and a one-channel sensor, such as the FC-03."""

from __future__ import annotations

from tiniscript.robots.driver import BOARD_5V, GROUND, DiscDriver, Shape, Terminal


class Slotted(DiscDriver):
    name = "slotted"
    profile_help = (
        "left, right: pins that count, on an uno and a nano 2 and 3, on a mega also 18 to 21; "
        "holes of a disc, 20; wheel_cm, the diameter of a wheel, 6.5"
    )
    fixed_shape = Shape(
        "disc",
        "need_slotted",
        (
            Terminal("left_d0", "left"),
            Terminal("right_d0", "right"),
            Terminal("VCC", rail=BOARD_5V),
            Terminal("GND", rail=GROUND),
        ),
        "FC-03",
        note_keys=("mind_slotted", "mind_no_text"),
        check_keys=("check_slotted",),
    )


DRIVER = Slotted()
