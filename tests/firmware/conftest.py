"""Simulated boards with the firmware that goes onto them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.support.mosquitto import Mosquitto
from tools.uno import Uno


@pytest.fixture
def memory(tmp_path: Path) -> Path:
    return tmp_path / "eeprom"


@pytest.fixture
def uno(sketch: Path, memory: Path) -> Iterator[Uno]:
    from tests.support.robot_on_uno import switched_on

    with switched_on(sketch, memory) as started_uno:
        yield started_uno


@pytest.fixture
def robot(board: str, sketches: Callable[[str], Path], memory: Path) -> Iterator[Uno]:
    """The one of the parameter `board`."""
    from tests.support.robot_on_uno import switched_on

    with switched_on(sketches(board), memory, board) as started_uno:
        yield started_uno


@pytest.fixture
def brokers(request: pytest.FixtureRequest, tmp_path: Path) -> Callable[..., Mosquitto]:
    """Return a factory of brokers for a test; the arguments are those of `Mosquitto`."""

    def begin(user: str = "", password: str = "", extra_rules: str = "") -> Mosquitto:
        mosquitto = Mosquitto(tmp_path, user, password, extra_rules)
        request.addfinalizer(mosquitto.kill)
        return mosquitto

    return begin
