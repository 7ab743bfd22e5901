"""Decides whose run continues: it is stopped when its command has left, in any order of events."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any, cast

import pytest

from tests.support.images import image_of
from tests.support.link_events import event
from tests.support.waiting import until
from tiniscript import robots
from tiniscript.library import opening
from tiniscript.library.client import Client
from tiniscript.link.connection import PendingRequest, Requester
from tiniscript.link.outcomes import CANCELLED, Event, TimedEvent
from tiniscript.link.payloads import DoneEvent, ReceiptReply
from tiniscript.link.port_connection import PortConnection
from tiniscript.link.requests import OK, Reply
from tiniscript.link.sharing import registry
from tiniscript.link.sharing.requests import ClientRequest, ClientRequests
from tiniscript.link.sharing.server import Server
from tiniscript.link.sharing.shared_connection import SharedConnection, join

PORT = "/dev/ttyUSB0"


class FakeLine:
    """A line with a scripted robot: begins run 7, ends it, and sends events."""

    address, end_reason, robot, holder_verb = PORT, None, None, ""
    heard_count, early_bytes, is_echoed, boot, has_ended = 0, b"", False, 0, False

    def __init__(self) -> None:
        self.is_running = False
        self.is_closed = False
        self.stops = 0
        self.halted: list[int] = []
        self.withdrawn_requests: list[PendingRequest[Any]] = []
        self.requests: list[PendingRequest[Any]] = []

    def listen(self, on_events: Callable[[list[TimedEvent]], None]) -> None:
        self._on_events = on_events

    def post_event(self, event: Event) -> None:
        self._on_events([(0, event)])

    def begin(
        self, make_request: Callable[[Requester], PendingRequest[Any]]
    ) -> PendingRequest[Any]:
        self.requests.append(make_request(cast(Requester, ClientRequests())))
        return self.requests[-1]

    def begin_run(self) -> None:
        """Begin the run that was requested last."""
        self.is_running = True
        self.requests[-1].outcome = Reply(OK, 0, ReceiptReply(1, 7, 0, 0))

    def runs(self, run: int) -> bool:
        return self.is_running and run == 7

    def stop(self) -> int:
        self.stops += 1
        return 0

    def end_run(self, run: int) -> None:
        self.halted.append(run)

    def withdraw(self, request: PendingRequest[Any]) -> None:
        self.withdrawn_requests.append(request)

    def event(self) -> TimedEvent:
        return 0, event("STOPPED")

    def close(self) -> None:
        self.is_closed = True


@pytest.fixture
def line() -> FakeLine:
    return FakeLine()


@pytest.fixture
def server(line: FakeLine) -> Iterator[Server]:
    with closing(Server(cast(PortConnection, line), PORT, 9600, "monitor")) as shared_server:
        yield shared_server


@pytest.fixture
def command(server: Server) -> Iterator[SharedConnection]:
    """Another command, which shares the port."""
    shared_connection = join(PORT, "upload")
    assert shared_connection is not None
    with closing(shared_connection):
        yield shared_connection


def wait_for_event(command: SharedConnection, name: str) -> None:
    until(lambda: (event := command.event(0.1)) is not None and event[1].name == name, name)


def send_start(command: SharedConnection, line: FakeLine, is_detached: bool = False) -> None:
    command.begin(lambda requests: requests.start(is_detached))
    until(lambda: bool(line.requests), "the request arrives")


START_REQUESTS: list[Callable[[Requester], PendingRequest[Any]]] = [
    lambda requests: requests.start(),
    lambda requests: requests.start(is_detached=True),
    lambda requests: requests.live(image_of("S").code),
    lambda requests: requests.upload(image_of("SI|F(1, 80)")),
    lambda requests: requests.upload(image_of("SB|F(1, 80)"), runs=False),
]


@pytest.mark.parametrize("start_index", range(len(START_REQUESTS)))
def test_no_start_reaches_a_robot_that_was_just_stopped(line: FakeLine, start_index: int) -> None:
    """Such requests end, and later ones without a start are sent."""
    with (
        closing(Server(cast(PortConnection, line), PORT, 9600, "studio", lambda: True)) as server,
        closing(cast(SharedConnection, join(PORT, "upload"))) as command,
    ):
        request = command.begin(START_REQUESTS[start_index])
        assert command.wait(request).status == CANCELLED
        command.begin(lambda requests: requests.status())
        until(lambda: bool(line.requests), "the request arrives")
        assert [cast(ClientRequest[Any], request).message["do"] for request in line.requests] == [
            "status"
        ]
        assert not server.may_have_owned_run


def test_a_port_with_two_names_is_listed_once(line: FakeLine) -> None:
    line.address = "socket://127.0.0.1:7007"
    with closing(Server(cast(PortConnection, line), PORT, 9600, "link")) as server:
        own_registration = server.registration
        assert [
            registration
            for registration in registry.find_all()
            if registration.token == own_registration.token
        ] == [own_registration]
        registration = registry.find_registration(line.address)
        assert registration is not None and registration.token == own_registration.token


def test_requests_of_a_leaving_client_are_withdrawn(
    line: FakeLine, server: Server, command: SharedConnection
) -> None:
    send_start(command, line)
    send_start(command, line, is_detached=True)
    until(lambda: len(line.requests) == 2, "both requests arrive")
    command.close()
    until(lambda: line.withdrawn_requests == line.requests, "they are withdrawn")
    line.requests[0].outcome = Reply(OK, 0, ReceiptReply(1, 7, 0, 0))  # the request was under way
    line.is_running = True
    line.post_event(event("SHOW"))
    until(lambda: line.halted == [7], "its run is ended")
    assert line.stops == 0
    with closing(cast(SharedConnection, join(PORT, "upload"))) as other_client:
        other_client.begin(lambda requests: requests.start())
        until(lambda: len(line.requests) == 3, "its request arrives")
        line.begin_run()  # a reset robot restarts its run numbers
        line.post_event(event("SHOW"))
        wait_for_event(other_client, "SHOW")
        line.post_event(event("SHOW"))
        wait_for_event(other_client, "SHOW")
        assert line.halted == [7], "the next run is not its"


def test_a_run_ends_with_its_client_without_a_stop_for_all(
    line: FakeLine, server: Server, command: SharedConnection
) -> None:
    send_start(command, line)
    line.begin_run()
    line.post_event(event("SHOW"))
    wait_for_event(command, "SHOW")
    command.close()
    until(lambda: line.halted == [7], "its run is ended")
    assert line.stops == 0


@pytest.mark.parametrize("end", ["STOPPED", "DONE"])
def test_a_late_end_event_takes_no_owner_from_the_next_run(
    end: str, line: FakeLine, server: Server, command: SharedConnection
) -> None:
    """A stop, and an upload right after it: the server's thread may see both at once."""
    send_start(command, line)
    line.begin_run()
    line.post_event(DoneEvent(6) if end == "DONE" else event(end))
    wait_for_event(command, end)
    assert server.has_owned_run
    line.is_running = False
    line.post_event(DoneEvent(7) if end == "DONE" else event(end))
    wait_for_event(command, end)
    line.is_running = True  # the same number from another client
    assert not server.has_owned_run


