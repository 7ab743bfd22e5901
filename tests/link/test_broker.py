"""A broker: the list of a class is complete over a slow network, its messages are not stored, and
large ones are refused.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from random import Random
from threading import Thread
from typing import Any

import pytest

from tests.support.mosquitto import Mosquitto
from tests.support.network import Network
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript.link.messages import STOP_BYTES

paho = pytest.importorskip("paho.mqtt.publish")
from tiniscript.link.errors import PortError  # noqa: E402
from tiniscript.link.transports import broker  # noqa: E402
from tiniscript.link.transports.broker import MESSAGE_BYTES, SKIPPED_BYTES, Access, Broker  # noqa: E402

ROBOTS = 30
LAST_TOPIC = "tests/last"
CONNACK = bytes((0x20, 2, 0, 0))
LARGE_PIECE = bytes(65_536)


@pytest.fixture
def school(tmp_path: Path) -> Iterator[Mosquitto]:
    """A broker that knows thirty robots of the class 3b."""
    mosquitto = Mosquitto(tmp_path, "robots", "word")
    robots = [
        {"topic": f"{broker.ROOT}/3b/{k:08x}", "payload": f"+R{k}", "qos": 1, "retain": True}
        for k in range(ROBOTS)
    ]
    paho.multiple(
        robots, "127.0.0.1", mosquitto.port, auth={"username": "robots", "password": "word"}
    )
    yield mosquitto
    mosquitto.kill()


# -- the list of a class ------------------------------------------------------------------------


class SlowNetwork(Network):
    """Data for the broker is delayed by `late_s`, and its own stops for `gap_s` once, in the middle
    of the retained messages; `is_cut` drops those.
    """

    max_bytes = 200

    def __init__(self, target: int, late_s: float, gap_s: float, is_cut: bool) -> None:
        self.late_s, self.gap_s, self.is_cut = late_s, gap_s, is_cut
        self.is_silent = False
        super().__init__(target)

    def pass_on(self, data: bytes, is_back: bool, number: int) -> bytes:
        if not is_back:
            time.sleep(self.late_s)
        elif b"tiniscript/" in data:
            time.sleep(self.gap_s)
            self.gap_s = 0
            self.is_silent = self.is_cut
        return b"" if is_back and self.is_silent else data


@pytest.mark.parametrize(("late_s", "gap_s"), [(0.0, 0.0), (0.4, 0.0), (0.0, 0.8)])
def test_each_robot_of_a_class_is_listed(school: Mosquitto, late_s: float, gap_s: float) -> None:
    with (
        closing(SlowNetwork(school.port, late_s, gap_s, is_cut=False)) as network,
        closing(Broker("127.0.0.1", network.port, Access("robots", "word"))) as broker,
    ):
        for _ in range(2):
            assert len(broker.list_robots("3b")) == ROBOTS
        assert broker.list_robots("4a") == []


def test_an_incomplete_list_is_ignored(school: Mosquitto, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(broker, "LIST_S", 1.0)
    with (
        closing(SlowNetwork(school.port, 0, 0, is_cut=True)) as network,
        closing(Broker("127.0.0.1", network.port, Access("robots", "word"))) as school_broker,
        pytest.raises(PortError),
    ):
        school_broker.list_robots("3b")


# -- a broker that goes and comes back ------------------------------------------------------------


@pytest.mark.parametrize("seed", range(3))
def test_a_process_reconnects_when_its_broker_is_available(tmp_path: Path, seed: int) -> None:
    """However often it was not, and whether somebody wanted it meanwhile: robots share a connection
    as long as that lasts.
    """
    rng, mosquitto, is_running = Random(seed), Mosquitto(tmp_path), True
    connections = [broker.connect("127.0.0.1", mosquitto.port)]
    try:
        for _ in range(12):
            if rng.random() < 0.5:
                is_running = not is_running
                mosquitto.start() if is_running else mosquitto.kill()
            if not is_running:
                until(lambda: connections[-1].end_reason != "", "the connection ends")
            port = broker.port_of("127.0.0.1", mosquitto.port, "aula", f"{rng.randrange(3):08x}")
            if is_running:
                broker.open_port(port, 0, 1.0).write(bytes(STOP_BYTES))
                connections.append(broker.connect("127.0.0.1", mosquitto.port))
                assert connections[-1].stop("aula")
                assert connections[-1] is connections[-2] or connections[-2].end_reason
            else:
                with pytest.raises(PortError):
                    broker.open_port(port, 0, 1.0)
    finally:
        mosquitto.kill()
        for connection in connections:
            connection.close()


# -- a computer's messages are sent once ----------------------------------------------------------


def flush(client: Broker) -> None:
    """Wait until the broker has taken all that a client has said."""
    client._client.publish(LAST_TOPIC, b"", qos=1).wait_for_publish(HANG_LIMIT_S)


def retained_topics(mosquitto: Mosquitto) -> list[str]:
    """Return the topics of all that a broker retains."""
    late_client = mosquitto.connect_client()
    texts: list[str] = []

    def keep(_: Any, __: Any, message: Any) -> None:
        texts.append(message.topic)

    late_client._client.on_message = keep
    late_client._client.subscribe("#")
    late_client._client.publish(LAST_TOPIC, b"")  # retained messages precede later ones
    until(lambda: LAST_TOPIC in texts, "all that is retained has come")
    late_client.close()
    return texts[: texts.index(LAST_TOPIC)]


def test_stops_and_frames_are_not_retained(tmp_path: Path) -> None:
    mosquitto = Mosquitto(tmp_path)
    try:
        teacher = mosquitto.connect_client()
        port = teacher.port_of("aula", "12345678")
        port.write(bytes(STOP_BYTES))
        teacher.stop("aula")
        port.close()
        flush(teacher)
        assert retained_topics(mosquitto) == []
        teacher._client.publish("tiniscript/aula/12345678", b"+x", retain=True)
        flush(teacher)
        assert retained_topics(mosquitto) == ["tiniscript/aula/12345678"], (
            "what is retained would be seen"
        )
        teacher.close()
    finally:
        mosquitto.kill()


# -- a broker that sends more than a robot says ---------------------------------------------------


def message(bytes_of_it: int) -> bytes:
    """Return the head of a message with so many bytes after it."""
    head = bytearray((0x30,))
    while True:
        rest = bytes_of_it >> 7
        head.append((bytes_of_it & 127) | (128 if rest else 0))
        if not rest:
            return bytes(head)
        bytes_of_it = rest


@pytest.mark.parametrize("size", [MESSAGE_BYTES, MESSAGE_BYTES + 1, 10_000, SKIPPED_BYTES - 1000])
def test_an_oversized_retained_message_is_left_out(school: Mosquitto, size: int) -> None:
    """It may come before a robot, between robots and after one, and is named."""
    topics = [f"{broker.ROOT}/3b/{name}" for name in ("0000000f", "fff", "x" * 300)]
    retained_messages = [
        {"topic": topic, "payload": bytes(size), "qos": 1, "retain": True} for topic in topics
    ]
    retained_messages.append(
        {"topic": f"{broker.ROOT}/3b/ffffffff", "payload": "+Z", "qos": 1, "retain": True}
    )
    access = {"username": "robots", "password": "word"}
    paho.multiple(retained_messages, "127.0.0.1", school.port, auth=access)
    with closing(Broker("127.0.0.1", school.port, Access("robots", "word"))) as school_broker:
        for _ in range(2):
            assert len(school_broker.list_robots("3b")) == ROBOTS  # one of them was written over
        assert sorted(school_broker.skipped_topics) == sorted(topic[:80] for topic in topics)
        assert all(
            size < bytes_of_it < size + 320 for bytes_of_it in school_broker.skipped_topics.values()
        )
        assert school_broker.stop("3b") and not school_broker.end_reason


@pytest.mark.parametrize("size", [SKIPPED_BYTES + 1, (256 << 20) - 1])
def test_a_large_message_ends_the_connection_before_it_is_buffered(size: int) -> None:
    sent_count = 0

    def serve() -> None:
        nonlocal sent_count
        peer, _ = server_socket.accept()
        with peer:
            peer.recv(4096)
            peer.sendall(CONNACK + message(MESSAGE_BYTES) + b"\0\1x" + bytes(MESSAGE_BYTES - 3))
            peer.sendall(message(size))
            try:
                while sent_count < size:
                    sent_count += peer.send(LARGE_PIECE)
            except ConnectionError:
                pass

    with socket.create_server(("127.0.0.1", 0)) as server_socket:
        serving = Thread(target=serve, daemon=True)
        serving.start()
        client = Broker("127.0.0.1", server_socket.getsockname()[1], Access())
        until(lambda: client.end_reason != "", "the connection ends")
        assert client.end_reason == f"the broker sends a message of {size} bytes"
        serving.join(HANG_LIMIT_S)
        client.close()
    assert sent_count < 32 << 20  # size of the system's buffers
