"""A main loop that hangs: the motors go off, and the chip restarts and reports the reason."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.wired import Wired
from tests.support.images import image_of
from tests.support.robot_on_uno import (
    AWAY_PROGRAM,
    BAUD,
    FORWARD,
    NAMES,
    OFF,
    computer,
    send,
    states,
)
from tests.support.uno_watchdog import (
    HANGING_LOOP,
    HANGING_LOOP_WITHOUT_INTERRUPTS,
    STALL,
    TIMER_MS,
    WATCHDOG,
    WATCHDOG_MS,
    build_hanging_firmware,
    is_on,
)
from tiniscript.link.payloads import HelloReply
from tiniscript.link.trim import Pace, Trim, trim_from_reply
from tools.uno import CYCLES_PER_MS, Uno

LATER = "SI|W(0.1); F(70, 80)"
MOVE_AT = {AWAY_PROGRAM: 2, LATER: 4}  # the offset of the move, after its values
PACED = Trim(is_exchanged=True, least=3, pace=Pace(10, 20, 30, 40))


def hello_of(wired_uno: Wired) -> HelloReply:
    """Return the robot's answer to HELLO."""
    return wired_uno.complete(wired_uno.session.hello())


@pytest.mark.sampled("board")
@pytest.mark.parametrize("board", ["uno", "nano", "mega"])
@pytest.mark.parametrize(
    ("hang", "limit_ms"),
    [
        pytest.param(HANGING_LOOP, TIMER_MS, id="the timer turns the motors off"),
        pytest.param(
            HANGING_LOOP_WITHOUT_INTERRUPTS, WATCHDOG_MS, id="the watchdog, with interrupts off"
        ),
    ],
)
def test_a_hanging_main_loop_is_reset(hang: str, limit_ms: int, board: str, tmp_path: Path) -> None:
    """The program becomes the last fault, even after a power-off. A second hang has the same
    effect, and no other data is lost.
    """
    elf = build_hanging_firmware(tmp_path, hang, board)
    eeprom_path = tmp_path / "eeprom"
    chip = "mega" if board == "mega" else "uno"
    with Uno(elf, names=NAMES, board=chip, baud=BAUD, eeprom=eeprom_path) as uno:
        uno.run_ms(300)
        wired_uno = computer(uno)
        assert wired_uno.complete(wired_uno.session.trim(PACED.data()))
        for number, text in enumerate((AWAY_PROGRAM, LATER)):
            wired_uno = computer(uno, 2 + 2 * number)
            send(wired_uno, text)
            wired_uno.run(400)
            assert states(uno) == FORWARD
            start_cycle = uno.cycle
            uno.drive("button", False)
            uno.run_ms(limit_ms)
            assert not is_on(uno)
            changes = (change for name in ("left", "right") for change in uno.pins.history(name))
            assert max(change.cycle for change in changes) - start_cycle <= limit_ms * CYCLES_PER_MS
            uno.drive("button", None)
            uno.run_ms(1000)
            assert states(uno) == OFF
            hello_reply = hello_of(computer(uno, 3 + 2 * number))
            assert hello_reply.reset == WATCHDOG
            fault_facts = (hello_reply.fault, hello_reply.fault_program, hello_reply.fault_at)
            assert fault_facts == (STALL, image_of(text).checksum, MOVE_AT[text])
            uno.run_ms(500)
            assert states(uno) == OFF
            uno.reset()
            uno.run_ms(300)
            assert hello_of(computer(uno, 8 + number)).reset != WATCHDOG
    with Uno(elf, names=NAMES, board=chip, baud=BAUD, eeprom=eeprom_path) as restarted_robot:
        restarted_robot.run_ms(300)
        wired_uno = computer(restarted_robot, 7)
        hello_reply = hello_of(wired_uno)
        assert (hello_reply.reset, hello_reply.fault) == (1, STALL)
        assert hello_reply.fault_program == image_of(text).checksum
        assert trim_from_reply(wired_uno.complete(wired_uno.session.trim())) == PACED


@pytest.mark.sampled(of="hangs of an Uno")
def test_a_main_loop_that_stalled_briefly_runs_the_next_program(tmp_path: Path) -> None:
    pauses = "for (uint8_t k = 0; k < 112; k++) {\n __builtin_avr_delay_cycles(16000);\n }"
    with Uno(build_hanging_firmware(tmp_path, pauses), names=NAMES, baud=BAUD) as uno:
        uno.run_ms(300)
        send(computer(uno), AWAY_PROGRAM)
        uno.drive("button", False)
        uno.run_ms(400)
        uno.drive("button", None)
        uno.run_ms(100)
        assert states(uno) == OFF
        wired_uno = computer(uno, 2)
        hello_reply = hello_of(wired_uno)
        assert (hello_reply.reset, hello_reply.fault) == (1, STALL)
        send(wired_uno, AWAY_PROGRAM)
        wired_uno.run(300)
        assert states(uno) == FORWARD


@pytest.mark.sampled(of="hangs of an Uno")
def test_a_hang_without_a_program_is_not_a_program_fault(tmp_path: Path) -> None:
    with Uno(build_hanging_firmware(tmp_path, HANGING_LOOP), names=NAMES, baud=BAUD) as uno:
        uno.run_ms(300)
        uno.press("button")
        uno.run_ms(600)
        hello_reply = hello_of(computer(uno))
        fault_facts = (
            hello_reply.reset,
            hello_reply.fault,
            hello_reply.fault_program,
            hello_reply.fault_at,
        )
        assert fault_facts == (WATCHDOG, STALL, 0, 0)


def test_a_reset_without_a_hang_is_not_a_fault(uno: Uno) -> None:
    """This holds in the middle of a program, too; and each nonce differs from the last, even if
    nothing happens in between and each reset takes the same number of cycles."""
    nonces = []
    for number in range(5):
        wired_uno = computer(uno, number + 1)
        hello_reply = hello_of(wired_uno)
        assert hello_reply.fault == 0
        nonces.append(hello_reply.nonce)
        send(wired_uno, AWAY_PROGRAM)
        assert states(uno) == FORWARD
        uno.reset()
        uno.run_ms(300)
    for _ in range(5):
        uno.reset()
        uno.run_ms(200)
        nonces.append(hello_of(computer(uno, 7)).nonce)
    assert len(set(nonces)) == 10
