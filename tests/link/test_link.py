"""The link's tables keep their word, and a session its times."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise

import pytest

from tests.machines.link import CppLink, cpp_link, missing
from tests.support.link_cases import KIT, items_of
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import REFUSALS, Image, pack, unpack
from tiniscript.bytecode.verify import RULES
from tiniscript.link import messages, statuses
from tiniscript.link.frames import Frame, decoded, encoded
from tiniscript.link.messages import (
    AGAIN_MS,
    BY_NAME,
    FIRST_ACTING,
    FIRST_EVENT,
    FIRST_STATUS,
    LARGEST,
    LISTEN_MS,
    MESSAGES,
    PAYLOAD_BYTES,
    REPLY,
    RESERVED,
    SEALED,
    STATUSES,
    TETHER_MS,
    TEXT_FROM,
    sizes,
)
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.requests import DATA_BYTES, SHORT_BYTES
from tiniscript.link.session import (
    BEAT_MS,
    CONFIRM_MS,
    DEADLINE_MS,
    IDLE_BEAT_MS,
    STOP_MS,
    Session,
)
from tools.bench import link_size, machine_size

needs_host = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a host machine")
FORWARD = bytes.fromhex("443250")  # F(5,80)


# -- the tables -----------------------------------------------------------------------------------


def test_numbers_are_used_once_and_leave_the_bits_alone() -> None:
    numbers = [each.number for each in MESSAGES] + list(RESERVED)
    assert len(set(numbers)) == len(numbers)
    assert all(0 < number < min(REPLY, SEALED) for number in numbers)
    assert len(set(STATUSES.values())) == len(STATUSES)
    assert all(number >= FIRST_STATUS for name, number in STATUSES.items() if name != "OK")
    lower = [number for number, _ in (*REFUSALS.values(), *RULES.values())]
    assert max(lower) < FIRST_STATUS
    for each in MESSAGES:
        assert each.acts == (FIRST_ACTING <= each.number < FIRST_EVENT)


def test_every_payload_fits_a_frame() -> None:
    for each in MESSAGES:
        assert sizes(each.request)[1] <= PAYLOAD_BYTES, each.name
        assert sizes(each.reply)[1] + (each.number < FIRST_EVENT) <= PAYLOAD_BYTES, each.name
    assert (
        sizes(BY_NAME["PROGRAM"].request)[1] == sizes(BY_NAME["DATA"].request)[1] == PAYLOAD_BYTES
    )
    assert (SHORT_BYTES, DATA_BYTES) == (55, 54)


def test_no_frame_begins_like_text() -> None:
    for seq in range(1, 256):
        longest = Frame(1, seq, 1, b"\1" * PAYLOAD_BYTES)
        assert len(encoded(longest)) == LARGEST + 2
        assert encoded(longest)[0] < TEXT_FROM
        assert decoded(encoded(longest)[:-1]) == longest


def test_a_short_program_takes_few_bytes() -> None:
    compiled = compile_text("SI|F(5,80)", robots.load("tinibot").kit)
    assert compiled.image
    session = greeted()
    session.upload(unpack(compiled.image))
    assert len(session.poll(0)) == 13  # at most 14


def test_each_status_has_its_sentences() -> None:
    assert set(statuses.texts()) == {*STATUSES, "IMAGE", "RULE"}
    for name, words in statuses.texts().items():
        assert {"en", "es"} <= set(words) <= {"en", "es", "en_try", "es_try"}, name
        assert ("en_try" in words) == ("es_try" in words) == (name != "OK"), name
        gaps = {lang: set(re.findall(r"{(\w+)}", words[lang])) for lang in ("en", "es")}
        assert gaps["en"] == gaps["es"], name
        assert bool(gaps["en"]) == (name in {*messages.DETAILS, "IMAGE", "RULE"}), name


@pytest.mark.parametrize("lang", ["en", "es"])
def test_sentences_have_no_gaps_left(lang: str) -> None:
    for status in range(1, 256):
        said, advice = statuses.sentence(status, 0x1234, lang)
        assert said and advice and "{" not in said + advice


def test_some_sentences() -> None:
    assert statuses.sentence(71, 430, "en").said == (
        "The program is too large: the robot has room for 430 bytes of code."
    )
    assert statuses.sentence(23, 5, "en").said == (
        "The robot's verifier refuses the code at 5: BAD_OPERAND."
    )
    assert "DAMAGED" in statuses.sentence(4, 0, "es").said
    assert "0100" not in statuses.sentence(69, 256, "es").said
    assert "1.0" in statuses.sentence(69, 256, "es").said
    assert statuses.sentence(200, 0, "en") == statuses.sentence(64, 0, "en")


# -- the session ----------------------------------------------------------------------------------

DESCRIPTION: dict[str, int | bytes] = {
    "major": 1, "minor": 0, "isa_major": 1, "isa_minor": 0, "kit": KIT, "id": 7, "nonce": 8,
    "largest": 63, "window": 1, "features": 0, "room": 430, "state": 0, "run": 0, "program": 0,
    "length": 0, "slot": 0, "saved": 0, "fault": 0, "fault_at": 0, "fault_program": 0,
    "reset": 1, "name": b"Tini",
}  # fmt: skip


def answer(sent: bytes, values: dict[str, int | bytes], status: int = 0, epoch: int = 10) -> bytes:
    """Return a robot's answer to what a session has sent."""
    frame = decoded(sent.strip(b"\0"))
    assert frame
    payload = bytes((status, 0, 0))
    if not status:
        payload = b"\0" + messages.written(messages.BY_NUMBER[frame.number].reply, values)
    return encoded(Frame(frame.number, frame.seq, epoch, payload, is_reply=True))


