"""Bytes that people, apps and radio modules really send, given to the whole link of a robot.

A correct line after their bytes runs, or an answer gives the reason: silence is never the reaction.
A glitch that is a 0x00, at any byte, has no other program run than the one that was typed, and a
person and a computer in turns at one port are both heard.
`python -m tests.link.test_field 100000` tries more than the tests.
"""

from __future__ import annotations

import random
import re
from functools import lru_cache, partial
from typing import Any

import pytest

from tests.machines.link import CppLink, cpp_link, link_library
from tests.support.campaign import each_seed, make_options
from tests.support.link_cases import KIT
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import SILENCE_MS, TEXT_MS
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

SEEDS = 150  # of a property, in the tests
LINES = (
    "SI|F(0.5,60)",
    "si|f(0.5, 60)",
    "SI|F(0.5,60);W(1)",
    "SB|F(0.5,60)",
    "PING|check_connection",
)
PROGRAMS = (
    "SI|W(1);F(20,60)",
    "SI|F(20,60) UNTIL(DISTANCE<10)",
    "W(1);F(20,60)",
    "SI|LOOP(2)\nF(1,60)\nEND_LOOP",
)
TYPED_PROGRAMS = ("SI|F(1,60)", "F(2,80)")  # of a person
LINE_ENDS = (b"\n", b"\r", b"\r\n", b"\n\n", b"\r\n\r\n", b"")
# from Bluetooth apps, terminals, radio modules, editors, and lines that are noisy at rest
NOISE_BEFORE = (
    b"\n", b"\r\n", b"\r", b"\n\n", b"\r\n\r\n", b"1\n", b";\n;\n", b"OK+CONN", b"OK+LOST\r\n",
    b"AT\r\n", b"OK", b"+CONNECTED\r\n", b"+DISC:SUCCESS\r\n", b"ERROR:(0)\r\n", b"\xef\xbb\xbf",
    b"\x1b[A\x1b[B", b"\x1b[1;5C", b"\x1b", b"\t\n\t\n", b"\x07", b"\xff\xfe", b"// hi\n\n",
    b"\x7f\x7f", b"\x08", b"\0", b"\0\0", b"hello\0", b"\x03", b"!B5", b" ", b"u", b"\0\n\n",
    b"\0\r\n", b"\xc3\xb1", b"\x01\x02", b"F(1,80", b"FFFF", b"SI|F(", b"SI|LOOP(2)\n", b"S",
    b"stop", b"(\n", b"HELP\n", b"\xf0", b"\xff" * 40, b"x" * 90,
)  # fmt: skip
PAUSES_MS = (0, 0, 50, 300, 1200, 2500, 3500)