@pytest.mark.parametrize(
    ("request_kind", "is_stopped"),
    [("start", True), ("detached", False), ("ping", False), ("over", False), ("begun", True)],
)
def test_a_run_that_begins_while_its_server_leaves_is_stopped(
    request_kind: str, is_stopped: bool, line: FakeLine, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two uploads at once: the first is replaced by its own client, and leaves."""
    monkeypatch.setattr(opening, "connection_to", lambda *_: line)
    client = Client(PORT, "monitor", robots.load("tinibot"), is_shared=False)
    client.server = Server(cast(PortConnection, line), PORT, 9600, "monitor")
    command = join(PORT, "upload")
    assert command is not None
    with closing(command):
        if request_kind == "ping":
            command.begin(lambda requests: requests.ping())
            until(lambda: bool(line.requests), "the request arrives")
        else:
            send_start(command, line, request_kind == "detached")
        if request_kind in ("over", "begun"):
            line.begin_run()
            line.is_running = request_kind == "begun"
        client.close()
    assert line.stops == is_stopped
    assert line.is_closed


def test_each_client_has_its_own_keys_and_releases_them_when_it_leaves(
    line: FakeLine, command: SharedConnection
) -> None:
    def list_pressed_keys() -> list[tuple[object, object]]:
        messages = [
            cast(ClientRequest[Any], pending_request).message for pending_request in line.requests
        ]
        return [(message["speaker"], message["keys"]) for message in messages]

    command.begin(lambda requests: requests.press(1))
    until(lambda: len(line.requests) == 1, "the first word arrives")
    with closing(cast(SharedConnection, join(PORT, "live"))) as other_client:
        other_client.begin(lambda requests: requests.press(2))
        until(lambda: len(line.requests) == 2, "the second word arrives")
    until(lambda: len(line.requests) == 3, "the second client has left")
    assert list_pressed_keys() == [(1, 1), (2, 2), (2, 0)]
    assert line.stops == 0 and line.halted == []