def event(name: str, seq: int, values: dict[str, int | bytes], epoch: int = 11) -> bytes:
    message = BY_NAME[name]
    payload = messages.written(message.reply, values)
    return encoded(Frame(message.number, seq, epoch, payload, is_reply=True))


def greeted(baud: int = 9600, now_ms: int = 0) -> Session:
    """Return a session that has said HELLO."""
    session = Session(1, baud, KIT)
    session.hello()
    session.receive(answer(session.poll(now_ms), {**DESCRIPTION}), now_ms)
    assert session.robot and session.robot.name == "Tini" and session.robot.room == 430
    return session


def receipt(run: int, code: bytes = FORWARD) -> dict[str, int | bytes]:
    checksum = unpack(pack("SI", 0, code)).checksum
    return {"program": checksum, "run": run, "slot": 0, "saved": 1}


def sending(session: Session, until_ms: int) -> list[tuple[int, bytes]]:
    """Return what a session sends when it is woken exactly when it wants to be."""
    found = []
    while (at := session.wakes_at()) is not None and at <= until_ms:
        data = session.poll(at)
        if data:
            found.append((at, data))
        assert session.wakes_at() != at or session.wakes_at() is None, (
            "it wants to be woken at once"
        )
    return found


@pytest.mark.parametrize(("baud", "first"), [(9600, 200), (57600, 134), (115200, 127)])
def test_times_of_retries_come_from_the_baud_rate(baud: int, first: int) -> None:
    session = greeted(baud)
    session.is_attached = False
    task = session.live(FORWARD)
    session.poll(0)
    sent = sending(session, DEADLINE_MS)
    times = [at for at, _ in sent]
    # a byte more, the 0x00 before, from the second one on is no matter
    assert abs(times[0] - first) <= 2
    gaps = [later - earlier for earlier, later in pairwise(times)]
    for k, gap in enumerate(gaps[:5]):
        assert abs(gap - times[0] - 80 * (k + 1)) <= 2
    assert set(gaps[5:]) == {gaps[5]}
    assert len({data for _, data in sent}) == 1 and sent[0][1][:1] == b"\0"
    assert len(sent) + 1 <= 30
    sending(session, 2 * DEADLINE_MS)
    assert task.outcome and task.outcome.status == LOST


def test_a_session_that_waits_for_nothing_sleeps() -> None:
    assert Session(1).wakes_at() is None
    session = greeted()
    session.is_attached = False
    assert session.wakes_at() is None


