"""Whose robot it is: claims, keys and what a stranger may do, in the robot's own firmware."""

from __future__ import annotations

import random
from typing import Any

import pytest

from tests.machines.host_firmware import missing
from tests.support.owners import FOREVER, HELD, PRESSED, RELEASED, Keys, Owned, image_of
from tiniscript.link.authority import FREE, OF_ANOTHER, YOUR_OWN, whose
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, decoded, encoded
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    FIRST_EVENT,
    KEY_OWNER,
    KEY_TEACHER,
    OWNERS,
    STATE_IDLE,
    STATE_RUNNING,
    STATE_STOPPED,
    STATUSES,
)
from tiniscript.link.outcomes import UNKEPT
from tiniscript.link.session import Session

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")

OPEN_TO_ALL = {"HELLO", "PING", "STATUS", "STOP", "IDENTIFY"}


def owner_of(table: Owned, session: Session) -> str:
    assert table.outcome(session, session.hello()) == "OK"
    assert session.robot
    return whose(session.robot)


def state_of(table: Owned, session: Session) -> int:
    request = session.status()
    assert table.outcome(session, request) == "OK"
    assert request.outcome
    return request.outcome.values.state


# -- claiming -------------------------------------------------------------------------------------


def test_a_robot_without_an_owner_is_free() -> None:
    table = Owned()
    session = table.session(Keys())
    assert owner_of(table, session) == FREE
    assert table.tries(session) == "OK"


def test_the_button_confirms_a_claim_and_the_robot_keeps_the_key() -> None:
    table, keys = Owned(), Keys()
    session = table.claimed(keys)
    assert [key.is_pending for key in keys.found] == [False]
    assert owner_of(table, session) == YOUR_OWN
    assert table.tries(session) == "OK"
    later = Owned(table.robot.memory(), seed=7)
    assert owner_of(later, later.session()) == OF_ANOTHER
    assert owner_of(later, later.session(keys, nonce=2)) == YOUR_OWN


@pytest.mark.parametrize("press_ms", [200, 1000, 1900])
def test_a_shorter_press_confirms_nothing(press_ms: int) -> None:
    table, keys = Owned(), Keys()
    session = table.session(keys)
    request = session.claim(KEY_OWNER)
    table.pass_time(session, 300)
    table.hold(session, press_ms)
    assert table.outcome(session, request) == "HOLD_BUTTON"
    assert keys.found == []
    assert owner_of(table, session) == FREE


def test_a_press_before_the_claim_confirms_nothing() -> None:
    table, keys = Owned(), Keys()
    session = table.session(keys)
    assert table.outcome(session, session.hello()) == "OK"
    table.hold(session, 2500)
    assert table.outcome(session, session.claim(KEY_OWNER)) == "HOLD_BUTTON"


def test_spikes_on_the_buttons_wire_confirm_nothing() -> None:
    table, keys = Owned(), Keys()
    session = table.session(keys)
    request = session.claim(KEY_OWNER)
    table.pass_time(session, 300)
    for _ in range(40):  # edges down that no press follows
        table.pass_time(session, 1, PRESSED)
        table.pass_time(session, 99)
    assert table.outcome(session, request) == "HOLD_BUTTON"


def test_a_claim_lapses_where_no_frame_comes() -> None:
    table, keys = Owned(), Keys()
    session = table.session(keys)
    session.claim(KEY_OWNER)
    table.pass_time(session, 300)
    table.pass_time(None, 2100)  # out of reach
    table.hold(None, 2500)
    other = table.session(keys, nonce=5)
    assert table.outcome(other, other.claim(KEY_OWNER)) == "HOLD_BUTTON"


def test_of_two_computers_the_one_whose_session_lives_gets_the_robot() -> None:
    table = Owned()
    first, second = Keys(1), Keys(50)
    early, late = table.session(first, nonce=1), table.session(second, nonce=2)
    early.claim(KEY_OWNER)
    table.pass_time(early, 300)
    request = late.claim(KEY_OWNER)
    table.pass_time(late, 300)
    table.hold(late, 2200)
    assert table.outcome(late, request) == "OK"
    again = table.session(first, nonce=3)
    assert table.outcome(again, again.claim(KEY_OWNER)) in ("NOT_OWNER", "WRONG_KEY")
    assert table.tries(table.session(first, nonce=4)) != "OK"
    assert table.tries(table.session(second, nonce=5)) == "OK"


