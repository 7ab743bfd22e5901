"""Strangers who talk to a shared port."""

from __future__ import annotations

import socket
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from random import Random

from tests.support.command import FOREVER, TSC
from tiniscript import __version__
from tiniscript.link.sharing import protocol, registry
from tiniscript.link.sharing.registry import Registration

OWN_VERSION = __version__.encode()
GREETING = b'{"tsc":"%s","token":"%s","verb":"link"}\n' % (OWN_VERSION, b"0" * 32)
STRANGE_LINES = (
    b'{"token":"\\ud800","verb":"x"}\n',
    b'{"tsc":"' + OWN_VERSION + b'","token":"\\ud800","verb":"x"}\n',
    b'{"tsc":"' + OWN_VERSION + b'","token":"' + b"0" * 32 + b'","verb":"\\udfff"}\n',
    '{"token":"é","verb":"x"}\n'.encode(),
    b'{"token":"\xff\xfe","verb":"x"}\n',
    b'{"token":NaN,"verb":Infinity}\n',
    b'{"token":' + b"9" * 900 + b',"verb":true}\n',
    b'{"token":1e999,"verb":-1e999}\n',
    b'{"token":null,"token":"a","token":[]}\n',
    b'{"token":' + b"[" * 900 + b"\n",
    b'{"a":' * 180 + b"\n",
    b"9" * 5000 + b"\n",
    b"[" * 100_000,
    b'{"tsc":"' + b"0" * 1_000_000,
    b"\xef\xbb\xbf" + GREETING,
    GREETING.decode().encode("utf-16"),
    GREETING * 50,
    GREETING[:-1],
    protocol.encode_message({"do": "stop"}),
    b"\n" * 1000,
    b"\0" * 1000,
    b"GET / HTTP/1.1\r\nUpgrade: websocket\r\n\r\n",
    b"\x16\x03\x01\x00\xf0\x01",
    b"",
)


def mutate_data(rng: Random) -> bytes:
    """Return something strange that is a little otherwise."""
    data = bytearray(rng.choice(STRANGE_LINES)[:1200] or b"{")
    for _ in range(rng.randrange(1, 6)):
        offset = rng.randrange(len(data))
        kind = rng.randrange(4)
        if kind == 0:
            data[offset] = rng.randrange(256)
        elif kind == 1:
            data[offset:offset] = rng.choice(
                (b'"', b"\\ud8", b"\n", b"\0", b"{", b"[", b"\xff", b"1e9")
            )
        elif kind == 2:
            del data[offset : offset + rng.randrange(20)]
        else:
            data += rng.choice(STRANGE_LINES)[:200]
        data = data or bytearray(b"{")
    return bytes(data)


def send_and_leave(registration: Registration, data: bytes, rng: Random) -> None:
    """Say something in one or more pieces, and leave in one of several ways."""
    with (
        socket.create_connection((protocol.HOST, registration.number), 10) as peer,
        suppress(OSError),
    ):
        split_offset = rng.randrange(len(data) + 1)
        for piece in (data[:split_offset], data[split_offset:]) if rng.random() < 0.3 else (data,):
            peer.sendall(piece)
        if rng.random() < 0.5:
            peer.shutdown(socket.SHUT_WR)
            reply = peer.recv(1000)
            assert reply == b"", "a stranger is answered"


def say_all(port: str, seed: int, count: int) -> None:
    """Send everything strange, and so many variations."""
    rng, registration = Random(seed), registration_of(port)
    for data in (*STRANGE_LINES, *(mutate_data(rng) for _ in range(count))):
        send_and_leave(registration, data, rng)


def registration_of(port: str) -> Registration:
    registration = registry.find_registration(port)
    assert registration is not None
    return registration


FEW_FILES_COMMAND = ["sh", "-c", 'ulimit -n 256; exec "$@"', "sh", *TSC]  # files, as on macOS


@contextmanager
def run_with_few_files(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A `tsc` that may have few files open."""
    process = subprocess.Popen(
        [*FEW_FILES_COMMAND, *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@contextmanager
def drive_robot() -> Iterator[tuple[subprocess.Popen[bytes], str, subprocess.Popen[bytes], bytes]]:
    """A virtual robot, its port, and the command that drives it, with its output."""
    with run_with_few_files("robot") as robot:
        assert robot.stdout
        port = robot.stdout.readline().decode().strip()
        with run_with_few_files("upload", "--port", port, "-e", FOREVER) as command:
            assert command.stdout
            receipt = command.stdout.readline()
            assert b"running" in receipt
            yield robot, port, command, receipt
