"""A robot on a desk whose port this process shares, as `tsc link` does."""

from __future__ import annotations

from tests.desk import Desk
from tiniscript import robots
from tiniscript.link.line import Line
from tiniscript.link.ports import opened
from tiniscript.link.session import Session
from tiniscript.sharing.registry import Holder
from tiniscript.sharing.server import Host

KIT = robots.load("tinibot").kit


class Shared:
    """A line of this process that is shared."""

    def __enter__(self) -> tuple[Desk, Holder]:
        self.desk = Desk(KIT)
        device = opened(self.desk.port, 9600)
        self.line = Line(device, Session(1, 9600, KIT.fingerprint))
        self.host = Host(self.line, self.desk.port, 9600, "link")
        return self.desk, self.host.holder

    def __exit__(self, *_: object) -> None:
        self.host.close()
        self.line.close()
        self.desk.clear_away()
