"""A broker that sends more than a robot says."""

from __future__ import annotations

import socket
from threading import Thread

import pytest

from tests.support.waiting import HANGS_S, until
from tiniscript.link.transports.broker import MESSAGE_BYTES, Access, Broker

LET_IN = bytes((0x20, 2, 0, 0))
PIECE = bytes(65_536)


def message(bytes_of_it: int) -> bytes:
    """Return the head of a message with so many bytes behind it."""
    head = bytearray((0x30,))
    while True:
        rest = bytes_of_it >> 7
        head.append((bytes_of_it & 127) | (128 if rest else 0))
        if not rest:
            return bytes(head)
        bytes_of_it = rest


@pytest.mark.parametrize("size", [MESSAGE_BYTES + 1, (256 << 20) - 1])
def test_a_large_message_ends_the_connection_before_it_is_in_memory(size: int) -> None:
    taken = 0

    def serve() -> None:
        nonlocal taken
        peer, _ = listening.accept()
        with peer:
            peer.recv(4096)
            peer.sendall(LET_IN + message(MESSAGE_BYTES) + b"\0\1x" + bytes(MESSAGE_BYTES - 3))
            peer.sendall(message(size))
            try:
                while taken < size:
                    taken += peer.send(PIECE)
            except ConnectionError:
                pass

    with socket.create_server(("127.0.0.1", 0)) as listening:
        serving = Thread(target=serve, daemon=True)
        serving.start()
        broker = Broker("127.0.0.1", listening.getsockname()[1], Access())
        until(lambda: broker.gone != "", "the connection ends")
        assert broker.gone == f"the broker sends a message of {size} bytes"
        serving.join(HANGS_S)
        broker.close()
    assert taken < 32 << 20  # what the system's buffers hold
