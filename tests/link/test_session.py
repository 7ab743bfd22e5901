"""The computer's session: retries, waits, the heartbeat, the stop, and a robot's answers."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.link_cases import KIT
from tests.support.session_frames import DESCRIPTION, FORWARD, answer, event, greet, receipt
from tests.support.session_resets import running
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import Image, pack, unpack
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.bytecode.verify import RULES
from tiniscript.link import messages
from tiniscript.link.connection import (
    EXCHANGE_TIMEOUT_MS,
    LinkConnection,
    PendingRequest,
    reason_of,
)
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    PLACES,
    STATE_FAULTED,
    STATE_IDLE,
    STATE_RUNNING,
    STATE_STOPPED,
    STATUSES,
)
from tiniscript.link.outcomes import CANCELLED, DETAIL_MIDWAY, LOST, PlaceEvent, TextEvent
from tiniscript.link.payloads import DoneEvent, ReceiptReply
from tiniscript.link.requests import SHORT_BYTES
from tiniscript.link.round_trips import MAX_DOUBLED_MS, MAX_RETRY_MS
from tiniscript.link.session import IDLE_HEARTBEAT_MS, Session
from tiniscript.link.transmission import CONFIRM_MS, STOP_MS, TRIES

ROBOT = robots.load("tinibot")
NO_CONNECTION = LinkConnection()
LOW_SUPPLY, SAVING = STATUSES["LOW_SUPPLY"], STATUSES["SAVING"]


def list_packets(session: Session, until_ms: int) -> list[tuple[int, bytes]]:
    """Return a session's output if it is woken exactly when it requested."""
    packets = []
    while (poll_ms := session.next_wake_ms()) is not None and poll_ms <= until_ms:
        data = session.poll(poll_ms)
        if data:
            packets.append((poll_ms, data))
        assert session.next_wake_ms() != poll_ms or session.next_wake_ms() is None, (
            "it wants to be woken at once"
        )
    return packets


@pytest.mark.parametrize(("baud", "first_wait_ms"), [(9600, 200), (57600, 134), (115200, 127)])
def test_a_retry_waits_for_the_line_and_then_twice_as_long_up_to_a_second(
    baud: int, first_wait_ms: int
) -> None:
    session = greet(baud)
    session.is_attached = False
    request = session.live(FORWARD)
    session.poll(0)
    packets = list_packets(session, EXCHANGE_TIMEOUT_MS)
    times = [sent_ms for sent_ms, _ in packets]
    # a byte more, the 0x00 before, from the second one on is no matter
    assert abs(times[0] - first_wait_ms) <= 2
    gaps = [later_ms - earlier_ms for earlier_ms, later_ms in pairwise(times)]
    doubled = [min(times[0] << k, MAX_DOUBLED_MS) for k in range(1, len(gaps) + 1)]
    assert all(
        abs(gap - expected_gap) <= 2 for gap, expected_gap in zip(gaps, doubled, strict=True)
    )
    assert len({data for _, data in packets}) == 1 and packets[0][1][:1] == b"\0"
    assert 20 <= len(packets) + 1 <= TRIES
    list_packets(session, 2 * EXCHANGE_TIMEOUT_MS)
    assert request.outcome and request.outcome.status == LOST
    assert session.next_wake_ms() is None


def test_a_retry_learns_how_long_an_answer_takes() -> None:
    """The timeout is four variations above the mean, as in RFC 6298; an answer to a repetition does
    not reveal its own time, and the doubled timer stays."""
    session = greet(115_200)
    session.is_attached = False
    now_ms = 0

    def measure_waits(answer_delay_ms: int) -> list[int]:
        """Ask, and be answered; return how long after each sending the next one came."""
        nonlocal now_ms
        session.ping()
        start_ms = now_ms
        data = session.poll(now_ms)
        times = [
            sent_ms - start_ms for sent_ms, _ in list_packets(session, start_ms + answer_delay_ms)
        ]
        now_ms = start_ms + answer_delay_ms
        session.receive(answer(data, {"state": 0, "run": 0, "place": b""}), now_ms)
        return [later_ms - earlier_ms for earlier_ms, later_ms in pairwise([0, *times])]

    assert measure_waits(600) == [127, 254]  # and 508, which is not over
    assert measure_waits(500) == []  # it stays, and this one is certain: 500 and 4 * 250
    silent_ping = session.ping()
    session.poll(now_ms)
    first_wait_ms = list_packets(session, now_ms + 2000)[0][0] - now_ms
    assert silent_ping.outcome is None
    # HELLO's round trip took no time: a mean of 500 / 8, a variation of 500 / 4
    assert first_wait_ms == pytest.approx(500 / 8 + 4 * 500 / 4, abs=80)