def test_the_heartbeat() -> None:
    session = greeted()
    assert session.wakes_at() == IDLE_BEAT_MS
    session.live(FORWARD)
    session.receive(answer(session.poll(5), receipt(1)), 5)
    assert session.is_running and session.wakes_at() == 5 + BEAT_MS
    data = session.poll(5 + BEAT_MS)
    assert len(data) == 9
    session.receive(answer(data, {"state": 1, "run": 1}), 300)
    assert session.wakes_at() == 5 + 2 * BEAT_MS


def test_a_robot_that_is_silent_is_lost() -> None:
    session = greeted()
    sent = sending(session, 10_000)
    assert [each.name for each in session.events()] == ["LOST"]
    assert all(IDLE_BEAT_MS <= at < IDLE_BEAT_MS + 3000 for at, _ in sent)
    assert session.wakes_at() is None
    task = session.live(FORWARD)  # begins with HELLO again
    frame = decoded(session.poll(10_000).strip(b"\0"))
    assert frame and frame.number == BY_NAME["HELLO"].number and not task.outcome


def test_a_stop_cuts_everything_short() -> None:
    session = greeted()
    tasks = [session.live(FORWARD), session.fetch()]
    session.poll(0)
    session.stop(3)
    assert [task.outcome.status for task in tasks if task.outcome] == [CANCELLED, CANCELLED]
    assert sending(session, 250) == [(3, bytes(8)), (103, bytes(8)), (203, bytes(8))]
    session.receive(event("STOPPED", 0, {"cause": 1}), 260)
    assert [each.name for each in session.events()] == ["STOPPED"]
    assert session.is_latched and sending(session, 500) == []


def test_a_stop_that_nobody_answers_is_told() -> None:
    session = greeted()
    session.stop(0)
    sent = sending(session, 2 * DEADLINE_MS)
    assert len(sent) == CONFIRM_MS // STOP_MS
    assert [each.name for each in session.events()] == ["LOST"]


def test_a_stop_that_nobody_answers_holds_up_others_for_a_few_seconds() -> None:
    session = greeted()
    session.stop(0)
    early = session.ping()
    sending(session, CONFIRM_MS)
    assert early.outcome and early.outcome.status == LOST
    late = session.ping()
    data = session.poll(CONFIRM_MS + 1)
    session.receive(answer(data, {"state": 0, "run": 0}), CONFIRM_MS + 2)
    assert late.outcome and late.outcome.status == 0


def test_what_came_before_a_stop_was_sent_confirms_nothing() -> None:
    """The robot may have been started again since."""
    session = greeted()
    session.stop(3)
    session.receive(event("STOPPED", 0, {"cause": 3}), 3)
    assert session.poll(3) == bytes(8)
    session.events()
    session.receive(event("STOPPED", 1, {"cause": 1}, epoch=12), 30)
    assert [each.name for each in session.events()] == ["STOPPED"]
    assert sending(session, 500) == []


def test_a_stop_that_is_confirmed_twice_ends_nothing_that_is_wanted_since() -> None:
    """The radio was slow: two stop sequences were sent before the first was confirmed."""
    session = greeted()
    session.stop(0)
    assert len(sending(session, 150)) == 2
    session.receive(event("STOPPED", 0, {"cause": 1}), 160)
    assert [each.name for each in session.events()] == ["STOPPED"]
    tasks = [session.clear(), session.live(FORWARD)]
    session.poll(170)
    session.receive(event("STOPPED", 1, {"cause": 1}), 180)
    assert session.events() == []
    assert [task.outcome for task in tasks] == [None, None]
    session.stop(200)
    session.poll(200)
    session.receive(event("STOPPED", 2, {"cause": 1}), 300)
    assert [each.name for each in session.events()] == ["STOPPED"]
    session.receive(event("STOPPED", 3, {"cause": 1}, epoch=12), 400)
    assert [each.name for each in session.events()] == ["STOPPED"]


def test_an_old_answer_is_none() -> None:
    session = greeted()
    first = session.live(FORWARD)
    data = session.poll(0)
    session.receive(answer(data, receipt(1)), 10)
    assert first.outcome
    second = session.live(FORWARD)
    session.poll(20)
    session.receive(answer(data, receipt(1)), 30)
    assert second.outcome is None


