"""Code that arrives while another one runs: it replaces that whole, or changes nothing."""

from __future__ import annotations

import pytest

from tests.firmware.test_host_firmware import computer, happened, image_of, send, switched_on
from tests.machines.host_firmware import HostFirmware
from tiniscript.link.frames import Frame, encoded
from tiniscript.link.messages import BY_NAME, RUN
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

RUNS = "SI|X = 3; W(0.02); X = 4; LOOP(FOREVER); F(0.2, 40); SHOW(X); END_LOOP"


def live(robot: HostFirmware, session: Session, text: str) -> None:
    request = session.live(image_of(text).code)
    assert robot.until(session, request) == OK


@pytest.mark.parametrize("is_line", [False, True])
def test_a_line_that_replaces_a_run_begins_at_its_own_beginning(is_line: bool) -> None:
    robot, session = switched_on(), computer()
    (live if is_line else send)(robot, session, RUNS)
    robot.talk(session, 100)
    session.events()
    robot.did.clear()
    live(robot, session, "SI|F(0.1, 60); Y = TIME; SHOW(Y < 0.2); SHOW(5)")
    robot.talk(session, 300)
    moves = [line for line in happened(robot) if line.startswith("MOTORS")]
    assert moves[-2:] == ["MOTORS 60 60", "MOTORS 0 0"] and "MOTORS 40 40" not in moves
    shown = [each.value for each in session.events() if each.name == "SHOW"]
    assert shown == [1, 5000]


@pytest.mark.parametrize("at", range(-5, 0))
def test_a_damaged_line_changes_nothing_of_the_one_that_runs(at: int) -> None:
    """Code is made ready while its frame arrives: not where the code lies that runs."""
    robot, session = switched_on(), computer()
    live(robot, session, "SI|F(0.2, 40); F(0.2, 50); SHOW(7)")
    robot.talk(session, 50)
    session.events()
    payload = bytes([RUN]) + image_of("SI|F(0.2, 90); F(0.2, 90); SHOW(9)").code
    frame = Frame(BY_NAME["LIVE"].number, (session._seq + 1) & 0xFF, session._epoch, payload)
    wire = bytearray(encoded(frame))
    if at < -1:
        wire[at] ^= 0x11
    for byte in wire if at < -1 else wire[:-1]:  # or it is cut before its end
        robot.step(bytes([byte]))
    robot.talk(session, 600)
    moves = [line for line in happened(robot) if line.startswith("MOTORS")]
    assert "MOTORS 50 50" in moves and "MOTORS 90 90" not in moves
    assert [each.value for each in session.events() if each.name == "SHOW"] == [7000]
