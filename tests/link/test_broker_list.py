"""The list of a class at a broker: whole over a slow network, and over one with gaps."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.mosquitto import Mosquitto
from tests.support.network import Network

paho = pytest.importorskip("paho.mqtt.publish")
from tiniscript.link.errors import PortError  # noqa: E402
from tiniscript.link.transports import broker  # noqa: E402

ROBOTS = 30


class SlowNetwork(Network):
    """What the broker hears is `late_s` on its way, and what it says stands still for `gap_s` once,
    in the middle of what it retains; `is_cut` says nothing of that at all.
    """

    most = 200

    def __init__(self, target: int, late_s: float, gap_s: float, is_cut: bool) -> None:
        self.late_s, self.gap_s, self.is_cut = late_s, gap_s, is_cut
        self.is_silent = False
        super().__init__(target)

    def passed(self, data: bytes, is_back: bool, number: int) -> bytes:
        if not is_back:
            time.sleep(self.late_s)
        elif b"tiniscript/" in data:
            time.sleep(self.gap_s)
            self.gap_s = 0
            self.is_silent = self.is_cut
        return b"" if is_back and self.is_silent else data


@pytest.fixture
def school(tmp_path: Path) -> Iterator[Mosquitto]:
    """A broker that knows thirty robots of the class 3b."""
    found = Mosquitto(tmp_path, "robots", "word")
    robots = [
        {"topic": f"{broker.ROOT}/3b/{k:08x}", "payload": f"+R{k}", "retain": True}
        for k in range(ROBOTS)
    ]
    paho.multiple(robots, "127.0.0.1", found.port, auth={"username": "robots", "password": "word"})
    yield found
    found.kill()


@pytest.mark.parametrize(("late_s", "gap_s"), [(0.0, 0.0), (0.4, 0.0), (0.0, 0.8)])
def test_each_robot_of_a_class_is_listed(school: Mosquitto, late_s: float, gap_s: float) -> None:
    network = SlowNetwork(school.port, late_s, gap_s, is_cut=False)
    found = broker.Broker("127.0.0.1", network.port, broker.Access("robots", "word"))
    try:
        for _ in range(2):
            assert len(found.present("3b")) == ROBOTS
        assert found.present("4a") == []
    finally:
        found.close()
        network.close()


def test_a_list_that_is_not_whole_is_none(
    school: Mosquitto, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(broker, "LIST_S", 1.0)
    network = SlowNetwork(school.port, 0, 0, is_cut=True)
    found = broker.Broker("127.0.0.1", network.port, broker.Access("robots", "word"))
    try:
        with pytest.raises(PortError):
            found.present("3b")
    finally:
        found.close()
        network.close()