def test_a_claimed_robot_is_claimed_by_nobody_else_with_the_button() -> None:
    table = Owned()
    table.claimed(Keys())
    stranger = table.session(Keys(99), nonce=9)
    assert table.claim(stranger) == "NOT_OWNER"
    assert table.claim(stranger, KEY_TEACHER) == "NOT_OWNER"


def test_a_key_that_this_computer_cannot_keep_is_not_given_to_the_robot() -> None:
    table, keys = Owned(), Keys()
    keys.is_full = True
    session = table.session(keys)
    assert table.outcome(session, session.claim(KEY_OWNER)) == str(UNKEPT)
    assert owner_of(table, session) == FREE


@pytest.mark.parametrize("cut_ms", range(1, 260, 7))
def test_a_pulled_plug_leaves_the_old_key_or_the_new_one(cut_ms: int) -> None:
    table, keys = Owned(), Keys()
    session = table.claimed(keys)
    session.claim(KEY_OWNER)
    table.pass_time(session, 300)
    table.pass_time(session, 1, PRESSED)
    table.pass_time(session, 31)
    table.pass_time(session, 2100, HELD)
    table.pass_time(session, cut_ms)
    later = Owned(table.robot.memory(), seed=cut_ms)
    assert len(keys.found) in (1, 2)
    assert owner_of(later, later.session(keys, nonce=77)) == YOUR_OWN


def test_a_claim_whose_answer_is_lost_is_settled_when_its_key_is_shown() -> None:
    table, keys = Owned(), Keys()
    session = table.session(keys)
    for _ in range(7):  # claims that were left before the button was held
        session.claim(KEY_OWNER)
        table.pass_time(session, 300)
        session = table.session(keys, nonce=len(keys.found) + 1)
    left = list(keys.found)
    assert len(left) == 7
    session.claim(KEY_OWNER)
    table.pass_time(session, 300)
    table.pass_time(session, 1, PRESSED)
    table.pass_time(session, 30)
    table.pass_time(session, 2100, HELD)
    table.pass_time(session, 400)
    table.robot.step(flags=RELEASED)
    keys.found = [left[0], keys.found[-1]._replace(is_pending=True)]
    later = table.session(keys, nonce=99)
    assert owner_of(table, later) == YOUR_OWN
    assert [(key.key[0], key.is_pending) for key in keys.found] == [(8, False)]
    stale = Keys()
    stale.found = left[:2]
    assert owner_of(table, table.session(stale, nonce=100)) == OF_ANOTHER
    assert stale.found == []


def test_a_worn_memory_is_told() -> None:
    table, keys = Owned(), Keys()
    table.robot.wear_out(536 + 8)  # the first byte of a key
    session = table.session(keys)
    assert table.claim(session) == "NOT_KEPT"
    assert owner_of(table, session) == FREE


# -- what a stranger may do ------------------------------------------------------------------------


def test_a_stranger_looks_and_stops_and_nothing_else() -> None:
    table, keys = Owned(), Keys()
    owner = table.claimed(keys)
    assert table.tries(owner) == "OK"
    stranger = table.session(nonce=3)
    assert owner_of(table, stranger) == OF_ANOTHER
    for is_open in (stranger.ping(), stranger.identify()):
        assert table.outcome(stranger, is_open) == "OK"
    assert state_of(table, stranger) == STATE_RUNNING
    closed: list[PendingRequest[Any]] = [
        stranger.clear(),
        stranger.start(),
        stranger.live(image_of("F(1, 80)").code),
        stranger.upload(image_of(FOREVER)),
        stranger.upload(image_of("SHOW(1); " * 40)),
        stranger.name(b"Mine"),
        stranger.trim(),
        stranger.trim(b"\0\0\0"),
        stranger.fetch(),
        stranger.allow_text(True),
    ]
    for request in closed:
        assert table.outcome(stranger, request) == "NOT_OWNER"
    stranger.stop(table.robot.now_ms)
    table.pass_time(stranger, 50)
    assert state_of(table, stranger) == STATE_STOPPED
    assert table.robot.is_latched
    assert table.outcome(stranger, stranger.clear()) == "NOT_OWNER"