def test_requests_are_retried_before_the_dead_man_timer_ends_a_program() -> None:
    """However long its answers have taken."""
    session = greet(115_200)
    live_request = session.live(FORWARD)
    session.receive(answer(session.poll(0), receipt(1)), 0)
    assert live_request.outcome and session.is_running
    for _ in range(3):
        start_ms = session.next_wake_ms()
        assert start_ms is not None
        data = session.poll(start_ms)
        late_ms = start_ms + 900
        gaps = [
            b - a
            for a, b in pairwise(
                [start_ms, *(sent_ms for sent_ms, _ in list_packets(session, late_ms))]
            )
        ]
        assert gaps and max(gaps) <= MAX_RETRY_MS < messages.DEAD_MAN_MS / 2
        session.receive(answer(data, {"state": 1, "run": 1, "place": b""}), late_ms)


def test_a_stop_preempts_everything() -> None:
    session = greet()
    requests: list[PendingRequest[Any]] = [session.live(FORWARD), session.fetch()]
    session.poll(0)
    session.stop(3)
    assert all(request.outcome and request.outcome.status == CANCELLED for request in requests)
    assert list_packets(session, 250) == [(3, bytes(8)), (103, bytes(8)), (203, bytes(8))]
    session.receive(event("STOPPED", 0, {"cause": 1}), 260)
    assert [event.name for event in session.events()] == ["STOPPED"]
    assert session.is_latched and list_packets(session, 500) == []


def test_an_unanswered_stop_is_reported_and_delays_others_for_a_few_seconds() -> None:
    session = greet()
    session.stop(0)
    early_request = session.ping()
    assert len(list_packets(session, CONFIRM_MS)) == CONFIRM_MS // STOP_MS
    assert [event.name for event in session.events()] == ["LOST"]
    assert early_request.outcome and early_request.outcome.status == LOST
    late_request = session.ping()
    data = session.poll(CONFIRM_MS + 1)
    session.receive(answer(data, {"state": 0, "run": 0}), CONFIRM_MS + 2)
    assert late_request.outcome and late_request.outcome.status == 0


def test_messages_before_a_stop_was_sent_do_not_confirm_it() -> None:
    """The robot may have been started again since."""
    session = greet()
    session.stop(3)
    session.receive(event("STOPPED", 0, {"cause": 3}), 3)
    assert session.poll(3) == bytes(8)
    session.events()
    session.receive(event("STOPPED", 1, {"cause": 1}, epoch=12), 30)
    assert [event.name for event in session.events()] == ["STOPPED"]
    assert list_packets(session, 500) == []


@pytest.mark.parametrize("cause", [2, 3, 4, 5])
def test_an_earlier_stop_does_not_confirm_a_later_one(cause: int) -> None:
    """Its STOPPED was under way; the robot may have been started again since."""
    session = greet()
    session.stop(0)
    assert session.poll(0) == bytes(8)
    session.receive(event("STOPPED", 0, {"cause": cause}), 30)
    assert session.events() == [] and session.is_latched
    assert list_packets(session, 150) == [(100, bytes(8))]  # the program continues
    session.receive(event("STOPPED", 1, {"cause": 1}, epoch=12), 160)
    assert [event.name for event in session.events()] == ["STOPPED"]
    assert list_packets(session, 500) == []


@pytest.mark.parametrize("cause", [3, 5])
def test_a_robot_stopped_by_another_client_confirms_in_its_epoch(cause: int) -> None:
    """It reports the first cause each time; the session may know of that stop, or not yet."""
    for is_known in (True, False):
        session = greet() if is_known else Session(1, kit=KIT)
        if is_known:
            session.receive(event("STOPPED", 0, {"cause": cause}), 0)
            session.events()
        session.stop(10)
        for number, poll_ms in ((1, 10), (2, 110)):
            assert session.poll(poll_ms) == bytes(8)
            assert session.events() == []
            session.receive(event("STOPPED", number, {"cause": cause}), poll_ms + 20)
            if is_known:
                break
        assert [event.name for event in session.events()] == ["STOPPED"]
        assert list_packets(session, 500) == []