def test_a_program_that_is_done_before_its_receipt_does_not_run() -> None:
    session = greeted()
    session.live(FORWARD)
    data = session.poll(0)
    session.receive(event("DONE", 0, {"run": 1}, epoch=10), 10)
    session.receive(answer(data, receipt(1)), 20)
    assert not session.is_running


def test_text_and_echoes_are_told() -> None:
    session = greeted()
    session.receive(b"OK+LOST\r\n\0" + encoded(Frame(2, 1, 1)), 5)
    found = session.events()
    assert [each.name for each in found] == ["TEXT", "ECHO"]
    assert found[0].values == {"text": b"OK+LOST"}


def test_what_a_newer_robot_sends_is_no_harm() -> None:
    session = greeted()
    for frame in (Frame(40, 0, 10, b"new", is_reply=True), Frame(35, 1, 10, b"", is_reply=True)):
        session.receive(encoded(frame), 5)
    task = session.ping()
    data = session.poll(6)
    sent = decoded(data.strip(b"\0"))
    assert sent
    session.receive(encoded(Frame(2, sent.seq, 10, b"", is_reply=True)), 7)
    session.receive(encoded(Frame(2, sent.seq, 10, b"\0\1\1\1\1", is_reply=True)), 7)
    assert task.outcome is None and session.damaged == 3
    session.receive(answer(data, {"state": 0, "run": 0}), 8)
    assert task.outcome


def test_what_does_not_fit_is_not_sent() -> None:
    image = unpack(pack("SI", 0, FORWARD))
    cases: list[tuple[Image, int, int]] = [
        (image._replace(kit=1), STATUSES["WRONG_KIT"], KIT),
        (image._replace(isa=(2, 0)), STATUSES["OTHER_MACHINE"], 256),
        (image._replace(isa=(1, 1)), STATUSES["OTHER_MACHINE"], 256),
        (image._replace(code=bytes(431)), STATUSES["TOO_LARGE"], 430),
    ]
    session = greeted()
    for each, status, detail in cases:
        task = session.upload(each)
        assert session.poll(0) == b""
        assert task.outcome and (task.outcome.status, task.outcome.detail) == (status, detail)
    task = session.live(bytes(SHORT_BYTES + 1))
    assert session.poll(0) == b""
    assert task.outcome and task.outcome.status == STATUSES["TOO_LARGE"]


def test_a_receipt_for_another_program_is_no_success() -> None:
    session = greeted()
    task = session.upload(unpack(pack("SI", 0, FORWARD)))
    session.receive(answer(session.poll(0), {**receipt(1), "program": 1}), 5)
    assert task.outcome and task.outcome.status != 0


def test_a_program_of_an_older_instruction_set_says_so() -> None:
    """In one frame it could not: HELLO has named the one of our compiler."""
    session = Session(1, kit=KIT, isa=(1, 1))
    session.hello()
    session.receive(answer(session.poll(0), {**DESCRIPTION, "isa_minor": 1}), 0)
    session.upload(unpack(pack("SI", 0, FORWARD)))
    frame = decoded(session.poll(0).strip(b"\0"))
    assert frame and frame.number == BY_NAME["BEGIN"].number


def test_a_busy_robot_is_asked_again_but_not_for_ever() -> None:
    session = greeted()
    task = session.upload(unpack(pack("SI", 0, FORWARD)))
    now_ms = 0
    while task.outcome is None and now_ms < 3 * DEADLINE_MS:
        data = session.poll(now_ms)
        if data:
            session.receive(answer(data, {}, STATUSES["BUSY"]), now_ms)
        now_ms += 10
    assert task.outcome and task.outcome.status == STATUSES["BUSY"], "it answers: it is not lost"
    assert now_ms <= DEADLINE_MS + 1000


def test_a_robot_that_was_busy_and_then_falls_silent_is_lost() -> None:
    session = greeted()
    task = session.upload(unpack(pack("SI", 0, FORWARD)))
    now_ms = 0
    while task.outcome is None and now_ms < 3 * DEADLINE_MS:
        data = session.poll(now_ms)
        if data and now_ms < 1000:
            session.receive(answer(data, {}, STATUSES["BUSY"]), now_ms)
        now_ms += 10
    assert task.outcome and task.outcome.status == LOST


