"""A robot writes its data only while its motors are off, with enough voltage, and never confirms a
write before it is done.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.kept_programs import (
    DRIVE_PROGRAM,
    FIRST_SLOT,
    RECORD_BYTES,
    bytes_of,
    name_after_power_off,
    program_after_power_off,
    read_saved_state,
)
from tests.support.robot_on_host import (
    KIT,
    actions_of,
    broken_upload,
    computer,
    push_button,
    robot_with_saved_program,
    send,
    switched_on,
    wait_until_saved,
)
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import STATUSES
from tiniscript.link.payloads import EmptyReply, FetchReply
from tiniscript.link.requests import OK, Request, send_single
from tiniscript.link.session import Session
from tiniscript.link.trim import Pace, Trim, trim_from_reply

WAITS = "SI|LOOP(FOREVER);W(1);END_LOOP"
PAUSES = "SI|LOOP(FOREVER);F(0.05, 80);W(0.004);END_LOOP"


def marks(robot: HostFirmware) -> list[str]:
    return [line for line in actions_of(robot) if "MARK" in line or "MEASURED" in line]


# -- motors ---------------------------------------------------------------------------------------


def test_a_program_without_moves_is_saved_while_it_runs() -> None:
    robot, session = switched_on(), computer()
    send(robot, session, WAITS)
    assert read_saved_state(robot, session) == "SAVING"
    wait_until_saved(robot, session, 2000)
    assert program_after_power_off(robot) == bytes_of(WAITS)
    assert robot.until(session, session.name(b"NEW")) == OK
    assert session.is_running
    assert name_after_power_off(robot) == "NEW"


def test_a_program_that_drives_without_a_pause_is_saved_when_it_ends() -> None:
    robot, session = switched_on(), computer()
    send(robot, session, DRIVE_PROGRAM)
    robot.talk(session, 5000)
    assert read_saved_state(robot, session) == "SAVING"
    assert program_after_power_off(robot) == b""
    session.stop(robot.now_ms)
    robot.talk(session, 300)
    assert read_saved_state(robot, session) == "STORED"
    assert program_after_power_off(robot) == bytes_of(DRIVE_PROGRAM)


@pytest.mark.parametrize("wait", [1, 2, 3, 4, 5, 7])
def test_a_program_is_saved_in_its_pauses_and_no_motor_runs_meanwhile(wait: int) -> None:
    """A motor that starts waits for the byte: it may pull the voltage down. So it is at most three
    bytes late, once."""
    robot, session = switched_on(), computer()
    text = PAUSES.replace("0.004", f"0.00{wait}")
    send(robot, session, text)
    wait_until_saved(robot, session, 5000)
    assert session.is_running
    assert marks(robot) == []
    assert program_after_power_off(robot) == bytes_of(text)


@pytest.mark.parametrize("seed", range(12))
def test_a_program_without_moves_is_eventually_stored_after_any_history(seed: int) -> None:
    """Sent again, after another one, after a power-off, or with a supply that was low."""
    rng, texts = Random(seed), [f"SI|SHOW({number})" for number in range(3)]
    robot, session = switched_on(), computer()
    for nonce in range(2, 8):
        text = rng.choice(texts)
        robot.set_supply(is_low=rng.random() < 0.3)
        send(robot, session, text, saves=rng.random() < 0.7)
        robot.talk(session, rng.randrange(1500))
        if rng.random() < 0.5:
            robot, session = switched_on(robot.memory()), computer(nonce)
        else:
            robot.set_supply(is_low=False)
        text = rng.choice([text, *texts])
        send(robot, session, text)
        wait_until_saved(robot, session)
        assert program_after_power_off(robot) == bytes_of(text)


# -- names and trims ------------------------------------------------------------------------------


def test_a_name_is_confirmed_once_stored_and_deferred_while_driving() -> None:
    """The plug is pulled as soon as the robot has said OK."""
    robot, session = switched_on(), computer()
    for name in (b"TINI", b"TIN", b"ANA"):
        assert robot.until(session, session.name(name)) == OK
        assert name_after_power_off(robot) == name.decode()
        assert session.robot is not None and session.robot.name == name.decode()
    send(robot, session, DRIVE_PROGRAM, saves=False)
    began_ms = robot.now_ms
    assert robot.until(session, session.name(b"NEW")) == STATUSES["SAVING"]
    assert robot.now_ms - began_ms < 6000  # time that a command waits
    assert session.is_running
    assert name_after_power_off(robot) == "ANA"
    session.stop(robot.now_ms)
    robot.talk(session, 500)
    assert name_after_power_off(robot) == "NEW"
    assert robot.until(session, session.name(b"NEW")) == OK


@pytest.mark.parametrize("cut_ms", range(1, 240, 17))
def test_an_unconfirmed_name_is_the_old_or_the_new_one(cut_ms: int) -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.name(b"OLD")) == OK
    request = session.name(b"NEW")
    robot.talk(session, cut_ms)
    name = name_after_power_off(robot)
    assert name in ("OLD", "NEW")
    assert request.outcome is None or name == "NEW"


def test_a_trim_is_confirmed_once_stored() -> None:
    robot, session = switched_on(), computer()
    for trim in (b"\1\5\7", b"\1\5\1", b"\0\0\0"):
        assert robot.until(session, session.trim(trim)) == OK
        restarted_robot, other_session = switched_on(robot.memory()), computer(2)
        values = restarted_robot.complete(other_session, other_session.trim())
        assert bytes((values.wheels, values.balance, values.least)) == trim
    send(robot, session, DRIVE_PROGRAM, saves=False)
    assert robot.until(session, session.trim(b"\1\2\3")) == STATUSES["SAVING"]


def test_a_power_cut_while_storing_a_pace_leaves_a_whole_one() -> None:
    """It is the old or the new one, whatever the trim next to it; both are new once the robot has
    answered OK."""
    robot, session = switched_on(), computer()
    trim_before = Trim(balance=3, least=7, pace=Pace(9, 19, 80, 170))
    trim_after = Trim(balance=5, least=7, pace=Pace(11, 30, 70, 260))
    assert robot.until(session, session.trim(trim_before.data())) == OK
    request = session.trim(trim_after.data())
    trims: list[Trim] = []
    while request.outcome is None or robot.now_ms % 7:
        robot.talk(session, 1)
        if robot.now_ms % 7 == 0:
            trims.append(trim_after_power_off(robot))
    assert robot.until(session, request) == OK
    assert {trim.pace for trim in trims} == {trim_before.pace, trim_after.pace}
    assert {trim._replace(pace=Pace()) for trim in trims} == {
        trim._replace(pace=Pace()) for trim in (trim_before, trim_after)
    }
    assert trim_after_power_off(robot) == trims[-1] == trim_after


def trim_after_power_off(robot: HostFirmware) -> Trim:
    restarted_robot, other_session = switched_on(robot.memory()), computer(2)
    return trim_from_reply(restarted_robot.complete(other_session, other_session.trim()))


def test_a_name_that_fits_a_worn_byte_is_stored_after_one_that_did_not() -> None:
    """The byte of the first letter stays an O. A name that did not fit has no effect."""
    robot, session = switched_on(), computer()
    for name in (b"OLD", b"NEW"):
        assert robot.until(session, session.name(name)) == OK
    robot.wear_out(robot.memory().index(b"OLD"))  # the next one is written there
    assert robot.until(session, session.name(b"XYZ")) == STATUSES["NOT_KEPT"]
    assert name_after_power_off(robot) == "NEW"
    assert robot.until(session, session.name(b"ONE")) == OK
    assert name_after_power_off(robot) == "ONE"


PACED = Trim(is_exchanged=True, least=3, pace=Pace(10, 20, 30, 40))
# A request, and the state of a robot after the next power-on.
KEPT: dict[str, tuple[Callable[[Session], PendingRequest[Any]], Callable[[HostFirmware], bool]]] = {
    "a name": (lambda session: session.name(b"XYZ"),
               lambda robot: name_after_power_off(robot) == "XYZ"),
    "a trim": (lambda session: session.trim(bytes((0, 0, 3))),
               lambda robot: trim_after_power_off(robot).least == 3),
    "a pace": (lambda session: session.trim(PACED.data()),
               lambda robot: trim_after_power_off(robot) == PACED),
    "a program": (lambda session: session.upload(image_of(WAITS)),
                  lambda robot: program_after_power_off(robot) == bytes_of(WAITS)),
}  # fmt: skip


@pytest.mark.parametrize("request_name", KEPT)
def test_a_failed_save_succeeds_on_a_later_request(request_name: str) -> None:
    """The memory accepts no writes for a while, as if the supply failed in each write. The first
    answer afterwards may still be about the last time.
    """
    robot, session = robot_with_saved_program()
    make_request, is_kept = KEPT[request_name]
    for place in range(len(robot.memory())):
        robot.wear_out(place)
    is_program = request_name == "a program"  # programs are answered at once
    assert robot.until(session, make_request(session)) == (
        OK if is_program else STATUSES["NOT_KEPT"]
    )
    robot.talk(session, 3000)
    assert not is_kept(robot)
    robot.mend()
    answers = {robot.until(session, make_request(session)) for _ in "12"}
    robot.talk(session, 3000)
    assert OK in answers and is_kept(robot)


def test_a_name_is_stored_after_a_program_that_hit_a_worn_byte() -> None:
    """Each save begins with its first byte, wherever the one before has ended."""
    robot, session = switched_on(), computer()
    for power in (20, 30):
        send(robot, session, f"SB|F(1, {power})")
        assert wait_until_saved(robot, session)
    robot.wear_out(robot.memory().index(image_of("SB|F(1, 20)").code) + 2)  # the power
    send(robot, session, "SB|F(1, 40)")
    robot.talk(session, 1500)
    assert read_saved_state(robot, session) == "MEMORY"
    assert robot.until(session, session.name(b"NEW")) == OK
    assert name_after_power_off(robot) == "NEW"


def test_data_with_a_worn_last_byte_reads_as_empty() -> None:
    robot, session = switched_on(), computer()
    for name in (b"OLD", b"NEW"):
        assert robot.until(session, session.name(name)) == OK
    slot = robot.memory().index(b"OLD") - 4 - 8
    robot.wear_out(slot + RECORD_BYTES - 1)
    assert robot.until(session, session.trim(bytes((0, 0, 3)))) == STATUSES["NOT_KEPT"]
    robot.talk(session, 400)  # the pace's record, then this one again
    assert robot.memory()[slot : slot + 2] == b"\xff\xff", "the generation and its mark"


# -- the supply -----------------------------------------------------------------------------------


def test_a_low_supply_is_reported_and_waited_for() -> None:
    robot, session = switched_on(), computer()
    robot.set_supply(is_low=True)
    send(robot, session, "SI|SHOW(1)")
    robot.talk(session, 1500)
    assert read_saved_state(robot, session) == "LOW_SUPPLY"
    assert robot.until(session, session.name(b"NEW")) == STATUSES["LOW_SUPPLY"]
    assert program_after_power_off(robot) == b""
    assert marks(robot) == []
    robot.set_supply(is_low=False)
    robot.talk(session, 1500)
    assert read_saved_state(robot, session) == "STORED"
    assert robot.until(session, session.name(b"NEW")) == OK
    assert program_after_power_off(robot) == bytes_of("SI|SHOW(1)")
    assert name_after_power_off(robot) == "NEW"


def test_with_a_low_supply_another_program_can_still_run() -> None:
    """The earlier program is kept, and the pending one is given up for the new one."""
    robot, session = robot_with_saved_program()
    robot.set_supply(is_low=True)
    for power in (20, 30, 40):
        text = f"SI|F(0.1, {power}); " + "SHOW(1); " * 20
        send(robot, session, text)
        robot.talk(session, 800)
        assert f"MOTORS {power} {power}" in actions_of(robot)
        assert read_saved_state(robot, session) == "LOW_SUPPLY"
    assert program_after_power_off(robot) == bytes_of("SB|F(0.2, 80)")
    broken_upload(robot, session)
    assert push_button(robot) == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]
    robot.set_supply(is_low=False)
    robot.talk(session, 3000)
    assert read_saved_state(robot, session) == "STORED"
    assert marks(robot) == []


@pytest.mark.sampled("seed", keep=12)
@pytest.mark.parametrize("seed", range(30))
def test_a_low_supply_at_any_time_keeps_the_last_program_intact(seed: int) -> None:
    """Uploads arrive at any moment of a save, and the program in memory at a power loss is always
    whole."""
    rng = Random(seed)
    robot, session = robot_with_saved_program()
    programs, kept_index = (
        [bytes_of("SB|F(0.2, 80)")],
        0,
    )  # accepted programs, and the saved one
    for number in range(6):
        robot.set_supply(is_low=rng.random() < 0.6)
        robot.talk(session, rng.choice((1, 20, 60, 130, 400, 700)))
        text = f"SI|SHOW({number}); " + "SHOW(1); " * rng.choice((2, 20, 40))
        if robot.until(session, session.upload(image_of(text))) != OK:
            continue  # data being written is not overwritten
        robot.talk(session, rng.choice((1, 20, 60, 130, 400, 700)))
        if rng.random() < 0.7:  # the supply recovers during the wait
            robot.set_supply(is_low=False)
            robot.talk(session, rng.choice((1, 20, 60, 130, 400, 700)))
        programs.append(bytes_of(text))
        if read_saved_state(robot, session) == "STORED":
            kept_index = len(programs) - 1
        assert program_after_power_off(robot) in programs[kept_index:], number
    robot.set_supply(is_low=False)
    robot.talk(session, 3000)
    assert read_saved_state(robot, session) == "STORED"
    assert program_after_power_off(robot) == programs[-1]


def test_a_low_supply_after_an_interrupted_save_is_reported() -> None:
    """Repairs after a cut need enough voltage; until then, the result is unknown."""
    robot, session = robot_with_saved_program()
    memory = bytearray(robot.memory())
    assert memory[FIRST_SLOT] == 0
    memory[FIRST_SLOT + 3] = 0  # the third mark was not written
    robot, session = HostFirmware(KIT, bytes(memory)), computer()
    robot.set_supply(is_low=True)
    robot.wait(500)
    assert read_saved_state(robot, session) == "LOW_SUPPLY"
    low = STATUSES["LOW_SUPPLY"]
    assert robot.until(session, session.fetch()) == low
    assert robot.until(session, session.upload(image_of("SI|F(0.1, 50)"))) == low
    assert robot.until(session, session.name(b"NEW")) == low
    robot.set_supply(is_low=False)
    robot.wait(1000)
    assert read_saved_state(robot, session) == "STORED"
    assert program_after_power_off(robot) == bytes_of("SB|F(0.2, 80)")


# -- reading while it is written ------------------------------------------------------------------


def session_while_name_is_written(
    robot: HostFirmware, session: Session, name: bytes = b"A LONG NAME"
) -> Session:
    """Return another session of a robot with a stored program that writes its name."""
    broken_upload(robot, session)
    other_session = computer(3)
    assert robot.until(other_session, other_session.hello()) == OK
    other_session.name(name)
    robot.talk(other_session, 5)
    return other_session


def test_a_program_is_fetched_whole_and_started_while_a_name_is_written() -> None:
    text = "SB|" + "F(0.2, 80); " * 30
    robot, session = robot_with_saved_program(text)
    session_while_name_is_written(robot, session)
    another = computer(4)
    assert robot.complete(another, another.fetch()).image == bytes_of(text)
    robot.talk(another, 1000)
    other_session = session_while_name_is_written(robot, another, b"ANOTHER ONE")
    robot.push(1)
    robot.talk(other_session, 7000)
    assert actions_of(robot)[0] == "MOTORS 80 80" and actions_of(robot)[-1] == "FINISHED"


def test_a_robot_that_is_saving_answers_busy_to_fetch() -> None:
    robot, session = robot_with_saved_program()
    broken_upload(robot, session)
    other_session = computer(3)
    assert robot.until(other_session, other_session.hello()) == OK

    naming = other_session._queue_exchange(
        send_single(Request("NAME", {"name": b"NEW"}), EmptyReply)
    )
    assert robot.until(other_session, naming) == STATUSES["SAVING"]
    request = other_session._queue_exchange(
        send_single(Request("FETCH", {"offset": 0}), FetchReply)
    )
    assert robot.until(other_session, request) == STATUSES["BUSY"]


def test_a_stop_ends_a_start_that_waits_for_the_memory() -> None:
    robot, session = switched_on(write_ms=12), computer()
    send(robot, session, "SB|F(0.2, 80)")
    robot.talk(session, 2000)
    other_session = session_while_name_is_written(robot, session)
    robot.push(1)
    other_session.stop(robot.now_ms)
    robot.talk(other_session, 2000)
    assert [line for line in actions_of(robot) if line.startswith("MOTORS")] == []
