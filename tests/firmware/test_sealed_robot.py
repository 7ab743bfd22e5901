"""A whole robot with an owner, and an eavesdropper: no recorded frame opens it.

`python -m tests.firmware.test_sealed_robot 100000` sends as many frames.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable

import pytest

from tests.support.campaign import make_options
from tests.support.images import image_of
from tests.support.owners import (
    BUTTON_PRESSED,
    FOREVER,
    Keys,
    OwnedRobot,
    grants_key_request,
    owner_of,
    state_of,
)
from tests.support.thief import Thief, encoded
from tiniscript.link.authority import OWNED_BY_OTHER, OWNED_BY_YOU, ownership_of
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    FIRST_EVENT,
    KEY_TEACHER,
    MAJOR,
    MESSAGES,
    OWNERS,
    RADIO_MESSAGES,
    SEALS,
    STATE_FAULTED,
    STATE_RUNNING,
    STATE_STOPPED,
    STATUSES,
)
from tiniscript.link.outcomes import LOST
from tiniscript.link.payloads import HelloReply
from tiniscript.link.requests import OK, Reply
from tiniscript.link.seal import LAST_COUNTER, Seal
from tiniscript.link.session import Session

SHORT = "SI|F(0.1, 80)"
UNPLUGGED = 8
MAX_TIMES, AUTHENTICATION_MS = 3, 500  # each piece again, and an authentication


def upload_and_capture(
    table: OwnedRobot, session: Session, text: str
) -> tuple[list[bytes], list[bytes]]:
    """Run a program; return the frames to the robot and those back."""
    return table.frames(session, session.upload(image_of(text), saves=False))


def open_sealed_session(*defines: str) -> tuple[OwnedRobot, Session, Keys]:
    """Return a robot, and a session whose seal both know, with its keys."""
    table, keys = OwnedRobot(defines=defines), Keys()
    table.claim_session(keys)
    session = table.session(keys, nonce=4)
    assert owner_of(table, session) == OWNED_BY_YOU
    return table, session, keys


def test_firmware_without_seals_works_as_before() -> None:
    table, session, _ = open_sealed_session("tiniscript_without_seals")
    assert session.robot and session.robot.values.features & (SEALS | OWNERS) == OWNERS
    sent_bytes, _ = upload_and_capture(table, session, SHORT)
    assert not any(frame.is_sealed for frame in map(decode_frame, sent_bytes) if frame)
    sealed_frame = Seal(bytes(16)).seal_frame(Frame(BY_NAME["START"].number, 1, 0, b"\0"))
    reply = table.answer(sealed_frame)
    assert reply and reply.payload[0] == STATUSES["NOT_SEALED"]


def test_unsealed_frames_have_no_authority() -> None:
    """The attacker writes into the owner's line, in its epoch, with the next number."""
    table, session, _ = open_sealed_session()
    upload_and_capture(table, session, FOREVER)
    open_to_all = {"HELLO", "PING", "STATUS", "STOP", "CLAIM", "AUTHENTICATE", "IDENTIFY"}
    for message in MESSAGES:
        if message.number >= FIRST_EVENT or message.name in {*open_to_all, *RADIO_MESSAGES}:
            continue
        payload = bytes(sum(field.least_bytes for field in message.request))
        frame = Frame(message.number, (session._seq + 1) & 0xFF, session._epoch, payload)
        reply = table.answer(frame)
        assert reply and reply.payload[0] == STATUSES["NOT_OWNER"] and not reply.is_sealed, message
    for key_kind in (0, 1):
        claim = Frame(16, (session._seq + 1) & 0xFF, session._epoch, bytes([key_kind]))
        reply = table.answer(claim)
        assert reply and reply.payload[0] == STATUSES["NOT_OWNER"]
    assert state_of(table, session) == STATE_RUNNING


def test_an_answer_is_repeated_only_to_its_client() -> None:
    """The same number without a seal gets neither a receipt nor the program's bytes."""
    table, session, _ = open_sealed_session()
    upload_and_capture(table, session, SHORT)
    request = session.fetch()
    assert table.outcome(session, request) == "OK"
    frame = Frame(BY_NAME["FETCH"].number, session._seq, session._epoch, b"\0\0")
    reply = table.answer(frame)
    assert reply and reply.payload == bytes([STATUSES["NOT_OWNER"], 0, 0])


