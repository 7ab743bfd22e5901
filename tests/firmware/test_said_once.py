"""The robot's messages from a stop, a fault or an end until it is at rest, and afterwards.

A client sends random requests, one after the other, on a quick line or a slow one; programs show
values, end, fail and continue; at any moment, the robot may be stopped. Laws of its messages:

- Each request that has arrived whole gets one reply, and nothing else does.
- A stop is told once, with the cause that stopped the robot; again where it is stopped again.
- A run that ends by itself is told once, as DONE or as FAULT, and no other run is;
  the next one's end may replace it while the line is busy.
- Each value is told once, in its order, with the run that shows it, and none after its end.
- Who hears a new epoch is told why by HELLO's reply, STOPPED or FAULT.

`python -m tests.firmware.test_said_once 2000` tries more.
"""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import dataclass, field

import pytest

from tests.machines.host_firmware import TICKS, HostFirmware
from tests.support.campaign import each_seed, make_options
from tests.support.images import image_of
from tests.support.robot_on_host import KIT
from tests.support.small_robot import SmallRobot
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    AGAIN_MS,
    BY_NAME,
    DETACHED,
    MAJOR,
    MINOR,
    RUN,
    STATUSES,
    ZERO_MS,
)

SHOW, FAULT, STOPPED, DONE = (BY_NAME[name].number for name in ("SHOW", "FAULT", "STOPPED", "DONE"))
HELLO, CLEAR, LIVE, PROGRAM, START, STOP = (
    BY_NAME[name].number for name in ("HELLO", "CLEAR", "LIVE", "PROGRAM", "START", "STOP")
)
OTHER_NUMBERS = tuple(
    BY_NAME[name].number for name in ("PING", "STATUS", "TRIM", "IDENTIFY", "ABORT")
)
OK = STATUSES["OK"]
SEQUENCE, MESSAGE, BUTTON, CABLE, TEXT = range(1, 6)  # sources of a stop
PRESSED, RELEASED, STALLED, UNPLUGGED = 1, 2, 4, 8
KINDS: dict[str, type[HostFirmware]] = {"a mega": HostFirmware, "an uno": SmallRobot}
PACES = (0, 2, 21, 21)  # ticks of a byte: at once, as with 115200 baud, as with 9600
LONGEST_ANSWER_MS = 400  # longest answer time on the slowest line, including earlier output
LONGEST_OUTPUT_MS = 70  # longest time that earlier output keeps the line busy
ENDINGS = (";W(0.002)", ";SHOW(1 / (X - X))", ";W(9)", ";F(9, 80)")


@dataclass(frozen=True)
class Program:
    """A program that shows so many values from a first one on, unless it is ended."""

    first: int
    shows: int


@dataclass
class Run:
    program: Program
    began_ms: int
    ended: int = 0  # event by which the run ended itself
    ended_ms: int = 0
    ended_epoch: int = 0
    is_ended: bool = False  # whether it ended by itself or by a stop
    values: list[int] = field(default_factory=list)
    reported_ends: list[int] = field(default_factory=list)  # events that reported its end
    is_over: bool = False  # whether its client knows that it is over


@dataclass
class Stop:
    """`must`: it must be reported, even if the robot was stopped already."""

    at_ms: int
    must: bool
    epoch: int | None  # the epoch last heard; None if the robot was already stopped


