"""A network in between that breaks off: what a server says comes in small pieces, and ends."""

from __future__ import annotations

import contextlib
import select
import socket
import threading
from collections.abc import Sequence


class CuttingNetwork:
    """Passes connections on to a port of this computer; `port` is its own.

    The first connection ends after `cuts[0]` bytes of the server, the second after `cuts[1]`; later
    ones stay. No piece has more than `most` bytes.
    """

    def __init__(self, target: int, cuts: Sequence[int], most: int = 7) -> None:
        self.target, self.most = target, most
        self.cuts = list(cuts)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        self._listener.close()

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._listener.accept()
                server = socket.create_connection(("127.0.0.1", self.target))
            except OSError:
                return
            left = self.cuts.pop(0) if self.cuts else None
            threading.Thread(
                target=_pass, args=(client, server, left, self.most), daemon=True
            ).start()


def _pass(client: socket.socket, server: socket.socket, left: int | None, most: int) -> None:
    with client, server, contextlib.suppress(OSError):
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        while left is None or left > 0:
            ready, _, _ = select.select([client, server], [], [], 0.5)
            if client in ready:
                data = client.recv(4096)
                if not data:
                    return
                server.sendall(data)
            if server in ready:
                data = server.recv(most if left is None else min(most, left))
                if not data:
                    return
                client.sendall(data)
                left = None if left is None else left - len(data)
