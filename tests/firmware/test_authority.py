"""Authority: the reactions of an owned robot to a session without a key, or with a wrong one."""

from __future__ import annotations

import random

import pytest

from tests.support.campaign import make_options
from tests.support.images import image_of
from tests.support.owners import (
    NO_SEALS_DEFINES,
    UNSEALED_REQUESTS,
    Keys,
    OwnedRobot,
    grants_key_request,
    owner_of,
    robots_of_both_kinds,
    state_of,
)
from tiniscript.link.authority import OWNED_BY_OTHER
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, RADIO_MESSAGES, STATE_RUNNING, STATE_STOPPED, STATUSES
from tiniscript.link.seal import siphash
from tiniscript.link.session import Session

__all__ = ("robots_of_both_kinds",)  # a fixture

DISCONNECTED = 8  # the STATE pin of a module


def test_a_stranger_can_only_watch_and_stop() -> None:
    table, keys = OwnedRobot(), Keys()
    owner = table.claim_session(keys)
    assert table.try_to_drive(owner) == "OK"
    stranger = table.session(nonce=3)
    assert owner_of(table, stranger) == OWNED_BY_OTHER
    for is_open in (stranger.ping(), stranger.identify()):
        assert table.outcome(stranger, is_open) == "OK"
    assert state_of(table, stranger) == STATE_RUNNING
    stranger.stop(table.robot.now_ms)
    table.advance_time(stranger, 50)
    assert state_of(table, stranger) == STATE_STOPPED
    assert table.robot.is_latched
    assert table.outcome(stranger, stranger.clear()) == "NOT_OWNER"


def test_every_request_is_classified_by_authority() -> None:
    """Requests that act and are not listed here need authority, and the owner's run continues."""
    table, keys = OwnedRobot(), Keys()
    assert table.try_to_drive(table.claim_session(keys)) == "OK"
    stranger = table.session(nonce=3)
    assert owner_of(table, stranger) == OWNED_BY_OTHER
    for message in BY_NAME.values():
        if message.number >= 32 or message.name in UNSEALED_REQUESTS | {"CLAIM", "AUTHENTICATE"}:
            continue
        payload = bytes(sum(field.least_bytes for field in message.request))
        status = table.ask_unsealed(stranger, message.name, payload)[0]
        has_it = message.name not in RADIO_MESSAGES  # `test_esp32_wifi.py` tests those with a radio
        expected_status = STATUSES["NOT_OWNER" if has_it else "UNKNOWN_MESSAGE"]
        assert status == expected_status, message.name
    assert state_of(table, stranger) == STATE_RUNNING


@pytest.mark.parametrize("ending", ["silence", "STATE", "HELLO"])
def test_authority_ends_with_its_connection_and_is_proved_again(ending: str) -> None:
    """It ends less than 2 s after its last frame if a radio dropped out, or when another client
    arrives."""
    table, keys = OwnedRobot(), Keys()
    session = table.claim_session(keys)
    session._handshake._keys = None  # without a key, it cannot authenticate
    table.advance_time(None, 1900)
    assert table.outcome(session, session.trim()) == "OK"
    if ending == "silence":
        table.advance_time(None, 2050)
    elif ending == "STATE":
        table.advance_time(None, 10, DISCONNECTED)
    else:
        session = table.session(nonce=9)
        assert table.outcome(session, session.hello()) == "OK"
    assert table.outcome(session, session.trim()) == "NOT_OWNER"
    session._handshake._keys = keys
    assert table.outcome(session, session.trim()) == "OK"  # the session authenticates by itself


def test_a_replayed_session_grants_nothing() -> None:
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    next_session = table.session(keys, nonce=4)
    recorded_bytes, _ = table.frames(next_session, next_session.upload(image_of("SI|F(1, 80)")))
    table.advance_time(None, 4000)
    table.robot.did.clear()
    for _ in range(300):  # the epoch wraps around
        for data in recorded_bytes:
            table.robot.wait(3, b"\0" + data + b"\0")
    assert not [line for line in table.robot.did if "MOTORS" in line]


def test_a_replayed_tag_grants_nothing_in_its_own_epoch() -> None:
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    owner = table.session(keys, nonce=4)
    recorded_bytes, _ = table.frames(owner, owner.hello())
    (shown_frame,) = (
        frame for frame in map(decode_frame, recorded_bytes) if frame and len(frame.payload) == 9
    )
    assert table.outcome(owner, owner.trim()) == "OK"

    def status_of_tag(thief: Session, tag: bytes) -> int:
        return table.ask_unsealed(thief, "AUTHENTICATE", shown_frame.payload[:1] + tag)[0]

    assert (
        status_of_tag(owner, shown_frame.payload[1:]) == STATUSES["NOT_OWNER"]
    )  # twice to one challenge
    table.advance_time(None, 2100)
    # without a challenge
    assert status_of_tag(owner, shown_frame.payload[1:]) == STATUSES["NOT_OWNER"]
    assert status_of_tag(owner, b"") == 0
    # for another challenge
    assert status_of_tag(owner, shown_frame.payload[1:]) == STATUSES["WRONG_KEY"]
    for count in range(300):
        thief = table.session(nonce=4 if count % 2 else 9)
        assert table.outcome(thief, thief.hello()) == "OK"
        if thief._epoch == shown_frame.epoch and count % 2:
            break
        if thief._epoch == (shown_frame.epoch - 1) & 0xFF and not count % 2:
            continue
        if (thief._epoch - shown_frame.epoch) % 2 == count % 2:  # makes both frames arrive together
            table.robot.wait(100, bytes(8))
    assert thief._epoch == shown_frame.epoch
    assert status_of_tag(thief, b"") == 0
    assert status_of_tag(thief, shown_frame.payload[1:]) == STATUSES["WRONG_KEY"]