def test_every_request_has_a_side() -> None:
    """Whatever acts and is not listed here needs authority."""
    table, keys = Owned(), Keys()
    table.claimed(keys)
    stranger = table.session(nonce=3)
    assert owner_of(table, stranger) == OF_ANOTHER
    for message in BY_NAME.values():
        if message.number >= 32 or message.name in OPEN_TO_ALL | {"CLAIM", "AUTHENTICATE"}:
            continue
        payload = bytes(sum(field.low for field in message.request))
        stranger._seq = (stranger._seq + 1) & 0xFF
        frame = Frame(message.number, stranger._seq, stranger._epoch, payload)
        sent = table.robot.wait(20, b"\0" + encoded(frame)).strip(b"\0")
        answer = decoded(sent)
        assert answer, message.name
        assert answer.payload[0] == STATUSES["NOT_OWNER"], message.name


def test_a_long_press_starts_nothing_and_a_short_one_does() -> None:
    table = Owned()
    session = table.session(Keys())
    assert table.outcome(session, session.upload(image_of("SB|F(1, 80)"))) == "OK"
    table.pass_time(session, 2000)
    table.hold(session, 1010)
    table.pass_time(session, 100)
    assert state_of(table, session) == STATE_IDLE
    table.hold(session, 900)
    table.pass_time(session, 100)
    assert state_of(table, session) == STATE_RUNNING


# -- authority ------------------------------------------------------------------------------------


def test_authority_lapses_and_is_shown_again() -> None:
    table, keys = Owned(), Keys()
    session = table.claimed(keys)
    kept, session._handshake._keys = session._handshake._keys, None  # it cannot show a key now
    table.pass_time(None, 1900)
    assert table.outcome(session, session.trim()) == "OK"
    table.pass_time(None, 2050)
    assert table.outcome(session, session.trim()) == "NOT_OWNER"
    session._handshake._keys = kept
    assert table.outcome(session, session.trim()) == "OK"  # it shows the key by itself


def test_a_recorded_session_opens_nothing() -> None:
    table, keys = Owned(), Keys()
    session = table.claimed(keys)
    recorded: list[bytes] = []
    again = table.session(keys, nonce=4)
    request = again.upload(image_of("SI|F(1, 80)"))
    while request.outcome is None:
        data = again.poll(table.robot.now_ms)
        recorded.append(data)
        again.receive(table.robot.step(data), table.robot.now_ms)
    assert request.outcome.status == 0
    table.pass_time(None, 4000)
    del session
    table.robot.did.clear()
    for _ in range(300):  # the epoch goes around
        for data in recorded:
            table.robot.wait(3, data)
    assert not [line for line in table.robot.did if "MOTORS" in line]


def test_a_recorded_tag_opens_nothing_in_its_own_epoch() -> None:
    table, keys = Owned(), Keys()
    table.claimed(keys)
    owner = table.session(keys, nonce=4)
    recorded: list[Frame] = []
    request = owner.hello()
    while request.outcome is None:
        data = owner.poll(table.robot.now_ms)
        frame = decoded(data.strip(b"\0")) if data else None
        recorded += [frame] if frame is not None else []
        owner.receive(table.robot.step(data), table.robot.now_ms)
    (shown,) = (each for each in recorded if len(each.payload) == 9)
    assert table.outcome(owner, owner.trim()) == "OK"

    def answers(thief: Session, tag: bytes) -> int:
        thief._seq = (thief._seq + 1) & 0xFF
        frame = Frame(shown.number, thief._seq, thief._epoch, shown.payload[:1] + tag)
        answer = decoded(table.robot.wait(20, b"\0" + encoded(frame)).strip(b"\0"))
        assert answer
        return answer.payload[0]

    assert answers(owner, shown.payload[1:]) == STATUSES["NOT_OWNER"]  # twice to one challenge
    table.pass_time(None, 2100)
    assert answers(owner, shown.payload[1:]) == STATUSES["NOT_OWNER"]  # without a challenge
    assert answers(owner, b"") == 0
    assert answers(owner, shown.payload[1:]) == STATUSES["WRONG_KEY"]  # to another challenge
    for count in range(300):
        thief = table.session(nonce=4 if count % 2 else 9)
        assert table.outcome(thief, thief.hello()) == "OK"
        if thief._epoch == shown.epoch and count % 2:
            break
        if thief._epoch == (shown.epoch - 1) & 0xFF and not count % 2:
            continue
        if (thief._epoch - shown.epoch) % 2 == count % 2:  # so that both come together
            table.robot.wait(100, bytes(8))
    assert thief._epoch == shown.epoch
    assert answers(thief, b"") == 0
    assert answers(thief, shown.payload[1:]) == STATUSES["WRONG_KEY"]


