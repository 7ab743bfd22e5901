"""The robot's reader of text and the compiler: the same texts are programs, and do the same.

`python -m tests.text.test_reader_agreement 100000` runs a campaign: so many programs, and ten
broken ones from each.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from itertools import product

import pytest

from tests.machines import Senses
from tests.oracle import programs
from tests.oracle.task_programs import shared_program, task_program
from tests.support.campaign import each_seed, make_options
from tests.support.casefile import Case, all_cases
from tests.support.kits import KITS
from tests.support.reader_agreement import (
    check_bytes,
    check_program,
    damage_text,
    is_right,
    reader_of,
    soup,
)
from tests.support.rows import each_row
from tiniscript import robots
from tiniscript.base.kit import Kit

MAX_MS, MAX_STEPS = 5_000, 5_000
SHORT_BUFFER = 389 - 15
# Numbers for the tests; a commit runs a part, a campaign more.
PROGRAMS, BROKEN_TEXTS, SOUPS = 400, 4, 3000
TRACED_ONE_OF = 10  # a campaign runs one of so many programs


ARMS = [
    f"{condition};{body};"
    for condition in ("(X > 1)", "(DISTANCE > 1)")
    for body in ("S", "DISTANCE")
]


@pytest.mark.parametrize("arm_count", [1, 2, 3])
def test_a_reading_is_known_after_arms_that_all_have_taken_it(arm_count: int) -> None:
    """Every combination of arms that read a sensor, in their condition or after it, or do not."""
    kit = robots.load("tinibot").kit
    for arms in product(ARMS, repeat=arm_count):
        for last_arm in ("", "ELSE;S;", "ELSE;DISTANCE;"):
            text = f"SI|X = 1;IF{'ELSEIF'.join(arms)}{last_arm}ENDIF;X = DISTANCE\n"
            answer = check_bytes(text.encode(), kit)
            assert answer is not None and answer.is_program


def texts_of(seed: int, broken_count: int) -> tuple[Kit, bytes, Senses, list[bytes]]:
    """Return a random program, its readings, and its text after slips."""
    rng = random.Random(seed)
    oracle_kit, kit = KITS[seed % len(KITS)]
    text = programs.program(rng, oracle_kit, ways=seed % 3 == 2)
    senses = Senses(programs.senses(rng, oracle_kit), MAX_MS, MAX_STEPS, seed + 1)
    slips = [
        programs.break_text(rng, text).encode("utf-8", "surrogatepass") for _ in range(broken_count)
    ]
    return kit, text.encode(), senses, [damage_text(rng, slip) for slip in slips]


def tasks_of(seed: int, broken_count: int) -> tuple[Kit, bytes, Senses, list[bytes]]:
    """Return a random program with tasks, and its slips.

    Every second one has ways, every fourth one DEFs with values that tasks share.
    """
    rng = random.Random(seed)
    if seed // 4 % 4 == 0:
        has_yes_no = seed // 16 % 4 == 0
        text, readings = shared_program(rng)
        # some have too many copies, or are called too deep
        while (not has_yes_no and "Q" in text) or not is_right(text.encode(), KITS[0][1]):
            text, readings = shared_program(rng)
    else:
        text, readings = task_program(rng, ways=seed % 2 == 1)
    if seed % 4 == 1:
        text = re.sub(r"(?<=\d) CM", rng.choice(("cm", "Cm", "\ncm")), text)
        text = re.sub(" DEG", rng.choice((" deg", "°", "º", " \n°")), text)
    slips = [
        programs.break_text(rng, text).encode("utf-8", "surrogatepass") for _ in range(broken_count)
    ]
    senses = Senses(readings, MAX_MS, MAX_STEPS, seed + 1)
    return KITS[0][1], text.encode(), senses, [damage_text(rng, slip) for slip in slips]


# -- in the tests -------------------------------------------------------------------------------

CASES = [case for case in all_cases() if "tiniscript" in case.parts]


@each_row("case", CASES)
def test_a_program_of_the_cases_agrees(case: Case) -> None:
    parts = case.parts
    match = re.search(r"^robot *= *(\w+)", parts.get("senses", ""), re.MULTILINE)
    kit = robots.load(match[1] if match else "tinibot").kit
    data = parts["tiniscript"].encode()
    if is_right(data, kit):
        check_program(data, kit, Senses({}, MAX_MS, MAX_STEPS, 1))
    for line in (data, *data.splitlines()):
        check_bytes(line, kit)


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, PROGRAMS, 50))
def test_random_programs_agree(first: int) -> None:
    for seed in range(first, first + 50):
        kit, data, senses, slips = texts_of(seed, BROKEN_TEXTS)
        check_program(data, kit, senses)
        for slip in slips:
            check_bytes(slip, kit)


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, PROGRAMS, 50))
def test_random_programs_with_tasks_agree(first: int) -> None:
    for seed in range(first, first + 50):
        kit, data, senses, slips = tasks_of(seed, BROKEN_TEXTS)
        check_program(data, kit, senses)
        for slip in slips:
            check_bytes(slip, kit)


@pytest.mark.parametrize("speed, turn", [(0, 7), (7, 0), (0, 0)])
def test_a_kit_without_speed_agrees(speed: int, turn: int) -> None:
    kit = KITS[1][1]._replace(speed=speed, turn=turn)
    for way, goes in (("F(1 CM,", speed), ("b(1cm,", speed), ("L(1 DEG,", turn), ("r(1°,", turn)):
        answer = check_bytes(f"{way} 60)".encode(), kit)
        assert answer is not None and answer.is_program == bool(goes), way


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, SOUPS, 300))
def test_random_tokens_agree(first: int) -> None:
    for kit, data in map(soup, range(first, first + 300)):
        assert check_bytes(data, kit) is not None


@pytest.mark.sampled("text")
@pytest.mark.parametrize(
    "text", [b"S // %b\n", b"S//%b", b"X%b=1", b"X=1%b", b"X=1.%b", b"F(1%b,2)", b"%bS", b"AN%bD=1"]
)
def test_every_byte_and_pair_of_bytes_agrees(text: bytes) -> None:
    for byte in range(256):
        check_bytes(text % bytes((byte,)), KITS[1][1])
        for other_byte in b"\x00\x02\x80\x93\xa0\xbf\xc2\xe2 /=9A":
            check_bytes(text % bytes((byte, other_byte)), KITS[1][1])


@pytest.mark.parametrize(
    "point",
    [0xA0, 0x7FF, 0x800, 0x1FFF, 0x2000, 0x200B, 0x200C, 0x200F, 0x2010, 0x2015, 0x2016, 0x2028,
     0x202F, 0x2212, 0x3000, 0x3001, 0xFEFF, 0xFFFD, 0x10000, 0x100A0, 0x12000, 0x1F600, 0x10FFFF],
)  # fmt: skip
def test_unicode_characters_agree(point: int) -> None:
    for text in ("S//%s", "S%s", "M(%s5,5)", "%sS"):
        check_bytes((text % chr(point)).encode(), KITS[1][1])


@pytest.mark.sampled("room")
@pytest.mark.parametrize("room", [8, 40, 100, SHORT_BUFFER])
def test_insufficient_room_only_causes_full_errors(room: int) -> None:
    for seed in range(100):
        kit, data, _, slips = texts_of(seed, 1)
        for data_line in (data, *slips):
            check_bytes(data_line, kit, room)
            expected, answer = reader_of(kit).read(data_line), reader_of(kit, room).read(data_line)
            assert answer.problem == "FULL" or answer == expected


FOUND_PROBLEMS: Counter[str] = Counter()  # problems found by a campaign in incomplete programs


def check_seed(seed: int) -> None:
    """Compare a program, ten with slips, and ten lines of any tokens.

    The behaviour is compared for one of TRACED programs: runs take longest.
    """
    kit, data, senses, slips = (tasks_of if seed % 4 == 0 else texts_of)(seed, 10)
    if seed % TRACED_ONE_OF:
        check_bytes(data, kit)
    else:
        check_program(data, kit, senses)
    soups = [soup(10 * seed + k) for k in range(10)]
    for each_kit, line in [(kit, slip) for slip in slips] + soups:
        answer = check_bytes(line, each_kit)
        FOUND_PROBLEMS[
            "full" if answer is None else "program" if answer.is_program else "refused"
        ] += 1


if __name__ == "__main__":
    each_seed(check_seed, make_options(100_000, 1_000_000))
    print(f"of other texts {dict(FOUND_PROBLEMS)}")
