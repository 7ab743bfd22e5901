"""A session with a robot that was reset meanwhile: it counts its events and its runs anew."""

from __future__ import annotations

import pytest

from tests.machines.host_firmware import HostFirmware, missing
from tiniscript import compile_text, robots
from tiniscript.link.messages import STATUSES
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

KIT = robots.load("tinibot").kit
pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")


def test_a_reset_robot_runs_its_first_program_with_a_heartbeat() -> None:
    session = Session(1, 9600, KIT.fingerprint)
    first = HostFirmware(KIT)
    first.wait(100)
    assert first.until(session, session.live(compile_text("SHOW(1)", KIT).code)) == OK
    first.talk(session, 500)
    assert [event.name for event in session.events()] == ["SHOW", "DONE"]

    second = HostFirmware(KIT, seed=0x9ABCDEF1)  # run 1 of the first has ended, this one's has not
    second.now_ms = first.now_ms
    second.wait(100)
    code = compile_text("SHOW(2);F(2, 80);SHOW(3)", KIT).code
    assert second.until(session, session.live(code)) == STATUSES["STALE"]
    assert second.until(session, session.live(code)) == OK
    assert session.is_running
    second.talk(session, 2500)
    assert [event.name for event in session.events()] == ["SHOW", "SHOW", "DONE"]
