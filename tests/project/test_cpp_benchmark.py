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
    interpreters,
    machine,
    machine_cycles,
    machine_size,
    machine_speed,
    native_cycles,
    sketch_cycles,
    workloads,
)
from tools.bench.workloads import (
    ALL_WORKS,
    WORKS,
    Work,
    WrongResult,
    check,
    code_of,
    driven,
    expected,
)

needs_chip = pytest.mark.skipif(
    bool(avr_bench.missing()), reason=avr_bench.missing() or "there is a simulated chip"
)
BY_NAME = [pytest.param(work, id=work.name) for work in WORKS]
ALL_BY_NAME = [pytest.param(work, id=work.name) for work in ALL_WORKS]


def test_what_the_works_show() -> None:
    """A is a sum, B counts beyond 500, and C is what its loop makes of whole thousandths."""
    total = 0
    for a in range(0, 1_000_000, 1000):
        total += 3 * a
        total = (2 * total + 7) // 14 % 100_000
    shown = {work.name: expected(work).shown for work in WORKS}
    assert shown == {"A": (30_000_000,), "B": (1_000_000, 500_000), "C": (total, 1_000_000)}


def test_what_the_works_beside_c_show() -> None:
    """D meets three obstacles in eight readings; E drives by the last of its own."""
    found = {work.name: (expected(work).shown, driven(work)) for work in ALL_WORKS[len(WORKS) :]}
    assert found == {
        "A2": ((30_000_000,), (0, 0)),
        "D": ((375_000,), (60, -60)),
        "E": ((-1000,), (46, 54)),
        "F": ((1_000_000,), (0, 0)),
    }