def test_a_move_after_another_stop_does_not_go_unseen() -> None:
    """The button stops, then starts; the stop that was sent meanwhile is lost once."""
    session, robot = running()
    stopped_event = robot.step(flags=1) + robot.wait(60)  # stopped, and STOPPED is under way
    robot.step(flags=2)
    other_session = Session(2, 9600, KIT)
    assert robot.until(other_session, other_session.clear()) == 0
    assert (
        robot.until(other_session, other_session.live(compile_text("F(200, 80)", ROBOT.kit).code))
        == 0
    )
    session.stop(robot.now_ms)
    assert session.poll(robot.now_ms)  # no client hears it
    session.receive(stopped_event, robot.now_ms)
    assert session.events() == []
    robot.talk(session, 500)
    assert [event.name for event in session.events()][-1:] == ["STOPPED"]
    assert robot.is_latched


def test_possibly_executed_requests_are_not_reported_as_void_after_a_stop() -> None:
    """The frame that does it is under way. Requests that were not sent, or were refused, have no
    effect."""
    session = greet()
    live_request, start_request = session.live(FORWARD), session.start()
    session.poll(0)
    session.stop(5)
    assert [
        reason_of(NO_CONNECTION, it.outcome) for it in (live_request, start_request) if it.outcome
    ] == [
        "stopped_midway",
        "stopped_elsewhere",
    ]
    for is_cleared in (False, True):  # the latch has to be released before the program
        session = greet()
        session.receive(event("STOPPED", 0, {"cause": 3}), 0)
        session.hello()
        session.receive(
            answer(session.poll(0), {**DESCRIPTION, "state": STATE_STOPPED}, epoch=11), 0
        )
        live_request = session.live(FORWARD)
        clear = session.poll(10)
        if is_cleared:
            session.receive(answer(clear, {}, epoch=11), 20)
        session.poll(20)
        session.stop(25)
        assert live_request.outcome and live_request.outcome.detail == (
            DETAIL_MIDWAY if is_cleared else 0
        )
    session = greet()
    live_request = session.live(FORWARD)
    session.receive(answer(session.poll(0), {}, status=STATUSES["BUSY"]), 5)
    session.stop(10)
    assert live_request.outcome and live_request.outcome.detail == 0


def test_one_stop_is_reported_once_however_late_its_answers_come() -> None:
    """51 of them were stalled; the stop was given up meanwhile. A later stop has another epoch."""
    session = greet()
    session.stop(100)
    list_packets(session, 8000)
    assert [event.name for event in session.events()] == ["LOST"] and not session.is_open
    for seq in range(51):
        session.receive(event("STOPPED", seq, {"cause": 1}), 8000 + seq)
    assert [event.name for event in session.events()] == ["STOPPED"]
    session.receive(event("STOPPED", 51, {"cause": 3}, epoch=12), 9000)
    session.receive(event("STOPPED", 52, {"cause": 3}, epoch=12), 9050)
    assert [event.name for event in session.events()] == ["STOPPED"]


def test_a_late_answer_to_a_stop_ends_no_later_run() -> None:
    session = greet()
    session.stop(0)
    session.poll(0)
    session.receive(event("STOPPED", 0, {"cause": 1}), 20)
    live_request = session.live(FORWARD)
    now_ms = 20
    while live_request.outcome is None:
        now_ms += 5
        data = session.poll(now_ms)
        frame = decode_frame(data.strip(b"\0")) if data else None
        if frame is not None:
            values = receipt(1) if frame.number == BY_NAME["LIVE"].number else {}
            session.receive(answer(data, values, epoch=11), now_ms)
    session.events()
    session.receive(event("STOPPED", 1, {"cause": 1}), now_ms)
    assert session.events() == [] and session.is_running
    session.receive(event("STOPPED", 2, {"cause": 3}, epoch=12), now_ms)
    assert [event.name for event in session.events()] == ["STOPPED"] and not session.is_running


def test_a_reset_robot_may_be_stopped_in_the_previous_epoch() -> None:
    session = greet()
    session.receive(event("STOPPED", 0, {"cause": 3}), 20)
    session.events()
    session.hello()
    session.receive(answer(session.poll(30), {**DESCRIPTION, "nonce": 9}, epoch=11), 30)
    session.receive(event("STOPPED", 0, {"cause": 3}), 40)
    assert [event.name for event in session.events()] == ["STOPPED"]


