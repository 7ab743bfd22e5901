"""UNDO: a robot holds the program before again, over every power-off, and loses none."""

from __future__ import annotations

import random
from struct import pack as struct_pack

import pytest

from tests.firmware.test_host_firmware import (
    KIT,
    LONG,
    computer,
    happened,
    held,
    image_of,
    send,
    stored,
    switched_on,
)
from tests.firmware.test_other_versions import OLD, kept
from tests.firmware.test_persistence import (
    DRIVES,
    FIRST,
    SECOND,
    bytes_of,
    program_after_power_off,
    saved,
)
from tests.machines.host_firmware import HostFirmware
from tiniscript.bytecode.image import sealed
from tiniscript.bytecode.opcodes import ISA_MINOR
from tiniscript.link.frames import decoded
from tiniscript.link.messages import SAVED, STATUSES
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

A, B, C = "SB|F(0.1, 50)", LONG.replace("SI", "SB"), "SI|F(0.1, 70)"
NO_PREVIOUS = STATUSES["NO_PREVIOUS"]


def with_two(first: str = A, second: str = B) -> tuple[HostFirmware, Session]:
    """Return a robot that holds the second program, and has saved the first one before."""
    robot, session = switched_on(), computer()
    for text in (first, second):
        send(robot, session, text, runs=False)
        stored(robot, session)
    return robot, session


def undo(robot: HostFirmware, session: Session) -> int:
    return robot.until(session, session.undo())


# -- refused --------------------------------------------------------------------------------------


def test_a_robot_without_any_program_has_none_before() -> None:
    robot, session = switched_on(), computer()
    assert undo(robot, session) == NO_PREVIOUS
    assert saved(robot, session) == "NOTHING"


def of_another_kit() -> bytes:
    """An image that is whole but for the devices: those of another kit."""
    image = bytearray(bytes_of("SI|SHOW(DISTANCE)"))
    image[6:8] = struct_pack("<H", int.from_bytes(image[6:8], "little") ^ 0x1111)
    return sealed(bytes(image))


def of_another_minor() -> bytes:
    image = bytearray(bytes_of(A))
    image[3] = ISA_MINOR + 1
    return sealed(bytes(image))


def that_no_verifier_takes() -> bytes:
    image = bytearray(bytes_of(A))
    image[-1] = 0xFE
    return sealed(bytes(image))


def that_is_damaged() -> bytes:
    image = bytearray(bytes_of(A))
    image[-1] ^= 1
    return bytes(image)


@pytest.mark.parametrize(
    "image",
    [OLD, of_another_kit(), of_another_minor(), that_no_verifier_takes(), that_is_damaged()],
    ids=["old", "kit", "minor", "verifier", "damaged"],
)
@pytest.mark.parametrize("is_first", [True, False])
def test_what_it_cannot_run_does_not_come_back(image: bytes, is_first: bool) -> None:
    good = bytes_of(A)
    places = (FIRST, SECOND) if is_first else (SECOND, FIRST)
    robot = HostFirmware(KIT, kept((places[0], 7, good), (places[1], 6, image)))
    session = computer()
    robot.wait(400)
    for _ in range(2):
        assert undo(robot, session) == NO_PREVIOUS
        assert saved(robot, session) == "STORED"
        assert held(robot, session) == good
    robot.push()
    robot.talk(session, 400)
    assert "MOTORS 50 50" in happened(robot)
    assert program_after_power_off(robot) == good
    # the next program goes beside the one that it can run
    send(robot, session, C)
    stored(robot, session)
    assert undo(robot, session) == OK
    assert held(robot, session) == good


@pytest.mark.parametrize(
    "image", [of_another_kit(), that_no_verifier_takes()], ids=["kit", "verifier"]
)
@pytest.mark.parametrize("has_good", [True, False])
def test_a_robot_begins_with_the_newest_program_that_it_can_run(
    image: bytes, has_good: bool
) -> None:
    """Its checksum is right, so that only the verifier or the kit says no."""
    good = bytes_of(A)
    robot, session = (
        HostFirmware(KIT, kept(*[(SECOND, 6, good)][:has_good], (FIRST, 7, image))),
        computer(),
    )
    robot.wait(400)
    assert saved(robot, session) == ("STORED" if has_good else "NOTHING")
    assert robot.is_lit == has_good
    robot.push()
    robot.talk(session, 400)
    assert happened(robot) == ["MOTORS 50 50", "MOTORS 0 0", "FINISHED"] * has_good
    send(robot, session, C, runs=False)
    stored(robot, session)
    assert program_after_power_off(robot) == bytes_of(C)


# -- what is in RAM only --------------------------------------------------------------------------


