"""A main loop that stands still on an Uno: the motors go off, and the chip starts anew."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.uno import needed
from tests.platformio import changed
from tests.test_uno_robot import AWAY, BAUD, FORWARD, NAMES, OFF, computer, send, states
from tiniscript.link.errands import OK
from tools.uno import CYCLES_PER_MS, Uno

PRESSED = "if (press == Press::kPressed) firmware_pressed();"
WATCHDOG = 4  # a reset in docs/link.md


def built(folder: Path, hang: str, environment: str = "uno") -> Path:
    """Return the firmware that hangs when the button is pressed."""
    needed()
    hangs = f"if (press == Press::kPressed) {hang}"
    return changed(folder, "main.cpp", PRESSED, hangs, environment)


@pytest.mark.parametrize(
    ("hang", "limit_ms"),
    [
        pytest.param("for (;;) {\n }", 110, id="the timer turns the motors off"),
        pytest.param("{ cli(); for (;;) {\n } }", 550, id="the watchdog, with interrupts off"),
    ],
)
def test_a_main_loop_that_hangs(hang: str, limit_ms: int, tmp_path: Path) -> None:
    with Uno(built(tmp_path, hang), names=NAMES, baud=BAUD) as uno:
        uno.run_ms(300)
        wired = computer(uno)
        send(wired, AWAY)
        wired.run(300)
        assert states(uno) == FORWARD
        began = uno.cycle
        uno.drive("button", False)
        uno.run_ms(limit_ms + 5)
        off = [uno.pins[name].cycle for name, state in OFF.items() if uno.pins[name].state == state]
        assert len(off) == len(OFF), states(uno)
        assert max(off) - began <= limit_ms * CYCLES_PER_MS
        uno.drive("button", None)
        uno.run_ms(1500)
        assert states(uno) == OFF
        causes = [event["cause"] for event in uno.events if event.what == "reset"]
        assert causes[-1] == "watchdog", causes
        again = computer(uno, 2)
        assert again.until(again.session.hello()) == OK
        robot = again.session.robot
        assert robot is not None
        assert robot.values["reset"] == WATCHDOG
        assert states(uno) == OFF
