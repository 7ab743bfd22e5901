"""Python and C++ agree: verdicts, refusals, arithmetic, and every line of every run.

`python -m tests.vm.test_cpp_agreement 10000000` compares more random codes than the tests, and
`--three` all codes of three bytes.
"""

from __future__ import annotations

import random
import time
import zlib
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from itertools import product
from struct import pack as struct_pack

import pytest

from tests.machines import Senses
from tests.machines.host import host
from tests.support import cpp_checks
from tests.support.campaign import make_options
from tests.support.case_runs import robot_and_senses
from tests.support.casefile import Case
from tests.support.cpp_checks import (
    KIT,
    MAX_MS,
    MAX_STEPS,
    OPERATIONS,
    SIZES,
    WIDE_KIT,
    check_arithmetic,
    check_codes,
    check_round,
    compare_runs,
    compare_verdicts,
    python_verdict,
    run_late,
    some_task_programs,
)
from tests.support.random_codes import random_codes, simple, some_programs
from tests.support.rows import each_row
from tests.support.vm_cases import disassemblies_alone
from tiniscript import compile_text
from tiniscript.base.limits import CODE_BYTES
from tiniscript.bytecode.disassembly import assemble
from tiniscript.bytecode.image import (
    ALL_NEEDS,
    GO,
    HEADER_BYTES,
    REFUSALS,
    TASKS,
    pack,
    with_checksum,
)
from tiniscript.bytecode.opcodes import BY_NAME, ISA_MINOR, NEEDS_GO, OPS
from tiniscript.bytecode.verify import RULES, load_image
from tiniscript.vm.tasks import machine_of

BATCH_SIZE = 12_500
BATCH_COUNT = 80  # batches of the tests


# -- code ---------------------------------------------------------------------------------------


@each_row("case", disassemblies_alone())
def test_disassembly_has_the_same_verdict(case: Case) -> None:
    """This also holds for each of its prefixes."""
    kit = robot_and_senses(case)[0].kit
    code = assemble(case.parts["bytecode"])
    beginnings = [code[:length] for length in range(len(code) + 1)]
    for needs in (0, TASKS, GO, ALL_NEEDS):
        compare_verdicts(host(), beginnings, len(kit.readings), len(kit.actuators), needs)


def test_the_length_limit_of_code_is_checked() -> None:
    lengths = (0, 1, CODE_BYTES - 1, CODE_BYTES, CODE_BYTES + 1, 100_000)
    compare_verdicts(host(), [simple("STOP") * length for length in lengths], 3, 2)


@each_row("devices", [0, 1, 32, 33, 255])
def test_the_number_of_devices_is_checked(devices: int) -> None:
    """Sensors and actuators of every number, for a kit that has so many sensors."""
    codes = [simple("READ") + bytes([k]) for k in range(256)]
    codes += [simple("PUSH_TRUE") + simple("SET") + bytes([k]) for k in range(256)]
    codes += [simple("PUSH_TRUE") * op.pops + bytes([op.code]) for op in OPS if op.implied]
    compare_verdicts(host(), codes, devices, 255 - devices)


def check_and_run(codes: Sequence[bytes]) -> None:
    for code in compare_verdicts(host(), codes, *SIZES):
        compare_runs(host(), code, WIDE_KIT, Senses(max_ms=100, max_steps=50))


def test_all_codes_of_up_to_two_bytes_agree() -> None:
    check_and_run(
        [bytes(values) for size in range(3) for values in product(range(256), repeat=size)]
    )


@pytest.mark.sampled("few_at")
@pytest.mark.parametrize("few_at", [1, 2])
def test_codes_of_three_bytes_with_two_opcodes_agree(few_at: int) -> None:
    """All pairs of opcodes; the byte at `few_at` is one of the edges of its ranges."""
    opcodes = [op.code for op in OPS if op.needs != NEEDS_GO]
    sets = [opcodes, opcodes, opcodes]
    sets[few_at] = [0, 1, 2, 3, 31, 32, 100, 101, 127, 128, 156, 255]
    check_and_run([bytes(values) for values in product(*sets)])


@pytest.mark.parametrize("first", range(0, 256, 16), ids=lambda first: f"from {first:02x}")
def test_all_codes_of_three_bytes_run_safely(first: int) -> None:
    """In C++ alone: code accepted by its verifier never fails a run-time check."""
    for byte in range(first, first + 16):
        accepted_count, wrong_count, _ = host().all_of_three(byte, 3, 2)
        assert wrong_count == 0, (
            f"{wrong_count} of {accepted_count} codes that begin with {byte:02x}"
        )


def check_three(first: int) -> int:
    """All codes of three bytes that begin with `first` have the same verdict.

    Return how many are accepted.
    """
    accepted_count, wrong_count, checksum = host().all_of_three(first, 3, 2)
    python_checksum = 0
    for rest in product(range(256), repeat=2):
        verdict = python_verdict(bytes((first, *rest)), 3, 2)
        python_checksum = zlib.crc32(struct_pack("<BH", *verdict), python_checksum)
    assert (wrong_count, checksum) == (0, python_checksum), f"{first:02x}"
    return accepted_count


