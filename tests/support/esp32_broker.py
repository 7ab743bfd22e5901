"""An ESP32 robot at a broker."""

from __future__ import annotations

import time
from collections.abc import Callable

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import talk
from tests.support.esp32_wifi import join_network
from tests.support.mosquitto import Mosquitto
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import wait_for_outcome
from tests.support.robot_on_host import actions_of
from tiniscript.link import wifi
from tiniscript.link.messages import AUTHORITY_MS
from tiniscript.link.session import Session
from tiniscript.link.transports.broker import Broker, RobotPresence

ID = "12345678"
DEAD_MAN_MS = 1050


def connect_to_broker(
    broker: Mosquitto, keys: Keys, settings: wifi.BrokerSettings | None = None
) -> tuple[Esp32Robot, Session]:
    """Return a robot with an owner, which is at the broker, and the owner's session by cable."""
    robot, owner = join_network(keys)
    request = owner.use_broker(settings or broker.settings())
    assert wait_for_outcome(robot, [(None, owner)], request) == "OK"
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY")
    talk(robot, [], AUTHORITY_MS + 100)
    # Shorter times would fail if the broker got no processor time.
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY")
    return robot, owner


def wait_until(robot: Esp32Robot, is_reached: Callable[[], bool], timeout_ms: int = 60_000) -> None:
    for _ in range(timeout_ms // 20):
        if is_reached():
            return
        for _ in range(20):
            robot.step()
            time.sleep(0.0005)
    raise AssertionError("not in time")


def broker_settings_of(robot: Esp32Robot, owner: Session) -> tuple[str, str, str]:
    """Return the mode, the state and the class of its broker."""
    request = owner.broker()
    assert wait_for_outcome(robot, [(None, owner)], request) == "OK" and request.outcome
    wifi_reply = request.outcome.values
    return wifi.MODES[wifi_reply.mode], wifi.STATES[wifi_reply.state], wifi_reply.network.decode()


def list_present_robots(
    robot: Esp32Robot, broker: Broker, group: str = "aula"
) -> list[RobotPresence]:
    robot.wait(20)
    return broker.list_robots(group)


def motor_state(robot: Esp32Robot) -> str:
    return [line for line in actions_of(robot) if "MOTORS" in line][-1]
