"""A robot over Bluetooth LE."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from tests.support.ble_robot import BleRobot
    from tests.support.fake_bluez import FakeBluez
    from tests.support.pty_robot import PtyRobot


@pytest.fixture
def bluez(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeBluez]:
    from tests.support.fake_bluez import FakeBluez

    with FakeBluez() as fake_bluez:
        monkeypatch.setenv("DBUS_SYSTEM_BUS_ADDRESS", fake_bluez.address)
        yield fake_bluez


@pytest.fixture
def ble(bluez: FakeBluez, pty_robot: PtyRobot) -> BleRobot:
    """An Uno with an HM-10."""
    from tests.support.ble_robot import BleRobot

    ble_robot = BleRobot(pty_robot)
    bluez.add(ble_robot)
    return ble_robot
