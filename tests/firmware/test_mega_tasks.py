"""Programs with tasks on a simulated Mega, with the firmware that ships: its pins, and stops."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.firmware.test_host_firmware import outcome
from tests.firmware.test_mega_text import sketch  # noqa: F401
from tests.firmware.test_uno_robot import (
    FORWARD,
    MOTORS,
    OFF,
    computer,
    send,
    states,
    switched_on,
)
from tests.firmware.test_uno_trace import check_pins, program
from tests.support.casefile import ROOT, Case, read
from tests.vm.test_tasks import STATES
from tiniscript.link.messages import STATE_STOPPED
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

BUSY = "F(FOREVER, 60);" + "TASK;X = 0;LOOP(FOREVER);X = X + 1;END_LOOP;END_TASK;" * 4
STOP = bytes(8)
STOP_RUN = (
    3  # the last zero of a stop that a robot must have seen behind a frame, which ends with one
)
STOP_US = 12


def without_readings() -> list[Case]:
    """Return the cases of tasks that a simulated board can follow to the millisecond."""
    found = [each for each in read(ROOT / "tests" / "cases" / "tasks.md") if "robot" in each.parts]
    return [each for each in found if not {"READ", "FAULT"} & set(each.parts["robot"].split())]


@pytest.fixture
def mega(sketch: Path, tmp_path: Path) -> Iterator[Uno]:  # noqa: F811
    with switched_on(sketch, tmp_path / "eeprom", "mega") as found:
        yield found


@pytest.mark.sampled("case", keep=8)
@pytest.mark.parametrize("case", without_readings(), ids=lambda case: case.title)
def test_the_pins_follow_the_trace(case: Case, mega: Uno) -> None:
    check_pins(case, mega)


def test_while_four_tasks_count_the_clock_goes_on(mega: Uno) -> None:
    text = "LOOP(3);F(0.1, 60);B(0.1, 60);END_LOOP;" + BUSY.partition(";")[2]
    check_pins(program(text)._replace(parts={"tiniscript": text, "senses": "max-time = 0.5"}), mega)


def test_a_stop_in_the_middle_of_busy_tasks(mega: Uno) -> None:
    """It is at the pins as soon as in any program; then nothing starts again."""
    wired = computer(mega)
    send(wired, BUSY, is_detached=True)
    wired.run(50)
    assert states(mega) == FORWARD
    mega.send(STOP)
    mega.run_ms(20)
    stopped = max(mega.pins[name].cycle for name in ("left", "right"))
    last = mega.received[STOP_RUN - 1 - len(STOP)].cycle
    assert states(mega) == OFF
    assert 0 < stopped - last < STOP_US * CYCLES_PER_MS // 1000
    wired.run(300)
    assert states(mega) == OFF
    assert wired.session.events()[-1].name == "STOPPED"


@pytest.mark.parametrize("state", STATES)
def test_a_stop_ends_all_tasks(state: str, mega: Uno) -> None:
    """None goes on afterwards, nor in the next program."""
    wired = computer(mega)
    send(wired, STATES[state], is_detached=True)
    wired.run(300)
    assert (states(mega) == OFF) == (state == "a task waits")
    mega.send(STOP)
    mega.run_ms(20)
    assert states(mega) == OFF
    stopped = mega.cycle
    wired.run(2000)
    assert not [name for name in MOTORS if mega.pins.history(name)[-1].cycle > stopped]
    status = wired.session.status()
    assert wired.until(status) == OK
    assert outcome(status).values.state == STATE_STOPPED
    send(wired, "F(600, 80)", is_detached=True)
    wired.run(100)
    assert states(mega) == FORWARD
