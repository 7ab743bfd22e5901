"""An ESP32 whose NVS cannot be read: it does not know its owner, so no one can drive it."""

from __future__ import annotations

import pytest

from tests.machines.esp32 import (
    EMPTY_MEMORY,
    NVS_BLOBS_FAIL,
    NVS_CLOSED,
    NVS_NUMBERS_FAIL,
    Esp32Robot,
    Kept,
)
from tests.support.esp32_radio import LowEnergy, RawClient, session, talk
from tests.support.esp32_wifi import make_owned_robot, remote
from tests.support.images import image_of
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import AWAY_PROGRAM, Ends, upload_text, wait_for_outcome
from tests.support.robot_on_host import actions_of
from tiniscript.link.messages import SAVED_STATES, STOP_BYTES
from tiniscript.link.session import Session

FAULTS = pytest.mark.parametrize("fault", [NVS_CLOSED, NVS_NUMBERS_FAIL, NVS_BLOBS_FAIL])


def claimed_with_program(keys: Keys) -> Kept:
    robot, owner = make_owned_robot(keys)
    clients: Ends = [(None, owner)]
    assert wait_for_outcome(robot, clients, owner.upload(image_of("SB|F(60, 80)"))) == "OK"
    talk(robot, clients, 3000)
    return robot.read_kept()


def boot(kept_memory: Kept, fault: int) -> Esp32Robot:
    robot = Esp32Robot(kept_memory=kept_memory, nvs_fault=fault)
    robot.wait(500)
    return robot


def read_saved_state(robot: Esp32Robot, session: Session) -> str:
    request = session.status()
    assert wait_for_outcome(robot, [(None, session)], request) == "OK"
    assert request.outcome
    return SAVED_STATES[request.outcome.values.saved][0]


@FAULTS
def test_strangers_do_not_drive_a_claimed_robot(fault: int) -> None:
    robot = boot(claimed_with_program(Keys()), fault)
    stranger, typed_bytes = session(2, robot), RawClient(b"SI|F(60, 80)\n")
    clients: Ends = [(None, stranger)]
    assert read_saved_state(robot, stranger) == "UNREADABLE"
    for request in (
        stranger.upload(image_of(AWAY_PROGRAM)), stranger.live(image_of("F(1, 10)").code),
        stranger.start(),
        stranger.name(b"mine"), stranger.fetch(), stranger.undo(),
    ):  # fmt: skip
        assert wait_for_outcome(robot, clients, request) == "NOT_OWNER"
    thief = remote(robot, Keys(80), 4)
    assert wait_for_outcome(robot, [(None, thief)], thief.claim(0)) == "UNREADABLE"
    talk(robot, [(LowEnergy(robot), typed_bytes)], 1500)
    assert b"//" in typed_bytes.received
    robot.step(flags=1)
    robot.wait(100)
    robot.step(flags=2)
    robot.wait(500)
    assert not [line for line in actions_of(robot) if "MOTORS 80" in line]


@FAULTS
def test_an_owner_of_an_unreadable_robot_gets_the_reason_and_keeps_the_key(fault: int) -> None:
    kept_memory = claimed_with_program(keys := Keys())
    robot = boot(kept_memory, fault)
    owner = remote(robot, keys, 4)
    assert upload_text(robot, [(None, owner)], owner) == "UNREADABLE"
    assert [(key.is_stale, key.is_pending) for key in keys.stored_keys] == [(False, False)]
    robot.step(bytes(STOP_BYTES))
    robot.wait(20)
    assert robot.is_latched
    restarted_robot = boot(kept_memory, 0)
    owner = remote(restarted_robot, keys, 5)
    assert upload_text(restarted_robot, [(None, owner)], owner) == "OK"


@pytest.mark.parametrize("fault", [NVS_CLOSED, NVS_NUMBERS_FAIL])  # a new chip has no blobs to read
def test_an_unreadable_new_robot_has_no_owner(fault: int) -> None:
    robot = boot(EMPTY_MEMORY, fault)
    anybody = session(2, robot)
    assert upload_text(robot, [(None, anybody)], anybody) == "NOT_OWNER"
    robot = boot(EMPTY_MEMORY, 0)
    anybody = session(2, robot)
    assert upload_text(robot, [(None, anybody)], anybody) == "OK"
