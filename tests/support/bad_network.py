"""A network in between: bytes come late, and now and then much later, as after a lost packet."""

from __future__ import annotations

import contextlib
import random
import select
import socket
import threading
import time


class BadNetwork:
    """Passes connections on to a port of this computer; `port` is its own.

    Each piece is `late_s` on its way, and one of `every` as long as TCP takes to send it again.
    """

    def __init__(self, target: int, late_s: float = 0.02, every: int = 10, seed: int = 1) -> None:
        self.target, self.late_s, self.every = target, late_s, every
        self._chance = random.Random(seed)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        self._is_over = False
        self._ends: list[socket.socket] = []
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        """End all connections."""
        for end in self._ends:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        self._is_over = True
        self.cut()
        self._listener.close()

    def _accept(self) -> None:
        while not self._is_over:
            try:
                client, _ = self._listener.accept()
                robot = socket.create_connection(("127.0.0.1", self.target))
            except OSError:
                return
            self._ends += [client, robot]
            threading.Thread(target=self._pass, args=(client, robot), daemon=True).start()

    def _pass(self, client: socket.socket, robot: socket.socket) -> None:
        waiting: list[tuple[float, socket.socket, bytes]] = []  # in the order of their arrival
        last = {client: 0.0, robot: 0.0}
        with client, robot:
            while not self._is_over:
                now = time.monotonic()
                while waiting and waiting[0][0] <= now:
                    _, end, data = waiting.pop(0)
                    try:
                        end.sendall(data)
                    except OSError:
                        return
                ready, _, _ = select.select([client, robot], [], [], 0.005)
                for each in ready:
                    other = robot if each is client else client
                    data = b""
                    with contextlib.suppress(OSError):
                        data = each.recv(4096)
                    if not data:
                        return
                    is_lost = self._chance.randrange(self.every) == 0
                    due = time.monotonic() + self.late_s + (0.2 if is_lost else 0.0)
                    last[other] = max(due, last[other])  # TCP keeps the order
                    waiting.append((last[other], other, data))
                    waiting.sort(key=lambda item: item[0])