def test_wrong_keys_are_tried_five_times() -> None:
    table, keys = Owned(), Keys()
    table.claimed(keys)
    wrong = Keys()
    wrong.found = [keys.found[0]._replace(key=bytes([200] * 16))]
    thief = table.session(wrong, nonce=8)
    assert owner_of(table, thief) == OF_ANOTHER
    for _ in range(3):
        assert table.outcome(thief, thief.start()) == "WRONG_KEY"
    request = thief.start()
    assert table.outcome(thief, request) == "WRONG_KEY"
    request = thief.start()
    assert table.outcome(thief, request) == "TOO_MANY_TRIES"
    assert request.outcome
    assert 25 <= request.outcome.detail <= 30
    owner = table.session(keys, nonce=9)
    assert table.outcome(owner, owner.start()) == "TOO_MANY_TRIES"
    table.pass_time(None, 30_000)
    assert table.tries(owner) == "OK"


def test_a_right_key_begins_the_count_of_wrong_ones_anew() -> None:
    table, keys = Owned(), Keys()
    table.claimed(keys)
    wrong = Keys()
    wrong.found = [keys.found[0]._replace(key=bytes([200] * 16))]
    for count in range(3):
        thief = table.session(wrong, nonce=10 + count)
        for _ in range(3):
            assert table.outcome(thief, thief.start()) in ("WRONG_KEY", "NOT_OWNER")
        owner = table.session(keys, nonce=20 + count)
        assert table.outcome(owner, owner.trim()) == "OK"


def test_the_same_seed_after_a_reset_is_another_challenge_or_needs_the_key() -> None:
    """Two robots with one memory and one nonce: what one was shown opens the other at no time."""
    table, keys = Owned(), Keys()
    table.claimed(keys)
    memory = table.robot.memory()
    challenges = set()
    for seed in range(12):
        later = Owned(memory, seed=seed)
        session = later.session(keys, nonce=4)
        asked: list[bytes] = []
        request = session.hello()
        while request.outcome is None:
            sent = later.robot.step(session.poll(later.robot.now_ms))
            asked.append(sent)
            session.receive(sent, later.robot.now_ms)
        reply = max(asked, key=len)
        challenges.add(b"".join(asked).replace(reply, b""))
    assert len(challenges) == 12


def test_forged_and_reordered_frames_drive_nothing(frames: int = 3000) -> None:
    """As `python -m tests.firmware.test_owners 100000`, which does more of the same."""
    assert forged(frames, 1) == 0


# -- the teacher ----------------------------------------------------------------------------------


def test_a_teachers_key_drives_and_gives_a_robot_back() -> None:
    table, pupil, teacher = Owned(), Keys(), Keys(90)
    session = table.session(teacher, nonce=2)
    assert table.claim(session, KEY_TEACHER) == "OK"
    assert owner_of(table, session) == FREE
    assert table.claim(table.session(pupil, nonce=3)) == "OK"
    session = table.session(teacher, nonce=4)
    assert table.tries(session) == "OK"
    session.stop(table.robot.now_ms)
    table.pass_time(session, 100)
    mine = table.session(pupil, nonce=5)
    assert table.outcome(mine, mine.disown(KEY_TEACHER)) == "NOT_OWNER"
    session = table.session(teacher, nonce=6)
    assert table.outcome(session, session.disown(KEY_OWNER)) == "OK"
    assert owner_of(table, table.session(nonce=7)) == FREE


def test_a_teachers_stop_is_released_by_the_teacher_or_the_button() -> None:
    table, pupil, teacher = Owned(), Keys(), Keys(90)
    table.claimed(teacher, KEY_TEACHER)
    table.claimed(pupil)
    mine = table.session(pupil, nonce=5)
    assert table.outcome(mine, mine.upload(image_of("SB|F(200, 40)"))) == "OK"
    session = table.session(teacher, nonce=6)
    assert table.outcome(session, session.hold_back()) == "OK"
    mine = table.session(pupil, nonce=7)
    assert table.outcome(mine, mine.start()) == "HELD_BACK"
    assert table.outcome(mine, mine.clear()) == "HELD_BACK"
    session = table.session(teacher, nonce=8)
    assert table.outcome(session, session.clear()) == "OK"
    mine = table.session(pupil, nonce=9)
    assert table.outcome(mine, mine.start()) == "OK"
    session = table.session(teacher, nonce=10)
    assert table.outcome(session, session.hold_back()) == "OK"
    table.hold(None, 200)
    mine = table.session(pupil, nonce=11)
    table.pass_time(mine, 10)
    assert state_of(table, mine) == STATE_RUNNING


