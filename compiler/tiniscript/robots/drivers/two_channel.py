"""A disc on each wheel and a sensor with two channels: it sees which way the wheel turns."""

from __future__ import annotations

from tiniscript.robots.driver import BOARD_5V, GROUND, DiscDriver, PinKey, Shape, Terminal


class TwoChannel(DiscDriver):
    name = "two_channel"
    profile_help = (
        "what slotted has, and left_b, right_b: it sees a wheel that turns back; holes are pulses"
    )
    pins = (*DiscDriver.pins, PinKey("left_b", "input"), PinKey("right_b", "input"))
    has_two_channels = True
    fixed_shape = Shape(
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
        note_keys=("mind_two_channel", "mind_no_text"),
        check_keys=("check_two_channel",),
    )


DRIVER = TwoChannel()
