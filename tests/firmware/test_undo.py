"""UNDO: a robot returns to the previous program, across every power-off, and loses none.

In every state, the run ends, no other starts, and a pulled plug leaves one of the two programs. The
states are those of the button. Before each of them the robot has saved one program more.
"""

from __future__ import annotations

import random
from itertools import product

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.button_states import OTHER_POWER, SAVED_POWER, STATES, Table
from tests.support.images import image_of
from tests.support.kept_programs import (
    DRIVE_PROGRAM,
    FIRST_SLOT,
    LATER_VERSION_IMAGE,
    SECOND_SLOT,
    bytes_of,
    eeprom_with,
    name_after_power_off,
    program_after_power_off,
    read_saved_state,
)
from tests.support.robot_on_host import (
    KIT,
    LONG_PROGRAM,
    actions_of,
    broken_upload,
    computer,
    fetch_image,
    outcome,
    send,
    switched_on,
    wait_until_saved,
)
from tiniscript.bytecode.image import with_checksum
from tiniscript.bytecode.opcodes import ISA_MINOR
from tiniscript.link.frames import decode_frame
from tiniscript.link.messages import SAVED_STORED, STATUSES
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

PROGRAM_A, PROGRAM_B, PROGRAM_C = "SB|F(0.1, 50)", LONG_PROGRAM.replace("SI", "SB"), "SI|F(0.1, 70)"
NO_PREVIOUS = STATUSES["NO_PREVIOUS"]


def robot_with_two_programs(
    first: str = PROGRAM_A, second: str = PROGRAM_B
) -> tuple[HostFirmware, Session]:
    """Return a robot that holds the second program, and has saved the first one before."""
    robot, session = switched_on(), computer()
    for text in (first, second):
        send(robot, session, text, runs=False)
        wait_until_saved(robot, session)
    return robot, session


def undo(robot: HostFirmware, session: Session) -> int:
    return robot.until(session, session.undo())


# -- refused --------------------------------------------------------------------------------------


def with_byte(text: str, index: int, value: int) -> bytes:
    image = bytearray(bytes_of(text))
    image[index] = value
    return bytes(image)


# One of the bytes that it needs.
OTHER_KIT_IMAGE = with_checksum(with_byte("SI|SHOW(DISTANCE)", 6, 0x11))
INVALID_IMAGE = with_checksum(with_byte(PROGRAM_A, -1, 0xFE))
UNRUNNABLE_IMAGES = {
    "version": LATER_VERSION_IMAGE,
    "kit": OTHER_KIT_IMAGE,
    "minor": with_checksum(with_byte(PROGRAM_A, 3, ISA_MINOR + 1)),
    "verifier": INVALID_IMAGE,
    "damaged": with_byte(PROGRAM_A, -1, bytes_of(PROGRAM_A)[-1] ^ 1),
}


@pytest.mark.parametrize("image", UNRUNNABLE_IMAGES.values(), ids=UNRUNNABLE_IMAGES)
@pytest.mark.parametrize("is_first", [True, False])
def test_undo_does_not_restore_an_unrunnable_program(image: bytes, is_first: bool) -> None:
    good_image = bytes_of(PROGRAM_A)
    places = (FIRST_SLOT, SECOND_SLOT) if is_first else (SECOND_SLOT, FIRST_SLOT)
    robot = HostFirmware(KIT, eeprom_with((places[0], 7, good_image), (places[1], 6, image)))
    session = computer()
    robot.wait(400)
    for _ in range(2):
        assert undo(robot, session) == NO_PREVIOUS
        assert read_saved_state(robot, session) == "STORED"
        assert fetch_image(robot, session) == good_image
    robot.push()
    robot.talk(session, 400)
    assert "MOTORS 50 50" in actions_of(robot)
    assert program_after_power_off(robot) == good_image
    # The next program is stored next to the one that can run.
    send(robot, session, PROGRAM_C)
    wait_until_saved(robot, session)
    assert undo(robot, session) == OK
    assert fetch_image(robot, session) == good_image