@pytest.mark.sampled("name", keep=3)
@pytest.mark.parametrize(
    "name",
    ["PUSH_TRUE", "PUSH_VAR", "ADD_VAR", "READ", "MOVE8_F", "MOTORS8", "STOP", "FOREVER", "DEF"],
)
def test_codes_of_three_bytes_with_the_same_first_byte_agree(name: str) -> None:
    """A sample of `--three`: codes that begin with an instruction of one, two or three bytes."""
    assert check_three(BY_NAME[name].code) > 0


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(BATCH_COUNT))
def test_verdicts_on_random_codes_agree(seed: int) -> None:
    """A million in all, an eightieth of it on a commit: they break every rule, end in every way."""
    counts = check_codes(host(), seed, BATCH_SIZE)
    others = ("CODE_LENGTH", "TOO_MANY_TASKS")  # these codes have no tasks
    rules = {str(number) for name, (number, _) in RULES.items() if name not in others}
    assert rules <= set(counts), sorted(rules - set(counts))
    assert {"DONE", "LIMIT", "OVERFLOW", "DIVIDE_BY_ZERO"} <= set(counts), counts
    assert "BAD_CODE" not in counts, counts


def test_the_machine_stays_within_its_memory_for_any_code() -> None:
    """Unverified code ends, waits or faults; sanitizers notice everything else."""
    endings: Counter[str] = Counter()
    for code in random_codes(1, 20_000):
        run = host().run_unverified(code, WIDE_KIT, Senses(max_ms=MAX_MS, max_steps=MAX_STEPS))
        endings[run.trace.split()[-1]] += 1
    assert endings["BAD_CODE"] > 1000, endings
    assert endings["DONE"] > 1000, endings


# -- time and a robot that is not ready ---------------------------------------------------------


def test_the_clock_may_begin_anywhere_and_wrap_around() -> None:
    for image, kit, senses in some_programs():
        run = host().run(image, kit, senses)
        for begin_ms in (1, 2**31 - 500, 2**31, 2**32 - 1, 2**32 - 1500):
            assert host().run(image, kit, senses, begin_ms=begin_ms) == run, (begin_ms, run.trace)


@pytest.mark.parametrize("late_ms", [0, 1, 19, 20, 21, 25, 100, 3000])
def test_ticks_may_come_late(late_ms: int) -> None:
    """A program's own clock catches up with a delay of up to 20 ms, and not with more."""
    delays_ms = [count * 7 % (late_ms + 1) for count in range(1, 200)]
    for image, kit, senses in some_programs():
        cpp_result = host().run_late(image, kit, senses, delays_ms)
        assert cpp_result == run_late(image, kit, senses, delays_ms), cpp_result


def test_a_watched_move_may_last_longer_than_the_clock() -> None:
    check_round(host().run_late)


@pytest.mark.sampled(of="weeks between two turns")
def test_weeks_may_pass_between_two_ticks() -> None:
    """Programs continue if a tick comes up to 2^30 ms after the previous one: an ended wait may
    have been over for as long.
    """
    for number, (image, kit, senses) in enumerate(some_programs()):
        rng = random.Random(number)
        late_ms = [rng.choice((0, 7, 30, rng.randrange(2**30 - 10**6))) for _ in range(60)]
        cpp_result = host().run_late(image, kit, senses, late_ms)
        assert cpp_result == run_late(image, kit, senses, late_ms), cpp_result


def test_a_robot_that_is_not_ready_is_polled_again() -> None:
    """The trace is the same, only the tries are more."""
    tries = 0
    for image, kit, senses in some_programs():
        ready = host().run(image, kit, senses)
        if not ready.trace.endswith(" LIMIT\n") or ready.steps < senses.max_steps:
            slow = host().run(image, kit, senses._replace(max_steps=20_000), not_ready=2)
            assert slow.trace == ready.trace, f"{ready.trace}not\n{slow.trace}"
            tries += slow.steps - ready.steps
    assert tries > 500, tries


# -- tasks --------------------------------------------------------------------------------------


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(2))
def test_random_codes_with_tasks_agree(seed: int) -> None:
    cpp_checks.check_task_codes(host(), seed, 5000)


@pytest.mark.sampled("first", keep=2)
@pytest.mark.parametrize("first", range(0, 2000, 250))
def test_random_programs_with_tasks_agree(first: int) -> None:
    cpp_checks.check_task_programs(host(), first, 250)


def test_the_clock_of_tasks_may_begin_anywhere_and_wrap_around() -> None:
    for image, senses in some_task_programs(0, 200):
        run = host().run(image, KIT, senses)
        for begin_ms in (2**31 - 100, 2**32 - 100):
            assert host().run(image, KIT, senses, begin_ms=begin_ms) == run, (begin_ms, run.trace)


def check_late_turns(late_of: Callable[[random.Random], int]) -> None:
    """Each task's own clock catches up with a delay of up to 20 ms, and not with more."""
    for number, (image, senses) in enumerate(some_task_programs(0, 200)):
        rng = random.Random(number)
        late_ms = [late_of(rng) for _ in range(80)]
        cpp_result = host().run_late(image, KIT, senses, late_ms)
        assert cpp_result == run_late(image, KIT, senses, late_ms, machine_of), cpp_result