class Client:
    """A client that sends requests, and checks the messages against the laws."""

    def __init__(self, rng: random.Random, kind: str) -> None:
        self.rng = rng
        self.robot = KINDS[kind](KIT)
        self.robot.wait(300)
        self.set_byte_ticks(rng.choice(PACES))
        self.heard = b""
        self.sent_ms = -ZERO_MS  # the last frame; none was sent since
        self.asked_ms = 0
        self.seq = 0
        self.epoch = 0
        self.nonce = 1
        self.programs: dict[bytes, Program] = {}
        self.runs: list[Run] = []
        self.waiting: dict[int, tuple[int, int]] = {}  # message and time, by number
        self.stops: list[Stop] = []  # stops not reported yet
        self.causes: list[tuple[int, int]] = []  # causes with times, since the robot last ran
        self.cause = 0  # cause of the current or next reported stop
        self.confirmed_ms = -AGAIN_MS
        self.log: list[object] = []
        self.is_new = True
        self.ask(HELLO, self.hello())
        self.advance_ms(LONGEST_ANSWER_MS)

    def set_byte_ticks(self, ticks: int) -> None:
        self.ticks = ticks
        self.robot.set_byte_ticks(ticks)

    # -- received ---------------------------------------------------------------------------------

    def advance_ms(
        self, milliseconds: int, data: bytes = b"", flags: int = 0, cause: int = 0
    ) -> None:
        """Let time pass, with received bytes or another stop at its beginning."""
        robot = self.robot
        until_ms = robot.now_ms + milliseconds
        if cause in (SEQUENCE, MESSAGE, TEXT):
            self.note_stop(cause)
        was_running = not robot.is_latched
        sent_bytes = robot.step(data, flags)
        ended = self.note_runs()
        if cause in (BUTTON, CABLE) and was_running and robot.is_latched and not ended:
            self.note_stop(cause)
        self.receive(sent_bytes)
        while robot.now_ms < until_ms:
            sent_bytes = robot.until_sent(until_ms - robot.now_ms)
            self.note_runs()
            self.receive(sent_bytes)

    def note_stop(self, cause: int) -> None:
        """Record a stop; a robot that is already stopped repeats STOPPED, but not too often."""
        now_ms = self.robot.now_ms
        passed_ms = now_ms - self.confirmed_ms
        must = not self.causes or passed_ms > AGAIN_MS + 2
        self.stops.append(Stop(now_ms, must, None if self.causes else self.epoch))
        is_clear_pending = CLEAR in (asked_number for asked_number, _ in self.waiting.values())
        if not self.causes or passed_ms >= AGAIN_MS - 2 or is_clear_pending:
            self.confirmed_ms = now_ms
        self.causes.append((now_ms, cause))
        self.cause = self.causes[0][1]
        self.log.append((now_ms, "stop", cause))

    def note_runs(self) -> bool:
        """Record the runs that have begun and ended; no program ends in its first millisecond.

        Return whether one has ended by itself.
        """
        begun_programs = [self.programs[code] for code in self.robot.codes()]
        actions = [line.split()[1] for line in self.robot.did]
        self.robot.did.clear()
        for event_name, end in (("FINISHED", DONE), ("FAULTED", FAULT)):
            if event_name in actions:
                if end == FAULT:
                    self.begin(begun_programs)
                self.runs[-1].ended = end
                self.runs[-1].ended_ms, self.runs[-1].ended_epoch = self.robot.now_ms, self.epoch
                self.runs[-1].is_ended = True
                self.log.append((self.robot.now_ms, event_name))
        self.begin(begun_programs)
        if self.runs and self.robot.is_latched:
            self.runs[-1].is_ended = True
        return "FINISHED" in actions or "FAULTED" in actions

    def begin(self, programs: list[Program]) -> None:
        for program in programs:
            self.runs.append(Run(program, self.robot.now_ms))
            self.log.append((self.robot.now_ms, "run", len(self.runs), program))
            self.forget_stops_before(self.robot.now_ms)
        programs.clear()

    def forget_stops_before(self, now_ms: int) -> None:
        """Forget the cause of the last stop: the robot is no longer stopped."""
        self.causes = [row for row in self.causes if row[0] >= now_ms - 1]
        if self.causes:
            self.cause = self.causes[0][1]

    def receive(self, sent_bytes: bytes) -> None:
        *packets, self.heard = (self.heard + sent_bytes).split(b"\0")
        for packet in packets:
            frame = decode_frame(packet) if packet else None
            assert frame or not packet, f"no frame: {packet!r}"
            if frame is not None:
                self.log.append((self.robot.now_ms, frame))
                self.take(frame, self.robot.now_ms - (len(packet) + 1) * self.ticks // TICKS)

    def take(self, frame: Frame, began_ms: int) -> None:
        self.take_epoch(frame)
        if frame.number == SHOW:
            self.take_value(frame.payload)
        elif frame.number == STOPPED:
            self.take_stop(frame, began_ms)
        elif frame.number in (FAULT, DONE):
            run = self.run_of(frame.payload[0])
            run.reported_ends.append(frame.number)
            run.is_over = True
            assert frame.number == DONE or frame.epoch != run.ended_epoch, (
                "a fault without an epoch"
            )
            assert run.reported_ends == [run.ended], (
                "an end that is none, another one, or told twice"
            )
        else:
            asked_number, asked_ms = self.waiting.pop(frame.seq, (0, 0))
            assert frame.is_reply and asked_number == frame.number, "a reply that nobody waits for"
            if asked_number == CLEAR and frame.payload[0] == OK:
                self.forget_stops_before(asked_ms + 1)

    def take_epoch(self, frame: Frame) -> None:
        """A reply may be ahead of the fault, which the next run's end may replace."""
        if frame.epoch == self.epoch and not self.is_new:
            return
        is_ahead = any(run.ended == FAULT and not run.reported_ends for run in self.runs[-2:])
        is_late = is_ahead and frame.number != SHOW  # a reply, or the end of the next run
        assert frame.number in (HELLO, STOPPED, FAULT) or is_late, "nothing tells why"
        assert self.is_new or (frame.epoch - self.epoch) % 256 < 128, "an old epoch"
        self.epoch, self.is_new = frame.epoch, False

    def run_of(self, number: int) -> Run:
        assert 0 < number <= len(self.runs) < 256
        return self.runs[number - 1]

    def take_value(self, payload: bytes) -> None:
        run = self.run_of(payload[5])
        assert not run.is_over, "a value after the end"
        run.values.append(int.from_bytes(payload[:4], "little", signed=True) // 1000)
        first = run.program.first
        assert run.values == list(range(first, first + len(run.values))), "not the next value"

    def take_stop(self, frame: Frame, began_ms: int) -> None:
        cause = frame.payload[0]
        assert self.stops, "a stop that is none, or told twice"
        cleared_ms = min(
            (ms for asked_number, ms in self.waiting.values() if asked_number == CLEAR),
            default=None,
        )
        first = {self.cause}
        if cleared_ms is not None:  # this may have happened earlier
            first |= {cause for at_ms, cause in self.causes if at_ms >= cleared_ms}
        assert cause in first, f"not the first cause: {first}"
        assert frame.epoch != self.stops.pop(0).epoch, "a stop without an epoch"
        self.stops = [stop for stop in self.stops if stop.at_ms >= began_ms - 2]
        for stop in self.stops:  # the stop may precede the writing of this message
            stop.must = False
        for run in self.runs:
            run.is_over |= run.is_ended and run.ended == 0

    # -- actions -----------------------------------------------------------------------------------

    def hello(self) -> bytes:
        kit = KIT.fingerprint.to_bytes(2, "little")
        return bytes((MAJOR, MINOR, 2, 0)) + kit + self.nonce.to_bytes(4, "little")

    def program(self) -> bytes:
        rng = self.rng
        first, shows = 100 * (len(self.programs) + 1), rng.choice((0, 0, 1, 2, 5, 30))
        wait = rng.choice(("", "", "W(0.001);", "W(0.02);"))
        loop = f"LOOP({shows});SHOW(X);X = X + 1;{wait}END_LOOP" if shows else f"{wait}W(0)"
        text = f"SI|X = {first};{loop}{rng.choice(ENDINGS)}"
        return self.code_of(text, Program(first, shows))

    def code_of(self, text: str, program: Program) -> bytes:
        """Return the code of a text, whose runs count as the program's."""
        code = image_of(text, KIT).code
        self.programs[code] = program
        return code

    def request(self) -> tuple[int, bytes]:
        """Return a message and its payload."""
        rng = self.rng
        number = rng.choice(
            (*OTHER_NUMBERS, CLEAR, CLEAR, LIVE, LIVE, LIVE, PROGRAM, START, STOP, HELLO)
        )
        if number == HELLO:
            self.nonce += rng.random() < 0.5
            return number, self.hello()
        if number == LIVE:
            return number, bytes((RUN,)) + self.program()
        if number == PROGRAM:
            return number, bytes((rng.choice((0, RUN, RUN | DETACHED)),)) + self.program()
        return number, bytes((rng.choice((0, DETACHED)),)) if number == START else b""

    def ask(
        self, number: int, payload: bytes = b"", bytes_after: bytes = b"", cause: int = 0
    ) -> None:
        """Send a request; a stop may follow at once. No robot acts on a frame with another
        epoch."""
        now_ms = self.robot.now_ms
        zero = b"\0" if number == HELLO or now_ms - self.sent_ms >= ZERO_MS else b""
        self.seq = (self.seq + 1) % 256
        self.waiting[self.seq] = (number, now_ms)
        frame = Frame(number, self.seq, self.epoch, payload)
        self.sent_ms = self.asked_ms = now_ms
        if number == STOP:
            self.note_stop(MESSAGE)
        self.advance_ms(1, zero + encode_frame(frame) + bytes_after, 0, cause)

    def turn(self) -> None:
        """Ask for something, or let time pass; mostly something stops the robot at any moment."""
        rng = self.rng
        data, flags, cause = rng.choice((
            (bytes(4), 0, SEQUENCE), (bytes(8), 0, SEQUENCE), (b"\0S\n", 0, TEXT),
            (b"", PRESSED, BUTTON), (b"", STALLED, 0), (b"", UNPLUGGED, CABLE),
            (b"", 0, 0), (b"", 0, 0), (b"", 0, 0),
        ))  # fmt: skip
        is_at_once = not flags and rng.random() < 0.3
        # Most messages are heard.
        if rng.random() < 0.9 or self.robot.now_ms - self.asked_ms > 1000:
            self.ask(*self.request(), *((data, cause) if is_at_once else ()))
        if not is_at_once:
            self.advance_ms(rng.choice((1, 2, 5, 15, 40, 70)))
            self.advance_ms(1, data, flags, cause)
        if data:
            self.sent_ms = -ZERO_MS
        if flags == PRESSED:
            self.advance_ms(rng.choice((5, 40, 90)))
            self.advance_ms(1, b"", RELEASED)
        self.advance_ms(LONGEST_ANSWER_MS if self.waiting else 1)
        assert not self.waiting, "no reply"
        self.advance_ms(rng.choice((1, 1, 60, 1100)))

    def settle(self) -> None:
        self.advance_ms(LONGEST_ANSWER_MS)
        assert not [stop for stop in self.stops if stop.must], "a stop that nobody is told of"
        for number, run in enumerate(self.runs, 1):
            # The button may start the next one while the line is busy.
            begins_ms = [later_run.began_ms for later_run in self.runs[number : number + 1]]
            is_overtaken = begins_ms and begins_ms[0] - run.ended_ms < LONGEST_OUTPUT_MS
            assert run.ended in (0, *run.reported_ends) or is_overtaken, f"no end of {number}"
            if run.ended == DONE:
                assert len(run.values) == run.program.shows, number


def check(seed: int, kind: str) -> Counter[str]:
    rng = random.Random(f"{seed} {kind}")
    client = Client(rng, kind)
    try:
        for _ in range(25):
            client.turn()
        client.settle()
    except Exception as error:
        log = "\n".join(map(str, client.log[-25:]))
        raise AssertionError(f"{seed} {kind} {client.ticks}: {error!r}\n{log}") from error
    names = {DONE: "done", FAULT: "faults"}
    event_counts = Counter(names[run.ended] for run in client.runs if run.ended)
    event_counts["stops"] += sum(isinstance(row, tuple) and row[1] == "stop" for row in client.log)
    return event_counts


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(5))
@pytest.mark.parametrize("kind", KINDS)
def test_each_event_is_reported_once(kind: str, part: int) -> None:
    event_counts: Counter[str] = Counter()
    for seed in range(part * 20, part * 20 + 20):
        event_counts += check(seed, kind)
    assert all(event_counts[name] for name in ("done", "faults", "stops")), event_counts


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("is_fault_first", [False, True])
def test_an_end_is_reported_for_its_own_run_though_another_waits(
    is_fault_first: bool, kind: str
) -> None:
    finished_text, fault = "SI|X = 1;W(0.002)", "SI|X = 1;SHOW(1 / (X - X))"
    waited = 0
    for delay_ms in range(1, 40):
        client = Client(random.Random(delay_ms), kind)
        client.set_byte_ticks(21)
        first, pressed_text = (fault, finished_text) if is_fault_first else (finished_text, fault)
        client.ask(PROGRAM, bytes((0,)) + client.code_of(pressed_text, Program(0, 0)))
        client.advance_ms(LONGEST_ANSWER_MS)
        client.ask(LIVE, bytes((RUN,)) + client.code_of(first, Program(0, 0)))
        client.advance_ms(delay_ms)
        client.advance_ms(1, b"", PRESSED, BUTTON)
        client.advance_ms(5)
        client.advance_ms(1, b"", RELEASED)
        client.settle()
        waited += len(client.runs) == 2 and sum(len(run.reported_ends) for run in client.runs) == 1
    assert waited, "the line was never busy at both ends"


def check_all(seed: int) -> None:
    for kind in KINDS:
        check(seed, kind)


if __name__ == "__main__":
    each_seed(check_all, make_options(2000, 10_000))
