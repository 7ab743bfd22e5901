"""An ESP32 is READY for existing services: a broker that grants access, a network that is up."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_broker import broker_settings_of, wait_until
from tests.support.esp32_radio import radios, talk
from tests.support.esp32_wifi import HOTSPOT, join_network, make_owned_robot, state
from tests.support.mosquitto import LOCAL_ADDRESS
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import Ends, wait_for_outcome
from tiniscript.link import wifi
from tiniscript.link.messages import STATE_STOPPED, STOP_BYTES
from tiniscript.link.session import Session

CONNECT, SUBSCRIBE, PING, PUBLISH = 0x10, 0x80, 0xC0, 0x30


class StrictBroker:
    """A broker that admits everyone, and answers subscriptions with these bytes.

    Before that, it sends the bytes `early`.
    """

    def __init__(self, granted_bytes: bytes = b"\0\0", early: bytes = b"") -> None:
        self.granted, self.early = granted_bytes, early
        self.published: list[bytes] = []  # published messages
        self.asked = 0  # number of subscriptions
        self.listener = socket.create_server(("127.0.0.1", 0))
        threading.Thread(target=self._serve, daemon=True).start()

    def settings(self) -> wifi.BrokerSettings:
        return wifi.BrokerSettings(LOCAL_ADDRESS, self.listener.getsockname()[1], "aula", b"", b"")

    def close(self) -> None:
        self.listener.close()

    def _serve(self) -> None:
        while True:
            try:
                end = self.listener.accept()[0]
            except OSError:
                return
            with end:
                self._talk(end)

    def _talk(self, end: socket.socket) -> None:
        data = b""
        try:
            while received := end.recv(4096):
                data += received
                while len(data) >= 2 and len(data) >= 2 + data[1]:  # no packet of ours is longer
                    self._answer(end, data[0] & 0xF0, data[2 : 2 + data[1]])
                    data = data[2 + data[1] :]
        except OSError:
            pass

    def _answer(self, end: socket.socket, kind: int, body: bytes) -> None:
        if kind == CONNECT:
            end.sendall(b"\x20\2\0\0")
        elif kind == SUBSCRIBE:
            self.asked += 1
            codes = body[:2] + self.granted
            end.sendall(self.early + b"\x90" + bytes([len(codes)]) + codes)
        elif kind == PING:
            end.sendall(b"\xd0\0")
        elif kind == PUBLISH:
            self.published.append(body)


@pytest.fixture
def brokers() -> Iterator[list[StrictBroker]]:
    strict_brokers: list[StrictBroker] = []
    yield strict_brokers
    for strict_broker in strict_brokers:
        strict_broker.close()


def robot_at_broker(
    broker: StrictBroker, strict_brokers: list[StrictBroker]
) -> tuple[Esp32Robot, Session]:
    strict_brokers.append(broker)
    robot, owner = join_network(Keys())
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(broker.settings())) == "OK"
    return robot, owner


@pytest.mark.sampled("granted_bytes")
@pytest.mark.parametrize("granted_bytes", [b"\x80\x80", b"\0\x80", b"\x80\0"])
def test_a_broker_that_refuses_the_subscription_is_not_ready(
    granted_bytes: bytes, brokers: list[StrictBroker]
) -> None:
    """For example, the broker's access list may omit the class."""
    robot, owner = robot_at_broker(broker := StrictBroker(granted_bytes), brokers)
    wait_until(robot, lambda: broker.asked >= 3)
    assert broker_settings_of(robot, owner)[1] == "REFUSED", "and it is tried again"
    assert broker.published == [], "nobody is told that the robot is there"
    broker.granted = b"\0\0"
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY")
    wait_until(robot, lambda: len(broker.published) == 1)


@pytest.mark.sampled("granted_bytes")
@pytest.mark.parametrize("granted_bytes", [b"\0", b"\0\0\0", b"\0\3"])
def test_an_answer_to_another_request_is_ignored(
    granted_bytes: bytes, brokers: list[StrictBroker]
) -> None:
    robot, owner = robot_at_broker(broker := StrictBroker(granted_bytes), brokers)
    wait_until(robot, lambda: broker.asked >= 2)
    assert broker_settings_of(robot, owner)[1] == "SEARCHING"
    assert broker.published == []


def test_a_stop_before_the_answer_counts(brokers: list[StrictBroker]) -> None:
    """A broker may send messages before it has confirmed a subscription."""
    topic = b"tiniscript/aula/stop"
    stop = bytes([PUBLISH, 2 + len(topic) + STOP_BYTES, 0, len(topic)]) + topic + bytes(STOP_BYTES)
    robot, owner = robot_at_broker(broker := StrictBroker(early=stop), brokers)

    def is_stopped() -> bool:  # messages from before the stop are stale
        status = owner.status()
        assert wait_for_outcome(robot, [(None, owner)], status) == "OK" and status.outcome
        return bool(status.outcome.values.state == STATE_STOPPED)

    wait_until(robot, is_stopped)
    assert wait_for_outcome(robot, [(None, owner)], owner.hello()) == "OK"
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY")
    assert broker.asked == 1, "it was the first answer"


def test_a_failed_access_point_is_not_ready_and_retried() -> None:
    robot, owner = make_owned_robot(Keys())
    clients: Ends = [(None, owner)]
    robot.radio("H", b"\1")
    assert wait_for_outcome(robot, clients, owner.join(HOTSPOT)) == "OK"
    talk(robot, clients, 1000)
    assert state(robot, owner) == ("ACCESS_POINT", "REFUSED")
    assert not radios(robot).is_access_point
    talk(robot, clients, 30_000)
    assert state(robot, owner) == ("ACCESS_POINT", "REFUSED")
    robot.radio("H", b"\0")
    talk(robot, clients, 16_000)
    assert state(robot, owner) == ("ACCESS_POINT", "READY")
    assert radios(robot).is_access_point and radios(robot).network.encode() == HOTSPOT.name
