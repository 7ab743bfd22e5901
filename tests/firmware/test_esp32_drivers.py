"""The driver of a robot that is reachable over several transports, and changes of the driver."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import LowEnergy, RawClient, session, talk
from tests.support.esp32_wifi import make_owned_robot, remote
from tests.support.images import image_of
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import AWAY_PROGRAM, Ends, boot, upload_text, wait_for_outcome
from tests.support.robot_on_host import actions_of
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import AUTHORITY_MS, LISTEN_MS
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

SHORT = "SI|F(0.1, 30)"
PAUSE_MS = AUTHORITY_MS // 2


def pair(is_owned: bool) -> tuple[Esp32Robot, Session, Session]:
    """Return a robot and two clients that may drive it."""
    if not is_owned:
        robot = boot()
        return robot, session(1, robot), session(2, robot)
    robot, first = make_owned_robot(keys := Keys())
    return robot, first, remote(robot, keys, 2)


@pytest.mark.sampled("is_owned")
@pytest.mark.parametrize("is_owned", [False, True])
def test_an_idle_page_gives_way(is_owned: bool) -> None:
    robot, page, rival = pair(is_owned)
    clients: Ends = [(None, page), (LowEnergy(robot), rival)]
    assert upload_text(robot, clients, page, SHORT) == "OK"
    talk(robot, clients, AUTHORITY_MS - 300)
    assert upload_text(robot, clients, rival) == "OTHER_DRIVER", (
        "it may be about to send the next one"
    )
    talk(robot, clients, 60_000)
    assert upload_text(robot, clients, rival) == "OK"
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    assert upload_text(robot, clients, page, SHORT) == "OTHER_DRIVER"
    rival.stop(robot.now_ms)
    talk(robot, clients, AUTHORITY_MS + 300)
    assert upload_text(robot, clients, page, SHORT) == "OK", "and so does the other one"


@pytest.mark.sampled("is_owned")
@pytest.mark.parametrize("is_owned", [False, True])
@pytest.mark.parametrize("is_detached", [False, True])
def test_a_client_stays_the_driver_while_it_is_heard_and_its_program_runs(
    is_owned: bool, is_detached: bool
) -> None:
    robot, page, rival = pair(is_owned)
    clients: Ends = [(None, page), (LowEnergy(robot), rival)]
    upload = page.upload(image_of(AWAY_PROGRAM), saves=False, is_detached=is_detached)
    assert wait_for_outcome(robot, clients, upload) == "OK"
    for _ in range(5):
        talk(robot, clients, 5000)
        assert upload_text(robot, clients, rival) == "OTHER_DRIVER"
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    page.stop(robot.now_ms)
    talk(robot, clients, AUTHORITY_MS + 300)
    assert upload_text(robot, clients, rival) == "OK"


SHOWS = "SI|F(0.1, 80);LOOP(FOREVER);SHOW(7);W(0.5);END_LOOP"


@pytest.mark.parametrize("is_owned", [False, True])
@pytest.mark.parametrize("starts", ["a client", "a client, and the button"])
def test_a_detached_run_can_be_taken_over_once_its_client_is_silent(
    starts: str, is_owned: bool
) -> None:
    """Its values go to the listener, which may take over."""
    robot, page, rival = pair(is_owned)
    clients: Ends = [(None, page), (LowEnergy(robot), rival)]
    upload = page.upload(image_of(SHOWS), saves=False, is_detached=True)
    assert wait_for_outcome(robot, clients, upload) == "OK"
    if "button" in starts:  # a stop, and a start
        for _ in range(2):
            talk(robot, clients, 100, flags=1)
            talk(robot, clients, 300, flags=2)
    only = clients[1:]
    assert wait_for_outcome(robot, only, rival.hello()) == "OK"
    talk(robot, only, LISTEN_MS + 600)
    rival.events()
    talk(robot, only, 2000)
    assert {event.name for event in rival.events()} == {"SHOW"}
    assert upload_text(robot, only, rival) == "OK"
    assert actions_of(robot)[-1] == "MOTORS 80 80"


def test_a_page_gives_way_only_to_clients_with_a_key() -> None:
    robot, page, _ = pair(is_owned=True)
    stranger, typed_bytes = session(5, robot), RawClient()
    end = LowEnergy(robot)
    assert upload_text(robot, [(None, page)], page, SHORT) == "OK"
    talk(robot, [(None, page)], 5000)
    assert upload_text(robot, [(None, page), (end, stranger)], stranger) == "NOT_OWNER"
    end.leave()
    typed_bytes.to_send = b"SI|F(60, 80)\n"
    talk(robot, [(None, page), (LowEnergy(robot), typed_bytes)], 1500)
    assert "MOTORS 80 80" not in actions_of(robot)


UPLOAD = "an upload"  # an upload with few bytes in each turn
CHANGES: dict[str, Callable[[Session, int], PendingRequest[Any]]] = {
    UPLOAD: lambda session, turn: session.upload(
        image_of("SB|" + ";".join(["F(1, 80)"] * 1500)), saves=False
    ),
    "short programs": lambda session, turn: session.upload(image_of(SHORT), saves=False),
    "lines": lambda session, turn: session.live(image_of(SHORT).code),
    "names": lambda session, turn: session.name(b"n%d" % turn),
    "a trim": lambda session, turn: session.trim(bytes((0, turn, 0))),
    "a latch": lambda session, turn: session.clear(),
}


@pytest.mark.sampled("action", "is_owned", keep=3)
@pytest.mark.parametrize("is_owned", [False, True])
@pytest.mark.parametrize("action", CHANGES)
def test_an_active_client_is_not_overtaken(action: str, is_owned: bool) -> None:
    """However long it takes: each part that changes something counts. Then the next one drives."""
    robot, page, rival = pair(is_owned)
    far_end = LowEnergy(robot)
    clients: Ends = [(None, page), (far_end, rival)]
    page._baud = 9600  # a low speed, so that few bytes are sent at once
    assert upload_text(robot, clients, page, SHORT) == "OK"
    talk(robot, clients, 300)
    for turn in range(3 * AUTHORITY_MS // PAUSE_MS + 1):
        if action != UPLOAD or turn == 0:
            request = CHANGES[action](page, turn)
        talk(robot, clients, 3 if action == UPLOAD else 400)
        status = None if request.outcome is None else request.outcome.status
        assert status == (None if action == UPLOAD else OK), turn
        talk(robot, [(far_end, rival)], PAUSE_MS)
        assert upload_text(robot, [(far_end, rival)], rival, SHORT) == "OTHER_DRIVER", turn
    talk(robot, [(far_end, rival)], AUTHORITY_MS)
    assert upload_text(robot, [(far_end, rival)], rival) == "OK"


# -- the button -------------------------------------------------------------------------------


def upload_running(robot: Esp32Robot, clients: Ends, page: Session) -> None:
    assert upload_text(robot, clients, page) == "OK"


def upload_waiting(robot: Esp32Robot, clients: Ends, page: Session) -> None:
    assert upload_text(robot, clients, page, "SB|F(60, 80)") == "OK"


def upload_stopped(robot: Esp32Robot, clients: Ends, page: Session) -> None:
    upload_waiting(robot, clients, page)
    page.stop(robot.now_ms)
    talk(robot, clients, 100)


@pytest.mark.parametrize("prepare", [upload_running, upload_waiting, upload_stopped])
@pytest.mark.parametrize("is_owned", [False, True])
@pytest.mark.parametrize("has_passed", [False, True])
def test_anybody_may_drive_after_the_button(
    prepare: Callable[[Esp32Robot, Ends, Session], None], is_owned: bool, has_passed: bool
) -> None:
    """The previous driver, though still heard, has no part in the new run."""
    robot, page, rival = pair(is_owned)
    clients: Ends = [(None, page), (LowEnergy(robot), rival)]
    prepare(robot, clients, page)
    for _ in range(1 + (prepare is upload_running)):  # the first press is a stop
        talk(robot, clients, 100, flags=1)
        talk(robot, clients, 300, flags=2)
    assert actions_of(robot)[-1] == "MOTORS 80 80", "the button has started it"
    talk(robot, clients, AUTHORITY_MS + 300 if has_passed else 1)
    assert upload_text(robot, clients, rival) == "OK"