def test_a_program_that_is_not_saved_makes_way_for_the_saved_one() -> None:
    robot, session = with_two()
    send(robot, session, C, saves=False)
    robot.talk(session, 500)
    memory = robot.memory()
    assert SAVED[robot.done(session, session.undo()).saved][0] == "STORED"
    assert held(robot, session) == bytes_of(B)
    robot.talk(session, 500)
    assert robot.memory() == memory, "nothing is written"
    assert undo(robot, session) == OK
    assert held(robot, session) == bytes_of(A)


def test_a_program_that_is_not_saved_stays_where_nothing_is() -> None:
    robot, session = switched_on(), computer()
    send(robot, session, A, saves=False)
    assert undo(robot, session) == NO_PREVIOUS
    assert held(robot, session) == bytes_of(A)
    robot.push()
    robot.talk(session, 400)
    assert "MOTORS 50 50" in happened(robot)


# -- in the middle of something -------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3])
def test_with_a_low_supply_nothing_is_touched_and_nothing_is_lost(count: int) -> None:
    robot, session = with_two()
    robot.supply(is_low=True)
    memory = robot.memory()
    for text in (A, B, A)[:count]:
        assert undo(robot, session) == OK
        robot.talk(session, 1500)
        assert held(robot, session) == bytes_of(text)
        assert robot.memory() == memory
        assert program_after_power_off(robot) == bytes_of(B)
    assert saved(robot, session) == ("STORED" if text == B else "LOW_SUPPLY")
    robot.supply(is_low=False)
    robot.talk(session, 1500)
    assert saved(robot, session) == "STORED"
    for now in (text, B if text == A else A):
        assert held(robot, session) == bytes_of(now)
        assert program_after_power_off(robot) == bytes_of(now)
        if now == text:
            assert undo(robot, session) == OK
            stored(robot, session)


def test_a_program_that_drives_does_not_let_it_lose_the_one_before() -> None:
    """It waits for the motors before its first byte."""
    robot, session = with_two(DRIVES, A)
    memory = robot.memory()
    assert undo(robot, session) == OK
    assert robot.until(session, session.start()) == OK
    robot.talk(session, 3000)
    assert saved(robot, session) == "SAVING"
    changed = sum(a != b for a, b in zip(memory, robot.memory(), strict=True))
    assert changed <= 3, "at most what it wrote before the start"
    session.stop(robot.now_ms)
    robot.talk(session, 1000)
    assert program_after_power_off(robot) == bytes_of(DRIVES)


@pytest.mark.parametrize("cut_ms", range(0, 160, 3))
def test_pulled_out_at_any_moment_it_has_one_of_the_two(cut_ms: int) -> None:
    robot, session = with_two()
    request = session.undo()
    robot.talk(session, cut_ms)
    memory = robot.memory()
    found = []
    for nonce in (5, 6):
        again, other = switched_on(memory), computer(nonce)
        found.append(held(again, other))
        memory = again.memory()
    assert found[0] == found[1]
    assert found[0] in (bytes_of(A), bytes_of(B))
    is_answered = request.outcome is not None
    robot.talk(session, 1000)
    assert program_after_power_off(robot) == bytes_of(A)
    assert is_answered or cut_ms < 100


def test_a_request_that_comes_twice_is_done_once() -> None:
    """The answer was lost, so the same bytes come again, also when it has long been saved."""
    robot, session = with_two()
    request = session.undo()
    wire = session.poll(robot.now_ms)
    answers = [decoded(robot.wait(wait_ms, wire)[:-1]) for wait_ms in (50, 500, 2000)]
    assert request.outcome is None
    programs = {answer.payload[:5] for answer in answers if answer}
    assert None not in answers
    assert programs == {bytes([OK]) + image_of(A).checksum.to_bytes(4, "little")}
    assert held(robot, computer(9)) == bytes_of(A)


def test_any_order_of_programs_undos_and_power_offs() -> None:
    """Against two variables: what it holds, and what it held before."""
    draw = random.Random(11)
    texts = [f"SB|F(0.1, {power})" for power in range(40, 46)] + [B]
    robot, session = switched_on(), computer()
    now, before = "", ""
    for step in range(120):
        what = draw.choice(("send", "undo", "undo", "off"))
        if what == "send":
            text = draw.choice(texts)
            send(robot, session, text)
            stored(robot, session)
            if text != now:
                now, before = text, now
        elif what == "undo":
            assert undo(robot, session) == (OK if before else NO_PREVIOUS), step
            if before:
                stored(robot, session, 500)  # eight bytes, and not the program
                now, before = before, now
        else:
            robot, session = switched_on(robot.memory()), computer(step)
        if now:
            assert held(robot, session) == bytes_of(now), step