def test_a_second_confirmation_of_a_stop_ends_no_later_request() -> None:
    """The radio was slow: two stop sequences were sent before the first was confirmed."""
    session = greet()
    session.stop(0)
    assert len(list_packets(session, 150)) == 2
    session.receive(event("STOPPED", 0, {"cause": 1}), 160)
    assert [event.name for event in session.events()] == ["STOPPED"]
    requests: list[PendingRequest[Any]] = [session.clear(), session.live(FORWARD)]
    session.poll(170)
    session.receive(event("STOPPED", 1, {"cause": 1}), 180)
    assert session.events() == []
    assert [request.outcome for request in requests] == [None, None]
    session.stop(200)
    session.poll(200)
    session.receive(event("STOPPED", 2, {"cause": 1}), 300)
    assert [event.name for event in session.events()] == ["STOPPED"]
    session.receive(event("STOPPED", 3, {"cause": 1}, epoch=12), 400)
    assert [event.name for event in session.events()] == ["STOPPED"]


def test_an_old_answer_is_ignored() -> None:
    session = greet()
    old_request = session.live(FORWARD)
    data = session.poll(0)
    session.receive(answer(data, receipt(1)), 10)
    assert old_request.outcome
    second_request = session.live(FORWARD)
    session.poll(20)
    session.receive(answer(data, receipt(1)), 30)
    assert second_request.outcome is None


def test_a_program_that_ends_before_its_receipt_is_not_running() -> None:
    session = greet()
    session.live(FORWARD)
    data = session.poll(0)
    session.receive(event("DONE", 0, {"run": 1}, epoch=10), 10)
    session.receive(answer(data, receipt(1)), 20)
    assert not session.is_running


def test_text_and_echoes_are_reported() -> None:
    session = greet()
    session.receive(b"OK+LOST\r\n\0" + encode_frame(Frame(2, 1, 1)), 5)
    events = session.events()
    assert [event.name for event in events] == ["TEXT", "ECHO"]
    assert events[0] == TextEvent(b"OK+LOST")


def test_messages_of_a_newer_robot_do_no_harm() -> None:
    session = greet()
    for frame in (Frame(40, 0, 10, b"new", is_reply=True), Frame(35, 1, 10, b"", is_reply=True)):
        session.receive(b"\0" + encode_frame(frame), 5)
    request = session.ping()
    data = session.poll(6)
    sent_frame = decode_frame(data.strip(b"\0"))
    assert sent_frame
    session.receive(encode_frame(Frame(2, sent_frame.seq, 10, b"", is_reply=True)), 7)
    session.receive(
        encode_frame(Frame(2, sent_frame.seq, 10, b"\0\1\1" + bytes(7), is_reply=True)), 7
    )
    assert request.outcome is None and session.damaged == 3
    session.receive(answer(data, {"state": 0, "run": 0}), 8)
    assert request.outcome


ISA = 256 * ISA_MAJOR + ISA_MINOR  # the robot's rule, as in a detail


def test_programs_that_do_not_fit_are_not_sent() -> None:
    image = unpack(pack("SI", 0, FORWARD))
    cases: list[tuple[Image, int, int]] = [
        (image._replace(isa=(ISA_MAJOR - 1, 0)), STATUSES["OTHER_MACHINE"], ISA),
        (image._replace(isa=(ISA_MAJOR, ISA_MINOR + 1)), STATUSES["OTHER_MACHINE"], ISA),
        (image._replace(code=bytes(390)), STATUSES["TOO_LARGE"], 389),
        (image._replace(code=bytes(389), later_fields=b"x"), STATUSES["TOO_LARGE"], 389),
    ]
    session = greet()
    for large_image, status, detail in cases:
        request = session.upload(large_image)
        assert session.poll(0) == b""
        assert request.outcome
        assert (request.outcome.status, request.outcome.detail) == (status, detail)
    request = session.live(bytes(SHORT_BYTES + 1))
    assert session.poll(0) == b""
    assert request.outcome and request.outcome.status == STATUSES["TOO_LARGE"]


Request = PendingRequest[ReceiptReply]


