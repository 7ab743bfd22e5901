"""How an ESP32 joins its network: a single owner of retries, waiting between them and for a
lease.
"""

from __future__ import annotations

from struct import pack

import pytest

from tests.support.esp32_radio import radios, set_network_in_reach, talk
from tests.support.esp32_wifi import SCHOOL, join_network, make_owned_robot, school_in_reach, state
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import Ends, boot, wait_for_outcome

drawn = pytest.mark.sampled(of="how an ESP32 joins", keep=2)

JOIN_RETRY_MS = 15_000  # kJoinAgainMs


@drawn
def test_a_late_address_is_waited_for() -> None:
    robot, owner = make_owned_robot(Keys())
    clients: Ends = [(None, owner)]
    school_in_reach(robot)
    robot.radio("l", pack("<I", 40_000))
    assert wait_for_outcome(robot, clients, owner.join(SCHOOL)) == "OK"
    talk(robot, clients, 39_000)
    assert state(robot, owner) == ("STATION", "SEARCHING")
    talk(robot, clients, 2000)
    assert state(robot, owner) == ("STATION", "READY")
    assert radios(robot).joins == 1, "each try would begin anew"


@drawn
def test_a_robot_out_of_reach_of_its_network_leaves_the_antenna_to_bluetooth() -> None:
    robot, owner = make_owned_robot(Keys())
    clients: Ends = [(None, owner)]
    assert wait_for_outcome(robot, clients, owner.join(SCHOOL)) == "OK"
    robot.wait(20 * JOIN_RETRY_MS)
    assert 20 <= radios(robot).joins <= 21
    school_in_reach(robot)
    robot.wait(JOIN_RETRY_MS + 100)
    assert state(robot, owner) == ("STATION", "READY")


@drawn
def test_a_returning_network_is_joined() -> None:
    robot, owner = join_network(Keys())
    robot.wait(JOIN_RETRY_MS)
    for away_ms in (50, 1000, 100_000):
        set_network_in_reach(robot, "", "")
        robot.wait(away_ms)
        school_in_reach(robot)
        robot.wait(JOIN_RETRY_MS + 100)
        assert state(robot, owner) == ("STATION", "READY")


@drawn
def test_a_network_that_disconnects_the_robot_is_joined_again() -> None:
    """After an ended authentication the status stays "connected", and `begin` does nothing."""
    robot, owner = join_network(Keys())
    robot.wait(2 * JOIN_RETRY_MS)
    joins = radios(robot).joins
    for turn in range(3):
        robot.radio("X")
        robot.wait(JOIN_RETRY_MS + 100)
        assert state(robot, owner) == ("STATION", "READY")
        assert radios(robot).joins == joins + turn + 1


def test_nothing_but_the_link_is_on_the_cable() -> None:
    """Espressif's libraries print their errors there, in the middle of a frame."""
    robot = boot()
    robot.radio("L")
    assert robot.wait(50) == b""
