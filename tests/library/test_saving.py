"""The wait for a robot that is saving a program, on a fake clock."""

from __future__ import annotations

import random
from argparse import Namespace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from tiniscript.cli.robot import run_monitor
from tiniscript.library import client
from tiniscript.library.client import LOW_VOLTAGE_TIMEOUT_S, SAVE_TIMEOUT_S, Saving
from tiniscript.link.messages import SAVED_LOW_SUPPLY, SAVED_SAVING, SAVED_STORED
from tiniscript.link.payloads import ReceiptReply, StatusReply
from tiniscript.link.requests import OK, Reply

LOOK_S = 0.1
PROGRAM = 7


class Clock:
    def __init__(self) -> None:
        self.now_s = 0.0  # a clock may begin there

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made_clock = Clock()
    monkeypatch.setattr(client, "monotonic", made_clock)
    return made_clock


def receipt(saved: int) -> ReceiptReply:
    return ReceiptReply(**{**dict.fromkeys(ReceiptReply._fields, 0), "program": PROGRAM,
                           "saved": saved})  # fmt: skip


def status(saved: int) -> StatusReply:
    fields: dict[str, Any] = dict.fromkeys(StatusReply._fields, 0)
    return StatusReply(**{**fields, "program": PROGRAM, "saved": saved})


def wait_for_saving(clock: Clock, saving: Saving, story: list[tuple[float, int]]) -> float:
    """Let the robot say, up to each of these times, how far it is; return how long it was asked."""
    began_s = clock.now_s
    for _ in saving.polls():
        passed_s = clock.now_s - began_s
        saving.update(status(next(saved for until_s, saved in story if passed_s < until_s)))
        clock.now_s += LOOK_S
        assert passed_s <= SAVE_TIMEOUT_S + LOOK_S, "it waits for ever"
    return clock.now_s - began_s


@pytest.mark.parametrize("seed", range(60))
def test_supply_dips_do_not_end_a_save_in_progress(clock: Clock, seed: int) -> None:
    rng = random.Random(seed)
    story, at_s = [], 0.0
    done_s = rng.uniform(LOW_VOLTAGE_TIMEOUT_S, SAVE_TIMEOUT_S - 1)
    is_low = rng.random() < 0.5
    while at_s < done_s:
        at_s += (
            rng.uniform(0.1, LOW_VOLTAGE_TIMEOUT_S - 2 * LOOK_S)
            if is_low
            else rng.uniform(2 * LOOK_S, 1.5)
        )
        story.append((min(at_s, done_s), SAVED_LOW_SUPPLY if is_low else SAVED_SAVING))
        is_low = not is_low
    story.append((SAVE_TIMEOUT_S * 9, SAVED_STORED))
    first_state = SAVED_LOW_SUPPLY if rng.random() < 0.5 else SAVED_SAVING
    clock.now_s = rng.choice((0.0, 5.0, 1e6))
    saving = Saving(receipt(first_state))
    wait_for_saving(clock, saving, story)
    assert (saving.is_over, saving.reason) == (True, ""), story


@pytest.mark.parametrize("seed", range(30))
def test_a_low_supply_is_waited_for_equally_long_each_time(clock: Clock, seed: int) -> None:
    """Earlier events do not matter, and a second wait is as long as the first."""
    rng = random.Random(seed)
    saving = Saving(receipt(SAVED_SAVING))
    for _ in range(3):
        dip_s = rng.uniform(0, 1.5)
        good_s = dip_s + rng.uniform(0.3, 3)
        story = [
            (dip_s, SAVED_LOW_SUPPLY),
            (good_s, SAVED_SAVING),
            (SAVE_TIMEOUT_S * 9, SAVED_LOW_SUPPLY),
        ]
        assert (
            good_s + LOW_VOLTAGE_TIMEOUT_S - LOOK_S
            <= wait_for_saving(clock, saving, story)
            <= good_s + LOW_VOLTAGE_TIMEOUT_S + 4 * LOOK_S
        )
        assert saving.reason == "low_supply"
        clock.now_s += rng.uniform(0, 20)


def test_an_endless_save_is_given_up(clock: Clock) -> None:
    saving = Saving(receipt(SAVED_SAVING))
    assert (
        SAVE_TIMEOUT_S
        <= wait_for_saving(clock, saving, [(SAVE_TIMEOUT_S * 9, SAVED_SAVING)])
        <= SAVE_TIMEOUT_S + LOOK_S
    )
    assert saving.reason == "saves_later"
    assert wait_for_saving(clock, saving, [(SAVE_TIMEOUT_S * 9, SAVED_STORED)]) == pytest.approx(
        LOOK_S
    )
    assert saving.reason == ""


# -- while the program runs ---------------------------------------------------------------------


class Asked:
    outcome: Reply[StatusReply] | None = None


class Line:
    """A connection to a robot that says how far it is, each time after a while."""

    language, options = "en", Namespace()

    def __init__(self) -> None:
        self.asked: list[Asked] = []

    def begin_request(self, make: object) -> Asked:
        self.asked.append(Asked())
        return self.asked[-1]


@pytest.mark.parametrize("seed", range(30))
def test_the_save_state_of_a_program_is_reported_while_it_runs(
    clock: Clock, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """A supply that is low, each time, and that it is saved: one answer is not the last one."""
    monkeypatch.setattr(run_monitor, "monotonic", clock)
    rng = random.Random(seed)
    late_s = rng.uniform(0, 0.5)
    story, expected_reasons = [], []
    for _ in range(rng.randrange(4)):
        story += [(rng.uniform(2, 5), SAVED_SAVING), (rng.uniform(2, 5), SAVED_LOW_SUPPLY)]
        expected_reasons.append("LOW_SUPPLY")
    story += [(rng.uniform(2, 5), SAVED_SAVING), (5.0, SAVED_STORED)]
    line, printed_names = Line(), list[str]()
    printer = SimpleNamespace(
        print_values=lambda at_ms, name, *rest, **more: printed_names.append(name)
    )
    saving = run_monitor.Saving(cast("Any", line), cast("Any", printer), receipt(SAVED_SAVING))
    for lasts_s, saved in story:
        end_s = clock.now_s + lasts_s
        while clock.now_s < end_s:
            if len(line.asked) > 0 and line.asked[-1].outcome is None and rng.random() > late_s:
                line.asked[-1].outcome = Reply(OK, 0, status(saved))
            saving.poll()
            clock.now_s += LOOK_S
    assert printed_names == [*expected_reasons, "SAVED"]
    assert len(line.asked) <= 1 + clock.now_s / run_monitor.STATUS_INTERVAL_S