@pytest.mark.parametrize("image", [OTHER_KIT_IMAGE, INVALID_IMAGE], ids=["kit", "verifier"])
@pytest.mark.parametrize("has_good", [True, False])
def test_a_robot_starts_with_the_newest_runnable_program(image: bytes, has_good: bool) -> None:
    """Its checksum is right, so that only the verifier or the kit says no."""
    good_image = bytes_of(PROGRAM_A)
    good_slots = [(SECOND_SLOT, 6, good_image)] if has_good else []
    robot, session = HostFirmware(KIT, eeprom_with(*good_slots, (FIRST_SLOT, 7, image))), computer()
    robot.wait(400)
    assert read_saved_state(robot, session) == ("STORED" if has_good else "NOTHING")
    assert robot.is_lit == has_good
    robot.push()
    robot.talk(session, 400)
    assert actions_of(robot) == ["MOTORS 50 50", "MOTORS 0 0", "FINISHED"] * has_good
    send(robot, session, PROGRAM_C, runs=False)
    wait_until_saved(robot, session)
    assert program_after_power_off(robot) == bytes_of(PROGRAM_C)


# -- programs in RAM only --------------------------------------------------------------------------


def test_undo_replaces_an_unsaved_program_with_the_saved_one() -> None:
    robot, session = robot_with_two_programs()
    send(robot, session, PROGRAM_C, saves=False)
    robot.talk(session, 500)
    memory = robot.memory()
    assert robot.complete(session, session.undo()).saved == SAVED_STORED
    assert fetch_image(robot, session) == bytes_of(PROGRAM_B)
    robot.talk(session, 500)
    assert robot.memory() == memory, "nothing is written"
    assert undo(robot, session) == OK
    assert fetch_image(robot, session) == bytes_of(PROGRAM_A)


def test_undo_keeps_an_unsaved_program_if_nothing_is_saved() -> None:
    robot, session = switched_on(), computer()
    assert undo(robot, session) == NO_PREVIOUS
    assert read_saved_state(robot, session) == "NOTHING"
    send(robot, session, PROGRAM_A, saves=False)
    assert undo(robot, session) == NO_PREVIOUS
    assert fetch_image(robot, session) == bytes_of(PROGRAM_A)
    robot.push()
    robot.talk(session, 400)
    assert "MOTORS 50 50" in actions_of(robot)


# -- in the middle of something -------------------------------------------------------------------


NAME_CHANGE, SAVED_PROGRAM, TRIED_PROGRAM, CUT_UPLOAD = (
    "a name",
    "a saved program",
    "a tried program",
    "a cut upload",
)
STEP_SEQUENCES = [
    steps
    for count in (1, 2, 3)
    for steps in product((NAME_CHANGE, SAVED_PROGRAM, TRIED_PROGRAM, CUT_UPLOAD), repeat=count)
]


@pytest.mark.sampled("steps", keep=20)
@pytest.mark.parametrize("steps", STEP_SEQUENCES, ids=", ".join)
def test_a_save_delayed_by_a_low_supply_follows_the_last_request(
    steps: tuple[str, ...],
) -> None:
    """A program that another one has followed since is not saved, nor is one in its place."""
    robot, session = robot_with_two_programs()
    robot.set_supply(is_low=True)
    waits, is_tried, name = "", False, ""
    for count, step in enumerate(steps):
        text = f"SI|SHOW({count}); " + "W(0); " * 20
        if step == NAME_CHANGE:
            name = f"name {count}"
            assert robot.until(session, session.name(name.encode())) == STATUSES["LOW_SUPPLY"]
        elif step == CUT_UPLOAD:
            broken_upload(robot, session)
            session = computer(90 + count)
        else:
            send(robot, session, text, saves=step == SAVED_PROGRAM)
            robot.talk(session, 800)  # makes it wait for the supply
        if step != NAME_CHANGE:
            waits, is_tried = text if step == SAVED_PROGRAM else "", step == TRIED_PROGRAM
    robot.set_supply(is_low=False)
    robot.talk(session, 5000)
    assert read_saved_state(robot, session) == ("MEMORY" if is_tried else "STORED")
    assert program_after_power_off(robot) == bytes_of(waits or PROGRAM_B)
    assert name_after_power_off(robot) == name
    if waits or SAVED_PROGRAM not in steps:  # otherwise the abandoned program has replaced A
        restarted_robot, session = switched_on(robot.memory()), computer(80)
        assert undo(restarted_robot, session) == OK
        assert fetch_image(restarted_robot, session) == bytes_of(PROGRAM_B if waits else PROGRAM_A)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_with_a_low_supply_undo_changes_nothing(count: int) -> None:
    robot, session = robot_with_two_programs()
    robot.set_supply(is_low=True)
    memory = robot.memory()
    for text in (PROGRAM_A, PROGRAM_B, PROGRAM_A)[:count]:
        assert undo(robot, session) == OK
        robot.talk(session, 1500)
        assert fetch_image(robot, session) == bytes_of(text)
        assert robot.memory() == memory
        assert program_after_power_off(robot) == bytes_of(PROGRAM_B)
    assert read_saved_state(robot, session) == ("STORED" if text == PROGRAM_B else "LOW_SUPPLY")
    robot.set_supply(is_low=False)
    robot.talk(session, 1500)
    assert read_saved_state(robot, session) == "STORED"
    for current_text in (text, PROGRAM_B if text == PROGRAM_A else PROGRAM_A):
        assert fetch_image(robot, session) == bytes_of(current_text)
        assert program_after_power_off(robot) == bytes_of(current_text)
        if current_text == text:
            assert undo(robot, session) == OK
            wait_until_saved(robot, session)


