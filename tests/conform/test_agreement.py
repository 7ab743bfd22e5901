"""The kit's answers are those of all machines: Python's are written down, the others judge them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import lru_cache, partial

import pytest

from tests.conform.spec_machine import Spec
from tests.machines import avr
from tests.machines.host import host, parse_run, run_request
from tests.machines.host import missing as host_missing
from tests.machines.pace import Pace, trace_at
from tests.oracle import interpreter
from tiniscript.base.kit import Kit
from tiniscript.conformance.kit import MACHINE_FORM, MACHINE_VERSION, cases_in
from tools.generate.machine_kit import Run, answer_of, case_of, lines_of, runs

AVR_BYTES = 620  # most bytes of an image
AVR_DEVICES = 14, 4  # sensors and actuators, at most: `kMaxSensors` of the chip's runner


@lru_cache(maxsize=1)
def list_answers() -> list[tuple[Run, list[str]]]:
    answers = ((run, answer_of(run)) for run in runs())
    return [(run, answer) for run, answer in answers if answer is not None]


def pace_of(run: Run) -> Pace:
    (times,) = {*run.slow_readings.values()} or {(1, 0, 0)}
    return Pace(run.schedule[1][0], tuple(run.slow_readings), *times)


# -- the machine in C++ -------------------------------------------------------------------------


def run_by_host(run: Run) -> str:
    request = run_request(run.image, run.kit, run.senses, begin_ms=run.schedule[0])
    return parse_run(host().ask(b"P", pace_of(run).pack(run.kit) + request).decode()).trace


def run_by_avr(chip: str, run: Run) -> str:
    pace = pace_of(run)
    return avr.run_on(
        chip, run.image, run.kit, run.senses, pace=pace, begin_ms=run.schedule[0]
    ).trace  # fmt: skip


def run_by_wasm(run: Run) -> str:
    from tiniscript.vm.wasm import WasmImage

    machine = WasmImage(run.image, run.kit).machine
    return trace_at(pace_of(run), machine, run.image, run.kit, run.senses)


CPP: dict[str, tuple[Callable[[Run], str], str, int]] = {  # one of so many runs is chosen
    "host": (run_by_host, host_missing(), 1),
    "wasm": (run_by_wasm, "", 5),
    "uno": (partial(run_by_avr, avr.UNO), avr.missing(), 10),
    "mega": (partial(run_by_avr, avr.MEGA), avr.missing(), 10),
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.skipif(bool(reason), reason=reason or "here"))
        for name, (_, reason, _) in CPP.items()
    ],
)
def test_a_machine_in_cpp_agrees(name: str) -> None:
    """Calls follow a given pace; other delays are tested elsewhere, and refused images by the
    verifiers' tests.
    """
    machine, _, one_in = CPP[name]
    cases = [(run, answer) for run, answer in list_answers() if is_for(name, run, answer)]
    assert len(cases) > 800
    assert any(run.slow_readings and run.needs for run, _ in cases)
    for run, answer in cases[::one_in]:
        assert machine(run).splitlines() == answer, run.name


def is_for(name: str, run: Run, answer: list[str]) -> bool:
    begin_ms, call_intervals_ms = run.schedule
    if answer[-1].startswith("REFUSED") or len(call_intervals_ms) > 1:
        return False
    if name in avr.COMPILER_ARGUMENTS:
        sensors, actuators = AVR_DEVICES
        has_room = len(run.kit.readings) <= sensors and len(run.kit.actuators) <= actuators
        return has_room and len(run.image) < AVR_BYTES
    return name != "wasm" or not begin_ms  # this machine has no start time


# -- the oracles --------------------------------------------------------------------------------

# A run that the interpreter cannot read.
UNREAD = "text: The dashes and spaces that phones insert are accepted"


def test_the_oracles_agree() -> None:
    """The interpreter has the language reference alone. Code without text and tasks is judged by
    the machine written from the specification alone, and all refused code by its verifier."""
    spec = Spec()
    spec.refuses_only = True
    judges = Counter[str]()
    for run, answer in list_answers():
        if run.text and len(run.schedule[1]) == 1 and not run.name.startswith(UNREAD):
            judges["interpreter"] += 1
            assert predict_output(run).splitlines() == answer, run.name
        elif answer[0].startswith("REFUSED") or not run.needs:
            judges["specification"] += 1
            assert spec.answer(request_of(run, answer)) == answer, run.name
        else:
            judges["nobody"] += 1  # judged only by the document
            assert run.name.startswith("tasks: ") and not run.text, run.name
    assert judges["interpreter"] > 900 and judges["specification"] > 400
    assert judges["nobody"] < 50, "disassemblies of several tasks"


def predict_output(run: Run) -> str:
    """Return the output that the text interpreter predicts for a run."""

    def is_slow(sensor: str, now_ms: int) -> bool:
        period_ms, from_ms, to_ms = run.slow_readings.get(sensor, (1, 0, 0))
        return from_ms <= now_ms % period_ms < to_ms

    readings, max_ms, max_steps, seed = run.senses
    (call_interval_ms,) = run.schedule[1]
    return interpreter.run(
        run.text, oracle_kit(run.kit), readings, max_ms, max_steps, seed, is_slow, call_interval_ms
    )


def oracle_kit(kit: Kit) -> interpreter.Kit:
    sensors, actuators = (
        tuple(
            interpreter.Device(device.name, device.is_yes_no, device.low, device.high)
            for device in devices
        )
        for devices in (kit.sensors, kit.actuators)
    )
    return interpreter.Kit(sensors, actuators, kit.speed, kit.turn)


def request_of(run: Run, answer: list[str]) -> list[str]:
    """Return the lines that ask a process for a run, without the last one."""
    kits = [[line.removesuffix("\n") for line in lines_of(run.kit)]]
    file = {
        "form": MACHINE_FORM,
        "version": MACHINE_VERSION,
        "kits": kits,
        "cases": [case_of(run, 0, answer)],
    }
    (case,) = cases_in(file)
    return case.request().splitlines()[:-1]
