"""A robot makes the image of LIVE before its frame ends: that only changes when it runs.

A robot that looks at its bytes one by one does so, one that looks after the last byte cannot.
"""

from __future__ import annotations

import random
import struct

import pytest

from tests.machines.link import CppLink, Step, cpp_link
from tests.support.link_channel import damage_frame
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import unpack
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.link import messages
from tiniscript.link.frames import Frame, decode_frame, encode_frame

LIVE, HELLO = (messages.BY_NAME[name].number for name in ("LIVE", "HELLO"))
RUN_MODE = 16
KIT = robots.load("tinibot").kit
EPOCH = 9  # of the robot when it begins; HELLO makes it one more
TEXTS = ("SI|F(5, 80)", "SI|X = 0; LOOP(3); X = X + 1; END_LOOP; SHOW(X)", "SI|SHOW(DISTANCE)")
CODES = [unpack(compile_text(text, KIT).image).code for text in TEXTS]
STARTED_ACTION = "START live, run 1"
EMPTY_STEP = Step(b"", [])
SEED = 5
FRAMES = 1500


def open_session(epoch: int = EPOCH) -> CppLink:
    """Return a robot in a session."""
    robot = cpp_link()
    robot.begin(epoch=epoch)
    payload = struct.pack("<BBBBHI", messages.MAJOR, 0, ISA_MAJOR, ISA_MINOR, KIT.fingerprint, 7)
    assert robot.step(0, b"\0" + encode_frame(Frame(HELLO, 1, 0, payload))).sent
    return robot


def live_data(code: bytes, seq: int = 2, epoch: int = EPOCH + 1) -> bytes:
    return encode_frame(Frame(LIVE, seq, epoch, bytes([RUN_MODE]) + code))


def test_code_prepared_ahead_equals_code_prepared_later() -> None:
    """Zeros anywhere in a frame, code that is refused, and damage included."""
    rng = random.Random(SEED)
    print(f"seed {SEED}")
    start_count = 0
    for number in range(FRAMES):
        epoch = rng.choice((rng.randrange(256), 255))  # the next one is 0
        code = rng.choice((*CODES, CODES[0] + bytes(rng.randrange(4)), rng.randbytes(9)))
        data = live_data(code, rng.randrange(2, 100), (epoch + rng.randrange(20) // 19 + 1) % 256)
        if number % 3 == 0:
            data = damage_frame(data[:-1], rng) + b"\0"
        steps = [open_session(epoch).step(10, data, is_late=is_late) for is_late in (False, True)]
        # A late reader misses bytes after the end of another packet.
        if data.count(b"\0") == 1 and not {*b"\r\n"} & {*data}:
            assert steps[0] == steps[1], data.hex()
        if number % 3 == 0 and data != live_data(code):
            continue
        start_count += STARTED_ACTION in steps[0].did
    assert start_count > FRAMES // 4


@pytest.mark.parametrize("code", CODES)
def test_a_live_line_does_not_run_before_its_frame_ends(code: bytes) -> None:
    """The running program continues until then."""
    for runs in (False, True):
        robot = open_session()
        if runs:
            robot.let_happen("r")
        assert not robot.step(10, live_data(code)[:-1]).did
        actions = robot.step(20, b"\0").did
        assert (actions[0] == "END") == runs
        assert actions[-1].startswith("START live")


@pytest.mark.parametrize("text", [*TEXTS, "SI|TASK;SHOW(1);END_TASK"])
def test_a_robot_makes_the_image_of_the_compiler(text: str) -> None:
    """Without tasks it is an image of 2.0, even in a session of 2.1."""
    image = compile_text(text, KIT).image
    sent_bytes = open_session().step(10, live_data(unpack(image).code)).sent
    replies = [frame for frame in map(decode_frame, sent_bytes.split(b"\0")) if frame is not None]
    checksum = unpack(image).checksum.to_bytes(4, "little")
    assert [checksum in reply.payload for reply in replies] == [True]


def test_a_damaged_overlong_or_late_frame_runs_nothing() -> None:
    for offset in (2, 3, 7, 9, 10, 11):
        damage = bytearray(live_data(CODES[0]))
        damage[offset] ^= 0x40 if offset < 8 else 0x11
        assert open_session().step(10, bytes(damage)) == EMPTY_STEP, offset
    wrong_packets = (b"\x01\0", b"\x05\0", b"\x01\x01\0", b"\xff\0")
    ends = [(10 + messages.SILENCE_MS, b"\0"), *((10, data) for data in wrong_packets)]
    for code in CODES:
        for now_ms, end in ends:
            robot = open_session()
            assert not robot.step(10, live_data(code)[:-1]).did
            assert robot.step(now_ms, end) == EMPTY_STEP, (code, end)


@pytest.mark.parametrize(("verb", "interruption"), [("", "b"), ("r", "f")], ids=["button", "fault"])
def test_a_button_or_a_fault_in_between_makes_prepared_code_stale(
    verb: str, interruption: str
) -> None:
    robot = open_session()
    if verb:
        robot.let_happen(verb)
    data = live_data(CODES[0])
    assert not robot.step(10, data[:-1]).did
    robot.let_happen(interruption, 65)
    step = robot.step(20, data[-1:])
    assert not [row for row in step.did if "START" in row]
    assert step.sent


def test_a_stop_ends_the_frame_and_then_the_run() -> None:
    robot = open_session()
    assert not robot.step(10, live_data(CODES[0])[:-1]).did
    actions = robot.step(10, bytes(8)).did
    assert actions.index(STARTED_ACTION) < actions.index("PINS OFF") < actions.index("STOP")
    assert not robot.step(20, bytes(1)).did


def test_a_frame_after_a_truncated_one_runs_its_own_code() -> None:
    robot = open_session()
    assert not robot.step(10, live_data(CODES[1])[:-1]).did
    step = robot.step(10 + messages.SILENCE_MS, b"\0" + live_data(CODES[0]))
    expected = open_session().step(10, live_data(CODES[0]), is_late=True)
    assert step == (b"\0" + expected.sent, expected.did)
