"""A running request ends well: it is not given up while few packets in a row are lost, or while the
robot regularly shows progress; and whatever is lost, each request ends.

`python -m tests.link.test_liveness 2000` tries more.
"""

from __future__ import annotations

import random
from collections import Counter, deque
from collections.abc import Callable
from typing import Any

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.campaign import each_seed, make_options
from tests.support.images import TINIBOT, image_of
from tests.support.robot_on_host import computer, switched_on
from tiniscript.link.connection import EXCHANGE_TIMEOUT_MS, PendingRequest
from tiniscript.link.requests import OK
from tiniscript.link.session import DEAF_MS, Session

CONSECUTIVE_LOSSES = 4  # packets of both that are lost before an answer arrives
LINE_DEAD_MS, LINE_ALIVE_MS = 2500, 1500  # of a line that is dead again and again
LONGEST_DELAY_MS = 1200  # most delay of data to the robot
MAX_POLLS = 5  # polls in one moment
REQUEST_LIMIT_MS = 10_000  # of a request and of each of its pieces
LONG_PROGRAM = "SI|" + "F(0.1, 30); B(0.1, 20);" * 60
DETACHED_PROGRAM = "SI|F(20, 40)"

REQUEST_MAKERS: dict[str, Callable[[Session], PendingRequest[Any]]] = {
    "a long program": lambda session: session.upload(image_of(LONG_PROGRAM), saves=False),
    "a saved program": lambda session: session.upload(image_of(LONG_PROGRAM)),
    "a short program": lambda session: session.upload(image_of("SI|F(0.2, 50)"), saves=False),
    "a line": lambda session: session.live(image_of("SI|F(0.2, 50)").code),
    "what goes on alone": lambda session: session.upload(
        image_of(DETACHED_PROGRAM), saves=False, is_detached=True
    ),
    "its program": lambda session: session.fetch(),
    "its state": lambda session: session.status(),
    "its trim": lambda session: session.trim(),
    "its name": lambda session: session.name(b"Pia"),
}