def test_a_teachers_stop_is_not_released_by_text() -> None:
    table, teacher = Owned(), Keys(90)
    session = table.claimed(teacher, KEY_TEACHER)
    assert table.outcome(session, session.hold_back()) == "OK"
    table.pass_time(None, 5000)
    sent = table.robot.wait(100, b"SI|F(1, 80)\n")
    assert b"teacher" in sent
    assert not [line for line in table.robot.did if "MOTORS" in line]


# -- forgetting, text, making itself known --------------------------------------------------------


def test_ten_seconds_of_the_button_from_power_on_forget_both_keys() -> None:
    table, keys = Owned(), Keys()
    table.claimed(keys, KEY_TEACHER)
    table.claimed(keys)
    for milliseconds, found in ((9800, YOUR_OWN), (10_800, FREE)):
        table = Owned(table.robot.memory(), seed=milliseconds)
        table.pass_time(None, 1, HELD)  # as a button that was down before the reset
        table.pass_time(None, milliseconds - 1)
        table.pass_time(None, 1, RELEASED)
        assert owner_of(table, table.session(keys)) == found
    other = table.session(Keys(200), nonce=3)
    assert table.claim(other, KEY_TEACHER) == "OK"


def test_ten_seconds_later_forget_nothing() -> None:
    table, keys = Owned(), Keys()
    table.claimed(keys)
    table.hold(None, 11_000)
    assert owner_of(table, table.session(keys, nonce=4)) == YOUR_OWN


def test_text_drives_an_owned_robot_only_where_it_may() -> None:
    table, keys = Owned(), Keys()
    session = table.claimed(keys)
    table.pass_time(None, 5000)
    said = table.robot.wait(200, b"SI|F(1, 80)\n")
    assert b"tsc text on" in said
    assert table.outcome(session, session.allow_text(True)) == "OK"
    table.pass_time(None, 5000)
    assert b"OK" in table.robot.wait(200, b"SI|F(1, 80)\n")
    assert [line for line in table.robot.did if "MOTORS" in line]
    assert table.outcome(session, session.allow_text(False)) == "OK"
    table.pass_time(None, 5000)
    assert b"tsc text on" in table.robot.wait(200, b"SI|F(1, 80)\n")


def test_a_press_of_two_seconds_lets_text_drive_until_power_off() -> None:
    table, keys = Owned(), Keys()
    table.claimed(keys)
    table.pass_time(None, 5000)
    table.hold(None, 2100)
    assert b"OK" in table.robot.wait(200, b"SI|F(1, 80)\n")
    later = Owned(table.robot.memory())
    assert b"tsc text on" in later.robot.wait(200, b"SI|F(1, 80)\n")


def test_s_stops_an_owned_robot_whatever_text_may_do() -> None:
    table, keys = Owned(), Keys()
    session = table.claimed(keys)
    assert table.outcome(session, session.upload(image_of(FOREVER), is_detached=True)) == "OK"
    table.pass_time(None, 5000)
    table.robot.wait(1500, b"S\n")
    assert table.robot.is_latched


def test_a_robot_makes_itself_known_and_leaves_the_buzzer_to_a_program() -> None:
    table = Owned()
    session = table.session()
    assert table.outcome(session, session.identify()) == "OK"
    table.pass_time(session, 3500)
    tune = [line.split()[1:] for line in table.robot.did if "BEEP" in line]
    number = session.robot.id if session.robot else 0
    assert tune == [["BEEP", str(131 * (4 + (number >> 3 * k) % 8)), "200"] for k in range(3)]
    assert not table.robot.is_lit
    table.robot.did.clear()
    assert table.tries(session) == "OK"
    assert table.outcome(session, session.identify()) == "OK"
    table.pass_time(session, 3500)
    assert not [line for line in table.robot.did if "BEEP" in line]


