"""How long a busy port is waited for, from when its address is known: on a fake clock."""

from __future__ import annotations

import random
from typing import Any

import pytest

from tiniscript.library import opening
from tiniscript.library.errors import RobotError
from tiniscript.library.opening import AGAIN_S, BUSY_S

SEARCH_S = 0.5 * BUSY_S, BUSY_S + 1, 10 * BUSY_S


class Place:
    """A port that takes a while to find, and that somebody else has until a moment."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, search_s: float, busy_s: float) -> None:
        self.now_s = 50.0
        self.search_s, self.busy_s = search_s, busy_s
        self.free_s = self.now_s + busy_s
        self.reason = "port_busy"
        self.tries = 0
        monkeypatch.setattr("tiniscript.library.opening.monotonic", lambda: self.now_s)
        monkeypatch.setattr("tiniscript.library.opening.sleep", self.pass_s)
        monkeypatch.setattr(opening, "_resolved", self.resolved)
        monkeypatch.setattr(opening, "_joined", lambda *_: None)
        monkeypatch.setattr(opening, "_claimed", lambda *_: None)
        monkeypatch.setattr(opening, "_opened_line", self.opened)

    def pass_s(self, seconds: float) -> None:
        self.now_s += seconds

    def resolved(self, port: str, language: str) -> str:
        self.pass_s(self.search_s)
        self.free_s = self.now_s + self.busy_s
        return "ble://aa:bb:cc:dd:ee:01"

    def opened(self, address: str, *_: object) -> Any:
        self.tries += 1
        if self.now_s < self.free_s:
            raise RobotError(self.reason, "en", {"port": address, "why": ""})
        return self


PORTS = ("ble://Tini 1", "/dev/ttyUSB0")


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("port", PORTS)
def test_a_port_that_is_free_soon_is_opened(
    monkeypatch: pytest.MonkeyPatch, port: str, seed: int
) -> None:
    """Its owner may be leaving: however long the search for it took."""
    rng = random.Random(seed)
    place = Place(monkeypatch, rng.choice(SEARCH_S), rng.uniform(0, BUSY_S - AGAIN_S))
    found: object = opening.connection_to(port, "upload", 9600, 1)
    assert found is place
    assert place.now_s <= place.free_s + AGAIN_S


@pytest.mark.parametrize("search_s", SEARCH_S)
@pytest.mark.parametrize("port", PORTS)
def test_a_port_that_stays_busy_is_said_to_be(
    monkeypatch: pytest.MonkeyPatch, port: str, search_s: float
) -> None:
    place = Place(monkeypatch, search_s, 100 * BUSY_S)
    began_s = place.now_s + (search_s if port == PORTS[0] else 0)
    with pytest.raises(RobotError) as busy:
        opening.connection_to(port, "upload", 9600, 1)
    assert busy.value.reason == "port_busy"
    assert BUSY_S < place.now_s - began_s < BUSY_S + 2 * AGAIN_S
    place.reason, place.tries = "port_gone", 0
    with pytest.raises(RobotError) as gone:
        opening.connection_to(port, "upload", 9600, 1)
    assert (gone.value.reason, place.tries) == ("port_gone", 1), "nothing else is waited for"
