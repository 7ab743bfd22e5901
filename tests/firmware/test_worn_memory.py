"""A memory that is ten years old: whichever bytes no longer change, the robot's reports about its
data are true, and the use of other bytes is unaffected.

`python -m tests.firmware.test_worn_memory 2000` tries more.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from struct import pack

import pytest

from tests.support.campaign import each_seed, make_options
from tests.support.images import image_of
from tests.support.kept_programs import bytes_of
from tests.support.owners import Keys, OwnedRobot, owner_of
from tests.support.robot_on_host import fetch_image
from tiniscript.link.authority import FREE, OWNED_BY_YOU
from tiniscript.link.messages import SAVED_STORED

NAMES = (b"x", b"Pia", b"OLD", b"sixteen letters!")
TRIMS = [pack("<BbBHHHH", *row) for row in ((0, 0, 0, 0, 0, 0, 0), (1, 5, 7, 11, 30, 70, 260),
                                            (0, -9, 30, 10, 31, 71, 261))]  # fmt: skip
# The addresses where both slots of each begin and end in `layout.h`. Four bytes say whether it
# counts.
IDENTITY, FAULT = ((4, 35), (35, 66)), ((66, 97), (97, 128))
PROGRAM, KEYS = ((128, 536), (576, 984)), ((536, 576), (984, 1024))
SLOTS = (*IDENTITY, *FAULT, *PROGRAM, *KEYS)


class Known:
    """The stored value that a robot has confirmed, and the values it may store instead."""

    def __init__(self, first: object) -> None:
        self.may_be = [first]

    def note_request(self, value: object, is_kept: bool) -> None:
        self.may_be = [value] if is_kept else [*self.may_be, value]


def count_worn_slots(worn_bytes: set[int], slots: Sequence[tuple[int, int]]) -> int:
    """Return the number of slots with worn bytes."""
    return sum(any(low <= place < high for place in worn_bytes) for low, high in slots)


def check(seed: int) -> str:
    rng = random.Random(seed)
    table, keys = OwnedRobot(seed=seed | 1), Keys()
    robot, session = table.robot, table.session(keys)
    worn_bytes: set[int] = set()
    name, program = Known(b""), Known(b"")
    trim, pace = Known(TRIMS[0][:3]), Known(TRIMS[0][3:])
    owner = Known(FREE)
    outcome = "all is kept"
    for _ in range(rng.randint(4, 14)):
        kind = rng.choice((*["worn"] * 5, "name", "name", "trim", "program", "claim", "fault"))
        if kind == "worn":
            low, high = rng.choice(SLOTS)
            place = low + rng.randrange(4) if rng.random() < 0.5 else rng.randrange(low, high)
            robot.wear_out(place)
            worn_bytes.add(place)
            continue
        if kind == "program":
            text = f"SB|F(1, {rng.randint(10, 99)})" + ";B(0.1, 60)" * rng.choice((0, 30))
            status = table.outcome(session, session.upload(image_of(text)))
            assert status == "OK", f"{seed} {status}"
            robot.talk(session, 3500)
            saved = robot.complete(session, session.status()).saved
            is_kept = saved == SAVED_STORED
            program.note_request(bytes_of(text), is_kept)
        elif kind == "claim":
            if owner.may_be != [FREE]:
                continue
            status = table.claim(session)
            is_kept = status == "OK"
            owner.note_request(OWNED_BY_YOU, is_kept)
        elif kind == "fault":
            robot.until(session, session.upload(image_of("SI|X = 0;SHOW(1 / X)"), saves=False))
            robot.talk(session, 600)
            continue
        else:
            asked_bytes = rng.choice(NAMES if kind == "name" else TRIMS)
            request = session.name(asked_bytes) if kind == "name" else session.trim(asked_bytes)
            status = table.outcome(session, request)
            is_kept = status == "OK"
            if kind == "name":
                name.note_request(asked_bytes, is_kept)
            else:
                trim.note_request(asked_bytes[:3], is_kept)
                pace.note_request(asked_bytes[3:], is_kept)
        slots = {"program": PROGRAM, "claim": KEYS}.get(kind, (*IDENTITY, *FAULT))
        if not is_kept:
            outcome = "it says what is not kept"
            assert count_worn_slots(worn_bytes, slots), f"{seed} {kind} {worn_bytes}"
    robot.talk(session, 1000)
    restarted_robot = OwnedRobot(robot.memory())
    later_session = restarted_robot.session(keys, nonce=9)
    whose = owner_of(restarted_robot, later_session)
    # A robot that cannot store its identity has no keys.
    assert whose in owner.may_be or count_worn_slots(worn_bytes, IDENTITY) == 2, (
        f"{seed} {worn_bytes}"
    )
    assert later_session.robot and later_session.robot.name.encode() in name.may_be, (
        f"{seed} {worn_bytes} {later_session.robot}"
    )
    trim_reply = restarted_robot.robot.complete(later_session, later_session.trim())
    assert trim_reply.pace in pace.may_be, f"{seed} {worn_bytes}"
    assert pack("<BbB", *trim_reply[:3]) in trim.may_be, f"{seed} {worn_bytes}"
    has_program = restarted_robot.robot.complete(later_session, later_session.status()).length != 0
    image = fetch_image(restarted_robot.robot, later_session) if has_program else b""
    assert image in program.may_be, f"{seed} {worn_bytes}"
    return outcome


@pytest.mark.sampled("part", keep=2)
@pytest.mark.parametrize("part", range(10))
def test_reports_about_stored_data_are_true(part: int) -> None:
    counts = Counter(check(seed) for seed in range(part * 30, part * 30 + 30))
    assert counts["it says what is not kept"] > 1 and counts["all is kept"] > 1, counts


if __name__ == "__main__":
    each_seed(check, make_options(2000, 10_000))