@pytest.mark.sampled("late_ms")
@pytest.mark.parametrize("late_ms", [1, 20, 21, 100])
def test_turns_may_come_late(late_ms: int) -> None:
    check_late_turns(lambda rng: rng.randint(0, late_ms))


@pytest.mark.sampled(of="weeks between two turns")
def test_weeks_may_pass_between_two_turns() -> None:
    """A task that is due at once, as its move ended weeks ago, may wait for weeks once more."""
    check_late_turns(lambda rng: rng.choice((0, 7, 30, rng.randrange(2**30 - 10**6))))


@pytest.mark.parametrize("not_ready", [2, 3])
def test_a_task_whose_reading_is_not_ready_lets_others_continue(not_ready: int) -> None:
    """The same holds for a SHOW that is not ready."""
    for image, senses in some_task_programs(0, 200):
        run = host().run(image, KIT, senses, not_ready=not_ready)
        assert run.trace == cpp_checks.slow_run(image, senses, not_ready), run.trace


# -- ways ---------------------------------------------------------------------------------------


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(2))
def test_random_codes_with_ways_agree(seed: int) -> None:
    cpp_checks.check_way_codes(host(), seed, 3000)


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, 1600, 200))
def test_random_programs_with_ways_agree(first: int) -> None:
    cpp_checks.check_way_programs(host(), first, 200)


# -- images and arithmetic ----------------------------------------------------------------------


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(8))
def test_images_get_the_same_verdict(seed: int) -> None:
    cpp_checks.check_images(host(), seed, BATCH_SIZE)


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(2))
def test_images_of_programs_get_the_same_verdict(seed: int) -> None:
    """Check the header, code and devices, in this order, for robots of which some have other
    devices.
    """
    cpp_checks.check_whole_images(host(), seed, 2000)


def test_needs_count_and_not_the_minor_version() -> None:
    """Code with features that the image does not declare is refused, in a header of each minor
    version."""
    for text, bit in (("TASK;END_TASK;SHOW(1)", TASKS), ("F(2 CM, 100);SHOW(1)", GO)):
        whole = compile_text(text, KIT).image
        assert (whole[2:4], whole[14]) == (b"\2\1", bit)
        for minor in range(ISA_MINOR + 2):
            for needs in (bit, 0):
                changed_bytes = bytearray(whole)
                changed_bytes[3], changed_bytes[14] = minor, needs
                image = with_checksum(bytes(changed_bytes))
                python_result = cpp_checks.refusal_of(partial(load_image, image, KIT))
                cpp_result = cpp_checks.refusal_of(partial(host().run, image, KIT, Senses()))
                want = "OTHER_VERSION" if minor > ISA_MINOR else "" if needs else "UNKNOWN_OPCODE"
                assert (
                    python_result == cpp_result
                    and want in python_result
                    and bool(want) == bool(python_result)
                ), (text, minor)


def test_long_images_get_the_same_verdict() -> None:
    """The header's statements about the code are known before the code."""
    longest = pack("SI", 0, bytes(CODE_BYTES))
    for length in (CODE_BYTES, CODE_BYTES + 1, 40_000, 65_535):
        for header_length in (HEADER_BYTES, 0xFF):
            head = bytearray(longest[:HEADER_BYTES])
            head[5], head[8:10] = header_length, struct_pack("<H", length)
            image = with_checksum(bytes(head) + bytes(header_length - HEADER_BYTES + length))
            images = [image, image[:-1], image + b"x"]
            refusals = host().refusals(images)
            assert refusals == [cpp_checks.python_refusal(image) for image in images]
            names = ["", "TRUNCATED", "TRAILING"] if length == CODE_BYTES else ["BAD_HEADER"] * 3
            assert refusals == [REFUSALS[name][0] if name else 0 for name in names], length


@pytest.mark.sampled("name", keep=7)
@pytest.mark.parametrize("name", OPERATIONS)
def test_arithmetic_agrees(name: str) -> None:
    """Two million operations in all."""
    check_arithmetic(host(), name, 100_000)


# -- a campaign ---------------------------------------------------------------------------------


def campaign(count: int, first: int) -> None:
    start_s = time.monotonic()
    total: Counter[str] = Counter()
    judged_count = 0
    for seed in range(first, first + -(-count // BATCH_SIZE)):
        total += check_codes(host(), seed, BATCH_SIZE)
        judged_count += BATCH_SIZE
        print(
            f"{judged_count} codes agree, "
            f"{judged_count / (time.monotonic() - start_s):.0f} a second",
            flush=True,
        )
    print(", ".join(f"{what}: {times}" for what, times in sorted(total.items())))


def check_all_of_three() -> None:
    for first in range(256):
        accepted_count = check_three(first)
        print(f"{first:02x}: {accepted_count} accepted", flush=True)


if __name__ == "__main__":
    options = make_options(1_000_000, BATCH_COUNT, "three")
    check_all_of_three() if options.three else campaign(options.count, options.seed)