class Robot:
    """A robot whose clock advances by a millisecond for each byte, or as the test wants."""

    def __init__(self, cpp: CppLink) -> None:
        self.cpp = cpp
        self.now_ms = 5000
        self.sent_bytes = b""
        self.did: list[str] = []
        cpp.begin(kit=KIT)
        self.wait(20)

    def type(self, data: bytes) -> None:
        for byte in data:
            self._step(1, bytes([byte]))

    def wait(self, passed_ms: int) -> None:
        for _ in range(passed_ms // 20):
            self._step(20)

    def _step(self, passed_ms: int, data: bytes = b"") -> None:
        self.now_ms += passed_ms
        step = self.cpp.step(self.now_ms, data)
        self.sent_bytes += step.sent
        self.did += step.did

    @property
    def answers(self) -> list[bytes]:
        return re.findall(rb"// [^\r]*\r\n", self.sent_bytes)

    @property
    def programs(self) -> set[str]:
        """The programs that were begun: each row has the checksum."""
        return {row for row in self.did if row.startswith("TEXT")}


def check_never_silent(cpp: CppLink, seed: int) -> str:
    rng = random.Random(seed)
    robot = Robot(cpp)
    noise = [rng.choice(NOISE_BEFORE) for _ in range(rng.randint(0, 4))]
    # Before the last silence, because a mistake removes all lines that follow it directly.
    answer_count = 0
    is_in_frames = False  # only if a line needs its end
    for data in noise:
        robot.type(data)
        pause_ms = rng.choice(PAUSES_MS)
        robot.wait(pause_ms)
        is_in_frames = is_in_frames or b"\0" in data
        if pause_ms > SILENCE_MS:
            answer_count, is_in_frames = len(robot.answers), False
    line = rng.choice(LINES).encode() + rng.choice(LINE_ENDS[: -1 if is_in_frames else None])
    event_count = len(robot.did)
    robot.type(line)
    robot.wait(4200)
    is_done = any(row.startswith("TEXT") for row in robot.did[event_count:])
    assert is_done or len(robot.answers) > answer_count, (
        f"seed {seed}: silence for {noise} {line!r}"
    )
    return "runs" if is_done else "told"


@lru_cache
def programs_of(cpp: CppLink, text: str) -> frozenset[str]:
    robot = Robot(cpp)
    robot.type(text.encode() + b"\n")
    robot.wait(100)
    assert len(robot.programs) == 1
    return frozenset(robot.programs)


def check_no_other_program(cpp: CppLink, seed: int) -> str:
    """A glitch is at one byte of a program: a 0x00, in its place or before it."""
    rng = random.Random(seed)
    text = rng.choice(PROGRAMS)
    data = text.encode() + b"\n"
    offset = rng.randrange(len(data))
    # without its first byte a first line is another one, and the next ones are lines of their own
    text_end = offset + (offset > 0 and rng.randrange(2))
    expected_programs = programs_of(cpp, text)
    robot = Robot(cpp)
    robot.type(data[:offset] + b"\0" + data[text_end:])
    robot.wait(4200)
    assert robot.programs <= expected_programs, f"seed {seed}: {text!r} with a 0x00 at {offset}"
    assert robot.programs or robot.answers, f"seed {seed}: silence for {text!r}, a 0x00 at {offset}"
    return "runs" if robot.programs else "told"


def check_both_are_heard(cpp: CppLink, seed: int) -> str:
    """A person and a computer, in turns, on one port."""
    rng = random.Random(seed)
    expected_of = {text: programs_of(cpp, text) for text in TYPED_PROGRAMS}
    robot = Robot(cpp)
    session = Session(rng.getrandbits(32), 115_200, KIT)
    session.is_attached = False

    def ask(request: PendingRequest[Any]) -> None:
        end_ms = robot.now_ms + 3000
        while request.outcome is None and robot.now_ms < end_ms:
            sent_before = len(robot.sent_bytes)
            robot.type(session.poll(robot.now_ms))
            robot.wait(20)
            session.receive(robot.sent_bytes[sent_before:], robot.now_ms)
        assert request.outcome and request.outcome.status == OK, f"seed {seed}: {request.outcome}"

    heard_count = 0
    ask(session.hello())
    for _ in range(12):
        robot.wait(rng.choice((0, 20, 160, 360, 440, 900, 1200)))
        if rng.random() < 0.5:
            ask(session.status())
            continue
        event_count, text = len(robot.did), rng.choice(TYPED_PROGRAMS)
        robot.type(text.encode() + b"\n")
        robot.wait(40)
        # a computer's frame without a 0x00, where the person's line has ended, may be a stop
        if "STOP" in robot.did:
            return "a frame was a stop"
        started_programs = {row for row in robot.did[event_count:] if row.startswith("TEXT")}
        assert started_programs == expected_of[text], (
            f"seed {seed}: {text!r} did {robot.did[event_count:]}"
        )
        heard_count += 1
    robot.wait(TEXT_MS + 100)
    return f"{heard_count} lines"


CHECKS = (check_never_silent, check_no_other_program, check_both_are_heard)


@pytest.mark.parametrize("check_law", CHECKS, ids=lambda holds: holds.__name__)
def test_each_law_of_the_wire_holds(check_law: object) -> None:
    for seed in range(SEEDS):
        check_law(cpp_link(), seed)  # type: ignore[operator]


if __name__ == "__main__":
    options = make_options(10_000, 1_000_000)
    for check in CHECKS:
        each_seed(partial(check, link_library()), options)
