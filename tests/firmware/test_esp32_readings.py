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
    driver, other = session(1, robot), session(2, robot)
    end = LowEnergy(robot)
    ends: Ends = [(None, driver), (end, other)]
    assert wait_for_outcome(robot, ends, other.tell_readings(True)) == "OK"
    talk(robot, ends, AUTHORITY_MS + 300)  # an idle open page gives way
    assert wait_for_outcome(robot, ends, driver.tell_readings(True)) == "OK"
    assert (
        wait_for_outcome(robot, ends, driver.upload(image_of(READING_PROGRAM), saves=False)) == "OK"
    )
    talk(robot, ends, 300)
    if then == "asks again":
        assert wait_for_outcome(robot, ends, other.tell_readings(True)) == "OTHER_DRIVER"
    elif then == "leaves":
        end.leave()
        ends = ends[:1]
    elif then == "comes anew":
        other = session(3, robot)
        ends = [(None, driver), (end, other)]
        assert wait_for_outcome(robot, ends, other.hello()) == "OK"
    for number in range(1, CHANGE_COUNT + 1):
        robot.analog(LIGHT_PIN, 400 * number)
        talk(robot, ends, 300)
    values = [event.value for event in readings(driver) if event.sensor == LIGHT]
    assert len(values) >= CHANGE_COUNT and values == sorted(values)
    assert not readings(other)
