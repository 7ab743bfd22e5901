"""The robot's half of the link in C++: dead-man timer, stops, echoes, and whom it listens to."""

from __future__ import annotations

import pytest

from tests.machines.link import CppLink, cpp_link
from tests.support.link_cases import KIT, packets_of
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.link import messages
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import AGAIN_MS, BY_NAME, DEAD_MAN_MS, LISTEN_MS

FORWARD = bytes.fromhex("448c50")  # F(5,80)
# Answers to mistakes without a pause of five seconds; the last one announces the silence.
ANSWERS = 17


def robot_with_session() -> CppLink:
    cpp = cpp_link()
    cpp.begin(kit=KIT)
    hello = {"major": messages.MAJOR, "minor": 0, "isa_major": ISA_MAJOR, "isa_minor": ISA_MINOR,
             "kit": KIT, "nonce": 3}  # fmt: skip
    cpp.step(
        0,
        b"\0"
        + encode_frame(Frame(1, 1, 0, messages.encode_payload(BY_NAME["HELLO"].request, hello))),
    )
    return cpp


def ends_at(cpp: CppLink, from_ms: int, until_ms: int) -> int | None:
    """Return when a fault ends the program, looking every 5 ms."""
    for now_ms in range(from_ms, until_ms, 5):
        if "FAULT 64" in cpp.step(now_ms).did:
            return now_ms
    return None


@pytest.mark.parametrize("start", [0, 0xFFFFFFFF - 2000])
def test_an_attached_program_ends_a_second_after_the_last_valid_frame(start: int) -> None:
    cpp = robot_with_session()
    live_payload = messages.encode_payload(BY_NAME["LIVE"].request, {"mode": 0x10, "code": FORWARD})
    cpp.step(start, b"\0" + encode_frame(Frame(8, 2, 10, live_payload)))
    cpp.step(start + 700, b"\0" + encode_frame(Frame(2, 3, 10)))
    cpp.step(start + 900, encode_frame(Frame(2, 4, 10))[:-2] + b"\1\0")  # damaged: does not count
    assert ends_at(cpp, start + 900, start + 2000) == start + 700 + DEAD_MAN_MS


@pytest.mark.parametrize("name", ["PROGRAM", "START", "button"])
def test_detached_and_button_started_programs_continue(name: str) -> None:
    cpp = robot_with_session()
    mode = {"PROGRAM": 0x50, "START": 0, "button": 0x10}[name]
    program = messages.encode_payload(BY_NAME["PROGRAM"].request, {"mode": mode, "code": FORWARD})
    cpp.step(10, encode_frame(Frame(9, 2, 10, program)))
    if name == "START":
        cpp.step(20, encode_frame(Frame(7, 3, 10, b"\x40")))
    elif name == "button":
        cpp.let_happen("b")
        cpp.step(20)
        cpp.let_happen("r")
    assert ends_at(cpp, 30, 5000) is None


def test_a_long_silence_is_not_taken_for_a_short_one() -> None:
    """Times are 16 bits: after a minute, a robot still knows about the silence."""
    cpp = robot_with_session()
    for now_ms in range(0, 200_000, 500):
        sent_bytes = cpp.step(now_ms).sent
        is_taken = cpp.let_happen("s", 1) or (
            cpp.step(now_ms).sent == b"\0" and cpp.let_happen("s", 1)
        )
        assert is_taken and (not sent_bytes or now_ms < LISTEN_MS + 1000), now_ms


def test_counters_saturate_instead_of_wrapping() -> None:
    """A line that is broken for long stops a robot all the time; a long text is no short one."""
    for find in (packets_of, cpp_link().packets):
        assert find([(0, 0)] * 1402) == [*["stop"] * 350, "damaged 0, dropped 0"]
        assert find([(0, byte) for byte in b"A" * 300 + b"\n"])[0].startswith("text 300 41 41")


