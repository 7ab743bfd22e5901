"""Robots with large frames and a window, and computers and robots that know neither."""

from __future__ import annotations

import random
import struct

import pytest
from cobs import cobs

from tests.machines.esp32 import Esp32Robot
from tests.machines.link import CppLink, cpp_link
from tests.support.large_frames import BAUD, CODE, IMAGE, AnsweringRobot, InOrderReceiver
from tests.support.link_cases import KIT, packets_of
from tiniscript import robots
from tiniscript.bytecode.image import HEADER_BYTES, MIN_ISA, pack, unpack
from tiniscript.link.frames import Frame, checksum, decode_frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    CRC_BYTES,
    FIRST_EVENT,
    HEAD_BYTES,
    LARGE_FRAME,
    LARGE_WINDOW,
    MAJOR,
    MESSAGES,
    MINOR,
    RUN,
    SMALL_FRAME,
    STATUSES,
    decode_payload,
    payload_bytes,
)
from tiniscript.link.outcomes import LOST
from tiniscript.link.receiver import LARGE_PACKET, SMALL_PACKET
from tiniscript.link.session import Session
from tiniscript.link.transmission import TRIES
from tools.bench import large_upload

DATA, HELLO, FETCH, LIVE, PING = (
    BY_NAME[name].number for name in ("DATA", "HELLO", "FETCH", "LIVE", "PING")
)
REQUESTS = [message.number for message in MESSAGES if message.number < FIRST_EVENT]
OK, STALE = STATUSES["OK"], STATUSES["STALE"]
EPOCH = 9  # of the robot when it begins; HELLO makes it one more


# -- the robot ------------------------------------------------------------------------------------


def open_link(is_large: bool = True, epoch: int = EPOCH) -> CppLink:
    """Return a robot in a session."""
    robot = cpp_link(is_large)
    robot.begin(room=8192, kit=KIT, epoch=epoch)
    payload = struct.pack("<BBBBHI", MAJOR, MINOR, *MIN_ISA, KIT, 7)
    frames = [decode_frame(packet) for packet in sent_by(robot, Frame(HELLO, 1, 0, payload))]
    (reply,) = [frame for frame in frames if frame]
    values = decode_payload(BY_NAME["HELLO"].reply, reply.payload[1:])
    sizes = (LARGE_FRAME, LARGE_WINDOW) if is_large else (SMALL_FRAME, 1)
    assert (values["largest"], values["window"]) == sizes
    return robot


def sent_by(robot: CppLink, *frames: Frame, is_late: bool = False) -> list[bytes]:
    """Return the packets that a robot answers to frames."""
    step = robot.step(10, b"\0" + b"".join(map(encode_frame, frames)), is_late=is_late)
    return [part for part in step.sent.split(b"\0") if part]


def list_answers(robot: CppLink, *frames: Frame, is_late: bool = False) -> list[Frame]:
    replies = [decode_frame(packet) for packet in sent_by(robot, *frames, is_late=is_late)]
    assert all(replies)
    return [frame for frame in replies if frame]


def test_frames_wait_until_they_are_read_and_an_excess_one_is_dropped() -> None:
    """A robot with a window of 4 answers four that came at once, one with 1 the first."""
    for is_large, window in ((True, LARGE_WINDOW), (False, 1)):
        robot = open_link(is_large=is_large)
        numbers = [(FETCH, PING)[k % 2] for k in range(window + 2)]
        frames = [
            Frame(number, 2 + k, EPOCH + 1, bytes(2 * (number == FETCH)))
            for k, number in enumerate(numbers)
        ]
        replies = list_answers(robot, *frames, is_late=True)
        assert [frame.number for frame in replies] == numbers[:window]
        statuses = {FETCH: STATUSES["NO_PROGRAM"], PING: OK}
        assert all(frame.payload[0] == statuses[frame.number] for frame in replies)
        assert [frame.seq for frame in replies] == [2 + k for k in range(window)]
        (status,) = list_answers(robot, Frame(BY_NAME["STATUS"].number, 50, EPOCH + 1))
        values = decode_payload(BY_NAME["STATUS"].reply, status.payload[1:])
        assert (values["dropped"], values["damaged"]) == (2, 0)


def test_live_code_of_a_large_frame_runs() -> None:
    max_bytes = payload_bytes(LARGE_FRAME) - 1
    for length in (54, 55, 56, 57, 58, max_bytes):
        for is_late in (False, True):
            robot = open_link()
            code = large_upload.program(length).code
            live_frame = Frame(LIVE, 2, EPOCH + 1, bytes([RUN]) + code)
            step = robot.step(10, b"\0" + encode_frame(live_frame), is_late)
            checksum = unpack(pack("SI", 0, code)).checksum
            assert f"TAKE live {checksum:08x}" in step.did, length
            assert sum(row.startswith("START") for row in step.did) == 1


