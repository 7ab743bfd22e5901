"""A virtual robot in time: whatever its clients do, the robot continues."""

from __future__ import annotations

import contextlib

import pytest

from tests.support.simulator_visits import PING, receive, until, visit
from tiniscript.virtual import transports as limits
from tiniscript.virtual.simulator import (
    HEARTBEAT_MS,
    MAX_WAITING_BYTES,
    SILENCE_S,
    Heartbeat,
    Simulator,
)

REST = b"the rest"


def test_a_flood_waits_outside(simulator: Simulator) -> None:
    """The line keeps its speed; data without room on it stays with the sender."""
    flood = b"\0\0" + bytes(range(1, 256)) * 400
    with visit(simulator) as client:
        sent_count, max_waiting = 0, 0
        for _ in range(300):
            with contextlib.suppress(BlockingIOError):
                sent_count += client.send(flood)
            simulator.turn(0.01)
            max_waiting = max(max_waiting, simulator.waiting_bytes)
        assert sent_count > 100_000
        assert MAX_WAITING_BYTES < max_waiting < MAX_WAITING_BYTES + limits.READ_BYTES + 100


def test_a_client_that_does_not_read_loses_the_unread_data(
    simulator: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(limits, "MAX_UNSENT_BYTES", 500)
    with visit(simulator) as client:
        client.sendall(PING)
        until(simulator, lambda: simulator.transports.is_connected)
        for _ in range(3000):
            simulator.transports.send(b"x" * 10_000)
        assert len(simulator.transports._unsent) <= 500
        simulator.turn(0.01)


def test_clients_come_and_go(simulator: Simulator) -> None:
    for _ in range(30):
        with visit(simulator) as client:
            client.sendall(PING)
            until(simulator, lambda: simulator.transports.is_connected)
        until(simulator, lambda: not simulator.transports.is_connected)
    assert simulator.transports.visit_count == 30
    # It is reachable only from this computer.
    assert simulator.transports._server.getsockname()[0] == "127.0.0.1"


def test_all_but_one_of_many_simultaneous_clients_are_refused(simulator: Simulator) -> None:
    crowd = [visit(simulator) for _ in range(6)]
    for client in crowd:
        client.sendall(PING)
    heard_bytes = [bytearray() for _ in crowd]
    refused_count = 0

    def all_are_told() -> bool:
        nonlocal refused_count
        refused_count = sum(
            bytes(receive(client, into)) == limits.PORT_TAKEN
            for client, into in zip(crowd, heard_bytes, strict=True)
        )
        return refused_count == 5

    until(simulator, all_are_told)
    for client in crowd:
        client.close()
    until(simulator, lambda: not simulator.transports.is_connected)


@pytest.mark.parametrize("late_ms", [1, 30, 300])
def test_a_new_client_gets_nothing_meant_for_the_previous_one(
    simulator: Simulator, late_ms: int
) -> None:
    """The line is bad, and its bytes are late."""
    for _ in range(3):
        assert REST not in bytes_heard_by_client(simulator, 1)
        simulator.from_robot.send_bytes(REST, simulator.robot.now_ms + late_ms)
    assert REST not in bytes_heard_by_client(simulator, 2 * late_ms)


def bytes_heard_by_client(simulator: Simulator, stays_ms: int) -> bytes:
    """Return the bytes that a client receives who connects, asks, and leaves after a while."""
    visits, end_ms = simulator.transports.visit_count, simulator.robot.now_ms + stays_ms
    with visit(simulator) as client:
        client.sendall(PING)
        until(simulator, lambda: simulator.transports.visit_count > visits)
        heard_bytes = bytearray()
        until(simulator, lambda: b"\0" in receive(client, heard_bytes))
        until(simulator, lambda: simulator.robot.now_ms > end_ms)
        return bytes(receive(client, heard_bytes))


# -- the heartbeat of a hurried robot -------------------------------------------------------------


def test_the_heartbeat_repeats_the_last_complete_frame() -> None:
    heart = Heartbeat()
    assert heart.bytes_due(10_000, 5.0) == b""  # no heartbeat was sent
    heart.on_bytes(b"\0" + PING[:3], 5.0)
    assert heart.bytes_due(10_000, 5.0) == b""  # one heartbeat is under way
    heart.on_bytes(PING[3:], 5.0)
    assert heart.bytes_due(10_000, 5.0) == PING
    assert heart.bytes_due(10_000 + HEARTBEAT_MS - 1, 5.0) == b""
    assert heart.bytes_due(10_000 + HEARTBEAT_MS, 5.0) == PING
    assert heart.bytes_due(20_000, 5.0 + SILENCE_S + 0.1) == b""  # the computer itself is silent
    heart.on_bytes(b"\0\0\0", 7.0)
    assert heart.bytes_due(30_000, 7.0) == PING
    heart.forget()
    assert heart.bytes_due(40_000, 7.0) == b""


def test_a_new_client_does_not_continue_the_previous_ones_line(simulator: Simulator) -> None:
    with visit(simulator) as client:
        client.sendall(PING + b"\5half")
        until(simulator, lambda: bool(simulator._heartbeat._unfinished_packet))
    with visit(simulator) as client:
        client.sendall(b"\0\0\0\0\0")
        until(simulator, lambda: simulator.transports.visit_count == 2)
        until(simulator, lambda: not simulator._heartbeat._unfinished_packet)
        assert simulator._heartbeat.bytes_due(10**6, simulator._heartbeat._received_s) == b""


def test_the_heartbeat_buffer_is_bounded() -> None:
    heart = Heartbeat()
    for _ in range(1000):
        heart.on_bytes(b"x" * 1000, 1.0)
    assert len(heart._unfinished_packet) < 200
    heart.on_bytes(b"\0", 1.0)
    assert heart.bytes_due(10_000, 1.0) == b""