def test_a_line_held_low_neither_wraps_the_epoch_nor_floods_the_reply_line() -> None:
    cpp = robot_with_session()
    sent_bytes = b"".join(cpp.step(now_ms, b"\0").sent for now_ms in range(10, 70_010))
    frames = [decode_frame(part) for part in sent_bytes.split(b"\0") if part]
    assert {frame.epoch for frame in frames if frame} == {11}
    assert {frame.number for frame in frames if frame} == {BY_NAME["STOPPED"].number}
    assert 1000 < len(frames) <= 70_000 // AGAIN_MS + 1, len(frames)


def test_many_unread_stops_are_not_lost() -> None:
    cpp = robot_with_session()
    for count in (1, 255, 256, 257, 512):
        assert "STOP" in cpp.step(10, bytes(4 * count), is_late=True).did


@pytest.mark.sampled("late_ms", keep=2)
@pytest.mark.parametrize("late_ms", [0, 300, 1500, 2900, 4000])
@pytest.mark.parametrize(("piece_bytes", "gap_ms"), [(99, 0), (10, 0), (7, 1100), (45, 1100)])
@pytest.mark.parametrize("noise", [b"", b"> "], ids=["plain", "prompt"])
def test_an_echo_of_everything_starts_no_endless_conversation(
    late_ms: int, piece_bytes: int, gap_ms: int, noise: bytes
) -> None:
    """A terminal or a radio module echoes its input, whole and in pieces."""
    cpp = cpp_link()
    cpp.begin(kit=KIT)
    packets_under_way = [(0, b"F(2,800)\r\n")]
    answers = []
    for now_ms in range(0, 60_000, 10):
        arrived_bytes = b"".join(
            data for arrival_ms, data in packets_under_way if arrival_ms == now_ms
        )
        packets_under_way = [pair for pair in packets_under_way if pair[0] > now_ms]
        sent_bytes = cpp.step(now_ms, arrived_bytes).sent.replace(b"\0", b"")
        answers += [now_ms] * sent_bytes.count(b"\n")
        echo = noise + sent_bytes if sent_bytes else b""
        for k in range(-(-len(echo) // piece_bytes)):
            piece = echo[k * piece_bytes : (k + 1) * piece_bytes]
            packets_under_way.append((now_ms + 10 + late_ms + k * gap_ms, piece))
    assert 1 <= len(answers) <= ANSWERS, answers


@pytest.mark.parametrize("line", [b"ERROR:(0)\r\n", b"What?\r\n"])
def test_a_module_that_answers_every_line_gets_few_answers(line: bytes) -> None:
    cpp = cpp_link()
    cpp.begin(kit=KIT)
    answers = [cpp.step(now_ms, line).sent for now_ms in range(0, 60_000, 500)]
    assert sum(bool(answer) for answer in answers) <= ANSWERS
    assert cpp.step(60_000, b"SI|F(1,50)\r\n").sent == b"// OK\r\n"
    for now_ms in range(60_000, 66_000, 100):
        cpp.step(now_ms)
    assert cpp.step(66_000, b"BAD\r\n").sent


def test_a_slow_reply_line_loses_no_answer() -> None:
    """Requests that arrive before the last answer could be sent wait."""
    cpp = robot_with_session()
    data = b"".join(encode_frame(Frame(2, seq, 10)) for seq in (2, 3, 4))
    sent_bytes = cpp.step(10, data, is_slow=True).sent
    frames = [decode_frame(part) for part in sent_bytes.split(b"\0") if part]
    assert [frame.seq for frame in frames if frame] == [2, 3, 4]


def test_a_robot_sends_events_only_to_listeners() -> None:
    cpp = cpp_link()
    cpp.begin(kit=KIT)
    assert cpp.let_happen("s", 1) and not cpp.step(0).sent  # no HELLO has been sent
    cpp = robot_with_session()
    assert cpp.let_happen("s", 1)
    assert not cpp.let_happen("s", 2)  # the last one has not been sent yet, so it is repeated
    assert cpp.step(LISTEN_MS - 1).sent
    cpp.step(LISTEN_MS)
    assert cpp.let_happen("s", 3) and cpp.let_happen("s", 3)
    cpp.let_happen("d")
    assert not cpp.step(LISTEN_MS + 5).sent
    cpp.let_happen("b")
    assert cpp.step(LISTEN_MS + 10).sent  # it always reports that it was stopped