class BadLine:
    """A line that decides the loss of each packet in both directions."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.lost_in_a_row = 0
        kind = rng.choice(("losses", "losses", "bursts", "late"))
        self.is_bursty = kind == "bursts"
        self.likely = rng.choice((0.2, 0.5, 0.8)) if kind == "losses" else 0
        self.late_ms = rng.choice((300, LONGEST_DELAY_MS)) if kind == "late" else 0
        self.under_way: deque[tuple[int, bytes]] = deque()  # to the robot
        self.packets = [(-9, False), (-9, False)]  # time and fate of the last one in each direction
        self.dead_ms = rng.choice((500, 1500, LINE_DEAD_MS))

    def carry(self, data: bytes, now_ms: int, is_answer: bool = False) -> bytes:
        if not data:
            return data
        if self.is_bursty:
            return data if now_ms % (self.dead_ms + LINE_ALIVE_MS) < LINE_ALIVE_MS else b""
        before_ms, is_lost = self.packets[is_answer]
        if now_ms > before_ms + 2:  # another packet
            is_lost = self.lost_in_a_row < CONSECUTIVE_LOSSES and self.rng.random() < self.likely
            self.lost_in_a_row = (
                self.lost_in_a_row + 1 if is_lost else 0 if is_answer else self.lost_in_a_row
            )
        self.packets[is_answer] = now_ms, is_lost
        return b"" if is_lost else data


def polled_when_due(session: Session, now_ms: int) -> bytes:
    """Return what a session sends that is polled when it wants that, which is seldom."""
    data = b""
    for _ in range(MAX_POLLS):
        wake_ms = session.next_wake_ms()
        if wake_ms is None or wake_ms > now_ms:
            return data
        data += session.poll(now_ms)
    raise AssertionError("it wants to be woken again and again")


def turn(session: Session, robot: HostFirmware, line: BadLine) -> None:
    data = line.carry(polled_when_due(session, robot.now_ms), robot.now_ms)
    line.under_way.append((robot.now_ms + line.late_ms, data))
    due_ms, data = line.under_way[0]
    is_due = due_ms <= robot.now_ms
    if is_due:
        line.under_way.popleft()
    sent_bytes = robot.wait(10 if line.late_ms else 1, data if is_due else b"")
    session.receive(line.carry(sent_bytes, robot.now_ms, True), robot.now_ms)


def finish_request(
    session: Session,
    robot: HostFirmware,
    line: BadLine,
    request: PendingRequest[Any],
    timeout_ms: int,
) -> int:
    """Return how a request has ended, which it does in so long a time."""
    end_ms = robot.now_ms + timeout_ms
    while request.outcome is None:
        assert robot.now_ms < end_ms, "it waits for ever"
        turn(session, robot, line)
    return request.outcome.status


def check(seed: int) -> str:
    rng = random.Random(seed)
    robot, session, line = switched_on(), computer(), BadLine(rng)
    name = rng.choice([*REQUEST_MAKERS])
    assert robot.until(session, session.upload(image_of("SI|F(0.2, 50)"))) == OK
    robot.talk(session, 3000)
    pending_requests = [REQUEST_MAKERS[name](session), session.status()]
    explanation = f"seed {seed}, {name}, {line.is_bursty} {line.likely} {line.late_ms}"
    pieces = 40 if "program" in name else 4
    for request in pending_requests:
        status = finish_request(session, robot, line, request, pieces * REQUEST_LIMIT_MS)
        assert status == OK, f"{explanation}: {status}"
    if name == "what goes on alone":
        robot.wait(2 * DEAF_MS)  # the client that sent it has left
        assert not robot.is_latched, explanation
    return name


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(20))
def test_requests_succeed_despite_occasional_loss(part: int) -> None:
    counts = Counter(check(seed) for seed in range(part * 15, (part + 1) * 15))
    assert len(counts) > 4, counts


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(10))
def test_each_request_to_a_silent_robot_ends_and_the_next_succeeds(part: int) -> None:
    """The robot falls silent at any moment, for any time, or was reset; then it is there again."""
    for seed in range(part * 12, (part + 1) * 12):
        rng = random.Random(seed)
        robot, session, line = switched_on(), computer(), BadLine(rng)
        line.is_bursty, line.likely, line.late_ms = False, 0, 0
        pending_requests = [
            rng.choice([*REQUEST_MAKERS.values()])(session) for _ in range(rng.randint(1, 4))
        ]
        for _ in range(rng.choice((0, 1, 3, 10, 40))):
            turn(session, robot, line)
        silent_ms = rng.choice((200, 1000, 4000, 40_000))
        for _ in range(silent_ms // 50):
            polled_when_due(session, robot.now_ms)
            robot.wait(50)
        if rng.random() < 0.5:
            new_robot = HostFirmware(TINIBOT, robot.memory(), seed=rng.getrandbits(32) | 1)
            new_robot.now_ms = robot.now_ms
            new_robot.wait(200)
            robot = new_robot
        timeout_ms = len(pending_requests) * (EXCHANGE_TIMEOUT_MS + DEAF_MS) + 5000
        for request in pending_requests:
            finish_request(session, robot, line, request, timeout_ms)
        robot.talk(session, 2000)
        if finish_request(session, robot, line, session.hello(), EXCHANGE_TIMEOUT_MS) != OK:
            raise AssertionError(f"seed {seed}: it is there")
        assert (
            finish_request(session, robot, line, REQUEST_MAKERS["a long program"](session), 20_000)
            == OK
        ), seed


@pytest.mark.parametrize("seed", range(3))
def test_polling_on_demand_is_rare_and_misses_nothing(seed: int) -> None:
    """This holds whatever is requested, and whatever is lost."""
    rng = random.Random(seed)
    robot, session, is_dead = switched_on(), computer(), False
    for _ in range(60):
        match rng.choice(("ask", "ask", "press", "stop", "die", "live", "wait")):
            case "ask":
                rng.choice([*REQUEST_MAKERS.values()])(session)
            case "press":
                session.press(rng.randrange(4))
            case "stop":
                session.stop(robot.now_ms)
            case "die":
                is_dead = True
            case "live":
                is_dead = False
        for _ in range(rng.choice((1, 10, 100, 400))):
            data = polled_when_due(session, robot.now_ms)
            sent_bytes = robot.wait(10, b"" if is_dead else data)
            session.receive(b"" if is_dead else sent_bytes, robot.now_ms)
    line = BadLine(rng)
    line.is_bursty, line.likely, line.late_ms = False, 0, 0
    session.stop(robot.now_ms)
    assert finish_request(session, robot, line, session.hello(), REQUEST_LIMIT_MS) == OK


def lost_after_ms(session: Session, robot: HostFirmware) -> int:
    """Return how long a line is dead before the session reports it."""
    start_ms = robot.now_ms
    while "LOST" not in [event.name for event in session.events()]:
        session.poll(robot.now_ms)
        robot.wait(10)
        assert robot.now_ms - start_ms < 3 * DEAF_MS, "it is never told"
    return robot.now_ms - start_ms


REQUESTS_AND_STOPS: dict[str, Callable[[Session, HostFirmware], object]] = {
    "a stop": lambda session, robot: session.stop(robot.now_ms),
    "an answer": lambda session, robot: session.status(),
    "keys": lambda session, robot: session.press(1),
}


@pytest.mark.parametrize("request_name", REQUESTS_AND_STOPS)
def test_a_received_line_restarts_its_timeout(request_name: str) -> None:
    """This holds however near its end was, with and without a running program."""
    robot, session = switched_on(), computer()
    for dead_ms in range(0, DEAF_MS, 215):
        assert robot.until(session, session.hello()) == OK
        if dead_ms % 2:
            upload = session.upload(image_of("SI|W(99)"), saves=False, is_detached=True)
            assert robot.until(session, upload) == OK
        session.events()
        for _ in range(dead_ms // 10):
            session.poll(robot.now_ms)
            robot.wait(10)
        REQUESTS_AND_STOPS[request_name](session, robot)
        robot.talk(session, 500)
        assert "LOST" not in [event.name for event in session.events()]
        assert lost_after_ms(session, robot) >= DEAF_MS, dead_ms
        robot.wait(DEAF_MS)


@pytest.mark.parametrize("late_ms", range(0, 700, 100))
def test_late_answers_to_keys_keep_the_line(late_ms: int) -> None:
    """Later than the next word is said."""
    robot, session = switched_on(), computer()
    assert robot.until(session, session.hello()) == OK
    answers_under_way = deque[bytes](b"" for _ in range(late_ms // 10))
    for _ in range(3 * DEAF_MS // 10):
        session.press(1)
        answers_under_way.append(robot.wait(10, session.poll(robot.now_ms)))
        session.receive(answers_under_way.popleft(), robot.now_ms)
    assert session.events() == []


if __name__ == "__main__":
    each_seed(check, make_options(1000, 10_000))
