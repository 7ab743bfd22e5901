"""A whole robot on a simulated Uno, and the activity of its motors."""

from __future__ import annotations

from pathlib import Path

from tests.machines.wired import Wired
from tests.support.images import image_of
from tiniscript import robots
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tools.uno import Uno

KIT = robots.load("tinibot").kit
BAUD = 9600
# The wiring of the profile `tinibot`.
NAMES = {
    "left": "D5", "left forward": "D7", "left backward": "D8",
    "right": "D6", "right forward": "D9", "right backward": "D10",
    "button": "D2", "echo": "D3", "trigger": "D4", "light": "D13", "radio": "D12",
}  # fmt: skip
MOTORS = [name for name in NAMES if "left" in name or "right" in name]
OFF = dict.fromkeys(MOTORS, "low")
FORWARD = OFF | {"left": "pwm", "right": "pwm", "left forward": "high", "right forward": "high"}
AWAY_PROGRAM = "SI|F(70, 80)"
OBSTACLE_LINES = (
    "SI|LOOP(FOREVER);", "  F(1, 80);", "  DISTANCE;", "  IF(DISTANCE < 10);", "    STOP;",
    "    R(1, 60);", "  ENDIF;", "END_LOOP;",
)  # fmt: skip


def switched_on(sketch: Path, memory: Path, board: str = "uno") -> Uno:
    # No test opens its port, and opening it by mistake does not reset it.
    uno = Uno(sketch, names=NAMES, board=board, eeprom=memory, baud=BAUD, resets_on_open=False)
    uno.run_ms(300)
    assert states(uno) == OFF
    return uno


def states(uno: Uno) -> dict[str, str]:
    return {name: uno.pins[name].state for name in MOTORS}


def computer(uno: Uno, nonce: int = 1) -> Wired:
    return Wired(uno, Session(nonce, BAUD, KIT.fingerprint))


def send(wired_uno: Wired, text: str, **options: bool) -> None:
    assert wired_uno.until(wired_uno.session.upload(image_of(text), **options)) == OK


def read_saved_state(wired_uno: Wired) -> int:
    """Return the storage state of the robot's program."""
    return wired_uno.complete(wired_uno.session.status()).saved
