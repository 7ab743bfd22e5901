"""Writes pins as the firmware of each family of chips names them.

Knows `pins.h` and `echo.h` of the families. Does not know what a pin is for.
"""

from __future__ import annotations

from tiniscript.robots.driver import PinTexts
from tiniscript.robots.ledc import channels_of
from tiniscript.robots.ports import AVRS, ESP32S
from tiniscript.robots.profile import Robot


class AvrPins:
    """Ports and bits, timers and their channels, and the interrupts of changes."""

    def __init__(self, robot: Robot) -> None:
        self._avr = AVRS[robot.board.chip]
        self.vectors: list[str] = []
        self.counters: list[str] = []

    def pin(self, pin: int | None) -> str:
        if pin is None:
            return "kNoPin"
        bit = self._avr.bits[pin]
        return f"{{kPort{bit.port.upper()}, 1 << {bit.bit}}}"

    def pwm(self, pin: int) -> str:
        timer, channel = self._avr.compares[pin]
        return f"{{{self.pin(pin)}, {timer}, kChannel{channel.upper()}}}"

    def servo(self, pin: int) -> str:
        return self.pin(pin)

    def buzzer(self, pin: int) -> str:
        return f"Pin kBuzzer = {self.pin(pin)}"

    def echo(self, pin: int) -> str:
        vector, group, bit = self._avr.interrupts[pin]
        if vector not in self.vectors:
            self.vectors.append(vector)
        return f"{{{self.pin(pin)}, {group}, 1 << {bit}}}"

    def count(self, pin: int) -> str:
        vector, _, bit = self._avr.external[pin]
        self.counters.append(vector)
        return f"{self.pin(pin)}, 1 << {bit}"


class Esp32Pins:
    """Numbers of pins, and channels of LEDC."""

    def __init__(self, robot: Robot) -> None:
        self._channels = channels_of(robot.board)
        self.vectors: list[str] = []
        self.counters: list[str] = []

    def pin(self, pin: int | None) -> str:
        return "kNoPin" if pin is None else f"{{{pin}}}"

    def pwm(self, pin: int) -> str:
        return f"{{{self.pin(pin)}, {self._channels[pin]}}}"

    def servo(self, pin: int) -> str:
        return self.pwm(pin)

    def buzzer(self, pin: int) -> str:
        return f"Pwm kBuzzer = {self.pwm(pin)}"

    def echo(self, pin: int) -> str:
        return f"{{{self.pin(pin)}}}"

    def count(self, pin: int) -> str:
        return self.pin(pin)


def texts_of(robot: Robot) -> PinTexts:
    """Return what writes the pins of a robot."""
    return Esp32Pins(robot) if robot.board.chip in ESP32S else AvrPins(robot)
