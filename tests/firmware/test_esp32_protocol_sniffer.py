"""Connections to an ESP32 in a network: clients get through, web pages do not."""

from __future__ import annotations

from random import Random

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import Network
from tests.support.esp32_wifi import join_network
from tests.support.foreign_protocols import FOREIGN_GREETINGS
from tests.support.owners import Keys
from tiniscript.link.messages import STOP_BYTES
from tiniscript.virtual.protocol_sniffer import sniff_robot_client


@pytest.fixture(scope="module")
def knocked_at() -> Esp32Robot:
    return join_network(Keys())[0]


@pytest.mark.parametrize("name", FOREIGN_GREETINGS)
def test_requests_of_web_pages_reach_no_robot(knocked_at: Esp32Robot, name: str) -> None:
    """In one piece and byte by byte: the robot disconnects without an answer."""
    robot, data = knocked_at, FOREIGN_GREETINGS[name]
    for size in (len(data), 1 if len(data) < 1000 else 97):
        end = Network(robot)
        for k in range(0, len(data), size):
            if not end.has_ended:
                end.send(data[k : k + size])
                robot.wait(1)
        robot.wait(3)
        assert end.take() == b"" and end.has_ended
        end.leave()
        robot.wait(2)


@pytest.mark.parametrize("data", [b"S\n", b"SI|F(2,80)\r\n", b"X = 5\n", b"// HTTP/1.1\n", b"\0"])
def test_robot_messages_pass_the_sniffer(knocked_at: Esp32Robot, data: bytes) -> None:
    end = Network(knocked_at)
    end.send(data + bytes(STOP_BYTES))
    knocked_at.wait(5)
    assert end.take() != b"" and not end.has_ended, "at least the stop is confirmed"
    end.leave()
    knocked_at.wait(60)


def sniff(robot: Esp32Robot, data: bytes) -> bool | None:
    """Return the verdict of the robot's own code about the first bytes of a connection."""
    return (None, True, False)[robot.ask(b"G", len(data).to_bytes(4, "little") + data)[0]]


def test_the_robot_classifies_clients_like_a_virtual_one(knocked_at: Esp32Robot) -> None:
    rng = Random(5)
    words = [*(data[:300] for data in FOREIGN_GREETINGS.values()), b"PING|\n", b"POST = 5\n",
             b"GET  /", b"S", b"a\xc3\xb1o = 5\n", b"https://x", b"HTTP/1.1",
             b"http:", b"\r\n", b"\0", b" ",
             b"\t", b"*", b"POST", b"pri", b"!x", b"="]  # fmt: skip
    for _ in range(3000):
        data = b"".join(rng.choice(words) for _ in range(rng.randrange(1, 4)))[:400]
        data = data[: rng.randrange(len(data) + 1)]
        if rng.random() < 0.3 and data:
            cut_index = rng.randrange(len(data))
            data = data[:cut_index] + rng.randbytes(1) + data[cut_index + 1 :]
        assert sniff(knocked_at, data) is sniff_robot_client(data), data
    for data in FOREIGN_GREETINGS.values():
        for k in range(min(len(data), 400)):
            assert sniff(knocked_at, data[:k]) is sniff_robot_client(data[:k]), data[:k]