def test_a_driving_program_does_not_lose_the_previous_one() -> None:
    """The restore waits until the motors are off before its first byte."""
    robot, session = robot_with_two_programs(DRIVE_PROGRAM, PROGRAM_A)
    memory = robot.memory()
    assert undo(robot, session) == OK
    assert robot.until(session, session.start()) == OK
    robot.talk(session, 3000)
    assert read_saved_state(robot, session) == "SAVING"
    changed_count = sum(a != b for a, b in zip(memory, robot.memory(), strict=True))
    assert changed_count <= 3, "at most what it wrote before the start"
    session.stop(robot.now_ms)
    robot.talk(session, 1000)
    assert program_after_power_off(robot) == bytes_of(DRIVE_PROGRAM)


@pytest.mark.sampled("cut_ms", keep=18)
@pytest.mark.parametrize("cut_ms", range(0, 160, 3))
def test_a_power_cut_during_undo_leaves_one_of_the_programs(cut_ms: int) -> None:
    robot, session = robot_with_two_programs()
    request = session.undo()
    robot.talk(session, cut_ms)
    memory = robot.memory()
    programs = []
    for nonce in (5, 6):
        restarted_robot, other_session = switched_on(memory), computer(nonce)
        programs.append(fetch_image(restarted_robot, other_session))
        memory = restarted_robot.memory()
    assert programs[0] == programs[1]
    assert programs[0] in (bytes_of(PROGRAM_A), bytes_of(PROGRAM_B))
    is_answered = request.outcome is not None
    robot.talk(session, 1000)
    assert program_after_power_off(robot) == bytes_of(PROGRAM_A)
    assert is_answered or cut_ms < 100


def test_a_duplicate_request_is_executed_once() -> None:
    """The answer was lost, so the same bytes come again, also when it has long been saved."""
    robot, session = robot_with_two_programs()
    request = session.undo()
    wire = session.poll(robot.now_ms)
    answers = [decode_frame(robot.wait(wait_ms, wire).strip(b"\0")) for wait_ms in (50, 500, 2000)]
    assert request.outcome is None
    programs = {answer.payload[:5] for answer in answers if answer}
    assert None not in answers
    assert programs == {bytes([OK]) + image_of(PROGRAM_A).checksum.to_bytes(4, "little")}
    assert fetch_image(robot, computer(9)) == bytes_of(PROGRAM_A)


def test_programs_undos_and_power_offs_work_in_any_order() -> None:
    """The model has two variables: the current program and the previous one."""
    rng = random.Random(11)
    texts = [f"SB|F(0.1, {power})" for power in range(40, 46)] + [PROGRAM_B]
    robot, session = switched_on(), computer()
    current_text, text_before = "", ""
    for step in range(120):
        action = rng.choice(("send", "undo", "undo", "off"))
        if action == "send":
            text = rng.choice(texts)
            send(robot, session, text)
            wait_until_saved(robot, session)
            if text != current_text:
                current_text, text_before = text, current_text
        elif action == "undo":
            assert undo(robot, session) == (OK if text_before else NO_PREVIOUS), step
            if text_before:
                wait_until_saved(robot, session, 500)  # eight bytes, and not the program
                current_text, text_before = text_before, current_text
        else:
            robot, session = switched_on(robot.memory()), computer(step)
        if current_text:
            assert fetch_image(robot, session) == bytes_of(current_text), step


# -- in every state of the firmware ---------------------------------------------------------------


