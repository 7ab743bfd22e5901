"""The recipients of an ESP32's readings, if several clients request them."""

from __future__ import annotations

import pytest

from tests.support.esp32_radio import LowEnergy, session, talk
from tests.support.images import image_of
from tests.support.robot_on_esp32 import Ends, boot, wait_for_outcome
from tiniscript.link.messages import AUTHORITY_MS
from tiniscript.link.payloads import ReadingEvent
from tiniscript.link.session import Session

LIGHT, LIGHT_PIN = 1, 35  # LIGHT_L of a tinibot32
CHANGE_COUNT = 8
READING_PROGRAM = "SI|LOOP(FOREVER);X = LIGHT_L;W(0.1);END_LOOP"


def readings(client: Session) -> list[ReadingEvent]:
    return [event for event in client.events() if isinstance(event, ReadingEvent)]


@pytest.mark.parametrize("then", ["stays", "asks again", "leaves", "comes anew"])
def test_the_driver_gets_all_readings_whatever_other_clients_do(then: str) -> None:
    """The other client gets none: readings go to the same client as values."""
    robot = boot()
    driver, other_session = session(1, robot), session(2, robot)
    end = LowEnergy(robot)
    clients: Ends = [(None, driver), (end, other_session)]
    assert wait_for_outcome(robot, clients, other_session.tell_readings(True)) == "OK"
    talk(robot, clients, AUTHORITY_MS + 300)  # an idle open page gives way
    assert wait_for_outcome(robot, clients, driver.tell_readings(True)) == "OK"
    assert (
        wait_for_outcome(robot, clients, driver.upload(image_of(READING_PROGRAM), saves=False))
        == "OK"
    )
    talk(robot, clients, 300)
    if then == "asks again":
        assert wait_for_outcome(robot, clients, other_session.tell_readings(True)) == "OTHER_DRIVER"
    elif then == "leaves":
        end.leave()
        clients = clients[:1]
    elif then == "comes anew":
        other_session = session(3, robot)
        clients = [(None, driver), (end, other_session)]
        assert wait_for_outcome(robot, clients, other_session.hello()) == "OK"
    for number in range(1, CHANGE_COUNT + 1):
        robot.set_analog(LIGHT_PIN, 400 * number)
        talk(robot, clients, 300)
    values = [event.value for event in readings(driver) if event.sensor == LIGHT]
    assert len(values) >= CHANGE_COUNT and values == sorted(values)
    assert not readings(other_session)
