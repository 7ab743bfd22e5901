"""A virtual robot in time: whoever talks to it, however badly, the robot goes on."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable, Iterator

import pytest

from tests.support.virtual_robot import floor, missing, robot_in
from tiniscript.link.frames import Frame, encoded
from tiniscript.link.messages import BY_NAME
from tiniscript.virtual import transports as guests_room
from tiniscript.virtual.heartbeat import BEAT_MS, SILENT_S, Heartbeat
from tiniscript.virtual.simulator import FULL_BYTES, Host
from tiniscript.virtual.transports import Guests

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is wasmtime")

PING = encoded(Frame(BY_NAME["PING"].number, 1, 0))
TURNS = 3000  # far more than anything here takes


@pytest.fixture
def host() -> Iterator[Host]:
    guests = Guests()
    yield Host(robot_in(floor()), guests)
    guests.close()


def visit(host: Host) -> socket.socket:
    found = socket.create_connection(("127.0.0.1", host.guests.port))
    found.setblocking(False)
    return found


def until(host: Host, is_so: Callable[[], bool]) -> None:
    for _ in range(TURNS):
        if is_so():
            return
        host.turn(0.01)
    raise AssertionError("it does not come to that")


def received(guest: socket.socket, into: bytearray) -> bytearray:
    with contextlib.suppress(BlockingIOError):
        into += guest.recv(10_000)
    return into


def test_a_guest_is_answered(host: Host) -> None:
    with visit(host) as guest:
        guest.sendall(PING)
        heard = bytearray()
        until(host, lambda: b"\0" in received(guest, heard))


def test_a_flood_waits_outside(host: Host) -> None:
    """The line is as slow as it is; what has no room on it stays with whoever sends."""
    flood = b"\0\0" + bytes(range(1, 256)) * 400
    with visit(host) as guest:
        sent, most = 0, 0
        for _ in range(300):
            with contextlib.suppress(BlockingIOError):
                sent += guest.send(flood)
            host.turn(0.01)
            most = max(most, host.waiting)
        assert sent > 100_000
        assert FULL_BYTES < most < FULL_BYTES + guests_room.READ_BYTES + 100


def test_a_guest_who_does_not_read_loses_what_it_does_not_read(
    host: Host, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(guests_room, "KEPT_BYTES", 500)
    with visit(host) as guest:
        guest.sendall(PING)
        until(host, lambda: host.guests.is_connected)
        for _ in range(3000):
            host.guests.send(b"x" * 10_000)
        assert len(host.guests._unsent) <= 500
        host.turn(0.01)


def test_guests_come_and_go(host: Host) -> None:
    for _ in range(30):
        with visit(host) as guest:
            guest.sendall(PING)
            until(host, lambda: host.guests.is_connected)
        until(host, lambda: not host.guests.is_connected)
    assert host.guests.visits == 30


def test_many_at_once_are_all_told_but_one(host: Host) -> None:
    crowd = [visit(host) for _ in range(6)]
    for guest in crowd:
        guest.sendall(PING)
    heard = [bytearray() for _ in crowd]
    told = 0

    def all_are_told() -> bool:
        nonlocal told
        told = sum(
            bytes(received(guest, into)) == guests_room.TAKEN
            for guest, into in zip(crowd, heard, strict=True)
        )
        return told == 5

    until(host, all_are_told)
    for guest in crowd:
        guest.close()
    until(host, lambda: not host.guests.is_connected)


def test_only_this_computer_is_let_in(host: Host) -> None:
    assert host.guests._server.getsockname()[0] == "127.0.0.1"


# -- the heartbeat of a hurried robot -------------------------------------------------------------


def test_a_hurried_robot_hears_the_last_whole_frame_again() -> None:
    heart = Heartbeat()
    assert heart.due(10_000, 5.0) == b""  # there was none
    heart.hear(b"\0" + PING[:3], 5.0)
    assert heart.due(10_000, 5.0) == b""  # one is on its way
    heart.hear(PING[3:], 5.0)
    assert heart.due(10_000, 5.0) == PING
    assert heart.due(10_000 + BEAT_MS - 1, 5.0) == b""
    assert heart.due(10_000 + BEAT_MS, 5.0) == PING
    assert heart.due(20_000, 5.0 + SILENT_S + 0.1) == b""  # the computer itself is silent
    heart.hear(b"\0\0\0", 7.0)
    assert heart.due(30_000, 7.0) == PING
    heart.forget()
    assert heart.due(40_000, 7.0) == b""


def test_a_new_guest_does_not_speak_with_the_words_of_the_one_before(host: Host) -> None:
    with visit(host) as guest:
        guest.sendall(PING + b"\5half")
        until(host, lambda: bool(host._heartbeat._open))
    with visit(host) as guest:
        guest.sendall(b"\0\0\0\0\0")
        until(host, lambda: host.guests.visits == 2)
        until(host, lambda: not host._heartbeat._open)
        assert host._heartbeat.due(10**6, host._heartbeat._heard_s) == b""


def test_the_heartbeat_keeps_nothing_endless() -> None:
    heart = Heartbeat()
    for _ in range(1000):
        heart.hear(b"x" * 1000, 1.0)
    assert len(heart._open) < 200
    heart.hear(b"\0", 1.0)
    assert heart.due(10_000, 1.0) == b""
