"""The trim of the motors, number by number: the power of a wheel for each percent."""

from __future__ import annotations

from itertools import product

import pytest

from tests.machines.host_firmware import HostFirmware
from tiniscript import robots
from tiniscript.link.messages import EXCHANGED, LEFT_REVERSED, RIGHT_REVERSED

MOST = 40  # percent of the balance, and of the least power for moving
POWERS = range(-128, 128)


def level_of(percent: int) -> int:
    return min(percent, 100) * 653 // 256


def level(power: int, least: int, weakened: int) -> int:
    """Return the level of a wheel from the words of its header."""
    if power == 0:
        return 0
    low = level_of(least)
    missing = low + level_of(max(weakened, 0))
    duty = low + level_of(abs(power)) * (256 - missing) // 256
    if missing == 0:
        duty = level_of(abs(power))
    return duty if power > 0 else -duty


def levels(wheels: int, balance: int, least: int) -> list[tuple[int, int]]:
    pairs = []
    for power in POWERS:
        left, right = level(power, least, balance), level(power, least, -balance)
        left = -left if wheels & LEFT_REVERSED else left
        right = -right if wheels & RIGHT_REVERSED else right
        pairs.append((right, left) if wheels & EXCHANGED else (left, right))
    return pairs


def trim_of(wheels: int, balance: int, least: int) -> bytes:
    return bytes((wheels, balance & 0xFF, least))


@pytest.fixture(scope="module")
def robot() -> HostFirmware:
    return HostFirmware(robots.load("tinibot").kit)


def test_every_trim_gives_the_expected_level_for_every_power(robot: HostFirmware) -> None:
    assert level_of(100) == 255
    for balance, least in product(range(-MOST, MOST + 1), (0, 1, 19, MOST)):
        wheels = (balance + least) % 8
        expected = (True, levels(wheels, balance, least))
        assert robot.levels(trim_of(wheels, balance, least)) == expected, (wheels, balance, least)


def test_out_of_range_trims_are_invalid(robot: HostFirmware) -> None:
    for balance in range(-128, 128):
        assert robot.levels(trim_of(0, balance, 0))[0] == (abs(balance) <= MOST), balance
    for number in range(256):
        assert robot.levels(trim_of(number, 0, 0))[0] == (number < 8), number
        assert robot.levels(trim_of(0, 0, number))[0] == (number <= MOST), number