def test_a_stranger_keeps_no_program_running() -> None:
    """The owner is gone, and another client pings, or opens a session and pings."""
    ping, hello = BY_NAME["PING"].number, BY_NAME["HELLO"].number
    for is_greeting in (False, True):
        table, session, _ = open_sealed_session()
        upload_and_capture(table, session, FOREVER)
        began_ms = table.robot.now_ms
        if is_greeting:
            payload = bytes([MAJOR, *bytes(5), *b"abcd"])
            table.robot.wait(5, b"\0" + encode_frame(Frame(hello, 1, 0, payload)))
        while table.robot.now_ms < began_ms + 1010:
            table.robot.wait(50, b"\0" + encode_frame(Frame(ping, 1, 0)))
        assert "MOTORS 0 0" in table.robot.did[-2] + table.robot.did[-1]
        frame = table.answer(Frame(ping, 1, 0))
        assert frame and frame.payload[1] == STATE_FAULTED


def test_a_relay_cannot_fake_success() -> None:
    """No frame reaches the robot, and its answers are forged in every way that works without the
    key."""
    rng = random.Random(1)
    table, session, _ = open_sealed_session()
    sent_bytes, replies = upload_and_capture(table, session, SHORT)
    table.advance_time(session, 400)
    request = session.live(image_of(SHORT).code)
    for _ in range(25_000):
        data = session.poll(table.robot.now_ms)
        table.robot.now_ms += 1
        frame = decode_frame(data.strip(b"\0")) if data else None
        if frame is None:
            continue
        receipt = bytes(8)
        forged_frames = [
            Frame(frame.number, frame.seq, frame.epoch, b"\0" + receipt, is_reply=True),
            Frame(frame.number, frame.seq, frame.epoch, b"\0" + receipt, True, True),
            Frame(frame.number, frame.seq, frame.epoch, bytes(22), True, True),
            frame._replace(is_reply=True),
        ]
        for packet in [
            *map(encode_frame, forged_frames),
            *(packet + b"\0" for packet in replies + sent_bytes),
            data,
        ]:
            session.receive(packet, table.robot.now_ms)
            assert request.outcome is None
        if rng.random() < 0.2:
            lost_bytes = bytes([STATUSES["NOT_OWNER"], 0, 0])
            session.receive(
                encode_frame(forged_frames[0]._replace(payload=lost_bytes)), table.robot.now_ms
            )
        if request.outcome is not None:
            break
    assert request.outcome and request.outcome.status in (LOST, STATUSES["NOT_OWNER"])


def refused_by_a_stranger(table: OwnedRobot, session: Session, is_cut: bool) -> Reply[HelloReply]:
    """Open a session while a stranger refuses each tag before the robot answers; where the line
    `is_cut`, the tags do not reach the robot.
    """
    request = session.hello()
    while request.outcome is None:
        data = session.poll(table.robot.now_ms)
        frame = decode_frame(data.strip(b"\0")) if data else None
        if frame and frame.number == BY_NAME["AUTHENTICATE"].number and len(frame.payload) > 1:
            for name in ("WRONG_KEY", "STALE", "NOT_OWNER"):
                reply = frame._replace(payload=bytes([STATUSES[name], 4, 0]), is_reply=True)
                session.receive(b"\0" + encode_frame(reply), table.robot.now_ms)
            data = b"" if is_cut else data
        session.receive(table.robot.step(data), table.robot.now_ms)
    return request.outcome


@pytest.mark.parametrize("is_cut", [False, True])
@pytest.mark.parametrize("is_pending", [False, True])
def test_no_refusal_by_a_stranger_removes_a_key(is_pending: bool, is_cut: bool) -> None:
    """A refusal has no seal: the robot's own answer, which has one, is waited for. An attacker who
    cuts the line may refuse a key forever; without that, the robot opens again."""
    table, _, keys = open_sealed_session()
    keys.stored_keys = [robot_key._replace(is_pending=is_pending) for robot_key in keys.stored_keys]
    session = table.session(keys, nonce=8)
    assert refused_by_a_stranger(table, session, is_cut).status == 0
    assert session.robot and ownership_of(session.robot) == (
        OWNED_BY_OTHER if is_cut else OWNED_BY_YOU
    )
    assert [key.is_stale for key in keys.stored_keys] == [is_cut]
    assert is_cut or not keys.stored_keys[0].is_pending
    assert table.try_to_drive(table.session(keys, nonce=9) if is_cut else session) == "OK"
    assert [(key.is_pending, key.is_stale) for key in keys.stored_keys] == [(False, False)]


