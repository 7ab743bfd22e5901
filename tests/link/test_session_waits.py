"""How long a session waits: for a robot that is silent, and for one that cannot save yet."""

from __future__ import annotations

import pytest

from tests.link.test_session import FORWARD, answer, greeted, receipt
from tiniscript.link.messages import STATUSES
from tiniscript.link.session import IDLE_HEARTBEAT_MS, Session

LOW, SAVING = STATUSES["LOW_SUPPLY"], STATUSES["SAVING"]


def lost_at(session: Session, now_ms: int = 0) -> int:
    """Let nobody answer, and look every millisecond; return when the robot is given up."""
    for at in range(now_ms, now_ms + 10_000):
        session.poll(at)
        if [each.name for each in session.events()] == ["LOST"]:
            return at
    raise AssertionError("it waits for ever")


def test_a_heartbeat_has_three_seconds() -> None:
    assert 3000 <= lost_at(greeted()) - IDLE_HEARTBEAT_MS < 3500  # the end of a try


def test_asking_for_the_end_of_a_run_is_a_heartbeat_too() -> None:
    session = greeted()
    session.live(FORWARD)
    session.receive(answer(session.poll(0), receipt(1)), 0)
    at = session.wakes_at()
    assert at is not None
    session.receive(answer(session.poll(at), {"state": 0, "run": 1}), at)
    assert session.poll(at), "it asks how the run has ended"
    assert 3000 <= lost_at(session, at) - at < 3500


def asked(statuses: list[int]) -> tuple[int, int]:
    """Name a robot that answers with these statuses, the last one for ever; return how many
    times it is asked, and how that ends."""
    session = greeted()
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
    ("statuses", "times", "ends"),
    [
        ([LOW], 1 + 4, LOW),
        ([SAVING], 1 + 12, SAVING),
        # a voltage that was enough in between is waited for anew
        ([LOW, LOW, LOW, LOW, SAVING, LOW], 1 + 4 + 4, LOW),
    ],
)
def test_a_low_voltage_is_waited_for_less_long(statuses: list[int], times: int, ends: int) -> None:
    assert asked(statuses) == (times, ends)
