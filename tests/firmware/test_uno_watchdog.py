"""A main loop that stands still: the motors go off, the chip starts anew and says why."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.wired import Wired
from tests.support.images import image_of
from tests.support.robot_on_uno import AWAY, BAUD, FORWARD, NAMES, OFF, computer, send, states
from tests.support.uno_watchdog import (
    HANGS,
    HANGS_ALONE,
    STALL,
    TIMER_MS,
    WATCHDOG,
    WATCHDOG_MS,
    built,
    is_on,
)
from tiniscript.link.payloads import HelloReply
from tiniscript.link.trim import Pace, Trim, trim_from_reply
from tools.uno import CYCLES_PER_MS, Uno

LATER = "SI|W(0.1); F(70, 80)"
MOVE_AT = {AWAY: 2, LATER: 4}  # the offset of the move, after what it takes
PACED = Trim(is_exchanged=True, least=3, pace=Pace(10, 20, 30, 40))


def hello_of(wired: Wired) -> HelloReply:
    """Return what HELLO says of the robot."""
    return wired.complete(wired.session.hello())


@pytest.mark.sampled("board")
@pytest.mark.parametrize("board", ["uno", "nano", "mega"])
@pytest.mark.parametrize(
    ("hang", "limit_ms"),
    [
        pytest.param(HANGS, TIMER_MS, id="the timer turns the motors off"),
        pytest.param(HANGS_ALONE, WATCHDOG_MS, id="the watchdog, with interrupts off"),
    ],
)
def test_a_main_loop_that_hangs(hang: str, limit_ms: int, board: str, tmp_path: Path) -> None:
    """What ran is the last fault of the robot, also after it was without power. A second hang is as
    the first one, and nothing else that the robot keeps is lost."""
    elf = built(tmp_path, hang, board)
    kept = tmp_path / "eeprom"
    chip = "mega" if board == "mega" else "uno"
    with Uno(elf, names=NAMES, board=chip, baud=BAUD, eeprom=kept) as uno:
        uno.run_ms(300)
        wired = computer(uno)
        assert wired.complete(wired.session.trim(PACED.data()))
        for number, text in enumerate((AWAY, LATER)):
            wired = computer(uno, 2 + 2 * number)
            send(wired, text)
            wired.run(400)
            assert states(uno) == FORWARD
            began = uno.cycle
            uno.drive("button", False)
            uno.run_ms(limit_ms)
            assert not is_on(uno)
            changes = (change for name in ("left", "right") for change in uno.pins.history(name))
            assert max(change.cycle for change in changes) - began <= limit_ms * CYCLES_PER_MS
            uno.drive("button", None)
            uno.run_ms(1000)
            assert states(uno) == OFF
            hello_reply = hello_of(computer(uno, 3 + 2 * number))
            assert hello_reply.reset == WATCHDOG
            what = (hello_reply.fault, hello_reply.fault_program, hello_reply.fault_at)
            assert what == (STALL, image_of(text).checksum, MOVE_AT[text])
            uno.run_ms(500)
            assert states(uno) == OFF
            uno.reset()
            uno.run_ms(300)
            assert hello_of(computer(uno, 8 + number)).reset != WATCHDOG
    with Uno(elf, names=NAMES, board=chip, baud=BAUD, eeprom=kept) as restarted:
        restarted.run_ms(300)
        wired = computer(restarted, 7)
        hello_reply = hello_of(wired)
        assert (hello_reply.reset, hello_reply.fault) == (1, STALL)
        assert hello_reply.fault_program == image_of(text).checksum
        assert trim_from_reply(wired.complete(wired.session.trim())) == PACED


@pytest.mark.sampled(of="hangs of an Uno")
def test_a_main_loop_that_stood_still_for_a_moment_runs_the_next_program(tmp_path: Path) -> None:
    pauses = "for (uint8_t k = 0; k < 112; k++) {\n __builtin_avr_delay_cycles(16000);\n }"
    with Uno(built(tmp_path, pauses), names=NAMES, baud=BAUD) as uno:
        uno.run_ms(300)
        send(computer(uno), AWAY)
        uno.drive("button", False)
        uno.run_ms(400)
        uno.drive("button", None)
        uno.run_ms(100)
        assert states(uno) == OFF
        wired = computer(uno, 2)
        hello_reply = hello_of(wired)
        assert (hello_reply.reset, hello_reply.fault) == (1, STALL)
        send(wired, AWAY)
        wired.run(300)
        assert states(uno) == FORWARD


@pytest.mark.sampled(of="hangs of an Uno")
def test_a_hang_without_a_program_is_a_fault_of_none(tmp_path: Path) -> None:
    with Uno(built(tmp_path, HANGS), names=NAMES, baud=BAUD) as uno:
        uno.run_ms(300)
        uno.press("button")
        uno.run_ms(600)
        hello_reply = hello_of(computer(uno))
        what = (
            hello_reply.reset,
            hello_reply.fault,
            hello_reply.fault_program,
            hello_reply.fault_at,
        )
        assert what == (WATCHDOG, STALL, 0, 0)


def test_a_reset_that_is_no_hang_is_no_fault(uno: Uno) -> None:
    """Not in the middle of a program either; and the next nonce is another one each time, also
    where nothing happens in between and each reset takes the same number of cycles."""
    nonces = []
    for number in range(5):
        wired = computer(uno, number + 1)
        hello_reply = hello_of(wired)
        assert hello_reply.fault == 0
        nonces.append(hello_reply.nonce)
        send(wired, AWAY)
        assert states(uno) == FORWARD
        uno.reset()
        uno.run_ms(300)
    for _ in range(5):
        uno.reset()
        uno.run_ms(200)
        nonces.append(hello_of(computer(uno, 7)).nonce)
    assert len(set(nonces)) == 10