EARLIER_POWER = 21  # the power of the program that was saved first
STATES_IN_MEMORY = {
    "holds a program in memory only", "holds a program that was typed",
    "is running a program in memory",
}  # fmt: skip
NOT_OWNER = STATUSES["NOT_OWNER"]


def robot_in_state(state: str, has_draft: bool = True) -> tuple[Table, Session]:
    """Return a robot in a state, and the client that asks: the connected one, or another one."""
    table = Table(has_draft)
    table.robot.wait(200)
    table.upload_program(EARLIER_POWER)
    STATES[state](table)
    if table.talks is not None:
        return table, table.talks
    return table, table.session if state == "has an owner" else computer(9)


def after_power_off(table: Table) -> bytes:
    """Return the program that it holds at the next two starts, which must agree; read with its
    key."""
    memory, programs = table.robot.memory(), []
    for nonce in (31, 32):
        robot = switched_on(memory, seed=nonce)
        session_after = Session(nonce, 9600, KIT.fingerprint, keys=table.keys)
        programs.append(fetch_image(robot, session_after))
        memory = robot.memory()
    assert programs[0] == programs[1]
    return programs[0]


def program_of(power: int) -> bytes:
    return bytes_of(f"SB|F(600, {power})")


def power_after_undo(state: str) -> int:
    """Return the power of the program that comes back."""
    if state == "holds no program":
        return 0  # EARLIER is the only one
    if state == "is bringing back the previous program":
        return OTHER_POWER
    return SAVED_POWER if state in STATES_IN_MEMORY else EARLIER_POWER


@pytest.mark.sampled("has_draft")
@pytest.mark.parametrize("has_draft", [True, False])
@pytest.mark.parametrize("state", STATES)
def test_undo_works_in_every_state(state: str, has_draft: bool) -> None:
    table, session = robot_in_state(state, has_draft)
    robot, previous = table.robot, power_after_undo(state)
    assert robot.has_draft == has_draft
    was_running = not robot.is_latched
    robot.did.clear()
    status = undo(robot, session)
    assert status == (OK if previous else NO_PREVIOUS)
    current_program = program_of(previous or EARLIER_POWER)
    assert fetch_image(robot, session) == current_program
    assert robot.is_latched, "what runs ends"
    robot.talk(session, 1500)
    moves = {line for line in actions_of(robot) if line.startswith("MOTORS")}
    assert moves == ({"MOTORS 0 0"} if was_running else set()), "nothing starts"
    wait_until_saved(robot, session)
    assert after_power_off(table) == current_program
    assert undo(robot, session) == (OK if previous else NO_PREVIOUS)
    wait_until_saved(robot, session)
    fetched_image = fetch_image(robot, session)
    assert after_power_off(table) == fetched_image
    assert (fetched_image != current_program) == bool(previous), "a second one brings another"


@pytest.mark.parametrize("state", STATES)
def test_two_undos_at_once_count_as_two(state: str) -> None:
    """The second request is on its way before the first is answered."""
    table, session = robot_in_state(state)
    robot, previous = table.robot, power_after_undo(state)
    requests = [session.undo(), session.undo()]
    outcomes = [robot.until(session, request) for request in requests]
    assert outcomes == [OK if previous else NO_PREVIOUS] * 2
    programs = [outcome(pending_request).values.program for pending_request in requests if previous]
    assert len(set(programs)) == len(programs)
    wait_until_saved(robot, session)
    assert after_power_off(table) == fetch_image(robot, session)


@pytest.mark.sampled("cut_ms", keep=1)
@pytest.mark.parametrize("cut_ms", [0, 10, 20, 30, 60, 140])
@pytest.mark.parametrize("state", STATES)
def test_a_power_cut_during_undo_leaves_an_existing_program(state: str, cut_ms: int) -> None:
    table, session = robot_in_state(state)
    robot = table.robot
    programs_there = {after_power_off(table), program_of(EARLIER_POWER), program_of(SAVED_POWER)}
    programs_there |= (
        {program_of(OTHER_POWER)} if state == "is bringing back the previous program" else set()
    )
    session.undo()
    robot.talk(session, cut_ms)
    assert after_power_off(table) in programs_there


def test_a_stranger_cannot_undo() -> None:
    table, _ = robot_in_state("has an owner")
    bytes_before = after_power_off(table)
    stranger = computer(9)
    assert undo(table.robot, stranger) == NOT_OWNER
    table.robot.wait(2000)
    assert after_power_off(table) == bytes_before