def test_a_large_frame_without_its_zero_is_damaged() -> None:
    """It is refused whether it is checked during its arrival or at its end, and no part of it runs.

    On the wire it begins as a large frame does: its epoch is 0.
    """
    code = large_upload.program(90).code
    for is_late in (False, True):
        robot = open_link(epoch=255)
        wire = with_checksum(bytes([LIVE, 2, 0, 7, RUN]) + code)
        assert wire[0] == HEAD_BYTES
        step = robot.step(10, wire + b"\0", is_late)
        assert step.sent == b"" and step.did == []
        (status,) = list_answers(robot, Frame(BY_NAME["STATUS"].number, 50, EPOCH + 1))
        assert decode_payload(BY_NAME["STATUS"].reply, status.payload[1:])["damaged"] == 1


def with_checksum(body: bytes) -> bytes:
    wire: bytes = cobs.encode(body + checksum(body).to_bytes(CRC_BYTES, "little"))
    return wire


@pytest.mark.parametrize(("is_large", "max_bytes"), [(True, 239), (False, 53)])
def test_a_computer_gets_the_image_in_the_largest_frames(is_large: bool, max_bytes: int) -> None:
    robot = open_link(is_large=is_large)
    session = Session(7, BAUD, KIT)
    pending_request = session.upload(IMAGE, runs=False)
    for now_ms in range(0, 3000, 5):
        session.receive(robot.step(now_ms, session.poll(now_ms)).sent, now_ms)
    assert (
        pending_request.outcome
        and pending_request.outcome.status == OK
        and robot.fetch_image() == pack("SI", 0, CODE)
    )
    hello = struct.pack("<BBBBHI", MAJOR, MINOR, *MIN_ISA, KIT, 8)
    list_answers(robot, Frame(HELLO, 1, 0, hello))
    image = b""
    image_bytes = len(pack("SI", 0, CODE))
    while len(image) < image_bytes:
        (wire,) = sent_by(robot, Frame(FETCH, 2, 0, struct.pack("<H", len(image))))
        frame = decode_frame(wire)
        assert frame and frame.payload[0] == OK
        assert struct.unpack("<H", frame.payload[1:3])[0] == image_bytes
        assert len(frame.payload) - 3 == min(max_bytes, image_bytes - len(image))
        assert len(wire) <= (LARGE_PACKET if max_bytes > 53 else SMALL_PACKET)
        image += frame.payload[3:]
    assert image == pack("SI", 0, CODE)


def test_both_receivers_agree_on_waiting_frames() -> None:
    """Frames, noise and silence, while some of them are not taken yet."""
    rng = random.Random(3)
    print("seed 3")
    wait_count = 0
    for _ in range(300):
        stream: list[tuple[int, int]] = []
        now_ms = 0
        for number in range(rng.randrange(1, 12)):
            payload = rng.randbytes(rng.choice((0, 3, 56, 57, 100, 242)))
            data = encode_frame(Frame(rng.choice(REQUESTS), number, rng.randrange(256), payload))
            if rng.random() < 0.2:
                noise = rng.randbytes(rng.randrange(1, 300)).replace(b"\0", b"")
                data = rng.choice((b"\1", b"\2", b"\4", b"\5", b"\x1f")) + noise + b"\0"
            wait_ms = rng.choice((0, 0, 0, 1200))
            now_ms += wait_ms
            data = b"\0" * (wait_ms > 0 or number == 0) + data
            stream += [(now_ms, byte) for byte in data]
        held_ms = rng.choice((0, 10, 100, 250))
        rows = packets_of(stream, held_ms, is_large=True)
        assert cpp_link(is_large=True).packets(stream, held_ms) == rows
        wait_count += held_ms > 0
    assert wait_count > 100


# -- the computer ---------------------------------------------------------------------------------


SENT_BYTES = bytes([pack("SI", 0, CODE)[HEADER_BYTES - 1]]) + CODE  # bytes after the checksum


@pytest.mark.parametrize(
    ("lost_numbers", "unanswered", "count"),
    [
        ((), (), 7),
        ((), (2, 3), 7),  # the next answer reports them
        ((), (7,), 8),
        ((2,), (), 10),  # the frames after it are sent again
        ((7,), (), 8),
        ((1, 2, 3, 4), (), 11),
    ],
)
def test_only_lost_pieces_are_sent_again(
    lost_numbers: tuple[int, ...], unanswered: tuple[int, ...], count: int
) -> None:
    receiver = InOrderReceiver(lost_numbers, unanswered)
    robot = AnsweringRobot(receiver)
    assert robot.run(robot.session.upload(IMAGE)) == OK
    assert receiver.received == SENT_BYTES and robot.has_commit
    assert len(robot.data) == count
    assert len({seq for seq, *_ in robot.data}) == count, "two frames have one number"
    assert 2 <= robot.most_waiting <= LARGE_WINDOW


