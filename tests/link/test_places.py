"""Where a program is: what a session makes of the replies to its heartbeats."""

from __future__ import annotations

from tests.link.test_session import greeted
from tiniscript.link.frames import Frame, decoded, encoded
from tiniscript.link.messages import PLACES
from tiniscript.link.outcomes import PlaceEvent


def places_told(*replies: bytes) -> list[tuple[int, int]]:
    """Return the runs and places that a session tells when its heartbeats get these replies."""
    session = greeted(features=PLACES)
    session.tells_places = True
    now_ms = 10
    for payload in replies:
        now_ms += 1000
        sent = decoded(session.poll(now_ms).strip(b"\0"))
        assert sent and sent.number == 2 and sent.payload == b"\1"
        reply = Frame(2, sent.seq, 10, b"\0" + payload, is_reply=True)
        session.receive(encoded(reply), now_ms + 1)
    return [(each.run, each.at) for each in session.events() if isinstance(each, PlaceEvent)]


def test_a_place_is_told_when_it_is_another_one() -> None:
    place, other = b"\3\0abcd", b"\3\0abce"
    assert places_told(b"\1\1" + place, b"\1\1" + place, b"\0\1") == [(1, 3), (1, -1)]
    assert places_told(b"\1\1" + place, b"\1\2" + place, b"\1\2" + other) == [
        (1, 3),
        (2, 3),
        (2, 3),
    ]


def test_a_place_that_is_cut_or_of_nothing_that_runs_is_none() -> None:
    assert places_told(b"\1\1", b"\1\1abc", b"\0\1\3\0abcd", b"\2\1\3\0abcd") == []
    assert places_told(b"\1\1\xff\xffabcd") == [(1, 0xFFFF)]
