"""What a session tells: events, and outcomes that no robot sends.

Shared by all that listen to one, also those in another process.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

LOST, CANCELLED = -1, -2  # outcomes that no robot sends
LOOK_S = 0.1  # between two looks at what has come: Windows lets Ctrl-C through only then


class Event(NamedTuple):
    """What there is to tell: an event of the robot by its name, or one of these.

    TEXT (`text`): a line of text came. MISSED (`count`): so many events did not arrive.
    LOST: nothing is heard of the robot any more. ECHO: what is sent comes back.
    ENDED: the program has ended, and the event that says how did not arrive.
    STARTED (`run`, `program`): somebody who shares the line has started this run.
    """

    name: str
    values: Mapping[str, int | bytes]


class Gone(Exception):
    """The way to the robot has ended; `why` is what the system says.

    `is_holder`: the command that held the port has ended. Else the port is not there any more.
    """

    def __init__(self, why: str = "", is_holder: bool = False) -> None:
        super().__init__(why)
        self.why = why
        self.is_holder = is_holder
