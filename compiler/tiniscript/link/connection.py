"""What the command may ask of a robot, and of whatever leads to it.

There are two ways: a `Line` of this process, and a `Guest` at the line of another one. Both have
these shapes, so whoever asks need not know which of them it is. Shapes only: for types.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from tiniscript.bytecode.image import Image
from tiniscript.link.outcomes import Event
from tiniscript.link.requests import Reply, Robot


class Asked(Protocol):
    """Something that is under way: `outcome` is there when it is over.

    `limit_ms` is its time, from its first request on; `done_bytes` of a program have arrived;
    `starts`: a program runs when it is done.
    """

    limit_ms: int
    done_bytes: int
    starts: bool
    outcome: Reply | None


class Asks(Protocol):
    """What can be asked; `link.session` does it."""

    def hello(self) -> Asked: ...

    def ping(self) -> Asked: ...

    def status(self) -> Asked: ...

    def clear(self) -> Asked: ...

    def start(self, is_detached: bool = False) -> Asked: ...

    def live(self, code: bytes, kit: int = 0) -> Asked: ...

    def upload(
        self, image: Image, runs: bool = True, saves: bool = True, is_detached: bool = False
    ) -> Asked: ...

    def name(self, name: bytes) -> Asked: ...

    def trim(self, trim: bytes = b"") -> Asked: ...

    def fetch(self) -> Asked: ...


class Way(Protocol):
    """The way to a robot. All of it but `close` and `stop` raises Gone where it has ended.

    `heard` counts the bytes that have come, `is_echoed`: what is sent comes back; `held_by` is
    the verb of the command that holds the port, if that is another one; `has_ended`: the way is
    not there any more.
    """

    @property
    def robot(self) -> Robot | None: ...

    @property
    def heard(self) -> int: ...

    @property
    def is_echoed(self) -> bool: ...

    @property
    def held_by(self) -> str: ...

    @property
    def has_ended(self) -> bool: ...

    def do(self, make: Callable[[Asks], Asked]) -> Asked:
        """Have something done; it is under way when this returns."""
        ...

    def wait(self, task: Asked, look: Callable[[], None] | None = None) -> Reply:
        """Wait for the outcome of a task, and call `look` now and then."""
        ...

    def event(self, limit_s: float = ...) -> tuple[int, Event] | None:
        """Return the next event and when it came (ms), or None where none comes."""
        ...

    def stop(self) -> None:
        """Stop the robot. STOPPED is among the events when it has confirmed."""
        ...

    def close(self) -> None: ...
