"""The tables of chips: the compiler's name of each, and the registers of an AVR's pins.

Facts from the data sheets of the ATmega328P and the ATmega2560, and the pins of their Arduino
boards. `boards` lists the uses of pins; this module has their registers. An ESP32 needs no table:
the number of a pin is that of its GPIO.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Bit(NamedTuple):
    """A bit of a port: `Bit("d", 5)` is PD5."""

    port: str
    bit: int


class Compare(NamedTuple):
    """A channel of a timer: `Compare(0, "b")` is OC0B."""

    timer: int
    channel: str


class Interrupt(NamedTuple):
    """The interrupt for a change of a pin: its vector, and its bit in the mask of its `group`.

    Groups 0 to 2 are pin change interrupts, group 3 has the external interrupts.
    """

    vector: str
    group: int
    bit: int


class Avr(NamedTuple):
    """A chip: the name that its compiler defines, and the registers of its pins."""

    macro: str
    bit_by_pin: Mapping[int, Bit]
    compare_by_pin: Mapping[int, Compare]
    interrupt_by_pin: Mapping[int, Interrupt]
    # External interrupts with a pin of their own.
    external_interrupt_by_pin: Mapping[int, Interrupt]


EXTERNAL_GROUP = 3  # the group of INT0 to INT7


def _bit_by_pin(*parts: str) -> dict[int, Bit]:
    """Return the pins of `"0 d0 d1"`: the number of the first pin, then the bit of each pin."""
    bit_of_pin = {}
    for part in parts:
        first_pin, *bit_names = part.split()
        for pin, bit in enumerate(bit_names, int(first_pin)):
            bit_of_pin[pin] = Bit(bit[0], int(bit[1]))
    return bit_of_pin


def _pwm_channels(text: str) -> dict[int, Compare]:
    words = [word.split(":") for word in text.split()]
    return {int(pin): Compare(int(channel[0]), channel[1]) for pin, channel in words}


_BITS_328P = _bit_by_pin(
    "0 d0 d1 d2 d3 d4 d5 d6 d7",
    "8 b0 b1 b2 b3 b4 b5",
    "14 c0 c1 c2 c3 c4 c5",
)
_BITS_2560 = _bit_by_pin(
    "0 e0 e1 e4 e5 g5 e3 h3 h4 h5 h6",
    "10 b4 b5 b6 b7 j1 j0 h1 h0 d3 d2 d1 d0",
    "22 a0 a1 a2 a3 a4 a5 a6 a7",
    "30 c7 c6 c5 c4 c3 c2 c1 c0",
    "38 d7 g2 g1 g0 l7 l6 l5 l4 l3 l2 l1 l0",
    "50 b3 b2 b1 b0",
    "54 f0 f1 f2 f3 f4 f5 f6 f7",
    "62 k0 k1 k2 k3 k4 k5 k6 k7",
)
_GROUPS_328P = {"b": 0, "c": 1, "d": 2}
_GROUPS_2560 = {"b": 0, "j": 1, "k": 2}
_EXTERNAL_328P = {"d2": 0, "d3": 1}
_EXTERNAL_2560 = {"d0": 0, "d1": 1, "d2": 2, "d3": 3, "e4": 4, "e5": 5}


def _change_interrupts(
    bit_by_pin: Mapping[int, Bit], group_by_port: Mapping[str, int]
) -> dict[int, Interrupt]:
    """Return the pin change interrupts. Bit 0 of port J is the second of its group."""
    return {
        pin: Interrupt(f"PCINT{group_by_port[port]}_vect", group_by_port[port], bit + (port == "j"))
        for pin, (port, bit) in bit_by_pin.items()
        if port in group_by_port
    }


def _external_interrupts(
    bit_by_pin: Mapping[int, Bit], number_by_pin_name: Mapping[str, int]
) -> dict[int, Interrupt]:
    return {
        pin: Interrupt(f"INT{number}_vect", EXTERNAL_GROUP, number)
        for pin, bit in bit_by_pin.items()
        if (number := number_by_pin_name.get(f"{bit.port}{bit.bit}")) is not None
    }


AVR_328P = Avr(
    "__AVR_ATmega328P__",
    _BITS_328P,
    _pwm_channels("3:2b 5:0b 6:0a 9:1a 10:1b 11:2a"),
    _change_interrupts(_BITS_328P, _GROUPS_328P),
    _external_interrupts(_BITS_328P, _EXTERNAL_328P),
)
AVR_2560 = Avr(
    "__AVR_ATmega2560__",
    _BITS_2560,
    _pwm_channels(
        "2:3b 3:3c 4:0b 5:3a 6:4a 7:4b 8:4c 9:2b 10:2a 11:1a 12:1b 13:0a 44:5c 45:5b 46:5a"
    ),
    {
        **_change_interrupts(_BITS_2560, _GROUPS_2560),
        **_external_interrupts(_BITS_2560, _EXTERNAL_2560),
    },
    _external_interrupts(_BITS_2560, _EXTERNAL_2560),
)
# Definitions of Espressif's core configuration for the chips of `CHIPS`.
ESP32S = {"esp32dev": "CONFIG_IDF_TARGET_ESP32", "esp32c3": "CONFIG_IDF_TARGET_ESP32C3"}
AVRS = {"uno": AVR_328P, "nano": AVR_328P, "mega": AVR_2560}  # boards of `CHIPS`
