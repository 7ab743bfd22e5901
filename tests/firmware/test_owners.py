"""The owner of a robot: claims, the teacher's key, forgetting, and other messages of a robot."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

import pytest

from tests.between.lines import Fault, Way
from tests.support.images import image_of
from tests.support.owners import (
    BUTTON_HELD,
    BUTTON_PRESSED,
    BUTTON_RELEASED,
    FOREVER,
    Keys,
    OwnedRobot,
    owner_of,
    robots_of_both_kinds,
    state_of,
)
from tiniscript.link.authority import FREE, OWNED_BY_OTHER, OWNED_BY_YOU, RobotKey
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import (
    AUTHORITY_MS,
    BY_NAME,
    KEY_BYTES,
    KEY_OWNER,
    KEY_TEACHER,
    OWNERS,
    STATE_RUNNING,
    STATUSES,
)
from tiniscript.link.outcomes import UNKEPT, UNPROVEN
from tiniscript.link.session import Session

__all__ = ("robots_of_both_kinds",)  # a fixture


# -- claiming -------------------------------------------------------------------------------------


def test_the_button_confirms_a_claim_and_the_robot_keeps_the_key() -> None:
    table, keys = OwnedRobot(), Keys()
    session = table.claim_session(keys)
    assert [key.is_pending for key in keys.stored_keys] == [False]
    assert owner_of(table, session) == OWNED_BY_YOU
    assert table.try_to_drive(session) == "OK"
    restarted = OwnedRobot(table.robot.memory(), seed=7)
    assert owner_of(restarted, restarted.session()) == OWNED_BY_OTHER
    assert owner_of(restarted, restarted.session(keys, nonce=2)) == OWNED_BY_YOU


def claim_then_press_too_briefly(table: OwnedRobot, session: Session) -> PendingRequest[Any]:
    request = session.claim(KEY_OWNER)
    table.advance_time(session, 300)
    table.hold(session, 1900)
    return request


def press_then_claim(table: OwnedRobot, session: Session) -> PendingRequest[Any]:
    assert table.outcome(session, session.hello()) == "OK"
    table.hold(session, 2500)
    return session.claim(KEY_OWNER)


def claim_then_spikes_on_the_wire(table: OwnedRobot, session: Session) -> PendingRequest[Any]:
    request = session.claim(KEY_OWNER)
    table.advance_time(session, 300)
    for _ in range(40):  # edges down that no press follows
        table.advance_time(session, 1, BUTTON_PRESSED)
        table.advance_time(session, 99)
    return request


@pytest.mark.parametrize(
    "act", [claim_then_press_too_briefly, press_then_claim, claim_then_spikes_on_the_wire]
)
def test_other_button_actions_confirm_no_claim(
    act: Callable[[OwnedRobot, Session], PendingRequest[Any]],
) -> None:
    table, keys = OwnedRobot(), Keys()
    session = table.session(keys)
    assert table.outcome(session, act(table, session)) == "HOLD_BUTTON"
    assert keys.stored_keys == []
    assert owner_of(table, session) == FREE


class Late:
    """A session and its robot, with a line between them on which bytes are late, or is cut."""

    def __init__(self, table: OwnedRobot, session: Session, late_ms: int) -> None:
        self.table, self.session = table, session
        self.ways = [Way(Fault("late", late_ms=late_ms), False, Random(0)) for _ in range(2)]
        self.is_cut = False

    def advance_time(self, milliseconds: int, flags: int = 0) -> None:
        """Let time pass, with a button event at its beginning."""
        robot, (to_robot, to_computer) = self.table.robot, self.ways
        end_ms = robot.now_ms + milliseconds
        while robot.now_ms < end_ms:
            data = self.session.poll(robot.now_ms)
            to_robot.put(b"" if self.is_cut else data, robot.now_ms)
            data = to_robot.take_arrived(robot.now_ms)
            sent_bytes = robot.step(data, flags) if flags else robot.wait(LINE_STEP_MS, data)
            to_computer.put(b"" if self.is_cut else sent_bytes, robot.now_ms)
            self.session.receive(to_computer.take_arrived(robot.now_ms), robot.now_ms)
            flags = 0

    def until(self, request: PendingRequest[Any]) -> None:
        while request.outcome is None:
            self.advance_time(LINE_STEP_MS)


LINE_STEP_MS = 5
WAIT_LIMIT_MS = 30_000  # "tsc waits 30 s"


CLAIM_CASES = ["nothing", "cut", "cut, later not", "held", "held and cut", "taken and cut"]


@pytest.mark.sampled("late_ms")
@pytest.mark.parametrize("late_ms", [0, 40, 300, 700])
@pytest.mark.parametrize("ending", CLAIM_CASES)
def test_a_claim_ends_within_the_documented_time(late_ms: int, ending: str) -> None:
    """However long answers take, and whatever the result of the press. A key that the robot may
    have taken is kept: it is shown the next time."""
    table, keys = OwnedRobot(), Keys()
    session = table.session(keys)
    line = Late(table, session, late_ms)
    began_ms = table.robot.now_ms
    request = session.claim(KEY_OWNER)
    line.is_cut = ending.startswith("cut")
    line.advance_time(WAIT_LIMIT_MS - 6000)
    line.is_cut = ending == "cut"
    if ending[:4] in ("held", "take"):
        line.advance_time(1, BUTTON_PRESSED)
        line.advance_time(30)
        line.advance_time(1970, BUTTON_HELD)
        line.is_cut = ending == "held and cut"
        while (
            ending == "taken and cut" and keys.stored_keys[0].is_pending and request.outcome is None
        ):
            line.advance_time(LINE_STEP_MS)
        line.is_cut |= ending == "taken and cut"
    line.until(request)
    assert table.robot.now_ms <= began_ms + WAIT_LIMIT_MS + 2 * LINE_STEP_MS
    table.robot.step(flags=BUTTON_RELEASED)
    is_taken = owner_of(table, table.session(nonce=8)) != FREE
    assert is_taken or ending not in ("held", "taken and cut")
    assert owner_of(table, table.session(keys, nonce=7)) == (OWNED_BY_YOU if is_taken else FREE)


def test_a_claim_without_frames_expires_and_the_next_one_succeeds() -> None:
    table = OwnedRobot()
    first, second = Keys(1), Keys(50)
    early_session, late_session = table.session(first, nonce=1), table.session(second, nonce=2)
    early_session.claim(KEY_OWNER)
    table.advance_time(early_session, 300)
    table.advance_time(None, 2100)  # out of reach
    table.hold(None, 2500)
    assert owner_of(table, table.session(nonce=5)) == FREE
    early_session.claim(KEY_OWNER)
    table.advance_time(early_session, 300)
    request = late_session.claim(KEY_OWNER)  # its session is alive
    table.advance_time(late_session, 300)
    table.hold(late_session, 2200)
    assert table.outcome(late_session, request) == "OK"
    next_session = table.session(first, nonce=3)
    assert table.outcome(next_session, next_session.claim(KEY_OWNER)) in ("NOT_OWNER", "WRONG_KEY")
    assert table.try_to_drive(table.session(first, nonce=4)) != "OK"
    assert table.try_to_drive(table.session(second, nonce=5)) == "OK"
    stranger = table.session(Keys(99), nonce=9)
    for key_kind in (KEY_OWNER, KEY_TEACHER):
        assert table.claim(stranger, key_kind) == "NOT_OWNER"


@pytest.mark.sampled("cut_ms", keep=9)
@pytest.mark.parametrize("cut_ms", range(1, 260, 7))
def test_a_power_cut_leaves_the_old_or_the_new_key(cut_ms: int) -> None:
    table, keys = OwnedRobot(), Keys()
    session = table.claim_session(keys)
    session.claim(KEY_OWNER)
    table.advance_time(session, 300)
    table.advance_time(session, 1, BUTTON_PRESSED)
    table.advance_time(session, 31)
    table.advance_time(session, 2100, BUTTON_HELD)
    table.advance_time(session, cut_ms)
    restarted = OwnedRobot(table.robot.memory(), seed=cut_ms)
    assert len(keys.stored_keys) in (1, 2)
    assert owner_of(restarted, restarted.session(keys, nonce=77)) == OWNED_BY_YOU


def test_a_claim_with_a_lost_answer_is_settled_by_using_its_key() -> None:
    table, keys = OwnedRobot(), Keys()
    session = table.session(keys)
    for _ in range(7):  # claims that were left before the button was held
        session.claim(KEY_OWNER)
        table.advance_time(session, 300)
        session = table.session(keys, nonce=len(keys.stored_keys) + 1)
    keys_left = list(keys.stored_keys)
    assert len(keys_left) == 7
    session.claim(KEY_OWNER)
    table.advance_time(session, 300)
    table.advance_time(session, 1, BUTTON_PRESSED)
    table.advance_time(session, 30)
    table.advance_time(session, 2100, BUTTON_HELD)
    table.advance_time(session, 400)
    table.robot.step(flags=BUTTON_RELEASED)
    keys.stored_keys = [keys_left[0], keys.stored_keys[-1]._replace(is_pending=True)]
    later_session = table.session(keys, nonce=99)
    assert owner_of(table, later_session) == OWNED_BY_YOU
    assert [(key.key[0], key.is_pending) for key in keys.stored_keys] == [(8, False)]
    stale = Keys()
    stale.stored_keys = keys_left[:2]
    assert owner_of(table, table.session(stale, nonce=100)) == OWNED_BY_OTHER
    assert [(key.is_pending, key.is_stale) for key in stale.stored_keys] == [(True, True)] * 2


def test_a_key_that_one_side_cannot_store_grants_nothing() -> None:
    table, keys = OwnedRobot(), Keys()
    keys.is_full = True
    session = table.session(keys)
    assert table.outcome(session, session.claim(KEY_OWNER)) == str(UNKEPT)
    assert owner_of(table, session) == FREE
    keys.is_full = False
    table.robot.wear_out(536 + 8)  # the first byte of a key
    session = table.session(keys, nonce=2)
    assert table.claim(session) == "NOT_KEPT"
    assert owner_of(table, session) == FREE


def test_a_claim_is_stored_despite_an_unsaved_name_that_stays_reported() -> None:
    table, keys = OwnedRobot(), Keys()
    for place in (4, 4 + 31):  # both slots of the name
        table.robot.wear_out(place + 12)  # the first letter of its name
    session = table.session(keys)
    assert table.outcome(session, session.name(b"NEW")) == "NOT_KEPT"
    table.advance_time(session, 500)  # the robot has tried again
    assert table.claim(session) == "OK"
    assert table.outcome(session, session.name(b"NEW")) == "NOT_KEPT"
    restarted_robot = OwnedRobot(table.robot.memory())
    assert owner_of(restarted_robot, restarted_robot.session()) == OWNED_BY_OTHER


def test_a_name_is_stored_despite_an_unsaved_key() -> None:
    table, keys = OwnedRobot(), Keys()
    session = table.session(keys)
    assert table.outcome(session, session.name(b"NEW")) == "OK"
    table.robot.wear_out(536 + 8)
    assert table.claim(session) == "NOT_KEPT"
    table.advance_time(session, 500)
    assert table.outcome(session, session.name(b"NEW")) == "OK"


@pytest.mark.parametrize("second", [KEY_OWNER, KEY_TEACHER])
@pytest.mark.parametrize("first", [KEY_OWNER, KEY_TEACHER])
@pytest.mark.parametrize("by", ["the same session", "the next one", "one whose answer was lost"])
def test_each_claim_needs_its_own_press(first: int, second: int, by: str) -> None:
    """A confirmed claim does not confirm the next one, whatever its number of requests."""
    table, keys = OwnedRobot(), Keys()
    session = table.claim_session(keys, first)
    if by == "one whose answer was lost":
        session = table.claim_session(keys, first)
    elif by == "the next one":
        session = table.session(keys, nonce=8)
    memory_before = table.robot.memory()
    request = session.claim(second)
    table.advance_time(session, 3000)
    assert request.outcome is None and table.robot.memory() == memory_before
    table.hold(session, 2200)
    assert table.outcome(session, request) == "OK"


@pytest.mark.parametrize("silent_ms", [0, AUTHORITY_MS + 100])
@pytest.mark.parametrize("has_pressed", [False, True])
@pytest.mark.parametrize("key_kind", [KEY_OWNER, KEY_TEACHER])
def test_a_press_for_an_absent_claimant_confirms_nobody_else(
    key_kind: int, has_pressed: bool, silent_ms: int
) -> None:
    """Nor does that client's request turn the next press into another client's."""
    table, keys = OwnedRobot(), Keys()
    first = table.session()
    assert table.outcome(first, first.hello()) == "OK"
    answer = table.ask_unsealed(first, "CLAIM", bytes([key_kind]) + bytes([70] * KEY_BYTES))
    assert answer[0] == STATUSES["HOLD_BUTTON"]
    if has_pressed:
        table.hold(first, 2200)
    table.robot.wait(max(1, silent_ms))
    memory_before = table.robot.memory()
    session = table.session(keys, nonce=8)
    assert table.outcome(session, session.hello()) == "OK"
    if not has_pressed:
        table.hold(session, 2200)  # has no effect
    request = session.claim(key_kind)
    table.advance_time(session, 3000)
    assert request.outcome is None and table.robot.memory() == memory_before
    table.hold(session, 2200)
    assert table.outcome(session, request) == "OK"


def test_a_stale_key_is_tried_at_most_once_at_hello() -> None:
    table, teacher_session, other_keys = OwnedRobot(), Keys(), Keys(70)
    table.claim_session(teacher_session)
    session = table.session(teacher_session, nonce=2)
    assert table.outcome(session, session.disown(KEY_OWNER)) == "OK"
    assert session.robot
    teacher_session.stored_keys = [RobotKey(session.robot.id, KEY_OWNER, bytes([1] * 16), "")]
    table.claim_session(other_keys)
    for nonce in range(10, 30):  # more times than it may be tried
        assert owner_of(table, table.session(teacher_session, nonce=nonce)) == OWNED_BY_OTHER
        assert [key.is_stale for key in teacher_session.stored_keys] == [True]
    assert owner_of(table, table.session(other_keys, nonce=40)) == OWNED_BY_YOU


def test_a_stale_key_that_works_is_no_longer_stale() -> None:
    """Another session may come between challenge and tag."""
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    keys.mark_stale(keys.stored_keys[0])
    session = table.session(keys, nonce=9)
    assert owner_of(table, session) == OWNED_BY_OTHER
    assert table.try_to_drive(session) == "OK"
    assert [key.is_stale for key in keys.stored_keys] == [False]
    assert owner_of(table, table.session(keys, nonce=10)) == OWNED_BY_YOU


# -- the teacher ----------------------------------------------------------------------------------


def test_a_teachers_key_drives_and_releases_a_robot() -> None:
    table, pupil, teacher = OwnedRobot(), Keys(), Keys(90)
    session = table.session(teacher, nonce=2)
    assert table.claim(session, KEY_TEACHER) == "OK"
    assert owner_of(table, session) == FREE
    assert table.claim(table.session(pupil, nonce=3)) == "OK"
    session = table.session(teacher, nonce=4)
    assert table.try_to_drive(session) == "OK"
    session.stop(table.robot.now_ms)
    table.advance_time(session, 100)
    teacher_session = table.session(pupil, nonce=5)
    assert table.outcome(teacher_session, teacher_session.disown(KEY_TEACHER)) == "NOT_OWNER"
    session = table.session(teacher, nonce=6)
    assert table.outcome(session, session.disown(KEY_OWNER)) == "OK"
    assert owner_of(table, table.session(nonce=7)) == FREE


def test_a_teachers_stop_is_released_by_the_teacher_or_the_button() -> None:
    table, pupil, teacher = OwnedRobot(), Keys(), Keys(90)
    table.claim_session(teacher, KEY_TEACHER)
    table.claim_session(pupil)
    teacher_session = table.session(pupil, nonce=5)
    assert table.outcome(teacher_session, teacher_session.upload(image_of("SB|F(200, 40)"))) == "OK"
    session = table.session(teacher, nonce=6)
    assert table.outcome(session, session.hold_back()) == "OK"
    teacher_session = table.session(pupil, nonce=7)
    assert table.outcome(teacher_session, teacher_session.start()) == "HELD_BACK"
    assert table.outcome(teacher_session, teacher_session.clear()) == "HELD_BACK"
    assert table.outcome(teacher_session, teacher_session.allow_text(True)) == "OK"
    table.advance_time(None, 5000)
    assert b"teacher" in table.robot.wait(100, b"SI|F(1, 80)\n")
    assert not [line for line in table.robot.did if "MOTORS" in line]
    session = table.session(teacher, nonce=8)
    assert table.outcome(session, session.clear()) == "OK"
    teacher_session = table.session(pupil, nonce=9)
    assert table.outcome(teacher_session, teacher_session.start()) == "OK"
    session = table.session(teacher, nonce=10)
    assert table.outcome(session, session.hold_back()) == "OK"
    table.hold(None, 200)
    teacher_session = table.session(pupil, nonce=11)
    table.advance_time(teacher_session, 10)
    assert state_of(table, teacher_session) == STATE_RUNNING


@pytest.mark.parametrize("seed", range(8))
def test_a_robot_stays_blocked_by_a_teachers_stop_until_released(seed: int) -> None:
    """This holds for any number of stops, and for any stops, starts and presses in between."""
    rng, table, pupil, teacher = Random(seed), OwnedRobot(), Keys(), Keys(90)
    table.claim_session(teacher, KEY_TEACHER)
    table.claim_session(pupil)
    teacher_session = table.session(pupil, nonce=5)
    assert (
        table.outcome(
            teacher_session, teacher_session.upload(image_of("SB|F(200, 40)"), runs=False)
        )
        == "OK"
    )
    is_held_back = False
    for nonce in range(10, 26):
        act = rng.choice(("holds back", "releases", "stops", "starts", "starts", "presses"))
        session = table.session(teacher if act in ("holds back", "releases") else pupil, nonce)
        if act == "holds back":
            assert table.outcome(session, session.hold_back()) == "OK"
            is_held_back = True
        elif act == "releases":
            assert table.outcome(session, session.clear()) == "OK"
            is_held_back = False
        elif act == "stops":
            session.stop(table.robot.now_ms)
            table.advance_time(session, 100)
        elif act == "presses":
            table.hold(None, 200)
            is_held_back = False
        else:
            expected_text = "HELD_BACK" if is_held_back else "OK"
            assert table.outcome(session, session.clear()) == expected_text
            assert table.outcome(session, session.start()) == expected_text


# -- forgetting, text, identifying -----------------------------------------------------------------


def test_ten_seconds_of_the_button_from_power_on_forget_both_keys() -> None:
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys, KEY_TEACHER)
    table.claim_session(keys)
    table.hold(None, 11_000)
    assert owner_of(table, table.session(keys, nonce=4)) == OWNED_BY_YOU, (
        "later they forget nothing"
    )
    for milliseconds, owner in ((9800, OWNED_BY_YOU), (10_800, FREE)):
        table = OwnedRobot(table.robot.memory(), seed=milliseconds)
        table.advance_time(None, 1, BUTTON_HELD)  # a button that was down before the reset
        table.advance_time(None, milliseconds - 1)
        table.advance_time(None, 1, BUTTON_RELEASED)
        session = table.session(keys)
        # Our own keys still have the old owner until they are forgotten.
        if owner == FREE and table.seals:
            assert table.outcome(session, session.hello()) == str(UNPROVEN)
            session = table.session()
        assert owner_of(table, session) == owner
    other_session = table.session(Keys(200), nonce=3)
    assert table.claim(other_session, KEY_TEACHER) == "OK"


def test_text_drives_an_owned_robot_only_with_permission() -> None:
    """The owner may allow text, or a press of two seconds does until power-off."""
    table, keys = OwnedRobot(), Keys()
    session = table.claim_session(keys)

    def answer(line: bytes = b"SI|F(1, 80)\n") -> bytes:
        table.advance_time(None, 5000)
        return table.robot.wait(200, line)

    assert b"tsc set text on" in answer()
    for is_allowed in (True, False):
        assert table.outcome(session, session.allow_text(is_allowed)) == "OK"
        assert (b"OK" if is_allowed else b"tsc set text on") in answer()
        assert ("MOTORS 80 80" in "".join(table.robot.did)) == is_allowed
        table.robot.did.clear()
    assert table.outcome(session, session.upload(image_of(FOREVER), is_detached=True)) == "OK"
    answer(b"S\n")
    table.robot.wait(1300)
    assert table.robot.is_latched, "S stops it whatever text may do"
    table.hold(None, 2100)
    assert b"OK" in answer()
    table = OwnedRobot(table.robot.memory())
    assert b"tsc set text on" in answer()


def test_a_robot_identifies_itself_but_leaves_the_buzzer_to_a_program() -> None:
    table = OwnedRobot()
    session = table.session()
    assert table.outcome(session, session.identify()) == "OK"
    table.advance_time(session, 3500)
    tune = [line.split()[1:] for line in table.robot.did if "BEEP" in line]
    number = session.robot.id if session.robot else 0
    assert tune == [["BEEP", str(131 * (4 + (number >> 3 * k) % 8)), "200"] for k in range(3)]
    assert not table.robot.is_lit
    table.robot.did.clear()
    assert table.try_to_drive(session) == "OK"
    assert table.outcome(session, session.identify()) == "OK"
    table.advance_time(session, 3500)
    assert not [line for line in table.robot.did if "BEEP" in line]


STEP_MS, STEPS = 250, 12  # pattern of the light
HELD_PROGRAMS = {"nothing": "", "a program for the button": "SB|F(1, 50)", "what it runs": FOREVER}


@pytest.mark.parametrize("held_program", HELD_PROGRAMS)
def test_each_identify_request_shows_the_robot_for_three_seconds(held_program: str) -> None:
    """Also while it still shows itself, or has just done so. Then its light shows the result."""
    table = OwnedRobot()
    robot, session = table.robot, table.session()
    assert table.outcome(session, session.hello()) == "OK"
    if text := HELD_PROGRAMS[held_program]:
        upload = session.upload(image_of(text), saves=False, is_detached=True)
        assert table.outcome(session, upload) == "OK"
    robot.wait(100)
    was_lit_before, number = robot.is_lit, session.robot.id if session.robot else 0
    runs = held_program == "what it runs"
    tune = [] if runs else [131 * (4 + (number >> 3 * k) % 8) for k in range(3)]
    for seq, before_ms in enumerate((1, 249, 251, 700, 2999, 3500)):
        for is_second in (False, True):
            robot.did.clear()
            its_seq = (session._seq + 1 + 2 * seq + is_second) % 256
            frame = Frame(BY_NAME["IDENTIFY"].number, its_seq, session._epoch)
            robot.step(b"\0" + encode_frame(frame))
            began_ms = robot.now_ms
            was_lit = [robot.is_lit]
            for _ in range((before_ms if not is_second else STEPS * STEP_MS + 500) - 1):
                robot.step()
                was_lit.append(robot.is_lit)
        expected = [k // STEP_MS % 2 == 0 for k in range(STEPS * STEP_MS)] + [was_lit_before] * 500
        assert was_lit == expected, before_ms
        beeps = [line.split() for line in robot.did if "BEEP" in line]
        assert beeps == [
            [str(began_ms + k * STEP_MS), "BEEP", str(hertz), "200"] for k, hertz in enumerate(tune)
        ]


def test_a_storm_of_identify_requests_affects_no_run_or_stop() -> None:
    """A stranger may ask as often as the line carries it."""
    table, keys = OwnedRobot(), Keys()
    session = table.claim_session(keys)
    assert table.try_to_drive(session) == "OK"
    table.robot.did.clear()
    number, epoch = BY_NAME["IDENTIFY"].number, session._epoch
    for seq in range(300):
        table.robot.step(b"\0" + encode_frame(Frame(number, seq % 256, epoch)))
        table.advance_time(session, 9)
    assert state_of(table, session) == STATE_RUNNING
    assert not [line for line in table.robot.did if "MOTORS" in line or "BEEP" in line]
    table.robot.step(bytes(4))
    assert table.robot.is_latched


@pytest.mark.sampled(of="other builds of the firmware")
def test_firmware_without_owner_support_announces_this_and_is_free() -> None:
    table = OwnedRobot(defines=("tiniscript_without_owners",))
    session = table.session(Keys())
    assert table.claim(session) == "UNKNOWN_MESSAGE"
    assert session.robot
    assert not session.robot.values.features & OWNERS
    assert table.try_to_drive(session) == "OK"
    for name, payload in (("CLAIM", bytes(17)), ("AUTHENTICATE", b"\0"), ("TEXT", b"\0")):
        assert table.ask_unsealed(session, name, payload)[0] == STATUSES["UNKNOWN_MESSAGE"]
    table.advance_time(None, 5000)
    assert b"OK" in table.robot.wait(200, b"SI|F(1, 80)\n")