def test_a_stop_between_makes_what_waits_stale() -> None:
    """The answer bears another epoch: what was wanted before is not wanted any more."""
    session = Session(1, kit=KIT)
    tasks = [session.hello(), session.live(FORWARD), session.live(FORWARD)]
    session.receive(answer(session.poll(0), DESCRIPTION), 0)
    assert tasks[1].outcome is None  # HELLO begins an epoch, it ends none
    session.receive(answer(session.poll(1), receipt(1), epoch=11), 1)
    assert tasks[1].outcome and tasks[1].outcome.status == 0
    assert tasks[2].outcome and tasks[2].outcome.status == STATUSES["STALE"]


# -- the robot's times ----------------------------------------------------------------------------


def cpp_items(stream: list[tuple[int, int]]) -> list[str]:
    return cpp_link().items(stream)


def robot_with_session() -> CppLink:
    cpp = cpp_link()
    cpp.begin(kit=KIT)
    hello = {"major": 1, "minor": 0, "isa_major": 1, "isa_minor": 0, "kit": KIT, "nonce": 3}
    cpp.step(0, encoded(Frame(1, 1, 0, messages.written(BY_NAME["HELLO"].request, hello))))
    return cpp


def ends_at(cpp: CppLink, from_ms: int, until_ms: int) -> int | None:
    """Return when a fault ends the program, looking every 5 ms."""
    for now_ms in range(from_ms, until_ms, 5):
        if "FAULT 64" in cpp.step(now_ms).did:
            return now_ms
    return None


@needs_host
@pytest.mark.parametrize("start", [0, 0xFFFFFFFF - 2000])
def test_a_tethered_program_ends_a_second_after_the_last_valid_frame(start: int) -> None:
    cpp = robot_with_session()
    live = messages.written(BY_NAME["LIVE"].request, {"mode": 0x10, "code": FORWARD})
    cpp.step(start, encoded(Frame(8, 2, 10, live)))
    cpp.step(start + 700, encoded(Frame(2, 3, 10)))
    cpp.step(start + 900, encoded(Frame(2, 4, 10))[:-2] + b"\1\0")  # damaged: does not count
    assert ends_at(cpp, start + 900, start + 2000) == start + 700 + TETHER_MS


@needs_host
@pytest.mark.parametrize("name", ["PROGRAM", "START"])
def test_a_detached_program_goes_on(name: str) -> None:
    cpp = robot_with_session()
    mode = 0x50 if name == "PROGRAM" else 0x40
    program = messages.written(
        BY_NAME["PROGRAM"].request, {"mode": mode & 0x70 if mode & 0x10 else 0, "code": FORWARD}
    )
    cpp.step(10, encoded(Frame(9, 2, 10, program)))
    if name == "START":
        cpp.step(20, encoded(Frame(7, 3, 10, bytes([mode]))))
    assert ends_at(cpp, 20, 5000) is None


@needs_host
def test_a_long_silence_is_no_short_one() -> None:
    """Times are 16 bits: after a minute a robot still knows that it has heard nothing."""
    cpp = robot_with_session()
    for now_ms in range(0, 200_000, 500):
        sent = cpp.step(now_ms).sent
        assert cpp.happens("s", 1) and (not sent or now_ms < LISTEN_MS + 1000), now_ms


@needs_host
def test_what_the_button_has_started_is_not_tethered() -> None:
    cpp = robot_with_session()
    live = messages.written(BY_NAME["LIVE"].request, {"mode": 0x10, "code": FORWARD})
    cpp.step(10, encoded(Frame(8, 2, 10, live)))
    cpp.happens("b")
    cpp.step(20)
    cpp.happens("r")
    assert ends_at(cpp, 30, 5000) is None


@pytest.mark.parametrize("find", [items_of, pytest.param(cpp_items, marks=needs_host)])
def test_what_is_counted_does_not_wrap(find: Callable[[list[tuple[int, int]]], list[str]]) -> None:
    """A line that is broken for long stops a robot all the time; a long text is no short one."""
    assert find([(0, 0)] * 1402) == [*["stop"] * 350, "damaged 0, dropped 0"]
    assert find([(0, byte) for byte in b"A" * 300 + b"\n"])[0].startswith("text 255 41 41")


