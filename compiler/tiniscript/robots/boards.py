"""The table of chips: the abilities of each pin.

Knows pins, timers and memory. It does not read profiles: `board_reader` does, and compares their
pins with the drivers' needs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.base.fixed_point import ONE
from tiniscript.robots.ports import AVRS


class Chip(NamedTuple):
    """A board that the firmware runs on. Pins are numbers of its Arduino core.

    `digital_pins` pins read and write, `reading_pins` pins only read. A0 has the number
    `first_analog`, if the board prints such names. `timer_of_pwm_pin` maps each pin to its timer.
    The link uses `link_pins`. `boot_pins` are high, or do PWM, before the firmware runs, or decide
    how the chip starts: no motor may hang on them. `reset_pin` is the one that a computer may pull
    low when it opens the port: no start button may. A timer field is None if the chip has enough
    timers. Each of `pwm_timers` serves two pins of one frequency; 0: the timers are those of
    `timer_of_pwm_pin`.
    """

    name: str
    program_bytes: int
    digital_pins: frozenset[int]
    analog_pins: frozenset[int]
    echo_pins: frozenset[int]
    timer_of_pwm_pin: Mapping[int, int]
    link_pins: frozenset[int]
    reading_pins: frozenset[int] = frozenset()
    first_analog: int | None = None
    servo_timer: int | None = None
    tone_timer: int | None = None
    boot_pins: frozenset[int] = frozenset()
    reset_pin: int | None = None
    counting_pins: frozenset[int] = (
        frozenset()
    )  # count the edges of a disc, by interrupts of their own
    pwm_timers: int = 0
    pin_volts: int = 5 * ONE  # thousandths of a volt: output of its pins, and most input
    capabilities: int = 0  # features of its firmware, as bits of an image's `needs`

    def has_ability(self, pin: int, ability: str) -> bool:
        """Return whether `pin` has the ability `ability`, one of ABILITIES."""
        if ability == "input":
            return pin in self.digital_pins or pin in self.reading_pins
        if ability == "analog":
            return pin in self.analog_pins
        if ability == "pwm":
            return pin in self.timer_of_pwm_pin
        if ability == "echo":
            return pin in self.echo_pins
        if ability == "count":
            return pin in self.counting_pins
        return pin in self.digital_pins  # output, pull_up, servo, tone

    def pin_number(self, pin_text: object) -> int | None:
        """Return the number of `5` or `"A0"`, or None if the board has no such pin."""
        number = pin_text if isinstance(pin_text, int) else None
        if isinstance(pin_text, str) and self.first_analog is not None:
            letter, digits = pin_text[:1].upper(), pin_text[1:]
            if letter == "A" and digits in ANALOG_DIGITS:
                number = self.first_analog + int(digits)
        all_pins = self.digital_pins | self.reading_pins | self.analog_pins | self.link_pins
        return number if number in all_pins else None

    def pin_name(self, number: int) -> str:
        """Return the name printed next to a pin on the board: `5`, `A0`."""
        first_number = self.first_analog
        return (
            str(number)
            if first_number is None or number < first_number
            else f"A{number - first_number}"
        )


ANALOG_DIGITS = frozenset(str(number) for number in range(16))
ABILITIES = ("input", "output", "pull_up", "analog", "pwm", "echo", "count", "servo", "tone")


def _pins(*parts: int | range) -> frozenset[int]:
    return frozenset(
        pin for part in parts for pin in (part if isinstance(part, range) else (part,))
    )


# Pins of an ESP32 that are free: 6 to 11 carry its flash memory, 1 and 3 the link. 34 to 39 only
# read. Only the analog pins of ADC1: ADC2 (0, 2, 4, 12 to 15, 25 to 27) cannot measure while WiFi
# is on. Data sheet, "Strapping Pins": 0, 2, 5, 12 and 15 are read at a reset; 12 held high keeps
# the chip from starting. 0, 5 and 15 are pulled up then, and 14 does PWM for a moment; 2 is pulled
# down.
# An ESP32-C3 has its flash on 12 to 17 (11 feeds it), its link on 20 and 21; its analog pins are
# those of ADC1, because the chip's errata sheet advises against ADC2 (5). It reads 2, 8 and 9 at a
# reset; 6 is pulled up then, for JTAG. 18 and 19 are its own USB: they carry the link of a board
# without a USB chip, whose port disappears as soon as they are used for something else.
_ESP32 = _pins(0, 2, 4, 5, range(12, 20), 21, 22, 23, 25, 26, 27, 32, 33)
_ESP32C3 = _pins(range(11))
# Bits of `needs`. A Nano's bootloader leaves no room for tasks.
_TASKS, _WAYS = 1, 2


def _avr(name: str, digital: range, analog: range, program_bytes: int, capabilities: int) -> Chip:
    """Return a chip with the pins in `ports`. Timer 0 keeps the time and also does PWM."""
    avr = AVRS[name]
    return Chip(
        name,
        program_bytes,
        digital_pins=_pins(digital),
        analog_pins=_pins(analog),
        echo_pins=frozenset(avr.interrupt_by_pin),
        timer_of_pwm_pin={pin: compare.timer for pin, compare in avr.compare_by_pin.items()},
        link_pins=_pins(0, 1),
        first_analog=analog[0],
        servo_timer=1,
        tone_timer=2,
        counting_pins=frozenset(avr.external_interrupt_by_pin),
        capabilities=capabilities,
    )


CHIPS = {
    chip.name: chip
    for chip in (
        _avr("uno", range(2, 20), range(14, 20), 389, _TASKS | _WAYS),
        # A6 and A7 are analog inputs only
        _avr("nano", range(2, 20), range(14, 22), 389, _WAYS),
        _avr("mega", range(2, 70), range(54, 70), 1900, _TASKS | _WAYS),
        Chip(
            "esp32dev",
            program_bytes=8192,
            digital_pins=_ESP32,
            reading_pins=_pins(34, 35, 36, 39),
            analog_pins=_pins(32, 33, 34, 35, 36, 39),
            echo_pins=_ESP32 | _pins(34, 35, 36, 39),
            timer_of_pwm_pin=dict.fromkeys(sorted(_ESP32), 0),
            link_pins=_pins(1, 3),
            boot_pins=_pins(0, 5, 12, 14, 15),
            reset_pin=0,
            counting_pins=_ESP32 | _pins(34, 35, 36, 39),
            pwm_timers=8,
            pin_volts=3_300,
            capabilities=_TASKS | _WAYS,
        ),
        Chip(
            "esp32c3",
            program_bytes=8192,
            digital_pins=_ESP32C3,
            analog_pins=_pins(range(5)),
            echo_pins=_ESP32C3,
            timer_of_pwm_pin=dict.fromkeys(sorted(_ESP32C3), 0),
            link_pins=_pins(18, 19, 20, 21),
            boot_pins=_pins(2, 6, 8, 9),
            reset_pin=9,
            pwm_timers=3,
            pin_volts=3_300,
            capabilities=_TASKS | _WAYS,
        ),
    )
}

BAUDS = (9600, 19200, 38400, 57600, 115200)