def upload_image(image: Image, kit: int | None, is_refused: int = 0) -> tuple[list[str], Request]:
    """Return a session's output for the upload of an image, and the request; the robot accepts all
    of it."""
    session = greet()
    request = session.upload(image, kit=kit)
    names: list[str] = []
    next_at = now_ms = 0
    while request.outcome is None:
        now_ms += 1000
        data = session.poll(now_ms)
        frame = decode_frame(data.strip(b"\0"))
        assert frame
        names.append(BY_NUMBER[frame.number].name)
        values: dict[str, int | bytes] = {}
        if names[-1] == "DATA":
            next_at = len(frame.payload) - 2
        if names[-1] in ("BEGIN", "DATA"):
            values = {"next": next_at}
        elif names[-1] == "HELLO":
            values = DESCRIPTION
        else:
            values = {"program": image.checksum, "run": 1, "slot": 0, "saved": 1}
        status = is_refused if names[-1] == "COMMIT" else 0
        session.receive(answer(data, values, status), now_ms)
    return names, request


def test_code_with_devices_is_sent_with_its_header_to_a_different_kit() -> None:
    """A frame alone does not name the devices: the robot compares them."""
    portable, bound = unpack(pack("SI", 0, FORWARD)), unpack(pack("SI", 7, b"\x38\x02"))
    extended = unpack(pack("SI", 0, FORWARD, b"later"))
    in_pieces = ["BEGIN", "DATA", "COMMIT"]
    for image, kit, expected in (
        (portable, KIT ^ 1, ["PROGRAM"]), (bound, KIT, ["PROGRAM"]), (bound, None, ["PROGRAM"]),
        (bound, KIT ^ 1, in_pieces), (bound, 0, in_pieces), (extended, KIT, in_pieces),
    ):  # fmt: skip
        names, request = upload_image(image, kit)
        assert names == expected
        assert request.outcome and request.outcome.status == 0
    for refused_status in (STATUSES["WRONG_KIT"], RULES["NO_SUCH_DEVICE"][0]):
        _, request = upload_image(bound, KIT ^ 1, refused_status)
        assert request.outcome and request.outcome.status == STATUSES["WRONG_KIT"]


def test_a_receipt_for_another_program_is_not_success() -> None:
    session = greet()
    request = session.upload(unpack(pack("SI", 0, FORWARD)))
    session.receive(answer(session.poll(0), {**receipt(1), "program": 1}), 5)
    assert request.outcome and request.outcome.status != 0


def test_a_program_of_an_older_instruction_set_is_reported() -> None:
    """In one frame it could not: HELLO has named the one of our compiler."""
    session = Session(1, kit=KIT, isa=(ISA_MAJOR, ISA_MINOR + 1))
    session.hello()
    session.receive(answer(session.poll(0), {**DESCRIPTION, "isa_minor": ISA_MINOR + 1}), 0)
    session.upload(unpack(pack("SI", 0, FORWARD)))
    frame = decode_frame(session.poll(0).strip(b"\0"))
    assert frame and frame.number == BY_NAME["BEGIN"].number


@pytest.mark.parametrize(
    ("minor", "version"),
    [
        (ISA_MINOR - 1, (STATUSES["OTHER_MACHINE"], ISA - 1)),
        (ISA_MINOR, (RULES["UNKNOWN_OPCODE"][0], 0)),
    ],
)
def test_a_line_unknown_to_an_older_machine_is_refused(
    minor: int, version: tuple[int, int]
) -> None:
    """LIVE names no version: the robot says only that it has no such instruction."""
    session = Session(1, kit=KIT)
    session.hello()
    session.receive(answer(session.poll(0), {**DESCRIPTION, "isa_minor": minor}), 0)
    request = session.live(compile_text("TASK;END_TASK", robots.load("tinibot32").kit).code)
    session.receive(answer(session.poll(0), {}, RULES["UNKNOWN_OPCODE"][0]), 5)
    assert request.outcome and (request.outcome.status, request.outcome.detail) == version


@pytest.mark.parametrize(("busy_ms", "expected_status"), [(60_000, STATUSES["BUSY"]), (1000, LOST)])
def test_a_busy_robot_is_retried_for_a_limited_time(busy_ms: int, expected_status: int) -> None:
    """One that answers is not lost; one that falls silent then is."""
    session = greet()
    request = session.upload(unpack(pack("SI", 0, FORWARD)))
    now_ms = 0
    while request.outcome is None and now_ms < 3 * EXCHANGE_TIMEOUT_MS:
        data = session.poll(now_ms)
        if data and now_ms < busy_ms:
            session.receive(answer(data, {}, STATUSES["BUSY"]), now_ms)
        now_ms += 10
    assert request.outcome and request.outcome.status == expected_status
    assert now_ms <= EXCHANGE_TIMEOUT_MS + 1000