def test_only_a_sealed_answer_confirms_a_stop() -> None:
    table, session, _ = open_sealed_session()
    upload_and_capture(table, session, FOREVER)
    session.events()
    session.stop(table.robot.now_ms)
    stopped_frame = Frame(BY_NAME["STOPPED"].number, 9, session._epoch + 1, b"\1", is_reply=True)
    forged_bytes = b"\0" + encode_frame(stopped_frame)
    for _ in range(500):  # the zeros do not arrive
        session.poll(table.robot.now_ms)
        session.receive(forged_bytes, table.robot.now_ms)
        table.robot.step()
    assert not [
        stopped_event for stopped_event in session.events() if stopped_event.name == "STOPPED"
    ]
    table.advance_time(session, 50)
    assert [event for event in session.events() if event.name == "STOPPED"]
    assert table.robot.is_latched
    upload_and_capture(table, session, FOREVER)
    table.robot.step(flags=BUTTON_PRESSED)
    assert table.robot.is_latched


@pytest.mark.parametrize("payload", [b"", bytes(12), bytes(13), bytes(40)])
def test_a_stop_with_a_wrong_seal_still_stops(payload: bytes) -> None:
    for is_claimed in (False, True):
        table, session, _ = open_sealed_session()
        if not is_claimed:
            table = OwnedRobot()
            session = table.session()
        upload_and_capture(table, session, FOREVER)
        table.answer(Frame(BY_NAME["STOP"].number, 1, 0, payload, is_sealed=True))
        assert table.robot.is_latched


def test_a_teachers_stop_needs_the_teachers_seal() -> None:
    """A STOP written into the teacher's line has no authority: the owner's program continues."""
    table, pupil, teacher = OwnedRobot(), Keys(), Keys(90)
    table.claim_session(teacher, KEY_TEACHER)
    table.claim_session(pupil)
    session = table.session(teacher, nonce=6)
    assert table.try_to_drive(session) == "OK"
    table.answer(Frame(BY_NAME["STOP"].number, 77, session._epoch))
    assert state_of(table, session) == STATE_STOPPED
    teacher_session = table.session(pupil, nonce=7)
    assert table.try_to_drive(teacher_session) == "OK"


def test_an_exhausted_counter_starts_a_new_seal() -> None:
    table, session, _ = open_sealed_session()
    seal = session._sealing.seal
    assert seal
    seal.sent_counter = LAST_COUNTER - 1
    assert table.try_to_drive(session) == "OK"
    assert session._sealing.seal is seal and seal.is_spent
    assert table.try_to_drive(session) == "OK"
    assert session._sealing.seal is not seal
    assert session._sealing.seal and session._sealing.seal.sent_counter < 10


def test_an_expired_seal_is_renewed_for_the_same_request() -> None:
    """After more requests than numbers: AUTHENTICATE has one after those of the sealed ones."""
    table, session, _ = open_sealed_session()
    seal_before = session._sealing.seal
    for _ in range(200):
        assert table.outcome(session, session.trim()) == "OK"
    table.advance_time(None, 2100)
    table.robot.did.clear()
    request = session.live(image_of(SHORT).code)
    assert table.outcome(session, request) == "OK"
    assert session._sealing.seal is not seal_before
    assert len([line for line in table.robot.did if "MOTORS 80 80" in line]) == 1


PIECES = {1: "F(0.1, 80);", 3: "F(0.1, 80);B(0.1, 60);" * 20, 7: "F(0.1, 80);B(0.1, 60);" * 45}


def unplug_cable(table: OwnedRobot, session: Session) -> None:
    """The robot forgets the seal."""
    table.robot.step(flags=UNPLUGGED)


def spend_number(table: OwnedRobot, session: Session) -> None:
    """The session has one more number for it."""
    if session._sealing.seal:
        session._sealing.seal.sent_counter = LAST_COUNTER - 1


@pytest.mark.parametrize("loses", [unplug_cable, spend_number])
@pytest.mark.parametrize("pieces", PIECES)
def test_a_seal_lost_during_an_upload_loses_no_piece(
    pieces: int, loses: Callable[[OwnedRobot, Session], None]
) -> None:
    """It costs no time either: the computer waits for no piece that was under way."""
    image = image_of("SI|" + PIECES[pieces])
    table, session, _ = open_sealed_session()
    began_ms = table.robot.now_ms
    assert table.outcome(session, session.upload(image, saves=False)) == "OK"
    duration_ms = table.robot.now_ms - began_ms
    for moment_ms in range(duration_ms + 2):
        session.stop(table.robot.now_ms)
        table.advance_time(session, 500)
        table.robot.codes()
        request = session.upload(image, saves=False)
        table.advance_time(session, moment_ms)
        loses(table, session)
        limit_ms = MAX_TIMES * duration_ms + AUTHENTICATION_MS
        assert table.robot.until(session, request, limit_ms) == OK, moment_ms
        assert table.robot.codes() == [image.code], moment_ms


