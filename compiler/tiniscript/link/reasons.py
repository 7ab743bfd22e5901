"""Why a request was not done, as a short name: what a robot refuses, and what a line does.

Knows no sentences: the command, the library and the page have their own.
"""

from __future__ import annotations

from typing import Protocol

from tiniscript.link.outcomes import CANCELLED, LOST, UNPROVEN
from tiniscript.link.requests import DeviceInfo, Reply

STATUS = "status"  # the robot's status says why


class Heard(Protocol):
    """What is known of a connection: whether a robot has answered, and what else came.

    `heard` counts received bytes; `is_echoed`: the line returns what is sent.
    """

    @property
    def robot(self) -> DeviceInfo | None: ...

    @property
    def heard(self) -> int: ...

    @property
    def is_echoed(self) -> bool: ...


def reason_of(line: Heard, reply: Reply[object]) -> str:
    """Return why a reply is not OK."""
    if reply.status == CANCELLED:
        return "stopped_elsewhere"
    if reply.status == UNPROVEN:
        return "unproven"
    if reply.status != LOST:
        return STATUS
    if line.robot is not None:
        return "link_lost"
    if line.is_echoed:
        return "link_echo"
    return "link_other" if line.heard else "link_silent"
