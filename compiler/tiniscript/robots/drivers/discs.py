"""The drivers of slotted discs on the wheels, whose edges are counted."""

from __future__ import annotations

from tiniscript.robots.driver import BOARD_5V, GROUND, DiscDriver, PinKey, Shape, Terminal


class Slotted(DiscDriver):
    """A slotted disc on each wheel and a sensor with one channel, as a FC-03 has."""

    name = "slotted"
    profile = (
        "left, right: pins that count, on an uno and a nano 2 and 3, on a mega also 18 to 21; "
        "holes of a disc, 20; wheel_cm, the diameter of a wheel, 6.5"
    )
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


class TwoChannel(DiscDriver):
    """A disc on each wheel and a sensor with two channels: it sees which way the wheel turns."""

    name = "two_channel"
    profile = (
        "what slotted has, and left_b, right_b: it sees a wheel that turns back; holes are pulses"
    )
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


DRIVERS = (Slotted(), TwoChannel())
