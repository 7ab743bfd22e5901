"""Keys of a remote control, from a person to a program: the newest state, and none older than the
release of a key.

A word is KEYS; the program's readings come from the robot's own firmware.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from struct import pack
from typing import Any

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.owners import KIT, Keys, OwnedRobot
from tests.support.queued_requests import OWN_STOP, STOPS
from tests.support.remote_readings import RELEASED_READINGS, remote_readings
from tests.support.session_frames import greet as described
from tests.support.unsent_requests import image, open_session
from tiniscript.base.kit import YES_NO, Device, Kit
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    AUTHORITY_MS,
    BY_NAME,
    HOLD_MS,
    REMOTE,
    STATE_RUNNING,
    STATE_STOPPED,
    STATUS_NAMES,
    STATUSES,
    encode_payload,
)
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.payloads import EmptyReply
from tiniscript.link.remote import (
    GAP_MS,
    NOTHING_PRESSED,
    RemoteControl,
    RemoteState,
    remote_state_of,
)
from tiniscript.link.requests import OK, Reply
from tiniscript.link.session import Session

KEY_UP, KEY_LEFT, KEY_A = (remote_state_of([name]) for name in ("UP", "LEFT", "A"))
DRIVE_PROGRAM = "SI|F(FOREVER, 40)\nTASK\nW(1)\nEND_TASK"
KEYS = BY_NAME["KEYS"]
LIVE = BY_NAME["LIVE"]


class Hand:
    """A person who holds keys: they are sent every 100 ms, and immediately at each change."""

    def __init__(self, session: Session, robot: HostFirmware) -> None:
        self.session, self.robot = session, robot
        self.held_state = NOTHING_PRESSED
        self.is_lossy: Callable[[], bool] = lambda: False  # whether the line loses a packet
        self.words: list[tuple[int, RemoteState]] = []  # sent, each with its number
        self.outcomes: list[int] = []
        self._requests = [session.press()]
        self._sent_ms = 0

    def hold(self, held_state: RemoteState) -> None:
        self.held_state = held_state
        self._say()

    def _say(self) -> None:
        self._sent_ms = self.robot.now_ms
        self._requests.append(self.session.press(*self.held_state))

    def talk(self, milliseconds: int) -> None:
        robot, session = self.robot, self.session
        for _ in range(milliseconds):
            if self.held_state != NOTHING_PRESSED and robot.now_ms - self._sent_ms >= 100:
                self._say()
            data = session.poll(robot.now_ms)
            for packet in data.split(b"\0"):
                frame = decode_frame(packet)
                if frame is not None and frame.number == KEYS.number:
                    self._note(frame)
            sent_bytes = robot.step(b"" if data and self.is_lossy() else data)
            if sent_bytes and not self.is_lossy():
                session.receive(sent_bytes, robot.now_ms)
        statuses = [
            request.outcome.status for request in self._requests if request.outcome is not None
        ]
        self.outcomes += statuses
        self._requests = [
            pending_request for pending_request in self._requests if pending_request.outcome is None
        ]

    def _note(self, frame: Frame) -> None:
        keys, x, y = frame.payload
        word = RemoteState(keys, x - (x & 0x80) * 2, y - (y & 0x80) * 2)
        assert word == self.held_state, "a word that is older than what is held"
        self.words.append((frame.seq, word))


def hand() -> Hand:
    return Hand(*open_session())


def test_held_keys_are_read_and_released_ones_are_not() -> None:
    remote = hand()
    for held_state in (
        KEY_UP,
        RemoteState(0, 100, -100),
        remote_state_of(["UP", "B"], -1, 30),
        NOTHING_PRESSED,
        KEY_A,
        NOTHING_PRESSED,
    ):
        remote.hold(held_state)
        remote.talk(40)
        assert remote.robot.remote() == remote_readings(held_state)
        remote.talk(700)
        assert remote.robot.remote() == remote_readings(held_state)
    assert set(remote.outcomes) <= {OK, CANCELLED}
    assert [event.name for event in remote.session.events()] == []


def test_key_messages_are_sent_every_200_ms_only_while_keys_are_held() -> None:
    remote = hand()
    remote.talk(3000)
    assert remote.words == []
    remote.hold(KEY_UP)
    remote.talk(2001)
    assert len(remote.words) == 11
    remote.hold(NOTHING_PRESSED)
    remote.talk(3000)
    assert len(remote.words) == 12
    numbers = [seq for seq, _ in remote.words]
    assert len(set(numbers)) == len(numbers), "no word is sent twice"


def test_a_key_message_waits_only_for_the_answer_to_the_previous_one() -> None:
    remote = hand()
    for held_state in (KEY_UP, NOTHING_PRESSED, KEY_A, KEY_UP, NOTHING_PRESSED):
        remote.hold(held_state)
        remote.talk(5)
        assert remote.words[-1][1] == held_state
    remote.is_lossy = lambda: True
    count = len(remote.words)
    remote.hold(KEY_UP)
    remote.talk(1)
    remote.hold(NOTHING_PRESSED)
    remote.talk(GAP_MS - 1)
    assert [word for _, word in remote.words[count:]] == [KEY_UP]
    remote.talk(1)
    assert [word for _, word in remote.words[count:]] == [KEY_UP, NOTHING_PRESSED]


def test_key_messages_alone_keep_an_attached_program_alive() -> None:
    remote = hand()
    assert (
        remote.robot.until(remote.session, remote.session.upload(image(DRIVE_PROGRAM), saves=False))
        == OK
    )
    remote.session.sends_heartbeat = lambda: False
    remote.hold(KEY_UP)
    remote.talk(3000)
    assert remote.robot.did[-1].endswith("MOTORS 40 40")
    remote.hold(NOTHING_PRESSED)
    remote.talk(1100)
    assert remote.robot.did[-1].endswith("FAULTED"), "and nothing else does"


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(3))
def test_a_lost_line_releases_all_keys_within_half_a_second(seed: int) -> None:
    """Whenever it is lost: 300 times in all."""
    rng = random.Random(seed)
    remote = hand()
    for _ in range(100):
        remote.is_lossy = lambda: False
        remote.hold(rng.choice([KEY_UP, remote_state_of(["A", "LEFT"]), RemoteState(0, 50, -50)]))
        remote.talk(rng.randint(60, 400))
        assert remote.robot.remote() == remote_readings(remote.held_state)
        remote.is_lossy = lambda: True
        remote.talk(HOLD_MS)
        assert remote.robot.remote() == RELEASED_READINGS
        remote.is_lossy = lambda: False
        remote.hold(NOTHING_PRESSED)
        remote.talk(250)


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(4))
def test_keys_work_on_a_line_that_loses_three_of_ten_packets(seed: int) -> None:
    """Held keys are mostly read, and released keys are never read more than 0.5 s later."""
    rng = random.Random(seed)
    remote = hand()
    read_count = look_count = 0
    for _ in range(40):
        remote.is_lossy = lambda: rng.random() < 0.3
        remote.hold(rng.choice([KEY_UP, KEY_A, remote_state_of(["DOWN", "B"], 10, 20)]))
        remote.talk(300)
        for _ in range(20):
            remote.talk(50)
            look_count += 1
            read_count += remote.robot.remote() == remote_readings(remote.held_state)
        remote.hold(NOTHING_PRESSED)
        remote.talk(HOLD_MS)
        for _ in range(10):
            assert remote.robot.remote() == RELEASED_READINGS
            remote.talk(20)
    assert read_count > 0.9 * look_count, (read_count, look_count)
    assert remote.session.is_open


@pytest.mark.parametrize("seed", range(4))
def test_rapidly_changing_keys_work_on_a_bad_line(seed: int) -> None:
    """`Hand` checks each state: it is that at the time of sending."""
    rng = random.Random(seed)
    remote = hand()
    remote.is_lossy = lambda: rng.random() < 0.3
    for _ in range(300):
        remote.hold(RemoteState(rng.randrange(64), rng.randint(-100, 100), rng.randint(-100, 100)))
        remote.talk(rng.randint(1, 60))
    remote.is_lossy = lambda: False
    remote.talk(250)
    assert remote.robot.remote() == remote_readings(remote.held_state)


def test_a_silent_client_holds_no_keys() -> None:
    """A command that hangs, while its session still talks."""
    session, robot = open_session()
    session.press(*KEY_UP)
    robot.talk(session, HOLD_MS - 50)
    assert robot.remote() == remote_readings(KEY_UP)
    robot.talk(session, 100)
    assert robot.remote() == RELEASED_READINGS


def test_keys_of_two_clients_on_one_line_combine() -> None:
    """All their keys count, and the pad that was moved last; a person who leaves releases their
    keys."""
    session, robot = open_session()
    session.press(*KEY_UP, 1)
    session.press(KEY_A.keys, 10, 20, 2)
    robot.talk(session, 100)
    assert robot.remote() == remote_readings(remote_state_of(["UP", "A"], 10, 20))
    session.press(KEY_UP.keys, -5, 0, 1)
    robot.talk(session, 100)
    assert robot.remote() == remote_readings(remote_state_of(["UP", "A"], -5, 0))
    session.press(speaker=1)
    robot.talk(session, 100)
    assert robot.remote() == remote_readings(remote_state_of(["A"], 10, 20))


@pytest.mark.parametrize("text", ["SI|SHOW(1)", "SI|" + "SHOW(1);" * 60], ids=["short", "long"])
def test_an_upload_succeeds_beside_keys_which_are_read_afterwards(text: str) -> None:
    remote = hand()
    remote.hold(KEY_UP)
    remote.talk(100)
    request = remote.session.upload(image(text))
    while request.outcome is None:
        remote.talk(1)
        remote.hold(random.Random(remote.robot.now_ms).choice([KEY_UP, KEY_A, KEY_LEFT]))
        assert remote.robot.now_ms < 30_000
    assert request.outcome.status == OK
    remote.talk(250)
    assert remote.robot.remote() == remote_readings(remote.held_state)


def test_endless_keys_leave_other_requests_their_turn() -> None:
    remote = hand()
    requests = []
    for k in range(1500):
        if k % 100 == 0:
            requests.append(remote.session.status())
        remote.hold(RemoteState(0, k % 101, 0))
        remote.talk(1)
    assert len(requests) == 15
    assert all(request.outcome and request.outcome.status == OK for request in requests)
    assert len(remote.words) > 20


def test_endless_requests_leave_keys_their_turn() -> None:
    remote = hand()
    waiting_requests = [remote.session.status() for _ in range(3)]
    for held_state in (KEY_UP, KEY_A, NOTHING_PRESSED, KEY_LEFT):
        remote.hold(held_state)
        for _ in range(300):
            waiting_requests = [request for request in waiting_requests if request.outcome is None]
            waiting_requests += [remote.session.status() for _ in range(3 - len(waiting_requests))]
            remote.talk(1)
        assert remote.robot.remote() == remote_readings(held_state)


@pytest.mark.parametrize("seed", range(6))
def test_keys_and_requests_of_an_owner_work_in_any_order(seed: int) -> None:
    """At any moment, also during an authentication, which the robot forgets in silence."""
    rng = random.Random(seed)
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    robot, session = table.robot, table.session(keys, nonce=4)
    requests: list[PendingRequest[Any]] = []
    request_makers: list[Callable[[], PendingRequest[Any]]] = [
        session.hello, session.status, session.trim,
        lambda: session.live(image("W(0.1)").code),
    ]  # fmt: skip
    for _ in range(60):
        if rng.random() < 0.2 and all(request.outcome for request in requests):
            robot.wait(AUTHORITY_MS + 100)
        for _ in range(rng.choice((0, 0, 1, 3))):
            requests.append(rng.choice(request_makers)())
        if rng.random() < 0.7:
            session.press(rng.randint(0, 63), rng.randint(-100, 100))
        robot.talk(session, rng.choice((1, 3, 10, 30, 100, 300)))
    for _ in range(20):
        session.press(*KEY_UP)
        robot.talk(session, 100)
    assert robot.remote() == remote_readings(KEY_UP)
    assert {request.outcome.status if request.outcome else None for request in requests} == {OK}
    assert [(key.is_stale, key.is_pending) for key in keys.stored_keys] == [(False, False)]


def test_keys_are_sent_between_retries_of_a_waiting_request() -> None:
    """The request is a name, which is saved as soon as the motors are off."""
    remote = hand()
    assert (
        remote.robot.until(remote.session, remote.session.upload(image(DRIVE_PROGRAM), saves=False))
        == OK
    )
    name = remote.session.name(b"Ana")
    remote.talk(300)
    for held_state in (KEY_UP, NOTHING_PRESSED, KEY_A, NOTHING_PRESSED):
        remote.hold(held_state)
        remote.talk(60)
        assert remote.robot.remote() == remote_readings(held_state)
    while name.outcome is None:
        remote.talk(1)
    assert name.outcome.status == STATUSES["SAVING"]
    assert len(remote.words) == 4


# -- stops and starts ---------------------------------------------------------------------------


def test_a_stop_releases_all_keys_and_keys_do_not_release_the_latch() -> None:
    remote = hand()
    assert (
        remote.robot.until(remote.session, remote.session.upload(image(DRIVE_PROGRAM), saves=False))
        == OK
    )
    remote.hold(KEY_UP)
    remote.talk(300)
    remote.session.stop(remote.robot.now_ms)
    remote.held_state = NOTHING_PRESSED
    remote.talk(300)
    assert remote.robot.is_latched
    action_count = len(remote.robot.did)
    remote.hold(KEY_UP)
    remote.talk(2000)
    assert remote.robot.is_latched and len(remote.robot.did) == action_count
    status = remote.session.status()
    assert remote.robot.until(remote.session, status) == OK
    assert status.outcome and status.outcome.values.state == STATE_STOPPED


@pytest.mark.parametrize("stop_kind", ["button", "zeros", "text"])
def test_a_stop_by_another_client_releases_held_keys(stop_kind: str) -> None:
    """It is held again once it is said again."""
    remote = hand()
    session, robot = remote.session, remote.robot
    assert robot.until(session, session.upload(image(DRIVE_PROGRAM), saves=False)) == OK
    session.press(*KEY_UP)
    robot.talk(session, 60)
    assert robot.remote() == remote_readings(KEY_UP)
    if stop_kind == "button":
        robot.push()
    else:
        robot.step(bytes(4) if stop_kind == "zeros" else b"\r\nS\r\n")
    robot.talk(session, 1000)  # it hears of the stop
    check_nothing_held_at_start(session, robot)
    robot.talk(session, HOLD_MS)
    assert robot.remote() == RELEASED_READINGS
    session.press(*KEY_UP)
    robot.talk(session, 60)
    assert robot.remote() == remote_readings(KEY_UP)


@pytest.mark.parametrize("seed", range(24))
def test_keys_held_before_a_stop_are_released_after_it(seed: int) -> None:
    """This holds before the next state arrives, for any holder, however soon the next program
    begins.
    """
    rng = random.Random(seed)
    session, robot = open_session()
    stop_kind = rng.choice((*STOPS, OWN_STOP))
    assert robot.until(session, session.upload(image(DRIVE_PROGRAM), saves=False)) == OK
    for _ in range(rng.randint(1, 3)):
        for speaker in range(rng.randint(1, 2)):
            session.press(rng.randint(1, 63), rng.randint(-100, 100), speaker=speaker)
        robot.talk(session, rng.choice((0, 1, 20, 60, 200)))
    if stop_kind == OWN_STOP:
        session.stop(robot.now_ms)
    else:
        session.receive(STOPS[stop_kind](robot, session), robot.now_ms)
    robot.talk(session, rng.choice((20, 40, 80, 150, 400)))  # it hears of the stop
    robot.codes()
    session.live(image("W(9)").code)
    has_begun = False
    for _ in range(70):
        robot.talk(session, 10)
        has_begun = has_begun or bool(robot.codes())
        assert not has_begun or robot.remote() == RELEASED_READINGS, stop_kind
    assert has_begun, stop_kind


def test_a_program_starts_without_held_keys() -> None:
    remote = hand()
    remote.hold(KEY_UP)
    remote.talk(60)
    assert remote.robot.remote() == remote_readings(KEY_UP)
    check_nothing_held_at_start(remote.session, remote.robot)
    remote.talk(250)
    assert remote.robot.remote() == remote_readings(KEY_UP)


def check_nothing_held_at_start(session: Session, robot: HostFirmware) -> None:
    request, run = session.live(image("W(9)").code), robot.codes()
    for _ in range(500):
        session.receive(robot.step(session.poll(robot.now_ms)), robot.now_ms)
        if robot.codes():
            assert robot.remote() == RELEASED_READINGS
            return
    raise AssertionError((request.outcome, run))


def test_keys_work_again_after_a_lost_link_is_restored() -> None:
    remote = hand()
    remote.hold(KEY_UP)
    remote.talk(60)
    remote.is_lossy = lambda: True
    remote.talk(6000)
    assert LOST in remote.outcomes and "LOST" in [event.name for event in remote.session.events()]
    remote.is_lossy = lambda: False
    remote.talk(3000)
    assert remote.robot.remote() == remote_readings(KEY_UP), "who goes on pressing is heard again"


# -- permissions ----------------------------------------------------------------------------------


def test_an_older_robot_gets_no_key_messages() -> None:
    session = described()
    request = session.press(*KEY_UP)
    assert session.poll(10) == b""
    assert request.outcome and request.outcome.status == STATUSES["NO_REMOTE"]
    newer_robot = described(features=REMOTE)
    newer_robot.press(*KEY_UP)
    frame = decode_frame(newer_robot.poll(10).strip(b"\0"))
    assert frame and frame.number == KEYS.number and frame.payload == bytes((1, 0, 0))


@pytest.mark.parametrize("count", [0, 8, 9, 16])
def test_a_robot_announces_a_remote_control_if_its_kit_leaves_room(count: int) -> None:
    kit = Kit(tuple(Device(f"S{k}", YES_NO, "", 0, 1) for k in range(count)), ())
    session, robot = Session(1, 9600, kit.fingerprint), HostFirmware(kit)
    robot.wait(100)
    assert robot.until(session, session.hello()) == OK
    assert session.robot
    assert bool(session.robot.values.features & REMOTE) == kit.has_remote == (count <= 8)


@pytest.mark.sampled("defines")
@pytest.mark.parametrize("defines", [(), ("tiniscript_without_seals",)], ids=["seals", "none"])
def test_keys_of_an_owned_robot_need_the_right_to_run_lines(
    defines: tuple[str, ...],
) -> None:
    table, keys = OwnedRobot(defines=defines), Keys()
    table.claim_session(keys)
    stranger = Session(9, 9600, KIT.fingerprint)
    assert table.robot.until(stranger, stranger.hello()) == OK
    refused_request = stranger.press(*KEY_UP)
    assert table.robot.until(stranger, refused_request) == STATUSES["NOT_OWNER"]
    assert table.robot.remote() == RELEASED_READINGS
    owner = table.session(keys, nonce=4)
    assert table.robot.until(owner, owner.hello()) == OK
    assert table.robot.until(owner, owner.press(*KEY_UP)) == OK
    assert table.robot.remote() == remote_readings(KEY_UP)
    table.robot.wait(5000)  # the robot knows its seal no more
    owner.press(*KEY_A)
    table.robot.talk(owner, 400)
    owner.press(*KEY_A)
    table.robot.talk(owner, 200)
    assert table.robot.remote() == remote_readings(KEY_A)


# -- frames --------------------------------------------------------------------------------------


class Wire:
    """Writes frames by hand, each with the next number."""

    def __init__(self) -> None:
        self.session, self.robot = open_session()
        self.seq = self.session._seq
        self.epoch = self.session._epoch

    def frame(self, name: str, payload: bytes, epoch: int | None = None) -> bytes:
        self.seq = (self.seq + 1) & 0xFF
        number = BY_NAME[name].number
        return b"\0" + encode_frame(
            Frame(number, self.seq, self.epoch if epoch is None else epoch, payload)
        )

    def keys(self, held_state: RemoteState, epoch: int | None = None) -> bytes:
        return self.frame("KEYS", encode_payload(KEYS.request, held_state._asdict()), epoch)

    def answer(self, sent_bytes: bytes) -> str:
        """Return the status of the last answer."""
        frames = [decode_frame(packet) for packet in self.robot.wait(60, sent_bytes).split(b"\0")]
        replies = [frame for frame in frames if frame is not None and frame.is_reply]
        return STATUS_NAMES[replies[-1].payload[0]]


@pytest.mark.parametrize(
    "payload", [b"\x40\0\0", b"\xff\0\0", b"\0\x65\0", b"\0\0\x9b", b"\0\x80\0"]
)
def test_out_of_range_keys_are_refused_and_change_nothing(payload: bytes) -> None:
    wire = Wire()
    assert wire.answer(wire.keys(KEY_UP)) == "OK"
    assert wire.answer(wire.frame("KEYS", payload)) == "BAD_VALUE"
    assert wire.robot.remote() == remote_readings(KEY_UP)
    assert wire.answer(wire.frame("KEYS", payload + b"\0")) == "BAD_LENGTH"


def test_a_key_message_of_an_earlier_epoch_is_stale() -> None:
    wire = Wire()
    late_word = wire.keys(KEY_UP)
    wire.robot.wait(10, bytes(4))
    assert wire.answer(late_word) == "STALE"
    assert wire.robot.remote() == RELEASED_READINGS
    assert wire.answer(wire.keys(KEY_UP, wire.epoch + 1)) == "OK"
    assert wire.robot.is_latched


def test_a_duplicate_key_message_counts_once() -> None:
    """A repeated one is answered, and presses no key again."""
    wire = Wire()
    word = wire.keys(KEY_UP)
    assert wire.answer(word) == "OK"
    assert wire.answer(wire.keys(NOTHING_PRESSED)) == "OK"
    assert wire.answer(word) == "STALE"
    assert wire.robot.remote() == RELEASED_READINGS
    last_word = wire.keys(KEY_A)
    assert wire.answer(last_word) == "OK"
    wire.robot.wait(HOLD_MS - 100)
    assert wire.answer(last_word) == "OK"
    wire.robot.wait(100)
    assert wire.robot.remote() == RELEASED_READINGS


@pytest.mark.parametrize("split", range(1, 14))
def test_a_key_message_may_arrive_in_two_reads_at_9600_baud(split: int) -> None:
    wire = Wire()
    word = wire.keys(remote_state_of(["B"], -100, 100))
    wire.robot.wait(30, word[:split])
    wire.robot.wait(30, word[split:])
    assert wire.robot.remote() == remote_readings(remote_state_of(["B"], -100, 100))
    slow_word = wire.keys(KEY_LEFT)
    wire.robot.latched_while(len(slow_word) + 5, slow_word, is_spread=True)
    assert wire.robot.remote() == remote_readings(KEY_LEFT)


def test_a_burst_of_a_thousand_key_messages_is_handled() -> None:
    """Some are dropped, the last one that is heard counts, and the robot is as before."""
    wire = Wire()
    burst = b"".join(wire.keys(RemoteState(k % 64, 0, 0)) for k in range(1000))
    wire.robot.wait(10, burst)
    assert wire.answer(wire.keys(KEY_A)) == "OK"
    assert wire.robot.remote() == remote_readings(KEY_A)
    wire.robot.wait(HOLD_MS)
    assert wire.robot.remote() == RELEASED_READINGS


def test_keys_work_between_the_pieces_of_a_program() -> None:
    """They end no upload, and it ends them no more than any other."""
    wire = Wire()
    sent_image = image("SI|" + "SHOW(1);" * 30)
    begin_payload = bytes((0x10, *sent_image.isa, 0, 15)) + pack(
        "<HH", sent_image.devices, len(sent_image.code)
    )
    assert wire.answer(wire.frame("BEGIN", begin_payload)) == "OK"
    rest = bytes([sent_image.needs]) + sent_image.code
    for offset in range(0, len(rest), 40):
        assert wire.answer(wire.keys(KEY_UP)) == "OK"
        piece = offset.to_bytes(2, "little") + rest[offset : offset + 40]
        assert wire.answer(wire.frame("DATA", piece)) == "OK"
    assert wire.answer(wire.keys(KEY_UP)) == "OK"
    assert wire.robot.remote() == remote_readings(KEY_UP)
    commit = sent_image.checksum.to_bytes(4, "little")
    wire.robot.wait(60, wire.frame("COMMIT", commit))
    assert wire.session.status() is not None
    assert any("FINISHED" in line for line in wire.robot.did)


def test_keys_do_not_discard_an_open_block_of_text() -> None:
    """Another request does: it may need the memory."""
    for sent_bytes, is_kept in ((None, True), ("KEYS", True), ("NAME", False)):
        wire = Wire()
        wire.robot.wait(1500)  # from here on the robot reads text again
        wire.robot.wait(50, b"SI|LOOP(1)\r\nF(0.1, 50)\r\n")
        if sent_bytes is not None:
            payload = b"\1\0\0" if sent_bytes == "KEYS" else b"Ana"
            assert wire.answer(wire.frame(sent_bytes, payload)) in ("OK", "SAVING")
        wire.robot.wait(1500)
        wire.robot.wait(50, b"END_LOOP\r\n")
        wire.robot.wait(300)
        assert any("MOTORS 50 50" in line for line in wire.robot.did) == is_kept, sent_bytes


def test_the_reply_contains_the_place_of_the_program() -> None:
    wire = Wire()
    program = image("SI|W(5)")
    wire.robot.wait(60, wire.frame("PROGRAM", b"\x10" + program.code))
    sent_bytes = wire.robot.wait(60, wire.keys(KEY_UP))
    frames = [decode_frame(packet) for packet in sent_bytes.split(b"\0")]
    reply = next(frame for frame in frames if frame is not None and frame.number == KEYS.number)
    assert reply.payload[:2] == bytes((0, STATE_RUNNING))
    assert int.from_bytes(reply.payload[5:9], "little") == program.checksum


@pytest.mark.parametrize("seed", range(30))
def test_each_press_is_settled_by_the_next_answer_or_a_release(seed: int) -> None:
    rng, remote, now_ms = random.Random(seed), RemoteControl(), 0
    end_actions: dict[str, Callable[[], None]] = {
        "answer": lambda: remote.take_answer(Reply(OK, 0, EmptyReply())),
        "refusal": lambda: remote.take_answer(Reply(STATUSES["UNOWNED"])),
        "silence": remote.note_unanswered,
        "stop": remote.let_go,
    }
    for _ in range(20):
        presses = [remote.press(rng.randrange(2), rng.choice((NOTHING_PRESSED, KEY_UP, KEY_A)))]
        for _ in range(rng.randrange(4)):
            now_ms += rng.randrange(400)
            if remote.expire_and_check_due(now_ms):
                remote.take_message(now_ms)
            presses.append(
                remote.press(rng.randrange(2), rng.choice((NOTHING_PRESSED, KEY_UP, KEY_A)))
            )
        end_kind = rng.choice([*end_actions])
        if end_kind in ("answer", "silence"):  # of a word after these presses
            remote.take_message(now_ms)
        end_actions[end_kind]()
        assert all(press.outcome is not None for press in presses), end_kind
