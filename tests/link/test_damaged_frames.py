"""Receivers on a line that damages frames: bytes lost, changed, doubled, put in, frames joined.

No frame that was changed is accepted, and damage costs one more frame at most. The frames are made,
damaged and judged in C++ with the robot's receiver; a sample of the same lines goes through the
receiver and the decoder in Python, and through the C++ with sanitizers, which find the same.
`python -m tests.link.test_damaged_frames 10000000` damages more of them than the tests.
"""

from __future__ import annotations

from typing import NamedTuple

import pytest

from tests.machines.damage import CppDamage, DamagedLine, cpp_damage
from tests.machines.link import cpp_link
from tests.support.campaign import make_options
from tests.support.link_cases import packets_of
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import CRC_BYTES, HEAD_BYTES, SMALL_FRAME

FRAMES = 250_000  # damaged ones, in the tests
LARGE_FRAMES = 100_000
LINES = 200  # that are judged at a time; a line has about 500 damaged frames
LINE_COUNT = 5  # lines in the tests
LARGE_LINE_COUNT = 1
SAMPLE_INTERVAL = 1000  # one in so many lines, in a campaign
SEED = 4


class Line(NamedTuple):
    """A stream of frames: those that were sent, and which of them were damaged on the way."""

    data: bytes
    frames: list[Frame]
    is_damaged: list[bool]


def judge(sent_line: Line, accepted_frames: list[Frame]) -> None:
    """Assert that no wrong frame was accepted, and that damage costs at most one more frame."""
    numbers = {frame: number for number, frame in enumerate(sent_line.frames)}
    judgements = []
    for frame in accepted_frames:
        assert frame in numbers, f"a frame that nobody has sent was accepted: {frame}"
        judgements.append(numbers[frame])
    assert judgements == sorted(set(judgements)), (
        "a frame came twice, or before one that was sent earlier"
    )
    arrived_numbers = set(judgements)
    for number, is_damaged in enumerate(sent_line.is_damaged):
        if not is_damaged and (number == 0 or not sent_line.is_damaged[number - 1]):
            assert number in arrived_numbers, (
                f"frame {number} is lost without damage to it or the one before"
            )


def frame_of(data: bytes) -> Frame:
    """Return the frame from its type to the end of its payload, as the C++ has it."""
    number, seq, epoch = data[:HEAD_BYTES]
    payload = data[HEAD_BYTES:]
    if len(data) + CRC_BYTES > SMALL_FRAME:
        assert payload[0] == 0, "a large frame has a 0 before its payload"
        payload = payload[1:]
    return Frame(number, seq, epoch, payload)


def whole_frames(rows: list[str]) -> list[Frame]:
    """Return the whole frames among a receiver's packets."""
    frames = []
    for row in rows:
        if row.endswith(" whole"):
            frame = decode_frame(bytes.fromhex(row.split(" ", 2)[2].removesuffix(" whole")))
            assert frame
            frames.append(frame)
    return frames


def judge_in_python(line: DamagedLine, is_large: bool) -> None:
    """Assert that Python encodes, receives and decodes a line as the C++ does."""
    sent_line = Line(line.data, [frame_of(frame) for frame in line.frames], line.is_damaged)
    offset = 0
    for frame, is_damaged in zip(sent_line.frames, sent_line.is_damaged, strict=True):
        if not is_damaged:
            wire = encode_frame(frame)
            start = sent_line.data.find(wire, offset)
            assert start >= 0, f"the C++ encodes it in another way: {frame}"
            offset = start + len(wire)
    stream = [(0, byte) for byte in sent_line.data]
    rows = packets_of(stream, is_large=is_large)
    assert cpp_link(is_large).packets(stream) == rows
    judge(sent_line, whole_frames(rows))
    assert [frame_of(packet) for packet in line.accepted] == whole_frames(rows)


def damage_frames(cpp: CppDamage, count: int, seed: int) -> tuple[int, int]:
    """Send lines until so many frames are damaged; return how many were, and the lines."""
    judged_count = lines = 0
    while judged_count < count:
        judged_count += cpp.damage_frames(seed, lines, LINES)
        lines += LINES
    return judged_count, lines


@pytest.mark.parametrize("is_large", [False, True])
def test_damaged_frames_never_decode_to_wrong_ones(is_large: bool) -> None:
    count = LARGE_FRAMES if is_large else FRAMES
    assert damage_frames(cpp_damage(is_large), count, SEED)[0] >= count


@pytest.mark.parametrize("is_large", [False, True])
def test_python_decodes_damaged_frames_alike(is_large: bool) -> None:
    for number in range(LARGE_LINE_COUNT if is_large else LINE_COUNT):
        judge_in_python(cpp_damage(is_large).line(SEED, number), is_large)


if __name__ == "__main__":
    options = make_options(10_000_000, 1_000_000, "large")
    judges = cpp_damage(options.large)
    damaged_count, lines = damage_frames(judges, options.count, options.seed)
    for line_number in range(0, lines, SAMPLE_INTERVAL):
        judge_in_python(judges.line(options.seed, line_number), options.large)
    print(f"{damaged_count} damaged frames in {lines} lines: nothing wrong")
