"""What a computer says at an MQTT broker is said once: Mosquitto keeps none of it."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

from tests.support.mosquitto import Mosquitto, missing
from tiniscript.link.messages import STOP_BYTES

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a broker")


def kept(own: Mosquitto) -> list[str]:
    """Return the topics of all that a broker retains."""
    late = own.connected()
    found: list[str] = []

    def keep(_: Any, __: Any, message: Any) -> None:
        found.append(message.topic)

    late._client.on_message = keep
    late._client.subscribe("#")
    time.sleep(0.3)
    late.close()
    return found


def test_stops_and_frames_are_not_retained(tmp_path: Path) -> None:
    own = Mosquitto(tmp_path)
    try:
        teacher = own.connected()
        port = teacher.robot("aula", "12345678")
        port.write(bytes(STOP_BYTES))
        teacher.stop("aula")
        port.close()
        time.sleep(0.1)
        assert kept(own) == []
        teacher._client.publish("tiniscript/aula/12345678", b"+x", retain=True)
        time.sleep(0.1)
        assert kept(own) == ["tiniscript/aula/12345678"], "what is retained would be seen"
        teacher.close()
    finally:
        own.kill()
