"""An attacker between a computer and a sealing robot cannot profit from clearing bits of HELLO.

The attacker controls the line: frames that they drop are not heard, and they may send any answers
instead. They may change the robot's id in HELLO, or lead the computer to a robot of their own that
has its name. They have no key. `python -m tests.firmware.test_downgrade 10000` has as many of them.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from tests.support.campaign import each_seed, make_options
from tests.support.images import image_of
from tests.support.owners import FOREVER, Keys, OwnedRobot
from tiniscript.link.authority import RobotKey
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    KEY_OWNER,
    KEY_TEACHER,
    MAJOR,
    OWNED,
    OWNERS,
    SEALS,
    STATE_RUNNING,
    STATE_STOPPED,
    STATUSES,
    decode_payload,
    encode_payload,
)
from tiniscript.link.outcomes import LOST, OTHER_ROBOT, UNPROVEN
from tiniscript.link.session import Session

TRIAL_COUNT = 150
HELLO, AUTHENTICATE, STATUS, STOPPED = (
    BY_NAME[name].number for name in ("HELLO", "AUTHENTICATE", "STATUS", "STOPPED")
)
LIMIT_MS = 9000
CLEARED_FLAGS = (OWNED, SEALS, OWNED | SEALS)
ROBOT_PLACE, NAME = "tcp://ana", b"ANA"
OTHER_ID, OTHER_SEED = 0x00C0FFEE, 0x0BADCAFE


class End:
    """A robot with an owner, whose clock the test controls; `keys` has its key."""

    def __init__(self, key_kind: int = KEY_OWNER) -> None:
        self.keys = Keys()
        self.table = OwnedRobot()
        session = self.table.claim_session(self.keys, key_kind)
        assert self.table.outcome(session, session.name(NAME)) == "OK"
        self.keys.stored_keys = [key._replace(name=NAME.decode()) for key in self.keys.stored_keys]

    def pass_time(self, milliseconds: int, data: bytes = b"") -> bytes:
        return self.table.robot.wait(milliseconds, data)

    def session(self, nonce: int, keys: Keys, place: str = "") -> Session:
        return self.table.session(keys, nonce, place)


class Stranger(End):
    """A robot of somebody in between, with the same name and without an owner."""

    def __init__(self) -> None:
        self.keys = Keys()
        self.table = OwnedRobot(seed=OTHER_SEED)
        session = self.table.session(self.keys)
        assert self.table.outcome(session, session.name(NAME)) == "OK"


class Between:
    """The attacker on the line. `cleared` are bits of HELLO; `passes_on` selects the frames for the
    robot; others are answered as done, and after zeros STOPPED comes at once or later.
    """

    def __init__(
        self, end: End, rng: random.Random, cleared: int, passes_on: Callable[[Frame], bool],
        cuts_stops: bool = True, other_id: int | None = None,
    ) -> None:  # fmt: skip
        self.other_id = other_id
        self.end, self.rng, self.cleared, self.passes_on = end, rng, cleared, passes_on
        self.cuts_stops = cuts_stops
        self.epoch = 0
        self.waits_ms = rng.choice((0, 0, 300, 1900, 2500, 4000))
        self.zeros_ms: int | None = None

    def reply_to(self, data: bytes, now_ms: int) -> bytes:
        """Return the bytes that the computer receives in reply to `data`."""
        replies = b""
        if b"\0\0\0\0" in data:
            if not self.cuts_stops:
                return self.end.pass_time(20, data)
            if self.zeros_ms is None:
                self.zeros_ms = now_ms
        for packet in filter(None, data.split(b"\0")):
            frame = decode_frame(packet)
            assert frame
            if self.passes_on(frame):
                replies += self.change_answers(self.end.pass_time(20, b"\0" + packet + b"\0"))
            else:
                self.epoch = frame.epoch
                replies += self.pretended_answer(frame)
        if self.zeros_ms is not None and now_ms >= self.zeros_ms + self.waits_ms:
            epoch = (self.epoch + self.rng.randrange(2)) & 0xFF
            replies += encode_frame(Frame(STOPPED, self.rng.randrange(256), epoch, b"\1", True))
        return b"\0" * bool(replies) + replies

    def change_answers(self, data: bytes) -> bytes:
        """Return the answers of the robot with bits of HELLO cleared, or another id."""
        stream = b""
        for packet in filter(None, data.split(b"\0")):
            frame = decode_frame(packet)
            if frame and frame.number == HELLO and frame.payload[0] == 0:
                values = decode_payload(BY_NAME["HELLO"].reply, frame.payload[1:])
                values["features"] = int(values["features"]) & ~self.cleared
                values["id"] = self.other_id or values["id"]
                payload = b"\0" + encode_payload(BY_NAME["HELLO"].reply, values)
                stream += encode_frame(frame._replace(payload=payload))
            else:
                stream += packet + b"\0"
        return stream

    def pretended_answer(self, frame: Frame) -> bytes:
        """Return a false answer of success, of the right length."""
        message = next(message for message in BY_NAME.values() if message.number == frame.number)
        min_size = sum(field.least_bytes for field in message.reply)
        payload = bytearray(self.rng.randbytes(min_size))
        if frame.number == STATUS:
            payload[0] = STATE_STOPPED
        if frame.number == BY_NAME["PROGRAM"].number:
            payload[:4] = image_of(FOREVER).checksum.to_bytes(4, "little")
        if frame.number == AUTHENTICATE and self.rng.random() < 0.5:
            wrong_payload = bytes(
                [self.rng.choice((STATUSES["WRONG_KEY"], STATUSES["NOT_OWNER"])), 4, 0]
            )
            return encode_frame(
                frame._replace(payload=wrong_payload, is_reply=True, is_sealed=False)
            )
        frame = frame._replace(payload=b"\0" + bytes(payload), is_reply=True)
        return encode_frame(frame._replace(is_sealed=False))


def talk(attacker: Between, session: Session, request: PendingRequest[Any] | None) -> list[str]:
    """Let a computer talk through the attacker until its request or stop is over; return the
    events.
    """
    names: list[str] = []
    now_ms, end_ms = 0, LIMIT_MS
    while now_ms < end_ms:
        data = session.poll(now_ms)
        replies = attacker.reply_to(data, now_ms) if data else b""
        session.receive(replies, now_ms + 1)
        names += [event.name for event in session.events()]
        if (request is not None and request.outcome) or {"STOPPED", "LOST"} & set(names):
            break
        wake_ms = session.next_wake_ms()
        now_ms = max(now_ms + 2, min(now_ms + 100, now_ms + 100 if wake_ms is None else wake_ms))
    return names


def state_of(end: End) -> int:
    """Return the state of the robot, which anybody may request."""
    end.pass_time(
        20, b"\0" + encode_frame(Frame(HELLO, 1, 0, bytes([MAJOR, *bytes(5), 1, 2, 3, 4])))
    )
    replies = end.pass_time(20, b"\0" + encode_frame(Frame(STATUS, 2, 0)))
    frames = [decode_frame(packet) for packet in replies.split(b"\0") if packet]
    return next(frame.payload[1] for frame in frames if frame and frame.number == STATUS)


def pass_frame(frame: Frame) -> bool:
    return True


def talk_honestly(end: End, session: Session, request: PendingRequest[Any] | None) -> list[str]:
    attacker = Between(end, random.Random(1), 0, pass_frame, cuts_stops=False)
    return talk(attacker, session, request)


def start_long_drive(end: End, rng: random.Random) -> None:
    """Start a long drive, whatever its state."""
    session = end.session(rng.getrandbits(32), end.keys)
    request = session.upload(image_of(FOREVER), saves=False, is_detached=True)
    talk_honestly(end, session, request)
    assert request.outcome and request.outcome.status == 0, request.outcome
    assert state_of(end) == STATE_RUNNING


def run_trial(end: End, seed: int) -> str:
    """Send a robot a request through the attacker; return its kind."""
    rng = random.Random(seed)
    keys = Keys()
    keys.stored_keys = list(end.keys.stored_keys)
    session = end.session(rng.getrandbits(32), keys)
    cleared = rng.choice((0, *CLEARED_FLAGS))
    greets = {HELLO} | ({AUTHENTICATE} if rng.random() < 0.5 else set())
    if rng.random() < 0.3:
        greets |= {STATUS, BY_NAME["PING"].number}
    passes_all = cleared != 0 and rng.random() < 0.3
    attacker = Between(
        end, rng, cleared, pass_frame if passes_all else lambda f: f.number in greets
    )
    kind = rng.choice(("hello", "stop", "upload", "live", "name"))
    if kind == "stop":
        if state_of(end) != STATE_RUNNING:
            start_long_drive(end, rng)
        is_greeted = rng.random() < 0.5
        if is_greeted:  # greeted by the robot itself
            talk_honestly(end, session, session.hello())
        session.stop(0)
        names = talk(attacker, session, None)
        assert "STOPPED" not in names, f"seed {seed}: a stop that nobody has heard is confirmed"
        assert "LOST" in names, f"seed {seed}: {names}"
        return "stop, greeted" if is_greeted else kind
    request: PendingRequest[Any]
    if kind == "upload":
        request = session.upload(image_of(FOREVER), saves=False)
    elif kind == "live":
        request = session.live(image_of(FOREVER).code)
    elif kind == "name":
        request = session.name(b"EVE")
    else:
        request = session.hello()
    talk(attacker, session, request)
    status = request.outcome.status if request.outcome else LOST
    if cleared & SEALS or AUTHENTICATE in greets or passes_all:
        expected = (UNPROVEN,) if cleared else (0,) if kind == "hello" else (UNPROVEN, LOST)
        assert status in expected, f"seed {seed}: {kind} with {cleared:x} cleared: {status}"
    elif cleared or kind != "hello":
        assert status != 0, f"seed {seed}: {kind} is believed done"
    return f"{kind}, cleared" if cleared else kind


def run_stranger_trial(end: End, strange: Stranger, seed: int) -> str:
    """Send a request to a robot while another one answers, or one with another id; return the
    answer."""
    rng = random.Random(seed)
    keys = Keys()
    keys.stored_keys = list(end.keys.stored_keys)
    disguise = rng.choice(("id", "robot", "id, greeted", "robot, greeted"))
    is_place = rng.random() < 0.5
    if is_place:  # the name is unknown, but the robot has answered here before
        keys.stored_keys = [key._replace(name="") for key in keys.stored_keys]
    place = ROBOT_PLACE if is_place else rng.choice(("", "tcp://bob"))
    session = end.session(rng.getrandbits(32), keys, place)
    talk_honestly(end, session, session.hello())
    assert keys.id_by_place.get(ROBOT_PLACE) == (end.keys.stored_keys[0].id if is_place else None)
    if state_of(end) != STATE_RUNNING:
        start_long_drive(end, rng)
    if "greeted" not in disguise:
        session = end.session(rng.getrandbits(32), keys, place)
    cleared = rng.choice((0, *CLEARED_FLAGS, OWNED | OWNERS))
    if disguise.startswith("id"):
        greets = rng.choice(({HELLO}, {HELLO, AUTHENTICATE}, {HELLO, STATUS}))
        attacker = Between(end, rng, cleared, lambda f: f.number in greets, other_id=OTHER_ID)
    else:
        attacker = Between(strange, rng, cleared, pass_frame, cuts_stops=rng.random() < 0.5)
    kind = rng.choice(("stop", "upload", "live", "hello"))
    request: PendingRequest[Any] | None = None
    if kind == "stop":
        session.stop(0)
    elif kind == "upload":
        request = session.upload(image_of(FOREVER), saves=False)
    elif kind == "live":
        request = session.live(image_of(FOREVER).code)
    else:
        request = session.hello()
    names = talk(attacker, session, request)
    assert "STOPPED" not in names, (
        f"seed {seed}: {disguise}: a stop that nobody has heard is confirmed"
    )
    if request is None:
        assert "LOST" in names, f"seed {seed}: {names}"
    else:
        expected = [OTHER_ROBOT]
        if "greeted" in disguise:
            expected += [UNPROVEN, LOST]
        if (
            disguise == "robot, greeted"
        ):  # a frame with the right epoch by chance, but without the key
            expected.append(STATUSES["WRONG_KEY"])
        status = request.outcome.status if request.outcome else LOST
        assert status in expected, f"seed {seed}: {disguise}: {kind}: {status}"
    shown_bytes = {key.key for key in end.keys.stored_keys}
    assert {key.key for key in keys.stored_keys} == shown_bytes, f"seed {seed}: a key is lost"
    assert state_of(end) == STATE_RUNNING, "nobody has reached it"
    return f"{kind}, {disguise}"


def test_a_stranger_with_its_own_id_is_not_trusted() -> None:
    end, strange = End(), Stranger()
    outcomes = {run_stranger_trial(end, strange, seed) for seed in range(1, TRIAL_COUNT + 1)}
    assert len(outcomes) == 16  # each kind


def test_accepted_robots_and_those_with_a_known_key_are_trusted() -> None:
    end, strange = End(), Stranger()
    keys = end.keys
    session = end.session(1, keys, ROBOT_PLACE)
    talk_honestly(end, session, session.hello())
    session = strange.session(2, keys, ROBOT_PLACE)
    request = session.hello()
    talk_honestly(strange, session, request)
    assert request.outcome and request.outcome.status == OTHER_ROBOT
    robot_id = request.outcome.detail
    keys.accepted_ids.add(robot_id)
    for _ in range(2):
        talk_honestly(strange, session, request := session.hello())
        assert request.outcome and request.outcome.status == 0
        assert session.robot and session.robot.id == robot_id
    strange.table.claim_session(keys)  # in another slot
    keys.accepted_ids.clear()
    session = strange.session(3, keys, ROBOT_PLACE)
    talk_honestly(strange, session, request := session.hello())
    assert request.outcome and request.outcome.status == 0
    assert keys.id_by_place[ROBOT_PLACE] == robot_id


def test_an_unknown_robot_is_trusted() -> None:
    """The same holds if the robot of the key does not seal."""
    strange = Stranger()
    for key in ([], [RobotKey(7, KEY_OWNER, bytes(15) + b"\7", NAME.decode())]):
        keys = Keys()
        keys.stored_keys = key
        keys.remember_robot(ROBOT_PLACE, 7)
        session = strange.session(4, keys, ROBOT_PLACE)
        talk_honestly(strange, session, request := session.hello())
        assert request.outcome and request.outcome.status == 0


def test_no_relay_can_remove_the_seals() -> None:
    end = End()
    assert len({run_trial(end, seed) for seed in range(1, TRIAL_COUNT + 1)}) == 10  # each kind


@pytest.mark.parametrize("key_kind", [KEY_OWNER, KEY_TEACHER])
@pytest.mark.parametrize("is_greeted", [False, True])
def test_a_received_stop_is_confirmed(key_kind: int, is_greeted: bool) -> None:
    """A robot that seals says so under the seal, with a teacher's key alone, too."""
    end = End(key_kind)
    start_long_drive(end, random.Random(3))
    session = end.session(99, end.keys)
    if is_greeted:
        talk_honestly(end, session, session.hello())
        end.pass_time(2500)  # time for the robot to forget the seal
    session.stop(0)
    assert talk_honestly(end, session, None)[-1] == "STOPPED"
    assert state_of(end) == STATE_STOPPED


