"""Python and C++ agree: verdicts, refusals, arithmetic, and every line of every run.

`python -m tests.vm.test_cpp_agreement 10000000` compares more random codes than the tests, and
`--three` all codes of three bytes.
"""

from __future__ import annotations

import argparse
import random
import time
from collections import Counter

import pytest

from tests.machines.host import host
from tests.support import cpp_checks, cpp_edges, cpp_images, cpp_tasks, cpp_ways
from tests.support.casefile import Case
from tests.support.rows import each_row
from tests.vm.test_cases import disassemblies_alone
from tiniscript.base.limits import CODE_BYTES
from tiniscript.bytecode.opcodes import BY_NAME

BATCH = 12_500
BATCHES = 80  # in the tests


# -- code ---------------------------------------------------------------------------------------


@each_row("case", disassemblies_alone())
def test_disassembly_has_the_same_verdict(case: Case) -> None:
    cpp_checks.check_disassembly(host(), case)


@pytest.mark.parametrize("length", [0, 1, CODE_BYTES - 1, CODE_BYTES, CODE_BYTES + 1, 100_000])
def test_length_of_code(length: int) -> None:
    cpp_checks.check_length(host(), length)


@pytest.mark.parametrize("devices", [0, 1, 32, 33, 255])
def test_number_of_devices(devices: int) -> None:
    cpp_checks.check_devices(host(), devices)


def test_all_codes_of_up_to_two_bytes() -> None:
    cpp_checks.check_short_codes(host())


@pytest.mark.sampled("few_at")
@pytest.mark.parametrize("few_at", [1, 2])
def test_codes_of_three_bytes_with_two_opcodes(few_at: int) -> None:
    cpp_checks.check_pairs(host(), few_at)


@pytest.mark.parametrize("first", range(0, 256, 16), ids=lambda first: f"from {first:02x}")
def test_all_codes_of_three_bytes_run_safely(first: int) -> None:
    cpp_checks.check_runs_safely(host(), first)


@pytest.mark.sampled("name", keep=3)
@pytest.mark.parametrize(
    "name",
    ["PUSH_TRUE", "PUSH_VAR", "ADD_VAR", "READ", "MOVE8_F", "MOTORS8", "STOP", "FOREVER", "DEF"],
)
def test_codes_of_three_bytes_that_begin_alike(name: str) -> None:
    """A sample of `--three`: what begins with an instruction of one, two or three bytes."""
    assert cpp_checks.check_three(host(), BY_NAME[name].code) > 0


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(BATCHES))
def test_random_codes(seed: int) -> None:
    """A million in all, an eightieth of it on a commit."""
    cpp_checks.check_a_batch(host(), seed, BATCH)


def test_many_defs() -> None:
    cpp_edges.check_many_defs(host())


def test_what_is_closed_takes_no_room() -> None:
    cpp_edges.check_what_is_closed(host())


def test_a_procedure_needs_what_it_calls_needs() -> None:
    cpp_edges.check_needs(host())


def test_everything_has_a_place_of_its_own() -> None:
    cpp_edges.check_places(host())


def test_an_instruction_of_one_byte_means_what_is_in_its_code() -> None:
    cpp_edges.check_shorts(host())


def test_a_program_may_run_for_24_days() -> None:
    cpp_edges.check_long_time(host())


def test_whatever_the_code_the_machine_keeps_to_its_memory() -> None:
    cpp_checks.check_memory(host())


def test_code_that_changed_after_it_was_verified() -> None:
    cpp_edges.check_run_time_checks(host())


# -- time and a robot that is not ready ---------------------------------------------------------


@pytest.mark.parametrize("begin_ms", [1, 2**31 - 500, 2**31, 2**32 - 1, 2**32 - 1500])
def test_the_clock_may_wrap_around(begin_ms: int) -> None:
    cpp_checks.check_clock(host(), begin_ms)


