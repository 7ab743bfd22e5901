"""The pins of a simulated Uno follow the trace of `tsc run`, in order and time."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from tests.support.casefile import ROOT, Case, read
from tests.support.robot_on_uno import computer, send, switched_on
from tests.support.uno_trace import OFF_MS, check_pins, last_zero, program
from tools.uno import CYCLES_PER_MS

PAPER = [case for case in read(ROOT / "tests" / "cases" / "paper.md") if "robot" in case.parts]
OTHERS = [
    "SI|F(0.3, 80) UNTIL(DISTANCE < 20); B(0.2, 40); SHOW(TIME)",
    "SI|X = 3; LOOP(X); M(X * 10, -50); W(0.15); X = X - 1; END_LOOP",
    "SI|BEEP(0.2, 440); F(0.2, 100); BEEP(0.1, 880); L(0.1, 30); SHOW(TRUE)",
    "SI|N = 2; F(10 CM, 60); R(45 * N DEG, 50); L(90 DEG, 100) UNTIL(DISTANCE < 70); B(N CM, 9)",
    "SI|DEF TURN; R(0.12, 60); W(0.05); END_DEF; LOOP(3); TURN; F(0.2, 70); END_LOOP",
]


@pytest.mark.sampled("case", keep=3)
@pytest.mark.parametrize("case", [*PAPER, *map(program, OTHERS)], ids=lambda case: case.title)
def test_the_pins_follow_the_trace(case: Case, sketch: Path, tmp_path: Path) -> None:
    with switched_on(sketch, tmp_path / "eeprom") as uno:
        check_pins(case, uno)


@pytest.mark.sampled(of="long ways of a chip")
def test_a_thousand_short_waits_take_a_minute(sketch: Path, tmp_path: Path) -> None:
    """A wait begins where the one before has ended, not when the machine comes to it."""
    with switched_on(sketch, tmp_path / "eeprom") as uno:
        heard_count = len(uno.received_bytes)
        send(computer(uno), "SI|LOOP(500); F(0.06, 50); W(0.06); END_LOOP; M(90, 90)",
             is_detached=True)  # fmt: skip
        began = last_zero(uno, heard_count)
        uno.run_ms(60_000)
        changes = [
            pin_change.cycle for pin_change in uno.pins.history("left") if pin_change.cycle > began
        ]
    times = [(cycle - began) / CYCLES_PER_MS for cycle in changes]
    assert len(times) == 1002  # 500 changes on and off, and one at the end
    assert all(abs(later_ms - earlier_ms - 60) < 2 for earlier_ms, later_ms in pairwise(times[:-1]))
    assert max(abs(time_ms - 60 * k) for k, time_ms in enumerate(times[:-1])) < OFF_MS
    assert abs(times[-2] - 60_000) < OFF_MS