def test_a_robot_claimed_by_another_computer_stops_without_proof() -> None:
    end = End()
    start_long_drive(end, random.Random(3))
    keys = Keys()
    keys.stored_keys = [key._replace(key=bytes(15) + b"\7") for key in end.keys.stored_keys]
    session = end.session(99, keys)
    session.stop(0)
    assert talk_honestly(end, session, None)[-1] == "LOST"
    assert state_of(end) == STATE_STOPPED
    request = session.hello()
    talk_honestly(end, session, request)
    assert request.outcome and request.outcome.status == 0  # public values are reported
    stranger = end.session(100, Keys())
    stranger.stop(0)
    assert talk_honestly(end, stranger, None)[-1] == "STOPPED"


def test_seal_support_is_learned_only_from_the_robot_itself() -> None:
    end = End()
    assert [key.uses_seals for key in end.keys.stored_keys] == [True]  # from its claim
    keys = Keys()
    # The form of older files.
    keys.stored_keys = [key._replace(uses_seals=False) for key in end.keys.stored_keys]
    cut = Between(end, random.Random(1), OWNED, pass_frame)
    session = end.session(50, keys)
    talk(cut, session, session.hello())
    assert not keys.stored_keys[0].uses_seals
    session = end.session(51, keys)
    talk_honestly(end, session, session.hello())
    assert keys.stored_keys[0].uses_seals


def play_either(ends: tuple[End, End, Stranger], seed: int) -> str:
    """Play one of somebody in between, or one of a stranger with an id of its own."""
    robot, other_end, strange = ends
    return run_stranger_trial(other_end, strange, seed) if seed % 2 else run_trial(robot, seed)


if __name__ == "__main__":
    each_seed(partial(play_either, (End(), End(), Stranger())), make_options(10_000, 1))