def test_a_sealed_session_is_renewed_with_a_reset_robot() -> None:
    """This holds whatever the first request is, including one that needs no HELLO."""
    table, session, _ = open_sealed_session()
    restarted = OwnedRobot(table.robot.memory(), seed=7)
    restarted.robot.now_ms = table.robot.now_ms
    assert restarted.outcome(session, session.status()) == "OK"
    assert session._sealing.seal


def test_sessions_with_the_same_numbers_have_different_seals() -> None:
    table, session, keys = open_sealed_session()
    sent_bytes, _ = upload_and_capture(table, session, SHORT)
    table.advance_time(None, 3000)
    table.robot.did.clear()
    memory = table.robot.memory()
    for seed in (0x12345678, 7):  # the same noise at the start, and another one
        restarted = OwnedRobot(memory, seed=seed)
        assert owner_of(restarted, restarted.session(keys, nonce=4)) == OWNED_BY_YOU
        for data in sent_bytes * 3:
            restarted.robot.wait(5, b"\0" + data + b"\0")
        assert not [line for line in restarted.robot.did if "MOTORS" in line]


def test_a_stranger_gets_all_public_messages_beside_a_seal() -> None:
    table, session, _ = open_sealed_session()
    for name, payload in (("PING", b""), ("STATUS", b""), ("IDENTIFY", b"")):
        frame = Frame(BY_NAME[name].number, (session._seq + 9) & 0xFF, session._epoch, payload)
        reply = table.answer(frame)
        assert reply and reply.payload[0] == 0 and not reply.is_sealed
    assert table.try_to_drive(session) == "OK"
    stranger = table.session(nonce=50)
    assert owner_of(table, stranger) == OWNED_BY_OTHER


def test_captured_frames_grant_nothing(frames: int = 2500) -> None:
    """`python -m tests.firmware.test_sealed_robot 100000` sends more of them."""
    counts = attack(frames, 1)
    assert counts["accepted"] == 0 and counts["stops"] > 1


# -- by command -----------------------------------------------------------------------------------


def attack(frames: int, seed: int) -> Counter[str]:
    """Send a thief's frames into an owner's line, during its sealed session; return how many of
    each kind there were, how many were accepted, and how many stops were tried and obeyed.
    """
    rng = random.Random(seed)
    table, session, _keys = open_sealed_session()
    recorded_frames, _ = upload_and_capture(table, session, SHORT)
    recorded = recorded_frames[-1:]
    robot = table.robot
    thief = Thief(rng, recorded)
    counts: Counter[str] = Counter(accepted=0)
    memory = robot.memory()
    for count in range(frames):
        if count % 500 == 0:
            if count:
                table.advance_time(session, 300)
                robot.wait(20, bytes(8) if rng.random() < 0.5 else b"\0" + _stop(rng) + b"\0")
                assert robot.is_latched, f"frame {count} of seed {seed}: a stop is not obeyed"
                counts["stops"] += 1
            thief.old_frames += thief.sent_frames[-3:]
            session = table.session(_keys, nonce=rng.getrandbits(32))
            recorded_frames, replies = upload_and_capture(table, session, SHORT)
            thief.sent_frames = [frame for frame in recorded_frames if _is_sealed(frame)]
            thief.replies = [data for data in replies if _is_sealed(data)]
            table.advance_time(session, 300)
            robot.did.clear()
        if count % 200 == 100:  # the seal lives on
            assert table.outcome(session, session.status()) == "OK", f"seed {seed}, frame {count}"
        kind, data = thief.frame(session._epoch, (session._seq + 1 + count % 3) & 0xFF)
        counts[kind] += 1
        sent_bytes = robot.wait(2, b"\0" + data + b"\0")
        packets = [part for part in sent_bytes.split(b"\0") if part]
        counts["accepted"] += sum(grants_key_request(data) or _is_sealed(data) for data in packets)
        counts["accepted"] += len([line for line in robot.did if "MOTORS" in line])
        robot.did.clear()
    counts["accepted"] += robot.memory() != memory
    assert table.try_to_drive(session) == "OK"
    return counts


def _is_sealed(wire: bytes) -> bool:
    frame = decode_frame(wire)
    return frame is not None and frame.is_sealed


def _stop(rng: random.Random) -> bytes:
    """Return a STOP with any seal, or none."""
    payload = rng.randbytes(rng.choice((13, 20)))
    return encoded(Frame(BY_NAME["STOP"].number, rng.randrange(256), 0, payload, is_sealed=True))


if __name__ == "__main__":
    options = make_options(100_000, 1)
    kinds = attack(options.count, options.seed)
    print(f"{options.count} frames of a thief: {dict(sorted(kinds.items()))}")
    assert kinds["accepted"] == 0