def test_a_firmware_without_owners_says_so_and_is_free() -> None:
    table = Owned(defines=("tiniscript_without_owners",))
    session = table.session(Keys())
    assert table.claim(session) == "UNKNOWN_MESSAGE"
    assert session.robot
    assert not session.robot.values.features & OWNERS
    assert table.tries(session) == "OK"
    for name, payload in (("CLAIM", bytes(17)), ("AUTHENTICATE", b"\0"), ("TEXT", b"\0")):
        session._seq = (session._seq + 1) & 0xFF
        frame = Frame(BY_NAME[name].number, session._seq, session._epoch, payload)
        answer = decoded(table.robot.wait(20, b"\0" + encoded(frame)).strip(b"\0"))
        assert answer
        assert answer.payload[0] == STATUSES["UNKNOWN_MESSAGE"]
    table.pass_time(None, 5000)
    assert b"OK" in table.robot.wait(200, b"SI|F(1, 80)\n")


# -- by command -----------------------------------------------------------------------------------


def forged(frames: int, seed: int) -> int:
    """Send recorded, forged and reordered frames to a robot with an owner; return how often one of
    them had it drive, start or change. A stop in between is always obeyed.
    """
    chance = random.Random(seed)
    table, keys = Owned(), Keys()
    table.claimed(keys)
    owner = table.session(keys, nonce=4)
    request = owner.upload(image_of("SI|F(0.1, 80)"))
    recorded = []
    while request.outcome is None:
        data = owner.poll(table.robot.now_ms)
        if data:
            recorded.append(data)
        owner.receive(table.robot.step(data), table.robot.now_ms)
    table.pass_time(None, 6000)
    table.robot.did.clear()
    memory = table.robot.memory()
    accepted = 0
    thief = table.session(nonce=4)
    for count in range(frames):
        if count % 97 == 0:
            table.outcome(thief, thief.hello())
        if count % 1009 == 1:
            table.robot.wait(60)  # a repeated stop is told 50 ms later at the earliest
            told = table.robot.wait(60, bytes(8))
            assert b"\xa2" in told, (count, told)  # STOPPED
            table.robot.wait(1100)
        how = chance.randrange(3)
        if how == 0:
            data = chance.choice(recorded)
        else:
            message = chance.choice([each for each in BY_NAME.values() if each.number < 32])
            low = sum(field.low for field in message.request)
            high = sum(field.high for field in message.request)
            payload = chance.randbytes(chance.randint(low, high))
            if message.name == "AUTHENTICATE":
                payload = bytes([chance.randrange(2)]) + chance.randbytes(chance.choice((0, 8)))
            if message.name == "CLAIM":
                payload = bytes([chance.randrange(2)]) + chance.randbytes(chance.choice((0, 16)))
            thief._seq = (thief._seq + 1) & 0xFF
            seq = thief._seq if how == 1 else chance.randrange(256)
            data = encoded(Frame(message.number, seq, thief._epoch, payload))
        sent = table.robot.step(b"\0" + data)
        accepted += sum(is_accepted(answer) for answer in sent.split(b"\0"))
        if chance.randrange(50) == 0:
            table.robot.wait(30)
        did = [line for line in table.robot.did if "MOTORS" in line]
        accepted += len(did)
        table.robot.did.clear()
    if table.robot.memory() != memory:
        accepted += 1
    assert table.tries(table.session(keys, nonce=5)) in ("OK", "TOO_MANY_TRIES")
    return accepted


def is_accepted(sent: bytes) -> bool:
    """Return whether an answer says that something was done for which it takes a key."""
    frame = decoded(sent)
    if frame is None or frame.number not in BY_NUMBER or not frame.payload:
        return False
    message = BY_NUMBER[frame.number]
    if message.name == "AUTHENTICATE":  # a challenge is for anybody
        is_open = len(frame.payload) == 1 + 2 + 8
    else:
        is_open = message.name in OPEN_TO_ALL or message.number >= FIRST_EVENT
    return frame.payload[0] == 0 and not is_open


def main(frames: int, seed: int) -> int:
    accepted = forged(frames, seed)
    print(f"{frames} replayed, forged and reordered frames: {accepted} accepted (seed {seed})")
    return int(accepted != 0)


if __name__ == "__main__":
    import sys

    numbers = [int(each) for each in sys.argv[1:]]
    sys.exit(main(numbers[0] if numbers else 100_000, numbers[1] if numbers[1:] else 1))