@pytest.mark.parametrize("late_ms", [0, 1, 19, 20, 21, 25, 100, 3000])
def test_ticks_may_come_late(late_ms: int) -> None:
    cpp_checks.check_late(host(), late_ms)


def test_a_watched_move_may_last_longer_than_the_clock() -> None:
    cpp_checks.check_round(host().run_late)


def test_weeks_may_pass_between_two_ticks() -> None:
    cpp_checks.check_weeks(host())


def test_a_robot_that_is_not_ready_is_asked_again() -> None:
    cpp_checks.check_not_ready(host())


# -- tasks --------------------------------------------------------------------------------------


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(2))
def test_random_codes_with_tasks(seed: int) -> None:
    cpp_tasks.check_task_codes(host(), seed, 5000)


@pytest.mark.sampled("first", keep=2)
@pytest.mark.parametrize("first", range(0, 2000, 250))
def test_random_programs_with_tasks(first: int) -> None:
    cpp_tasks.check_task_programs(host(), first, 250)


@pytest.mark.parametrize("begin_ms", [2**31 - 100, 2**32 - 100])
def test_the_clock_of_tasks_may_wrap_around(begin_ms: int) -> None:
    cpp_tasks.check_task_clock(host(), begin_ms)


@pytest.mark.parametrize("late_ms", [1, 20, 21, 100])
def test_turns_may_come_late(late_ms: int) -> None:
    cpp_tasks.check_late_tasks(host(), lambda rng: [rng.randint(0, late_ms) for _ in range(80)])


def test_weeks_may_pass_between_two_turns() -> None:
    def late(rng: random.Random) -> list[int]:
        return [rng.choice((0, 7, 30, rng.randrange(2**31 - 10**6))) for _ in range(80)]

    cpp_tasks.check_late_tasks(host(), late)


@pytest.mark.parametrize("not_ready", [2, 3])
def test_a_task_whose_reading_is_not_ready_lets_the_others_go_on(not_ready: int) -> None:
    cpp_tasks.check_slow_tasks(host(), not_ready)


# -- ways ---------------------------------------------------------------------------------------


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(2))
def test_random_codes_with_ways(seed: int) -> None:
    cpp_ways.check_way_codes(host(), seed, 3000)


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, 1600, 200))
def test_random_programs_with_ways(first: int) -> None:
    cpp_ways.check_way_programs(host(), first, 200)


# -- images and arithmetic ----------------------------------------------------------------------


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(8))
def test_images(seed: int) -> None:
    cpp_images.check_images(host(), seed, BATCH)


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(2))
def test_images_of_programs(seed: int) -> None:
    """Header, code and devices, in this order, for robots of which some have other devices."""
    cpp_images.check_whole_images(host(), seed, 2000)


def test_long_images() -> None:
    cpp_images.check_long_images(host())


@pytest.mark.parametrize("name", cpp_checks.OPERATIONS)
def test_arithmetic(name: str) -> None:
    """Two million operations in all."""
    cpp_checks.check_arithmetic(host(), name, 100_000)


# -- a campaign ---------------------------------------------------------------------------------


def campaign(count: int, first: int) -> None:
    begun = time.monotonic()
    total: Counter[str] = Counter()
    done = 0
    for seed in range(first, first + -(-count // BATCH)):
        total += cpp_checks.check_codes(host(), seed, BATCH)
        done += BATCH
        print(f"{done} codes agree, {done / (time.monotonic() - begun):.0f} a second", flush=True)
    print(", ".join(f"{what}: {times}" for what, times in sorted(total.items())))


def all_of_three() -> None:
    for first in range(256):
        accepted = cpp_checks.check_three(host(), first)
        print(f"{first:02x}: {accepted} accepted", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", nargs="?", type=int, default=1_000_000)
    parser.add_argument("--three", action="store_true", help="all codes of three bytes instead")
    parser.add_argument("--seed", type=int, default=BATCHES)
    options = parser.parse_args()
    all_of_three() if options.three else campaign(options.count, options.seed)
