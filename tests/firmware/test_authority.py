"""Authority: what a robot with an owner does for a session that shows no key, or a wrong one."""

from __future__ import annotations

import random

import pytest

from tests.support.campaign import wanted
from tests.support.images import image_of
from tests.support.owners import (
    OPEN_TO_ALL,
    WITHOUT_SEALS,
    Keys,
    Owned,
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


def test_a_stranger_looks_and_stops_and_nothing_else() -> None:
    table, keys = Owned(), Keys()
    owner = table.claimed(keys)
    assert table.tries(owner) == "OK"
    stranger = table.session(nonce=3)
    assert owner_of(table, stranger) == OWNED_BY_OTHER
    for is_open in (stranger.ping(), stranger.identify()):
        assert table.outcome(stranger, is_open) == "OK"
    assert state_of(table, stranger) == STATE_RUNNING
    stranger.stop(table.robot.now_ms)
    table.pass_time(stranger, 50)
    assert state_of(table, stranger) == STATE_STOPPED
    assert table.robot.is_latched
    assert table.outcome(stranger, stranger.clear()) == "NOT_OWNER"


def test_every_request_has_a_side() -> None:
    """Whatever acts and is not listed here needs authority, and the owner's run goes on."""
    table, keys = Owned(), Keys()
    assert table.tries(table.claimed(keys)) == "OK"
    stranger = table.session(nonce=3)
    assert owner_of(table, stranger) == OWNED_BY_OTHER
    for message in BY_NAME.values():
        if message.number >= 32 or message.name in OPEN_TO_ALL | {"CLAIM", "AUTHENTICATE"}:
            continue
        payload = bytes(sum(field.least_bytes for field in message.request))
        status = table.asked(stranger, message.name, payload)[0]
        has_it = message.name not in RADIO_MESSAGES  # `test_esp32_wifi.py` asks who has a radio
        wanted = STATUSES["NOT_OWNER" if has_it else "UNKNOWN_MESSAGE"]
        assert status == wanted, message.name
    assert state_of(table, stranger) == STATE_RUNNING


@pytest.mark.parametrize("how", ["silence", "STATE", "HELLO"])
def test_authority_ends_with_its_connection_and_is_shown_again(how: str) -> None:
    """Less than 2 s after its last frame where a radio dropped out, or somebody else comes."""
    table, keys = Owned(), Keys()
    session = table.claimed(keys)
    session._handshake._keys = None  # it cannot show a key now
    table.pass_time(None, 1900)
    assert table.outcome(session, session.trim()) == "OK"
    if how == "silence":
        table.pass_time(None, 2050)
    elif how == "STATE":
        table.pass_time(None, 10, DISCONNECTED)
    else:
        session = table.session(nonce=9)
        assert table.outcome(session, session.hello()) == "OK"
    assert table.outcome(session, session.trim()) == "NOT_OWNER"
    session._handshake._keys = keys
    assert table.outcome(session, session.trim()) == "OK"  # it shows the key by itself


def test_a_recorded_session_opens_nothing() -> None:
    table, keys = Owned(), Keys()
    table.claimed(keys)
    next_session = table.session(keys, nonce=4)
    recorded, _ = table.frames(next_session, next_session.upload(image_of("SI|F(1, 80)")))
    table.pass_time(None, 4000)
    table.robot.did.clear()
    for _ in range(300):  # the epoch goes around
        for data in recorded:
            table.robot.wait(3, b"\0" + data + b"\0")
    assert not [line for line in table.robot.did if "MOTORS" in line]


def test_a_recorded_tag_opens_nothing_in_its_own_epoch() -> None:
    table, keys = Owned(), Keys()
    table.claimed(keys)
    owner = table.session(keys, nonce=4)
    recorded, _ = table.frames(owner, owner.hello())
    (shown,) = (frame for frame in map(decode_frame, recorded) if frame and len(frame.payload) == 9)
    assert table.outcome(owner, owner.trim()) == "OK"

    def answers(thief: Session, tag: bytes) -> int:
        return table.asked(thief, "AUTHENTICATE", shown.payload[:1] + tag)[0]

    assert answers(owner, shown.payload[1:]) == STATUSES["NOT_OWNER"]  # twice to one challenge
    table.pass_time(None, 2100)
    assert answers(owner, shown.payload[1:]) == STATUSES["NOT_OWNER"]  # without a challenge
    assert answers(owner, b"") == 0
    assert answers(owner, shown.payload[1:]) == STATUSES["WRONG_KEY"]  # to another challenge
    for count in range(300):
        thief = table.session(nonce=4 if count % 2 else 9)
        assert table.outcome(thief, thief.hello()) == "OK"
        if thief._epoch == shown.epoch and count % 2:
            break
        if thief._epoch == (shown.epoch - 1) & 0xFF and not count % 2:
            continue
        if (thief._epoch - shown.epoch) % 2 == count % 2:  # so that both come together
            table.robot.wait(100, bytes(8))
    assert thief._epoch == shown.epoch
    assert answers(thief, b"") == 0
    assert answers(thief, shown.payload[1:]) == STATUSES["WRONG_KEY"]


def test_wrong_keys_cost_the_owner_nothing() -> None:
    """On a line of which the robot does not know who is at its other end."""
    table, keys = Owned(), Keys()
    table.claimed(keys)
    wrong = Keys()
    for count in range(20):
        wrong.stored_keys = [keys.stored_keys[0]._replace(key=bytes([200 + count] * 16))]
        thief = table.session(wrong, nonce=10 + count)
        assert owner_of(table, thief) == OWNED_BY_OTHER
        assert table.outcome(thief, thief.start()) == "WRONG_KEY"
    owner = table.session(keys, nonce=9)
    began_ms = table.robot.now_ms
    assert table.tries(owner) == "OK"
    assert table.robot.now_ms - began_ms < 500


def test_no_challenge_is_a_tag() -> None:
    """Both are hashes with one key: whoever chooses a session's nonce gets no tag by asking."""
    table, keys = Owned(), Keys()
    owner = table.claimed(keys)
    assert owner.robot is not None
    nonce = owner.robot.values.nonce.to_bytes(4, "little")
    [key] = keys.keys_of_robot(owner.robot.id)
    challenges = []
    for _ in range(2):
        answer = table.asked(owner, "AUTHENTICATE", bytes([key.which]))
        assert answer[0] == 0
        challenges.append(answer[3:])
    first, second = challenges
    times = range(table.robot.now_ms - 100, table.robot.now_ms + 100)
    texts = [first + nonce + (time & 0xFFFF).to_bytes(2, "little") for time in times]
    assert [siphash(key.key, text + b"C") for text in texts].count(second) == 1
    assert second not in [siphash(key.key, text) for text in texts]


def test_the_same_seed_after_a_reset_is_another_challenge_or_needs_the_key() -> None:
    """Two robots with one memory and one nonce: what one was shown opens the other at no time."""
    table, keys = Owned(), Keys()
    table.claimed(keys)
    memory = table.robot.memory()
    challenges = set()
    for seed in range(12):
        later = Owned(memory, seed=seed)
        session = later.session(keys, nonce=4)
        _, answers = later.frames(session, session.hello())
        reply = max(answers, key=len)
        challenges.add(b"".join(answer for answer in answers if answer != reply))
    assert len(challenges) == 12


def test_forged_and_reordered_frames_drive_nothing(frames: int = 3000) -> None:
    """As `python -m tests.firmware.test_authority 100000`, which does more of the same."""
    assert forged(frames, 1) == 0


# -- by command -----------------------------------------------------------------------------------


def forged(frames: int, seed: int) -> int:
    """Send recorded, forged and reordered frames to a robot with an owner; return how many of them
    had it drive, start or change. A stop in between is always obeyed.
    """
    chance = random.Random(seed)
    table, keys = Owned(), Keys()
    table.claimed(keys)
    owner = table.session(keys, nonce=4)
    recorded, _ = table.frames(owner, owner.upload(image_of("SI|F(0.1, 80)")))
    table.pass_time(None, 6000)
    table.robot.did.clear()
    memory = table.robot.memory()
    accepted = 0
    thief = table.session(nonce=4)
    for count in range(frames):
        if count % 97 == 0:
            table.outcome(thief, thief.hello())
        if count % 1009 == 1:
            table.robot.wait(60)  # a repeated stop is told 50 ms later at the earliest
            stopped_event = table.robot.wait(60, bytes(8))
            assert b"\xa2" in stopped_event, (count, stopped_event)  # STOPPED
            table.robot.wait(1100)
        how = chance.randrange(3)
        if how == 0:
            data = chance.choice(recorded) + b"\0"
        else:
            message = chance.choice(
                [message for message in BY_NAME.values() if message.number < 32]
            )
            low = sum(field.least_bytes for field in message.request)
            high = sum(field.most_bytes for field in message.request)
            payload = chance.randbytes(chance.randint(low, high))
            if message.name == "AUTHENTICATE":
                payload = bytes([chance.randrange(2)]) + chance.randbytes(chance.choice((0, 8)))
            if message.name == "CLAIM":
                payload = bytes([chance.randrange(2)]) + chance.randbytes(chance.choice((0, 16)))
            thief._seq = (thief._seq + 1) & 0xFF
            seq = thief._seq if how == 1 else chance.randrange(256)
            data = encode_frame(Frame(message.number, seq, thief._epoch, payload))
        sent = table.robot.step(b"\0" + data)
        accepted += sum(grants_key_request(answer) for answer in sent.split(b"\0"))
        if chance.randrange(50) == 0:
            table.robot.wait(30)
        did = [line for line in table.robot.did if "MOTORS" in line]
        accepted += len(did)
        table.robot.did.clear()
    if table.robot.memory() != memory:
        accepted += 1
    assert table.tries(table.session(keys, nonce=5)) == "OK"
    return accepted


if __name__ == "__main__":
    given = wanted(100_000, 1)
    Owned.DEFINES = WITHOUT_SEALS
    assert forged(given.count, given.seed) == 0
