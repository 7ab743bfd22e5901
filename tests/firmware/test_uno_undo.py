"""UNDO on the simulated Uno: eight bytes of the EEPROM, and the program of before is back."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.firmware.test_uno_robot import (
    FORWARD,
    computer,
    image_of,
    memory,
    saved,
    send,
    sketch,
    states,
    switched_on,
)
from tests.machines.wired import Wired
from tiniscript.link.messages import SAVED_STORED, STATUSES
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

__all__ = ["memory", "sketch"]

# The same promises are kept by the whole firmware on this computer, on every commit.
pytestmark = pytest.mark.sampled(of="programs, texts and UNDO on a simulated Uno", keep=14)

FIRST = "SB|F(0.2, 80); " + "SHOW(1); " * 20
SECOND = "SB|B(0.2, 60); " + "SHOW(2); " * 30
EVENTS = 13  # eight bytes, five of which are erased first
MOST_MS = 60  # from the first byte to the last


def until_saved(wired: Wired) -> None:
    end_ms = wired.now_ms + 5000
    while saved(wired) != SAVED_STORED:
        wired.run(20)
        assert wired.now_ms < end_ms


def undo(wired: Wired) -> int:
    """Bring the program before back; return its checksum."""
    request = wired.session.undo()
    assert wired.until(request) == OK
    assert request.outcome
    until_saved(wired)
    return request.outcome.values.program


def writes(uno: Uno, since: int) -> list[int]:
    """Return when bytes were written."""
    return [event.cycle for event in uno.events if event.what == "eeprom" and event.cycle > since]


def test_the_program_before_is_back_also_after_power_off(sketch: Path, memory: Path) -> None:
    first, second = image_of(FIRST).checksum, image_of(SECOND).checksum
    with switched_on(sketch, memory) as uno:
        wired = computer(uno)
        assert wired.until(wired.session.undo()) == STATUSES["NO_PREVIOUS"]
        for text in (FIRST, SECOND):
            send(wired, text)
            until_saved(wired)
        for checksum in (first, second, first):
            begun = uno.cycle
            assert undo(wired) == checksum
            written = writes(uno, begun)
            assert len(written) == EVENTS
            assert written[-1] - written[0] < MOST_MS * CYCLES_PER_MS
        uno.kill()
    with switched_on(sketch, memory) as again:
        again.run_ms(500)
        again.press("button")
        again.run_ms(130)
        assert states(again) == FORWARD
        wired = computer(again)
        assert undo(wired) == second


@pytest.mark.sampled("count", keep=4)
@pytest.mark.parametrize("count", range(EVENTS + 1))
def test_switched_off_after_each_byte_it_has_one_of_the_two(
    sketch: Path,
    memory: Path,
    count: int,
) -> None:
    first, second = image_of(FIRST).checksum, image_of(SECOND).checksum
    with switched_on(sketch, memory) as uno:
        wired = computer(uno)
        for text in (FIRST, SECOND):
            send(wired, text)
            until_saved(wired)
        begun = uno.cycle
        wired.session.undo()
        end_ms = wired.now_ms + 2000
        while len(writes(uno, begun)) < count and wired.now_ms < end_ms:
            wired.run(1)
        uno.kill()
    found = []
    for nonce in (5, 6):
        with switched_on(sketch, memory) as again:
            again.run_ms(200)
            wired = computer(again, nonce)
            request = wired.session.hello()
            assert wired.until(request) == OK and request.outcome
            assert request.outcome.values.saved == SAVED_STORED
            found.append(request.outcome.values.program)
    assert found[0] == found[1]
    assert found[0] == second if count < 9 else found[0] in (first, second)
