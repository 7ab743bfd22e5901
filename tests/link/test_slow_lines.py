"""Uploads over lines that are slow, late or lose bytes: an upload with progress is not given up.

The robot is the firmware's link, on a clock of the test.
"""

from __future__ import annotations

import random
from typing import Any, NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.machines.link import CppLink, cpp_link
from tests.support.link_cases import KIT
from tiniscript.bytecode.image import Image, pack, unpack
from tiniscript.library.client import REQUEST_TIMEOUT_MS
from tiniscript.link.connection import EXCHANGE_TIMEOUT_MS, PendingRequest
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import LOST
from tiniscript.link.session import Session
from tiniscript.link.transmission import TRIES
from tools.bench.large_upload import MOVE, Wire

OK, STALE = STATUSES["OK"], STATUSES["STALE"]
STEP_MS = 5
LOOK_MS = 50  # between two checks of a robot that hears nothing


def program(code_bytes: int) -> Image:
    """Return a program of about this many bytes, without an S: a cut frame could otherwise contain
    a stop."""
    moves = b"".join(bytes((MOVE, k % 80, k // 80)) for k in range(code_bytes // 3))
    return unpack(pack("SI", 0, moves))


class SlowLine(NamedTuple):
    """`rate` in bytes per second, `late_ms` each way; `lost` is the share of bytes that are."""

    rate: int
    late_ms: float = 0.0
    loss_rate: float = 0.0


class Talk:
    """A computer and a robot with a line between them. The port reports `baud`, whatever the
    line."""

    def __init__(
        self, line: SlowLine, baud: int = 9600, is_large: bool = False, seed: int = 1
    ) -> None:
        self.line, self.is_large = line, is_large
        self.rng = random.Random(seed)
        self.robot: CppLink = cpp_link(is_large)
        self.robot.begin(room=8192 if is_large else 389, kit=KIT, epoch=9)
        self.session = Session(3, baud, KIT)
        self.to_robot, self.to_computer = (Wire(line.rate * 10, line.late_ms) for _ in range(2))
        self.now_ms = 0
        self.sent_bytes = 0
        self.did: list[str] = []
        self.is_cut = False

    def without_lost(self, data: bytes) -> bytes:
        if self.is_cut:
            return b""
        if not self.line.loss_rate:
            return data
        return bytes(byte for byte in data if self.rng.random() >= self.line.loss_rate)

    def step(self) -> None:
        data = self.session.poll(self.now_ms)
        self.sent_bytes += len(data)
        self.to_robot.send(self.without_lost(data), self.now_ms)
        arrived_bytes = self.to_robot.receive(self.now_ms)
        if arrived_bytes or self.now_ms % LOOK_MS == 0:
            outcome = self.robot.step(self.now_ms, arrived_bytes)
            self.did += outcome.did
            self.to_computer.send(self.without_lost(outcome.sent), self.now_ms)
        self.session.receive(self.to_computer.receive(self.now_ms), self.now_ms)
        self.now_ms += STEP_MS

    def wait(self, request: PendingRequest[Any], limit_ms: int = 600_000) -> int:
        end_ms = self.now_ms + limit_ms
        while request.outcome is None and self.now_ms < end_ms:
            self.step()
        assert request.outcome, "it has no end"
        return request.outcome.status

    def upload(self, code_bytes: int) -> int:
        """Upload a program as a command does; return the status."""
        hello = self.session.hello()
        self.wait(hello)
        assert hello.outcome and hello.outcome.status == OK
        self.sent_bytes = 0
        request = self.session.upload(program(code_bytes), runs=False)
        request.limit_ms = REQUEST_TIMEOUT_MS
        status = self.wait(request)
        if status == OK:
            assert self.robot.fetch_image() == pack("SI", 0, program(code_bytes).code)
        return status


@pytest.mark.parametrize(
    ("code_bytes", "line"),
    [
        (377, SlowLine(100)),
        (387, SlowLine(300, 80)),
        (387, SlowLine(960, 300)),
        (387, SlowLine(960, 20, 0.01)),
        (387, SlowLine(100, 300, 0.005)),
    ],
)
def test_an_upload_that_progresses_is_not_given_up(code_bytes: int, line: SlowLine) -> None:
    for seed in range(5):
        assert Talk(line, seed=seed).upload(code_bytes) == OK, seed


class LossyWire(Wire):
    """Everything sent at once is lost together, at most a given number of times in a row."""

    max_in_a_row = losses = lost_in_a_row = 0
    rng = random.Random()

    def send(self, data: bytes, now_ms: int) -> None:
        is_lost = bool(data) and self.lost_in_a_row < self.max_in_a_row and self.rng.random() < 0.7
        if data:
            self.lost_in_a_row = self.lost_in_a_row + 1 if is_lost else 0
            self.losses += is_lost
        super().send(b"" if is_lost else data, now_ms)


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("in_a_row", [1, 2, 4])
def test_a_long_program_is_not_given_up_for_its_total_losses(in_a_row: int, seed: int) -> None:
    """Each piece that arrives gives the next one the whole patience."""
    line, is_large = SlowLine(11_520, 5), seed % 2 == 1
    talk = Talk(line, 115_200, is_large)
    wire = LossyWire(line.rate * 10, line.late_ms)
    wire.rng = random.Random(seed)
    talk.to_robot = wire
    talk.wait(talk.session.hello())
    wire.max_in_a_row = in_a_row
    max_losses = 0
    for code_bytes in (7000, 7000) if is_large else [380] * 6:
        losses_before = wire.losses
        request = talk.session.upload(program(code_bytes), runs=False)
        request.limit_ms = REQUEST_TIMEOUT_MS
        status = talk.wait(request)
        max_losses = max(max_losses, wire.losses - losses_before)
        assert status == OK, max_losses
    assert max_losses > TRIES or in_a_row == 1 or not is_large, max_losses


@pytest.mark.parametrize("is_large", [False, True])
@pytest.mark.parametrize("cut_ms", [0, 30, 60, 100])
def test_a_stuck_request_is_given_up_and_the_next_succeeds(is_large: bool, cut_ms: int) -> None:
    talk = Talk(SlowLine(1000, 5), 115_200, is_large)
    talk.wait(talk.session.hello())
    for _ in range(3):
        request = talk.session.upload(program(380), runs=False)
        for _ in range(cut_ms // STEP_MS):
            talk.step()
        talk.is_cut = True
        assert talk.wait(request, 60_000) == LOST
        talk.is_cut = False
        assert talk.upload(300) == OK


def test_the_line_is_free_for_a_request_after_an_answer() -> None:
    """No heartbeat comes before that, however long the answer took."""
    talk = Talk(SlowLine(11_520, 1000))
    talk.wait(talk.session.hello())
    for _ in range(5):
        start_ms = talk.now_ms
        talk.wait(talk.session.ping())
        assert talk.now_ms - start_ms < 2200
        talk.step()


@pytest.mark.parametrize("code_bytes", [56, 150, 237])
def test_a_program_that_would_fit_into_one_large_frame_gets_through_a_line_with_losses(
    code_bytes: int,
) -> None:
    for seed in range(20):
        talk = Talk(SlowLine(11_520, 20, 0.01), 115_200, is_large=True, seed=seed)
        assert talk.upload(code_bytes) == OK, seed


@pytest.mark.parametrize("code_bytes", [60, 100, 150])
def test_a_long_live_line_gets_through_a_line_with_losses_and_runs_once(
    code_bytes: int,
) -> None:
    """It cannot come in pieces, so hardly one of its frames comes whole."""
    for seed in range(60):
        talk = Talk(SlowLine(11_520, 20, 0.01), 115_200, is_large=True, seed=seed)
        assert talk.wait(talk.session.hello()) == OK
        assert talk.wait(talk.session.live(program(code_bytes).code, KIT)) == OK, seed
        for _ in range(200):  # bytes under way arrive
            talk.step()
        assert sum(line.startswith("START") for line in talk.did) == 1, seed


@pytest.mark.parametrize("line", [SlowLine(1000), SlowLine(1000, 40), SlowLine(500, 100)])
def test_a_long_live_line_gets_through_a_slow_line_without_many_copies(line: SlowLine) -> None:
    talk = Talk(line, 115_200, is_large=True)
    assert talk.wait(talk.session.hello()) == OK
    talk.sent_bytes = 0
    assert talk.wait(talk.session.live(program(230).code, KIT)) == OK
    assert talk.sent_bytes < 230 * 1.35


@pytest.mark.parametrize(
    "line", [SlowLine(1000), SlowLine(1000, 40), SlowLine(500, 100), SlowLine(11_520, 300)]
)
def test_a_line_slower_than_its_port_gets_few_duplicates(line: SlowLine) -> None:
    """An ESP32 at 115200 baud on a slow link, such as a radio or a broker."""
    talk = Talk(line, 115_200, is_large=True)
    assert talk.upload(1800) == OK
    assert talk.sent_bytes < 1800 * 1.35


@settings(max_examples=60, deadline=None)
@given(
    is_large=st.booleans(),
    rate=st.integers(100, 11_520),
    late_ms=st.integers(0, 500),
    lost=st.floats(0, 0.008),  # more than that may take all tries of a long frame
    code_bytes=st.integers(250, 380),
    seed=st.integers(0, 1000),
)
def test_a_line_that_lets_some_bytes_through_ends_an_upload(
    is_large: bool, rate: int, late_ms: int, lost: float, code_bytes: int, seed: int
) -> None:
    """The robot may also have been stopped: a damaged frame may be a line with a stop."""
    talk = Talk(SlowLine(rate, late_ms, lost), 115_200 if is_large else 9600, is_large, seed)
    status = talk.upload(code_bytes)
    was_stopped = any(event.name == "STOPPED" for event in talk.session.events())
    assert status == OK or (status == STALE and was_stopped)


@pytest.mark.parametrize("is_large", [False, True])
def test_a_line_survives_a_long_interruption_but_not_a_longer_one(is_large: bool) -> None:
    for cut_ms, status in ((EXCHANGE_TIMEOUT_MS - 3000, OK), (EXCHANGE_TIMEOUT_MS + 3000, LOST)):
        talk = Talk(SlowLine(960, 20), is_large=is_large)
        request = talk.session.upload(program(380), runs=False)
        while request.done_bytes == 0:
            talk.step()
        start_ms = talk.now_ms
        talk.is_cut = True
        while talk.now_ms < start_ms + cut_ms and request.outcome is None:
            talk.step()
        assert talk.now_ms <= start_ms + EXCHANGE_TIMEOUT_MS + 1000
        talk.is_cut = False
        assert talk.wait(request) == status


def test_an_answer_that_comes_after_its_piece_was_sent_again_counts() -> None:
    """A line that becomes slow in the middle: little is sent again, and not forever."""
    talk = Talk(SlowLine(11_520), 115_200, is_large=True)
    request = talk.session.upload(program(8000), runs=False)
    while request.done_bytes < 3000:
        talk.step()
    talk.to_robot, talk.to_computer = Wire(10_000, 400), Wire(10_000, 400)
    done_before, talk.sent_bytes = request.done_bytes, 0
    assert talk.wait(request) == OK
    assert talk.sent_bytes < (8000 - done_before) * 1.5
