"""Many connections that stay, of processes of their own.

A person's process may have 1,024 files open, and the test itself needs some.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager

HALF_A_REQUEST = b"POST /robots HTTP/1.1\r\nHost: "
CONNECTIONS_PER_PROCESS = 100  # connections of a process: not more than wait for a listener at once
CONNECTING_CODE = """
import contextlib, socket, sys
host, port, source, count, says = sys.argv[1:]
says = [bytes.fromhex(each) for each in says.split(",")]
peers = []
for k in range(int(count)):
    peer = socket.socket()
    if source:
        peer.bind((source, 0))
    peer.setblocking(False)
    peer.connect_ex((host, int(port)))
    peers.append((peer, says[k % len(says)]))
for peer, said in peers:
    with contextlib.suppress(OSError):
        peer.send(said)
print("here", flush=True)
sys.stdin.read()
"""


@contextmanager
def crowd(
    *ports: int, count: int = 1000, packets: Sequence[bytes] = (b"",), host: str = "127.0.0.1",
    source: str = "",
) -> Iterator[None]:  # fmt: skip
    """Open `count` connections to each port, which send one of `packets` in turn."""
    with ExitStack() as stack:
        for port in ports:
            for start_index in range(0, count, CONNECTIONS_PER_PROCESS):
                stack.enter_context(
                    _open_connections(
                        port,
                        min(CONNECTIONS_PER_PROCESS, count - start_index),
                        packets,
                        host,
                        source,
                    )
                )
        yield


@contextmanager
def _open_connections(
    port: int, count: int, sent_packets: Sequence[bytes], host: str, source: str
) -> Iterator[None]:
    packets = ",".join(data.hex() for data in sent_packets)
    words = [
        sys.executable,
        "-I",
        "-S",
        "-c",
        CONNECTING_CODE,
        host,
        str(port),
        source,
        str(count),
        packets,
    ]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout and process.stdout.readline() == b"here\n"
            yield
        finally:
            process.kill()
            process.communicate()