def test_wrong_keys_do_not_affect_the_owner() -> None:
    """This is on a line whose other end is unknown to the robot."""
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    wrong_keys = Keys()
    for count in range(20):
        wrong_keys.stored_keys = [keys.stored_keys[0]._replace(key=bytes([200 + count] * 16))]
        thief = table.session(wrong_keys, nonce=10 + count)
        assert owner_of(table, thief) == OWNED_BY_OTHER
        assert table.outcome(thief, thief.start()) == "WRONG_KEY"
    owner = table.session(keys, nonce=9)
    began_ms = table.robot.now_ms
    assert table.try_to_drive(owner) == "OK"
    assert table.robot.now_ms - began_ms < 500


def test_no_challenge_can_serve_as_a_tag() -> None:
    """Both are hashes with one key: the sender of a session's nonce cannot obtain a tag."""
    table, keys = OwnedRobot(), Keys()
    owner = table.claim_session(keys)
    assert owner.robot is not None
    nonce = owner.robot.values.nonce.to_bytes(4, "little")
    [key] = keys.keys_of_robot(owner.robot.id)
    challenges = []
    for _ in range(2):
        answer = table.ask_unsealed(owner, "AUTHENTICATE", bytes([key.kind]))
        assert answer[0] == 0
        challenges.append(answer[3:])
    first, second = challenges
    times = range(table.robot.now_ms - 100, table.robot.now_ms + 100)
    texts = [first + nonce + (time & 0xFFFF).to_bytes(2, "little") for time in times]
    assert [siphash(key.key, text + b"C") for text in texts].count(second) == 1
    assert second not in [siphash(key.key, text) for text in texts]


def test_a_reset_with_the_same_seed_gives_a_new_challenge_or_needs_the_key() -> None:
    """Two robots with one memory and one nonce: a tag shown to one never opens the other."""
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    memory = table.robot.memory()
    challenges = set()
    for seed in range(12):
        restarted = OwnedRobot(memory, seed=seed)
        session = restarted.session(keys, nonce=4)
        _, answers = restarted.frames(session, session.hello())
        reply = max(answers, key=len)
        challenges.add(b"".join(answer for answer in answers if answer != reply))
    assert len(challenges) == 12


def test_forged_and_reordered_frames_have_no_effect(frames: int = 3000) -> None:
    """`python -m tests.firmware.test_authority 100000` sends more of them."""
    assert send_forged_frames(frames, 1) == 0


# -- by command -----------------------------------------------------------------------------------


def send_forged_frames(frames: int, seed: int) -> int:
    """Send recorded, forged and reordered frames to a robot with an owner; return how many of them
    had it drive, start or change. A stop in between is always obeyed.
    """
    rng = random.Random(seed)
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    owner = table.session(keys, nonce=4)
    recorded_bytes, _ = table.frames(owner, owner.upload(image_of("SI|F(0.1, 80)")))
    table.advance_time(None, 6000)
    table.robot.did.clear()
    memory = table.robot.memory()
    accepted_count = 0
    thief = table.session(nonce=4)
    for count in range(frames):
        if count % 97 == 0:
            table.outcome(thief, thief.hello())
        if count % 1009 == 1:
            table.robot.wait(60)  # a repeated stop is reported at least 50 ms later
            stopped_event = table.robot.wait(60, bytes(8))
            assert b"\xa2" in stopped_event, (count, stopped_event)  # STOPPED
            table.robot.wait(1100)
        kind = rng.randrange(3)
        if kind == 0:
            data = rng.choice(recorded_bytes) + b"\0"
        else:
            message = rng.choice([message for message in BY_NAME.values() if message.number < 32])
            low = sum(field.least_bytes for field in message.request)
            high = sum(field.most_bytes for field in message.request)
            payload = rng.randbytes(rng.randint(low, high))
            if message.name == "AUTHENTICATE":
                payload = bytes([rng.randrange(2)]) + rng.randbytes(rng.choice((0, 8)))
            if message.name == "CLAIM":
                payload = bytes([rng.randrange(2)]) + rng.randbytes(rng.choice((0, 16)))
            thief._seq = (thief._seq + 1) & 0xFF
            seq = thief._seq if kind == 1 else rng.randrange(256)
            data = encode_frame(Frame(message.number, seq, thief._epoch, payload))
        sent_bytes = table.robot.step(b"\0" + data)
        accepted_count += sum(grants_key_request(answer) for answer in sent_bytes.split(b"\0"))
        if rng.randrange(50) == 0:
            table.robot.wait(30)
        actions = [line for line in table.robot.did if "MOTORS" in line]
        accepted_count += len(actions)
        table.robot.did.clear()
    if table.robot.memory() != memory:
        accepted_count += 1
    assert table.try_to_drive(table.session(keys, nonce=5)) == "OK"
    return accepted_count


if __name__ == "__main__":
    options = make_options(100_000, 1)
    OwnedRobot.DEFINES = NO_SEALS_DEFINES
    assert send_forged_frames(options.count, options.seed) == 0