@pytest.mark.parametrize(("largest", "window"), [
    # Earlier requests, which get the same answers.
    (0, 0), (0, 1), (SMALL_FRAME, 0), (SMALL_FRAME, 1),
    (255, 255), (251, 2), (100, 200),  # the header states more bytes than there are
])  # fmt: skip
def test_frames_follow_the_robots_window_up_to_the_available_data(
    largest: int, window: int
) -> None:
    receiver = InOrderReceiver()
    robot = AnsweringRobot(receiver, largest, window)
    assert robot.run(robot.session.upload(IMAGE)) == OK
    assert receiver.received == SENT_BYTES
    is_small = largest <= SMALL_FRAME
    assert robot.longest_bytes == (SMALL_PACKET if is_small else min(largest, LARGE_FRAME) + 1)
    assert robot.most_waiting == max(1, min(window, LARGE_WINDOW))
    assert not is_small or {length for *_, length in robot.data[:-1]} == {54}


def test_a_slow_line_buffers_little_before_a_stop() -> None:
    robot = AnsweringRobot(InOrderReceiver(), baud=9600)
    assert robot.run(robot.session.upload(IMAGE)) == OK
    assert robot.most_waiting * robot.longest_bytes <= 9600 // 10 * 0.25


@pytest.mark.parametrize(
    ("outcome", "status"),
    [
        ((OK, 0), LOST),  # it does not accept any
        ((STALE, 0), LOST),  # it calls all of them old, in the epoch of the session
        ((STATUSES["NOT_BEGUN"], 0), STATUSES["NOT_BEGUN"]),
        (None, LOST),
    ],
)
def test_a_robot_that_accepts_nothing_is_given_up(
    outcome: tuple[int, int] | None, status: int
) -> None:
    robot = AnsweringRobot(lambda *_: outcome)
    assert robot.run(robot.session.upload(IMAGE)) == status
    assert not robot.has_commit
    assert len(robot.data) <= (TRIES + 2) * LARGE_WINDOW


def test_a_robot_with_erratic_offsets_is_given_up() -> None:
    rng = random.Random(5)
    robot = AnsweringRobot(lambda *_: (OK, rng.randrange(len(SENT_BYTES))))
    assert robot.run(robot.session.upload(IMAGE)) == LOST
    assert not robot.has_commit


def test_an_offset_beyond_the_end_is_left_to_commit() -> None:
    robot = AnsweringRobot(lambda *_: (OK, 0xFFFF))
    assert robot.run(robot.session.upload(IMAGE)) == OK  # its receipt has the checksum
    assert robot.has_commit


def test_a_stop_ends_the_upload() -> None:
    robot = AnsweringRobot(InOrderReceiver())
    request = robot.session.upload(IMAGE)
    robot.session.receive(b"", 0)
    robot.take_data = lambda *_: None
    for _ in range(40):
        if robot.data:
            break
        for packet in robot.session.poll(robot.now_ms).split(b"\0"):
            frame = decode_frame(packet) if packet else None
            if frame is not None:
                robot.answer(frame)
        robot.now_ms += 5
    assert robot.data and request.outcome is None
    robot.session.stop(robot.now_ms)
    assert request.outcome is not None
    assert robot.session.poll(robot.now_ms).strip(b"\0") == b""
    seq = robot.data[0][0]
    late_reply = Frame(DATA, seq, 0, struct.pack("<BH", OK, 240), is_reply=True)
    robot.session.receive(encode_frame(late_reply), robot.now_ms)  # the answer arrives anyway
    assert robot.session.poll(robot.now_ms + 50).strip(b"\0") == b""


# -- both -----------------------------------------------------------------------------------------


def test_the_largest_program_takes_little_longer_than_its_bytes() -> None:
    """8,192 bytes at 115200 baud over a round trip of 40 ms, to the sketch of an ESP32."""
    profile = robots.load("tinibot32")
    assert profile.board.program_bytes == 8192
    robot = Esp32Robot(profile)
    robot.wait(300)
    upload_times = large_upload.upload(robot, profile.kit.fingerprint, 8192)
    robot.close()
    assert upload_times.times_of_wire <= large_upload.MAX_TIMES
    assert upload_times.sent_bytes < 8192 * 1.1