@needs_host
def test_a_line_that_is_held_low_neither_runs_the_epoch_round_nor_fills_the_line_back() -> None:
    cpp = robot_with_session()
    sent = b"".join(cpp.step(now_ms, b"\0").sent for now_ms in range(10, 70_010))
    told = [decoded(part) for part in sent.split(b"\0") if part]
    assert {each.epoch for each in told if each} == {11}
    assert {each.number for each in told if each} == {BY_NAME["STOPPED"].number}
    assert 1000 < len(told) <= 70_000 // AGAIN_MS + 1, len(told)


@needs_host
def test_many_stops_that_nobody_has_looked_at_are_not_none() -> None:
    cpp = robot_with_session()
    for count in (1, 255, 256, 257, 512):
        assert "STOP" in cpp.step(10, bytes(4 * count), is_late=True).did


@needs_host
@pytest.mark.parametrize("late_ms", [0, 300, 1500, 2900, 4000])
@pytest.mark.parametrize(("piece_bytes", "gap_ms"), [(99, 0), (10, 0), (7, 1100), (45, 1100)])
@pytest.mark.parametrize("before", [b"", b"> "], ids=["plain", "prompt"])
def test_an_echo_of_everything_starts_no_endless_conversation(
    late_ms: int, piece_bytes: int, gap_ms: int, before: bytes
) -> None:
    """A terminal or a radio module that sends back what it gets, whole and in pieces."""
    cpp = cpp_link()
    cpp.begin(kit=KIT)
    under_way = [(0, b"F(2,80)\r\n")]
    hints = 0
    for now_ms in range(0, 60_000, 10):
        came = b"".join(data for at, data in under_way if at == now_ms)
        under_way = [each for each in under_way if each[0] > now_ms]
        sent = cpp.step(now_ms, came).sent.replace(b"\0", b"")
        hints += sent.count(b"use tsc.")
        echo = before + sent if sent else b""
        for k in range(-(-len(echo) // piece_bytes)):
            piece = echo[k * piece_bytes : (k + 1) * piece_bytes]
            under_way.append((now_ms + 10 + late_ms + k * gap_ms, piece))
    assert hints == 1


@needs_host
def test_a_module_that_answers_each_line_gets_few_hints() -> None:
    cpp = cpp_link()
    cpp.begin(kit=KIT)
    hints = [cpp.step(now_ms, b"ERROR:(0)\r\n").sent for now_ms in range(0, 60_000, 500)]
    assert sum(bool(each) for each in hints) == 1


@needs_host
def test_a_slow_line_back_costs_no_answer() -> None:
    """What comes before the last answer could be sent waits."""
    cpp = robot_with_session()
    data = b"".join(encoded(Frame(2, seq, 10)) for seq in (2, 3, 4))
    sent = cpp.step(10, data, is_slow=True).sent
    frames = [decoded(part) for part in sent.split(b"\0") if part]
    assert [frame.seq for frame in frames if frame] == [2, 3, 4]


@needs_host
def test_a_robot_tells_only_who_listens() -> None:
    cpp = cpp_link()
    cpp.begin(kit=KIT)
    assert cpp.happens("s", 1) and not cpp.step(0).sent  # nobody has said HELLO
    cpp = robot_with_session()
    assert cpp.happens("s", 1)
    assert not cpp.happens("s", 2)  # the last one is not sent yet: it comes again
    assert cpp.step(LISTEN_MS - 1).sent
    cpp.step(LISTEN_MS)
    assert cpp.happens("s", 3) and cpp.happens("s", 3)
    cpp.happens("d")
    assert not cpp.step(LISTEN_MS + 5).sent
    cpp.happens("b")
    assert cpp.step(LISTEN_MS + 10).sent  # that it was stopped it always tells


@pytest.mark.skipif(
    bool(machine_size.missing(machine_size.AVR)), reason=machine_size.missing(machine_size.AVR)
)
def test_the_link_keeps_to_its_size() -> None:
    """What it takes beside the machine on an ATmega328P, with the flags of Arduino."""
    found = link_size.size()
    assert 2000 < found.flash <= link_size.MUST
    assert 150 < found.ram <= 245