def test_nothing_of_the_works_is_folded() -> None:
    """Each time around its loop takes as many instructions as its text says."""
    steps = {work.name: expected(work).steps // work.times for work in ALL_WORKS}
    # B: 3 up to 500, then 4; D: 4 or 7
    assert steps == {"A": 2, "A2": 2, "B": 3, "C": 16, "D": 5, "E": 16, "F": 4}


@pytest.mark.parametrize("work", BY_NAME)
def test_a_wrong_value_is_an_error(work: Work) -> None:
    shown, steps = expected(work)
    check("some machine", work, shown, steps)
    wrong = (*shown[:-1], shown[-1] + 1)
    for other, so_many in ((wrong, steps), (shown[:-1], steps), (shown, steps + 1)):
        with pytest.raises(WrongResult, match=f"some machine, work {work.name}"):
            check("some machine", work, other, so_many)


def test_a_wrong_value_ends_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(machine, "ROUNDS", 1)
    short = WORKS[0]._replace(times=9999)
    monkeypatch.setattr("tools.bench.machine_speed.code_of", lambda work: code_of(short))
    assert machine.main(["speeds"]) == 1
    assert "wrong result: " in capsys.readouterr().err


def test_what_is_missing_is_said(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(machine_speed, "find_spec", lambda name: None)
    monkeypatch.setattr(interpreters, "find_spec", lambda name: None)
    monkeypatch.setattr(machine, "ROUNDS", 1)
    monkeypatch.setattr(machine, "TIMES", 600)
    assert machine.main([]) == 0
    said = capsys.readouterr().out
    for row in ("TiniScript ", machine_size.AVR, *machine_size.EMULATED):
        assert re.search(rf"^\| {re.escape(row)}.*\| +- \|", said, re.M), row
    for tool in ("avr-g++", "simavr", "g++", "clang-22", "xtensa-lx106-elf-gcc", "wasmtime",
                 "lua5.4", "micropython", "pywasm3"):  # fmt: skip
        assert f"no {tool}" in said
    for row in ("Lua 5.4", "MicroPython", "wasm3"):
        assert re.search(rf"^\| {row} .*\|( +- \|){{3}}$", said, re.M), row
    steps = f"{expected(WORKS[0]).steps:,}"
    assert re.search(rf"^\| A, {steps} instructions +\|( +- \|){{4}} +\d", said, re.M)


def test_the_loops_of_other_interpreters_are_the_works() -> None:
    """In whole numbers: a quotient has no places."""
    shown = {work.name: interpreters.expected(work) for work in WORKS}
    y = 0
    for a in range(1000):
        y = (y + 3 * a) // 7 % 100
    assert shown == {"A": [30_000], "B": [1000, 500], "C": [y, 1000]}


@pytest.mark.parametrize("work", BY_NAME)
@pytest.mark.parametrize(
    "each",
    [each for each in interpreters.all_of_them() if not each.missing],  # Python is always there
    ids=lambda each: each.name,
)
def test_an_interpreter_that_is_there_shows_the_same(
    each: machine_speed.Timed, work: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    each.seconds(work)
    monkeypatch.setattr(interpreters, "expected", lambda work: [0] * (1 + (work.name != "A")))
    with pytest.raises(WrongResult, match=f"work {work.name}: "):
        each.seconds(work)


def test_a_part_that_is_none(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        machine.main(["cycles", "colours"])
    assert "no part is called colours" in capsys.readouterr().err


def test_table(capsys: pytest.CaptureFixture[str]) -> None:
    machine.table("T", ("", "n", "kind"), [("a", 1234.56, "x"), ("bc", "-", "")])
    assert capsys.readouterr().out.splitlines()[4:] == [
        "| -- | ------: | ---- |",
        "| a  | 1,234.6 | x    |",
        "| bc |       - |      |",
    ]


@needs_chip
@pytest.mark.parametrize("work", ALL_BY_NAME)
def test_the_chip_shows_what_python_does(work: Work) -> None:
    assert machine_cycles.per_iteration(work) > 1


@needs_chip
@pytest.mark.parametrize("work", ALL_BY_NAME)
def test_c_alone_shows_the_same(work: Work) -> None:
    """In whole numbers, as other interpreters do, or in thousandths."""
    assert 1 < native_cycles.per_iteration(work) < machine_cycles.per_iteration(work)
    if work.name in native_cycles.THOUSANDTHS:
        assert native_cycles.per_iteration(work, has_thousandths=True) > 1


@needs_chip
def test_a_wrong_value_of_c_alone_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native_cycles, "driven", lambda work: (1, 2))
    with pytest.raises(WrongResult, match="C alone, work E"):
        native_cycles.per_iteration(ALL_WORKS[-2])
    monkeypatch.setattr(native_cycles, "wanted", lambda work, has_thousandths: [1])
    with pytest.raises(WrongResult, match="C alone, work A"):
        native_cycles.per_iteration(WORKS[0])


@needs_chip
def test_the_chip_has_driven_what_python_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine_cycles, "driven", lambda work: (1, 2))
    with pytest.raises(WrongResult, match="work D: motors"):
        machine_cycles.per_iteration(ALL_WORKS[-3])


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
    assert machine.main(["cycles"]) == 1
    assert "wrong result: the sketch, work A" in capsys.readouterr().err


def test_a_sketch_that_is_not_built_ends_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(name: str) -> firmware_size.Sketch:
        raise RuntimeError(f"avr-g++ does not like {name}")

    monkeypatch.setattr(avr_bench, "missing", lambda: "no chip")
    monkeypatch.setattr(sketch_cycles, "missing", lambda: "")
    monkeypatch.setattr(firmware_size, "measured", refuse)
    assert machine.main(["cycles"]) == 2
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


@needs_chip
def test_cycles_of_arithmetic() -> None:
    least = {name: machine_cycles.of_arithmetic(name)[0] for name in ("ADD", "MUL")}
    assert 0 < least["ADD"] < least["MUL"]


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


def test_machines_of_this_computer_are_right(tmp_path: Path) -> None:
    for each in (
        machine_speed.of_host(tmp_path / "host"),
        machine_speed.of_wasm(),
        machine_speed.of_python(),
    ):
        if not each.missing:
            assert each.seconds(workloads.WORKS[2]) > 0


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
