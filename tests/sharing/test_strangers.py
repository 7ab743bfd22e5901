"""Whatever a client without the token sends to a shared port, the session there continues."""

from __future__ import annotations

import json
import signal

from tests.support.command import Command
from tests.support.port_strangers import say_all
from tests.support.pty_robot import PtyRobot, on, start_endless_upload


def test_no_bytes_of_a_stranger_end_a_run_or_the_server(pty_robot: PtyRobot, link: Command) -> None:
    """The heartbeat of the command that has started it continues."""
    command = start_endless_upload(pty_robot)
    say_all(pty_robot.port, 14, 1500)
    assert pty_robot.moves
    assert not [line for line in pty_robot.actions if "FAULT" in line or "STOP" in line]
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["state"] == "RUNNING"
    assert on(pty_robot, "stop").code == 0
    assert command.wait_for_result().code == 3
    link.signal(signal.SIGINT)
    result = link.wait_for_result()
    assert (result.code, result.err) == (0, "\n")
    assert result.out.count(": connected.") == 3  # strangers are not reported


# -- of `test_many_strangers.py`, too --------------------------------------------------------------
