"""The command that measures the C++ machine: its numbers are of runs that were right.

No time is asserted here. Cycles of the simulated chip are no time: they are always the same.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from tests.support.platformio import firmware, shared
from tools.bench import (
    avr_bench,
    firmware_size,
    machine,
    machine_cycles,
    machine_size,
    sketch_cycles,
    workloads,
)
from tools.bench.workloads import WORKS, Work, WrongResult, check, code_of, expected

needs_chip = pytest.mark.skipif(
    bool(avr_bench.missing()), reason=avr_bench.missing() or "there is a simulated chip"
)
BY_NAME = [pytest.param(work, id=work.name) for work in WORKS]


def test_what_the_works_show() -> None:
    """A is a sum, B counts beyond 500, and C is what its loop makes of whole thousandths."""
    total = 0
    for a in range(0, 1_000_000, 1000):
        total += 3 * a
        total = (2 * total + 7) // 14 % 100_000
    shown = {work.name: expected(work).shown for work in WORKS}
    assert shown == {"A": (30_000_000,), "B": (1_000_000, 500_000), "C": (total, 1_000_000)}


def test_nothing_of_the_works_is_folded() -> None:
    """Each time around its loop takes as many instructions as its text says."""
    steps = {work.name: expected(work).steps // work.times for work in WORKS}
    assert steps == {"A": 2, "B": 3, "C": 16}  # B: 3 up to 500, then 4


@pytest.mark.parametrize("work", BY_NAME)
def test_a_wrong_value_is_an_error(work: Work) -> None:
    shown, steps = expected(work)
    check("some machine", work, shown, steps)
    wrong = (*shown[:-1], shown[-1] + 1)
    for other, so_many in ((wrong, steps), (shown[:-1], steps), (shown, steps + 1)):
        with pytest.raises(WrongResult, match=f"some machine, work {work.name}"):
            check("some machine", work, other, so_many)


def test_what_is_missing_is_said(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert machine.main() == 0
    said = capsys.readouterr().out
    for row in ("all of `tick`", "in the shipped sketch"):
        assert re.search(rf"^{re.escape(row)}( +-){{3}}$", said, re.M), row
    assert "no avr-g++ and no simavr" in said and f"no {machine_size.AVR}" in said


@needs_chip
@pytest.mark.parametrize("work", BY_NAME)
def test_the_chip_shows_what_python_does(work: Work) -> None:
    assert machine_cycles.per_iteration(work) > 1


@pytest.fixture(scope="module")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if sketch_cycles.missing():
        pytest.skip(sketch_cycles.missing())
    return firmware("uno", tmp_path_factory.mktemp("sketch"), shared(tmp_path_factory))


def test_the_sketch_runs_the_same_loop() -> None:
    """What is measured in it differs before and behind the loop alone."""
    for work in WORKS:
        text = sketch_cycles.text_of(work)
        assert f"LOOP({work.times}); {work.body} END_LOOP;" in text and "DISTANCE" not in text
        assert "LOOP" not in sketch_cycles.text_of(work, has_loop=False)
    assert "P = LIGHT_L; Q = LIGHT_L + 4; N = LIGHT_L + 97;" in sketch_cycles.text_of(WORKS[2])


@needs_chip
@pytest.mark.parametrize("work", BY_NAME)
def test_the_shipped_sketch_takes_its_main_loop_more(work: Work, sketch: Path) -> None:
    """Its values are right; and the machine runs for so long that the rest costs little."""
    short = work._replace(times=2000)
    alone = machine_cycles.per_iteration(short)
    assert alone < sketch_cycles.per_iteration(sketch, short) < 1.25 * alone


@needs_chip
def test_the_cycles_of_the_sketch_are_those_of_its_loop(sketch: Path) -> None:
    """Twice as many times around take twice as long: nothing else is counted."""
    short = [WORKS[0]._replace(times=times) for times in (2000, 4000)]
    once, twice = (sketch_cycles.per_iteration(sketch, work) for work in short)
    assert once == pytest.approx(twice, rel=0.005)
    assert once == sketch_cycles.per_iteration(sketch, short[0])


def test_a_wrong_value_of_the_sketch_is_an_error(
    sketch: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(avr_bench, "missing", lambda: "no chip but the one on the board")
    monkeypatch.setattr(sketch_cycles, "built", lambda: sketch)
    monkeypatch.setattr("tools.bench.sketch_cycles.pin_of_sensor", lambda: "A5")
    assert machine.main() == 1
    assert "wrong result: the sketch, work A" in capsys.readouterr().err


def test_a_sketch_that_is_not_built_ends_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(name: str) -> firmware_size.Sketch:
        raise RuntimeError(f"avr-g++ does not like {name}")

    monkeypatch.setattr(avr_bench, "missing", lambda: "no chip")
    monkeypatch.setattr(sketch_cycles, "missing", lambda: "")
    monkeypatch.setattr(firmware_size, "measured", refuse)
    assert machine.main() == 2
    assert "avr-g++ does not like uno" in capsys.readouterr().err


@needs_chip
def test_only_a_tick_depends_on_the_budget() -> None:
    """Each call of `tick` costs the same, whatever it runs."""
    work = WORKS[1]
    cycles = {
        budget: machine_cycles.count(code_of(work), work.thousandths, budget).cycles
        for budget in (100, 40, 8)
    }
    calls = {budget: -(-work.times // budget) for budget in cycles}
    of_call = [
        (cycles[few] - cycles[many]) / (calls[few] - calls[many])
        for many, few in ((100, 40), (40, 8))
    ]
    assert of_call[0] == pytest.approx(of_call[1], rel=0.05)
    assert 0 < of_call[0] < 1000


@pytest.mark.parametrize("name", [machine_size.AVR, *machine_size.EMULATED])
def test_size(name: str) -> None:
    if machine_size.missing(name):
        pytest.skip(machine_size.missing(name))
    whole = machine_size.size(name, "all")
    assert 2000 < whole.flash < 20_000
    assert 300 < whole.ram < 1000


@needs_chip
def test_sizes_have_parts() -> None:
    parts = [machine_size.size(machine_size.AVR, use).flash for use in ("verify", "vm and number")]
    both = machine_size.size(machine_size.AVR, "machine and verifier").flash
    assert max(parts) < both <= sum(parts)
    assert both < machine_size.size(machine_size.AVR, "all").flash


@needs_chip
@pytest.mark.parametrize(
    ("work", "must"),
    [pytest.param(*each, id=each[0].name) for each in zip(WORKS, workloads.MUST, strict=True)],
)
def test_cycles_are_at_most_what_they_must(work: Work, must: float) -> None:
    assert machine_cycles.per_iteration(work) <= must


@needs_chip
def test_flash_is_at_most_what_it_must() -> None:
    assert machine_size.size(machine_size.AVR, "machine and verifier").flash <= machine_size.MUST
