"""What a computer says at an MQTT broker is said once: Mosquitto keeps none of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.support.mosquitto import Mosquitto
from tests.support.waiting import HANGS_S, until
from tiniscript.link.messages import STOP_BYTES
from tiniscript.link.transports.broker import Broker

LAST = "tests/last"


def heard(client: Broker) -> None:
    """Wait until the broker has taken all that a client has said."""
    client._client.publish(LAST, b"", qos=1).wait_for_publish(HANGS_S)


def kept(own: Mosquitto) -> list[str]:
    """Return the topics of all that a broker retains."""
    late = own.connected()
    found: list[str] = []

    def keep(_: Any, __: Any, message: Any) -> None:
        found.append(message.topic)

    late._client.on_message = keep
    late._client.subscribe("#")
    late._client.publish(LAST, b"")  # what is retained comes before what is said later
    until(lambda: LAST in found, "all that is retained has come")
    late.close()
    return found[: found.index(LAST)]


def test_stops_and_frames_are_not_retained(tmp_path: Path) -> None:
    own = Mosquitto(tmp_path)
    try:
        teacher = own.connected()
        port = teacher.robot("aula", "12345678")
        port.write(bytes(STOP_BYTES))
        teacher.stop("aula")
        port.close()
        heard(teacher)
        assert kept(own) == []
        teacher._client.publish("tiniscript/aula/12345678", b"+x", retain=True)
        heard(teacher)
        assert kept(own) == ["tiniscript/aula/12345678"], "what is retained would be seen"
        teacher.close()
    finally:
        own.kill()
