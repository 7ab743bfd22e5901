"""Visitors of a virtual robot over TCP."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable

from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.virtual.simulator import Simulator

PING = b"\0" + encode_frame(Frame(BY_NAME["PING"].number, 1, 0))
TURNS = 3000  # far more than any use here


def visit(simulator: Simulator) -> socket.socket:
    connection = socket.create_connection(("127.0.0.1", simulator.transports.port))
    connection.setblocking(False)
    return connection


def until(simulator: Simulator, is_reached: Callable[[], bool]) -> None:
    for _ in range(TURNS):
        if is_reached():
            return
        simulator.turn(0.01)
    raise AssertionError("it does not come to that")


def wait_until_answered(simulator: Simulator, client: socket.socket, end: bytes = b"\0") -> None:
    heard_bytes = bytearray()
    until(simulator, lambda: end in receive(client, heard_bytes))


def receive(client: socket.socket, into: bytearray) -> bytearray:
    with contextlib.suppress(BlockingIOError):
        into += client.recv(10_000)
    return into
