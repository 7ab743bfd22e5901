"""A sample of the checks of the C++ machine, quick enough to be asked of hundreds of machines.

The checks are those of the tests, some with fewer random codes. A check is run once on the machine
that is right, and what it asks is kept with the answers: another machine that gives the same
answers passes it too, and is asked that in C++ alone. Only where an answer is another one does the
check itself decide.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from threading import Lock, Timer
from typing import NamedTuple

from tests.machines import Senses
from tests.machines.host import Host
from tests.support import cpp_checks, cpp_edges, cpp_images
from tests.support.casefile import Case, all_cases
from tests.vm.test_agreement import check_machine, random_program
from tests.vm.test_cases import trace_of
from tiniscript.bytecode.opcodes import CODE_BYTES
from tiniscript.kit import Kit

MAX_STEPS = 20_000  # no case needs more while no time passes


class Check(NamedTuple):
    kind: str
    name: str
    run: Callable[[Host], object]


class Asked(NamedTuple):
    """A check, and what it asked of a machine that passed it: letter, request, answer."""

    check: Check
    questions: list[tuple[bytes, bytes, bytes]]
    seconds: float


def checks() -> Iterator[Check]:
    """Yield the checks, those first that say most about little."""
    for case in all_cases():
        if "robot" in case.parts:
            yield Check("case", case.id, partial(check_case, case))
        if "bytecode" in case.parts and "tiniscript" not in case.parts:
            yield Check("case", case.id, partial(_listing, case))
    for name in cpp_checks.OPERATIONS:
        yield Check("arithmetic", name, partial(_arithmetic, name))
    for length in (CODE_BYTES, CODE_BYTES + 1):
        yield Check("verdicts", f"{length} bytes", partial(_length, length))
    for devices in (0, 1, 32, 33, 255):
        yield Check("verdicts", f"{devices} sensors", partial(_devices, devices))
    yield Check("verdicts", "many DEFs", cpp_edges.check_many_defs)
    yield Check("verdicts", "what is closed", cpp_edges.check_what_is_closed)
    yield Check("verdicts", "what procedures need", cpp_edges.check_needs)
    yield Check("memory", "places", cpp_edges.check_places)
    yield Check("memory", "what is in a code", cpp_edges.check_shorts)
    yield Check("time", "24 days", cpp_edges.check_long_time)
    yield Check("images", "random images", partial(_images, 0))
    yield Check("images", "long images", cpp_images.check_long_images)
    yield Check("images", "images of programs", partial(_whole_images, 0))
    for late_ms in (0, 19, 20, 21, 100):
        yield Check("time", f"{late_ms} ms late", partial(_late, late_ms))
    yield Check("time", "behind 2^32 ms", lambda host: cpp_checks.check_round(host.run_late))
    yield Check("time", "weeks between two ticks", cpp_checks.check_weeks)
    for begin_ms in (1, 2**31 - 500, 2**32 - 1500):
        yield Check("time", f"from {begin_ms} ms on", partial(_clock, begin_ms))
    yield Check("time", "a robot that is not ready", cpp_checks.check_not_ready)
    yield Check("memory", "code that changed", cpp_edges.check_run_time_checks)
    yield Check("random", "200 programs and the oracle", _programs)
    yield Check("random", "all codes of up to two bytes", cpp_checks.check_short_codes)
    for few_at in (1, 2):
        yield Check("random", f"pairs of opcodes, few at {few_at}", partial(_pairs, few_at))
    for seed in (0, 1):
        yield Check("random", f"random codes, seed {seed}", partial(_batch, seed))
    yield Check("memory", "code that no verifier has seen", cpp_checks.check_memory)
    for first in range(0, 256, 16):
        yield Check("memory", f"three bytes from {first:02x}", partial(_safely, first))


def check_case(case: Case, host: Host) -> None:
    """The machine does what the case says."""

    def run(image: bytes, kit: Kit, senses: Senses) -> str:
        return host.run(image, kit, senses._replace(max_steps=MAX_STEPS)).trace

    trace = trace_of(case, run)
    assert trace == case.parts["robot"], f"{case.id}:\n{trace}"


def _listing(case: Case, host: Host) -> None:
    cpp_checks.check_listing(host, case)


def _arithmetic(name: str, host: Host) -> None:
    cpp_checks.check_arithmetic(host, name, 8000)


def _length(length: int, host: Host) -> None:
    cpp_checks.check_length(host, length)


def _devices(devices: int, host: Host) -> None:
    cpp_checks.check_devices(host, devices)


def _images(seed: int, host: Host) -> None:
    cpp_images.check_images(host, seed, 10_000)


def _whole_images(seed: int, host: Host) -> None:
    cpp_images.check_whole_images(host, seed, 1000)


def _late(late_ms: int, host: Host) -> None:
    cpp_checks.check_late(host, late_ms)


def _clock(begin_ms: int, host: Host) -> None:
    cpp_checks.check_clock(host, begin_ms)


def _pairs(few_at: int, host: Host) -> None:
    cpp_checks.check_pairs(host, few_at)


def _batch(seed: int, host: Host) -> None:
    cpp_checks.check_a_batch(host, seed, 25_000)


def _safely(first: int, host: Host) -> None:
    cpp_checks.check_runs_safely(host, first)


def _programs(host: Host) -> None:
    def run(image: bytes, kit: Kit, senses: Senses) -> str:
        return host.run(image, kit, senses).trace

    for seed in range(200):
        check_machine(random_program(seed), "host", run)


class _Noting(Host):
    """A machine that notes what it is asked, and what it answers."""

    def __init__(self, sources: Path, builds: Path) -> None:
        super().__init__(sources, builds)
        self.questions: list[tuple[bytes, bytes, bytes]] = []

    def ask(self, letter: bytes, request: bytes) -> bytes:
        answer = super().ask(letter, request)
        self.questions.append((letter, request, answer))
        return answer


class Sample:
    """The checks, and what they ask of the machine of `sources`, which must pass them.

    A check is run when it is first needed. Several threads may share a sample.
    """

    def __init__(self, sources: Path, builds: Path) -> None:
        self._builds = builds
        self._host = _Noting(sources, builds)
        self._checks = checks()
        self._asked: list[Asked] = []
        self._lock = Lock()

    def close(self) -> None:
        self._host.close()

    def asked(self) -> Iterator[Asked]:
        count = 0
        while True:
            with self._lock:
                if count == len(self._asked):
                    check = next(self._checks, None)
                    if check is None:
                        return
                    self._asked.append(self._ask(check))
            yield self._asked[count]
            count += 1

    def _ask(self, check: Check) -> Asked:
        begun = time.monotonic()
        self._host.questions = []
        try:
            check.run(self._host)
        except Exception as error:
            raise Unfit(f"{check.kind}: {check.name}: {error}") from error
        return Asked(check, self._host.questions, time.monotonic() - begun)

    def failing(self, sources: Path) -> tuple[Check, str] | None:
        """Return the first check that a machine fails, and what is wrong; None: it passes all.

        A machine that does not come back fails too. Raises AssertionError where g++ refuses it.
        """
        host = Host(sources, self._builds)
        try:
            for asked in self.asked():
                said = _failure(host, asked)
                if said is not None:
                    return asked.check, said
        finally:
            host.close()
        return None


class Unfit(Exception):
    """The machine that should be right fails a check: it would fail on every other one."""


def _failure(host: Host, asked: Asked) -> str | None:
    late = False

    def too_late() -> None:
        nonlocal late
        late = True
        host.end()

    timer = Timer(5 + 10 * asked.seconds, too_late)
    timer.start()
    try:
        if all(host.ask(letter, request) == answer for letter, request, answer in asked.questions):
            return None
        asked.check.run(host)
    except Exception as error:  # as in a test: whatever is raised, it has failed
        return "it does not come back" if late else str(error) or type(error).__name__
    finally:
        timer.cancel()
    return None
