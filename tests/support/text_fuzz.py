"""Random bytes for the reader of text."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.robot_on_host import computer, switched_on
from tests.support.text_robot import robot_with_program
from tiniscript.base.words import WORDS

TURNS = 25
SAVING_MESSAGE = b"// Still saving. Send it again."
MISTAKE_PATTERN = re.compile(rb"// (\d+: |Too late|Bytes were lost|It was stopped|It had a fault)")
LINE = b"SI|M(13,17);W(9)\n"
LINES = ("SI|F(1,50)\n", "F(9,50)\r", "SB|R(1,30)\r\n", "S\n", "STOP", "s", "HELP\n", "PING|\n",
         "SI|LOOP(FOREVER);\n", "END_LOOP\n", "LOOP(2)\n", "  STOP\n", "IF(DISTANCE<10)\n",
         "ENDIF\n", "SI|X=0;X=1/X\n", "SI|LOOP(FOREVER);SHOW(TIME);END_LOOP\n", "// no\n",
         "\t\tS\n", "SI|F(2,80)~72CA4271\n", "SB|", "SI|", "OK\n", "+X\n", "DEF A\n", "END_DEF\n",
         "A\n", ")\n",
         )  # fmt: skip
TOKENS = (*WORDS, "X", "DISTANCE", *"0123456789();,|=<>+-*/%~_. \t\r\n", "//", "é", "\ufeff")
FRAMES = ("SI|F(1,80)", "SB|L(1,40)", "SI|LOOP(FOREVER);SHOW(1);END_LOOP", "SI|X=0;X=1/X")
LONG_PROGRAM = "SI|" + "F(0.1,80);B(0.1,60);" * 12


class Fuzz:
    """A robot with arbitrary input, and its invariants."""

    def __init__(self, seed: int) -> None:
        self.rng = random.Random(seed)
        self.robot: HostFirmware
        if seed % 2:
            self.robot, self.session = robot_with_program()
        else:
            self.robot, self.session = switched_on(), computer()

    def step(self, data: bytes = b"", flags: int = 0) -> bytes:
        """Step one millisecond; no motor may turn while the robot is latched."""
        robot = self.robot
        robot.did.clear()
        was_latched = robot.is_latched
        sent_bytes = robot.step(data, flags)
        self.check(was_latched, robot.is_latched, robot.did, has_data=bool(data))
        return sent_bytes

    def check(
        self, was_latched: bool, is_latched: bool, actions: list[str], has_data: bool
    ) -> None:
        """Assert the invariants of a millisecond."""
        for line in actions:
            assert "MARK" not in line and "MEASURED" not in line, line
        moves = [line for line in actions if " MOTORS " in line]
        if not has_data:  # in several lines at once, one may start what the next one stops
            assert not (was_latched and is_latched and moves), actions
        if is_latched and moves:
            assert moves[-1].endswith("MOTORS 0 0"), moves

    def step_for(self, milliseconds: int, data: bytes) -> bytes:
        """Step milliseconds, in each of which one of the bytes arrives."""
        robot = self.robot
        robot.did.clear()
        was_latched, begin_ms = robot.is_latched, robot.now_ms + 1
        sent_bytes, latch_states = robot.latched_while(milliseconds, data, is_spread=True)
        actions: list[list[str]] = [[] for _ in latch_states]
        for line in robot.did:
            actions[int(line.split()[0]) - begin_ms].append(line)
        for number, is_latched in enumerate(latch_states):
            self.check(was_latched, is_latched, actions[number], has_data=number < len(data))
            was_latched = is_latched
        return sent_bytes

    def wait(self, milliseconds: int) -> bytes:
        return self.step_for(milliseconds, b"")

    def type(self, data: bytes) -> bytes:
        return self.step_for(len(data), data) if data else b""

    # -- the input --------------------------------------------------------------------------------

    def bytes_(self) -> None:
        data = self.rng.randbytes(self.rng.randrange(1, 80))
        if self.rng.random() < 0.5:
            self.type(data)
        else:
            self.step(data, flags=16)

    def line(self) -> None:
        data = "".join(self.rng.choices(LINES, k=self.rng.randrange(1, 5))).encode()
        if self.rng.random() < 0.3:
            offset = self.rng.randrange(len(data))
            data = data[:offset] + self.rng.randbytes(self.rng.randrange(2)) + data[offset + 1 :]
        if self.rng.random() < 0.8:
            self.type(data)
        else:
            self.step(data)

    def tokens(self) -> None:
        self.type("".join(self.rng.choices(TOKENS, k=self.rng.randrange(1, 30))).encode())

    def frames(self) -> None:
        session, rng = self.session, self.rng
        image = image_of(rng.choice(FRAMES))
        line_makers: tuple[Callable[[], object], ...] = (
            session.hello, session.ping, session.status, session.clear, session.start,
            session.fetch, lambda: session.live(image.code), lambda: session.name(b"A"),
            lambda: session.upload(image, saves=rng.random() < 0.5),
            lambda: session.upload(image_of(LONG_PROGRAM)),
        )  # fmt: skip
        rng.choice(line_makers)()
        for _ in range(rng.choice((2, 10, 60, 300))):
            data = session.poll(self.robot.now_ms)
            if data and rng.random() < 0.1:
                offset = rng.randrange(len(data))
                data = (
                    data[:offset] + rng.choice((b"", b"\n", b"S\n", b"\0\0\0")) + data[offset + 1 :]
                )
            session.receive(self.step(data), self.robot.now_ms)

    def zeros(self) -> None:
        self.step(bytes(self.rng.randrange(1, 10)))

    def silence(self) -> None:
        self.wait(self.rng.choice((1, 5, 30, 300, 998, 1001, 1100, 3000)))

    def button(self) -> None:
        self.step(flags=1)
        self.wait(self.rng.choice((1, 40, 1200)))
        self.step(flags=2)

    def turn(self) -> None:
        actions = (self.bytes_, self.line, self.line, self.line, self.tokens, self.frames,
            self.frames,
                self.zeros, self.silence, self.silence, self.button)  # fmt: skip
        self.rng.choice(actions)()

    # -- the invariants afterwards ----------------------------------------------------------------

    def check_line(self) -> None:
        """After anything and a second of silence the next whole line is answered.

        A line or block that was open ends with it: then the one after it is done. The open one may
        be right, as `SB|// no`, whose note swallows this one.
        """
        self.wait(3050)  # no client listens any more
        was_open = False
        for _ in range(20):
            answers = self.type(LINE) + self.wait(1050)
            lines = answers.split(b"\r\n")
            is_taken = any(line.startswith(b"// OK") for line in lines)
            if is_taken and self.moving():
                return
            if SAVING_MESSAGE not in lines:
                is_open = is_taken or any(MISTAKE_PATTERN.match(line) for line in lines)
                assert is_open and not was_open, answers
                was_open = True
                self.wait(1050)  # `moving` has stopped it
        raise AssertionError("it saves for ever")

    def moving(self) -> bool:
        """Return whether the line of `check_line` has the motors, which it stops here."""
        lines: list[str] = []
        for _ in range(50):
            self.step(b"\0" * 8)
            lines += self.robot.did
        return any(line.endswith("MOTORS 0 0") for line in lines)

    def check_stop(self) -> None:
        """After a stop, no motor turns until a line with a SETUP word after a silent second."""
        for _ in range(self.rng.randrange(1, 6)):
            data = "".join(self.rng.choices((*LINES, *TOKENS), k=6)).encode()
            self.type(data.replace(b"\0", b""))
            self.wait(self.rng.choice((1, 100, 900)))
            assert self.robot.is_latched, data
        self.wait(1100)
        without = [line for line in LINES if not line.lower().startswith(("si", "sb"))]
        self.type("".join(self.rng.choices(without, k=6)).encode())
        assert self.robot.is_latched


def run(seed: int) -> None:
    fuzz = Fuzz(seed)
    for _ in range(TURNS):
        fuzz.turn()
    fuzz.check_line()
    fuzz.check_stop()
    fuzz.wait(1100)
    fuzz.check_line()