@pytest.mark.parametrize(
    ("epoch", "values", "is_void"),
    [
        (11, {"state": STATE_STOPPED}, True),
        (11, {"state": STATE_IDLE}, True),  # a stop, and its latch was released
        (11, {"state": STATE_FAULTED}, False),
        (12, {"state": STATE_FAULTED}, True),  # more than a fault
        (11, {"state": STATE_IDLE, "nonce": 9}, False),  # a reset
        (11, {"state": STATE_RUNNING, "nonce": 9}, False),
        (11, {"state": STATE_STOPPED, "nonce": 9}, True),
    ],
)
def test_hello_decides_whether_a_new_epoch_voids_waiting_requests(
    epoch: int, values: dict[str, int], is_void: bool
) -> None:
    """The answer has another epoch, which was not announced."""
    session = Session(1, kit=KIT)
    session.hello()
    first_request, second_request = session.live(FORWARD), session.live(FORWARD)
    session.receive(answer(session.poll(0), DESCRIPTION), 0)
    assert first_request.outcome is None  # HELLO begins an epoch, and does not end one
    session.receive(answer(session.poll(1), receipt(1), epoch=epoch), 1)
    assert first_request.outcome and first_request.outcome.status == 0
    assert second_request.outcome is None
    session.receive(answer(session.poll(2), {**DESCRIPTION, **values}, epoch=epoch), 2)
    assert (second_request.outcome is not None) == is_void
    assert second_request.outcome is None or second_request.outcome.status == STATUSES["STALE"]


def time_lost_ms(session: Session, now_ms: int = 0) -> int:
    """Leave all frames unanswered, and check every millisecond; return when the robot is given
    up."""
    for time_ms in range(now_ms, now_ms + 10_000):
        session.poll(time_ms)
        if [event.name for event in session.events()] == ["LOST"]:
            return time_ms
    raise AssertionError("it waits for ever")


def session_after_run() -> tuple[Session, int]:
    """Return a session whose heartbeat has just said that its run is over, and the time."""
    session = greet()
    session.live(FORWARD)
    session.receive(answer(session.poll(0), receipt(1)), 0)
    poll_ms = session.next_wake_ms()
    assert poll_ms is not None
    session.receive(answer(session.poll(poll_ms), {"state": 0, "run": 1}), poll_ms)
    return session, poll_ms


def test_heartbeats_and_run_end_queries_time_out_after_three_seconds() -> None:
    assert 3000 <= time_lost_ms(greet()) - IDLE_HEARTBEAT_MS < 3500  # the end of a try
    session, poll_ms = session_after_run()
    assert session.poll(poll_ms), "it asks how the run has ended"
    assert 3000 <= time_lost_ms(session, poll_ms) - poll_ms < 3500


IDLE_STATUS: dict[str, int | bytes] = {
    "state": 0, "run": 1, "program": 0, "length": 0, "slot": 0, "saved": 0, "fault": 0,
    "fault_at": 0, "fault_program": 0, "damaged": 0, "dropped": 0, "framing": 0, "overrun": 0,
    "noise": b"",
}  # fmt: skip


@pytest.mark.parametrize("is_event_first", [True, False])
def test_the_end_of_a_run_is_reported_once(is_event_first: bool) -> None:
    """A heartbeat's reply may report it in the same moment as its event."""
    session, poll_ms = session_after_run()
    frames = [answer(session.poll(poll_ms), IDLE_STATUS),
              event("DONE", 0, {"run": 1}, epoch=10)]  # fmt: skip
    for frame in reversed(frames) if is_event_first else frames:
        session.receive(frame, poll_ms)
    assert [event.name for event in session.events()] == ["DONE"]


