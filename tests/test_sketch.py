"""The sketch as PlatformIO builds it for an Uno, seen from its pins."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.uno import needed
from tests.platformio import firmware
from tools.uno import CYCLES_PER_MS, Uno

# The wiring of `boards/tinibot.cpp`, which is that of the profile `tinibot`.
NAMES = {
    "left": "D5", "left forward": "D7", "left backward": "D8",
    "right": "D6", "right forward": "D9", "right backward": "D10",
    "button": "D2", "echo": "D3", "trigger": "D4", "light": "D13",
}  # fmt: skip
MOTORS = [name for name in NAMES if "left" in name or "right" in name]
MOST_START_MS = 1.0
MOST_STOP_MS = 1.0
ONE_MOVE_CYCLES = CYCLES_PER_MS // 3


@pytest.fixture(scope="session")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needed()
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if base.name.startswith("popen-") else base
    return firmware("uno", tmp_path_factory.mktemp("sketch"), shared)


def states(uno: Uno) -> dict[str, str]:
    return {name: uno.pins[name].state for name in MOTORS}


def power(uno: Uno, side: str, cycle: int) -> int:
    """Return how a motor turned at a cycle, -100 to 100, from its three pins."""
    forward, backward = (
        uno.pins.at(f"{side} {way}", cycle).state == "high" for way in ("forward", "backward")
    )
    assert not (forward and backward)
    pwm = uno.pins.at(side, cycle)
    duty = pwm.duty if pwm.state == "pwm" else float(pwm.state == "high")
    return round(duty * 100) * (forward - backward)


def moves(uno: Uno, since: int) -> list[tuple[float, int, int]]:
    """Return what the motors did from a cycle on: milliseconds, left, right.

    The pins change one after the other: changes that follow each other at once are one move.
    """
    changes = sorted(change.cycle for name in MOTORS for change in uno.pins.history(name))
    found = []
    for cycle, following in zip(changes, [*changes[1:], uno.cycle], strict=True):
        if cycle >= since and following - cycle > ONE_MOVE_CYCLES:
            ms = (cycle - since) / CYCLES_PER_MS
            found.append((ms, power(uno, "left", cycle), power(uno, "right", cycle)))
    return found


def test_nothing_moves_before_the_button(sketch: Path) -> None:
    with Uno(sketch, names=NAMES) as uno:
        uno.sonar("trigger", "echo", 5)
        uno.run_ms(300)
        assert states(uno) == dict.fromkeys(MOTORS, "low")
        for name in MOTORS:
            assert [change.state for change in uno.pins.history(name)] == ["input", "low"]
            assert uno.pins[name].ms < 1
        assert uno.pins["light"].state == "high"
        uno.reset("external")
        uno.run_ms(100)
        assert states(uno) == dict.fromkeys(MOTORS, "low")
        assert not [event for event in uno.events if event.rest.get("is") == "pwm"]


def test_the_button_starts_and_stops_it(sketch: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The paper's obstacle program: a second forward, a look; it goes on, or stops and turns."""
    with Uno(sketch, names=NAMES) as uno:
        uno.sonar("trigger", "echo", 50)
        uno.run_ms(100)
        began = uno.cycle
        uno.press("button")
        first = uno.run_until("left forward", "high", limit_ms=MOST_START_MS)
        uno.run_ms(1500)
        assert uno.pins["light"].state == "low"
        uno.sonar("trigger", "echo", 5)
        uno.run_ms(1000)
        stopped = uno.cycle
        uno.press("button")
        uno.run_ms(MOST_STOP_MS)
        assert states(uno) == dict.fromkeys(MOTORS, "low")
        off = max(uno.pins[name].cycle for name in MOTORS)
        uno.run_ms(1500)
        assert states(uno) == dict.fromkeys(MOTORS, "low")
        assert uno.pins["light"].state == "high"
    done = moves(uno, began)
    assert [(left, right) for _, left, right in done] == [
        (80, 80), (0, 0),
        (80, 80), (0, 0),  # 50 cm: on
        (60, -60), (0, 0),  # 5 cm: to the right, until the button
    ]  # fmt: skip
    # A reading takes what the module needs and the way of the sound, 3.4 and 0.7 ms. The time of a
    # move runs from when the one before has ended: so readings delay nothing after them.
    times = [0, 1000, 1003.4, 2000, 2000.7]
    assert [ms for ms, _, _ in done[:-1]] == pytest.approx(times, abs=1)
    with capsys.disabled():
        report("button to first motor pin", first.cycle - began)
        report("button to all motor pins low", off - stopped)


def report(what: str, cycles: int) -> None:
    print(f"\n{what}: {cycles} cycles, {cycles / CYCLES_PER_MS * 1000:.0f} us", end="")
