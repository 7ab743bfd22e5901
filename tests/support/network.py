"""Networks in between, which are slow, lose something, or break off."""

from __future__ import annotations

import contextlib
import random
import socket
import threading
import time
from collections.abc import Sequence
from itertools import count

RESENT_S = 0.2  # time before TCP resends a packet


class Network:
    """Passes connections on to a TCP port of this computer; `port` is its own."""

    max_bytes = 4096  # bytes of a piece

    def __init__(self, target: int) -> None:
        self._target = target
        self._ends: list[socket.socket] = []
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def pass_on(self, data: bytes, is_back: bool, number: int) -> bytes | None:
        """Return the part of a piece to pass on; None ends the connection. `number` counts from
        0.
        """
        return data

    def cut(self) -> None:
        """End all connections."""
        for end in self._ends:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self.cut()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            for number in count():
                client, _ = self._listener.accept()
                server = socket.create_connection(("127.0.0.1", self._target))
                for end in (client, server):
                    end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    self._ends.append(end)
                for direction in ((client, server, False), (server, client, True)):
                    threading.Thread(
                        target=self._pass, args=(*direction, number), daemon=True
                    ).start()

    def _pass(self, source: socket.socket, sink: socket.socket, is_back: bool, number: int) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(self.max_bytes):
                going_on = self.pass_on(data, is_back, number)
                if going_on is None:
                    break
                sink.sendall(going_on)
        for end in (source, sink):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)


class BadNetwork(Network):
    """Each piece is `late_s` on its way, one of `resend_interval` much longer; some are lost."""

    def __init__(
        self, target: int, late_s: float = 0.02, resend_interval: int = 10, loss_rate: float = 0.0
    ) -> None:
        self.late_s, self.resend_interval, self.loss_rate = late_s, resend_interval, loss_rate
        self._rng = random.Random(1)
        super().__init__(target)

    def pass_on(self, data: bytes, is_back: bool, number: int) -> bytes:
        time.sleep(self.late_s + RESENT_S * (self._rng.randrange(self.resend_interval) == 0))
        return b"" if self._rng.random() < self.loss_rate else data


class CuttingNetwork(Network):
    """A network that delivers a server's data in small pieces. The first connection ends after
    `bytes_left[0]` bytes of it, the second after `bytes_left[1]`; later ones stay.
    """

    max_bytes = 7

    def __init__(self, target: int, piece_sizes: Sequence[int]) -> None:
        self.bytes_left = list(piece_sizes)
        super().__init__(target)

    def pass_on(self, data: bytes, is_back: bool, number: int) -> bytes | None:
        if not is_back or number >= len(self.bytes_left):
            return data
        data = data[: self.bytes_left[number]]
        self.bytes_left[number] -= len(data)
        return data or None