@pytest.mark.parametrize("reading_count", [0, 3, 12, 10_000])
def test_the_end_of_a_run_waits_for_its_readings_and_nobody_else_does(reading_count: int) -> None:
    """Its event is lost; a robot that sends readings endlessly still obeys requests."""
    session, poll_ms = session_after_run()
    values: dict[str, int | bytes] = {"run": 1, "sensor": 0, "value": 7, "ms": 0}
    sent_reading_count, request = 0, session.name(b"Ana")
    for _ in range(100):
        poll_ms += 20
        data = session.poll(poll_ms)
        if sent_reading_count < reading_count:
            session.receive(event("READING", sent_reading_count, values, epoch=10), poll_ms)
            sent_reading_count += 1
        if data:
            frame = decode_frame(data.strip(b"\0"))
            assert frame
            asked_for = messages.BY_NUMBER[frame.number].reply
            reply = {field.name: IDLE_STATUS.get(field.name, b"") for field in asked_for}
            session.receive(answer(data, reply), poll_ms)
    assert request.outcome and request.outcome.status == 0
    names = [event.name for event in session.events()]
    assert names == ["READING"] * sent_reading_count + ["DONE"] * (
        sent_reading_count == reading_count
    )


def test_an_upload_waiting_for_the_button_reports_the_end_of_the_previous_run() -> None:
    """The upload ended that run, and no event of it is reported after the button's run."""
    robot = HostFirmware(ROBOT.kit)
    robot.wait(200)
    session = Session(1, kit=KIT)
    forever = compile_text("F(200, 80)", ROBOT.kit).code
    assert robot.until(session, session.live(forever)) == 0
    show_program = unpack(compile_text("SHOW(1)", ROBOT.kit).image or b"")
    assert robot.until(session, session.upload(show_program, runs=False, saves=False)) == 0
    assert session.events() == [DoneEvent(1)]
    assert not session.is_running
    robot.talk(session, 100, flags=1)
    robot.talk(session, 1500, flags=2)
    assert [event.name for event in session.events()] == ["SHOW", "DONE"]


def count_namings(statuses: list[int]) -> tuple[int, int]:
    """Name a robot that answers with these statuses, the last one forever; return how many
    times it is asked, and how that ends."""
    session = greet()
    request = session.name(b"Ana")
    times = now_ms = 0
    while request.outcome is None and now_ms < 60_000:
        data = session.poll(now_ms)
        if data:
            session.receive(answer(data, {}, statuses[min(times, len(statuses) - 1)]), now_ms)
            times += 1
        now_ms += 10
    assert request.outcome
    return times, request.outcome.status


@pytest.mark.parametrize(
    ("statuses", "times", "expected_status"),
    [
        ([LOW_SUPPLY], 1 + 4, LOW_SUPPLY),
        ([SAVING], 1 + 12, SAVING),
        # a voltage that was enough in between is waited for anew
        (
            [LOW_SUPPLY, LOW_SUPPLY, LOW_SUPPLY, LOW_SUPPLY, SAVING, LOW_SUPPLY],
            1 + 4 + 4,
            LOW_SUPPLY,
        ),
    ],
)
def test_a_low_voltage_has_a_shorter_timeout(
    statuses: list[int], times: int, expected_status: int
) -> None:
    assert count_namings(statuses) == (times, expected_status)


def reported_places(*replies: bytes) -> list[tuple[int, int]]:
    """Return the runs and places that a session tells when its heartbeats get these replies."""
    session = greet(features=PLACES)
    session.tells_places = True
    now_ms = 10
    for payload in replies:
        now_ms += 1000
        sent_frame = decode_frame(session.poll(now_ms).strip(b"\0"))
        assert sent_frame and sent_frame.number == 2 and sent_frame.payload == b"\1"
        reply = Frame(2, sent_frame.seq, 10, b"\0" + payload, is_reply=True)
        session.receive(b"\0" + encode_frame(reply), now_ms + 1)
    return [
        (place_event.run, place_event.offset)
        for place_event in session.events()
        if isinstance(place_event, PlaceEvent)
    ]


def test_a_place_is_reported_when_it_changes() -> None:
    place, other_place = b"\3\0abcd", b"\3\0abce"
    assert reported_places(b"\1\1" + place, b"\1\1" + place, b"\0\1") == [(1, 3), (1, -1)]
    places = reported_places(b"\1\1" + place, b"\1\2" + place, b"\1\2" + other_place)
    assert places == [(1, 3), (2, 3), (2, 3)]


def test_a_truncated_place_or_one_of_another_run_is_ignored() -> None:
    assert reported_places(b"\1\1", b"\1\1abc", b"\0\1\3\0abcd", b"\2\1\3\0abcd") == []
    assert reported_places(b"\1\1\xff\xffabcd") == [(1, 0xFFFF)]
