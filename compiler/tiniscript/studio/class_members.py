"""Who and what is in a class: a pupil, and a robot with its turn."""

from __future__ import annotations

import secrets
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tiniscript.studio.hosted_robot import HostedRobot


@dataclass(eq=False)
class Pupil:
    """`waits`: the pupil wants a robot; who has a smaller number is earlier."""

    number: int
    name: str
    address: str
    heard_s: float
    text: str = ""
    waits: int | None = None
    knows_end: bool = False
    # The page's name for `hosting`: no page of the teacher's has it.
    page: str = field(default_factory=lambda: f"pupil-{secrets.token_hex(16)}")


@dataclass(eq=False)
class ClassRobot:
    """`hosted` is the connection of this turn, once the pupil's page has taken it."""

    port: str
    name: str
    pupil: Pupil | None = None
    hosted: HostedRobot | None = None
    began_s: float = 0.0
    free_s: float = 0.0

    def begin(self, pupil: Pupil, now_s: float) -> None:
        self.pupil, self.hosted, self.began_s = pupil, None, now_s

    def end(self) -> None:
        self.pupil = self.hosted = None
