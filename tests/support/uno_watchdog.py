"""Firmware that hangs, on a simulated Uno."""

from __future__ import annotations

from pathlib import Path

from tests.machines.uno import skip_unless_available
from tests.support.platformio import build_changed_sketch
from tests.support.robot_on_uno import states
from tools.uno import Uno

PRESS_HANDLER = "if (press == Press::kPressed) firmware_on_pressed();"
WATCHDOG, STALL = 4, 66  # a reset and a fault in docs/develop/link.md
HANGING_LOOP, HANGING_LOOP_WITHOUT_INTERRUPTS = "for (;;) {\n }", "{ cli(); for (;;) {\n } }"
TIMER_MS, WATCHDOG_MS = 110, 300


def build_hanging_firmware(folder: Path, hang: str, environment: str = "uno") -> Path:
    """Return the firmware that hangs when the button is pressed."""
    skip_unless_available()
    hangs = f"if (press == Press::kPressed) {hang}"
    return build_changed_sketch(folder, "main.cpp", PRESS_HANDLER, hangs, environment)


def is_on(uno: Uno) -> bool:
    """Return whether a motor may turn. A chip that is being reset leaves all its pins alone."""
    return any(state in ("high", "pwm") for state in states(uno).values())
