"""The ways in which bytes reach a robot, a file for each: `link.ports` finds the one for a port.

Each has `resolve`, which finds the address of a name, and `open_port`, which opens an address.
"""

from __future__ import annotations

from typing import Protocol

READ_S = 0.02  # timeout of a read: on some systems it cannot be interrupted
WRITE_S = 1.0  # timeout of a write; the session sends the bytes again


class Port(Protocol):
    """An open port, as in pyserial. All but `close` raise OSError once the connection is lost."""

    @property
    def in_waiting(self) -> int: ...

    def read(self, size: int, /) -> bytes: ...

    def write(self, data: bytes, /) -> object: ...

    def close(self) -> None: ...


class Transport(Protocol):
    """A file of this folder. Both functions raise PortError."""

    def resolve(self, port: str) -> str:
        """Return the address of the robot that a name means: a port, too."""
        ...

    def open_port(self, port: str, baud: int, timeout_s: float) -> Port:
        """Open a port for exclusive use. `timeout_s` is for those without limits of their own."""
        ...
