"""Places of programs through another command's port: only clients that ask get them."""

from __future__ import annotations

from time import monotonic

from tests.support.images import image_of
from tests.support.shared_pty_robot import SharedLine
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.link.connection import LinkConnection
from tiniscript.link.outcomes import MAX_EVENTS, Backlog, Event, PlaceEvent, ShownEvent
from tiniscript.link.requests import OK
from tiniscript.link.sharing.shared_connection import join


def list_events_until_done(connection: LinkConnection) -> list[Event]:
    """Return the events up to the end of a run."""
    events: list[Event] = []
    end_s = monotonic() + HANG_LIMIT_S
    while monotonic() < end_s:
        row = connection.event(0.2)
        if row is not None:
            events.append(row[1])
            if row[1].name == "DONE":
                return events
    raise AssertionError(events)


def test_only_subscribed_clients_get_places() -> None:
    image = image_of("SI|F(2, 80);R(2, 60)")  # each is asked for often, on a busy computer too
    shared_port = SharedLine()
    with shared_port as (pty_robot, _):
        client, other_client = join(pty_robot.port, "studio"), join(pty_robot.port, "monitor")
        assert client and other_client
        client.enable_place_events()
        assert client.wait(client.begin(lambda session: session.hello())).status == OK
        request = client.begin(lambda session: session.upload(image, saves=False))
        assert client.wait(request).status == OK
        places = [
            place_event
            for place_event in list_events_until_done(client)
            if isinstance(place_event, PlaceEvent)
        ]
        assert len(places) == 2 and {place.program for place in places} == {image.checksum}
        assert places[0].offset < places[1].offset < len(image.code)
        for connection in (other_client, shared_port.line):
            assert "PLACE" not in {event.name for event in list_events_until_done(connection)}
        client.close()
        other_client.close()


def test_an_unread_backlog_keeps_only_the_newest_place() -> None:
    backlog = Backlog()
    backlog.add_events((k, PlaceEvent(1, 2, k)) for k in range(2 * MAX_EVENTS))
    backlog.add_events([(0, ShownEvent(1, 0))])
    assert backlog.take_event() == (2 * MAX_EVENTS - 1, PlaceEvent(1, 2, 2 * MAX_EVENTS - 1))
    assert backlog.take_event()[1] == ShownEvent(1, 0)
    assert not backlog
