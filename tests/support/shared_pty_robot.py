"""A robot on a pseudo-terminal whose port this process shares, as `tsc monitor --hold` does."""

from __future__ import annotations

from tests.support.pty_robot import PtyRobot
from tiniscript import robots
from tiniscript.link.port_connection import PortConnection
from tiniscript.link.ports import open_port
from tiniscript.link.session import Session
from tiniscript.link.sharing.registry import Registration
from tiniscript.link.sharing.server import Server

KIT = robots.load("tinibot").kit


class SharedLine:
    """A line of this process that is shared."""

    def __enter__(self) -> tuple[PtyRobot, Registration]:
        self.pty_robot = PtyRobot(KIT)
        device = open_port(self.pty_robot.port, 9600)
        self.line = PortConnection(device, Session(1, 9600, KIT.fingerprint))
        self.server = Server(self.line, self.pty_robot.port, 9600, "link")
        return self.pty_robot, self.server.registration

    def __exit__(self, *_: object) -> None:
        self.server.close()
        self.line.close()
        self.pty_robot.clear_away()
