"""The kits of the random programs, as the oracle and as the compiler know them."""

from __future__ import annotations

from tests.oracle import interpreter as oracle
from tests.oracle import programs
from tiniscript.base.kit import NUMBER, YES_NO, Device, Kit


def _devices(oracle_devices: tuple[oracle.Device, ...]) -> tuple[Device, ...]:
    return tuple(
        Device(device.name, YES_NO if device.is_yes_no else NUMBER, "", device.low, device.high)
        for device in oracle_devices
    )


def _kit(oracle_kit: oracle.Kit) -> Kit:
    devices = _devices(oracle_kit.sensors), _devices(oracle_kit.actuators)
    return Kit(*devices, oracle_kit.speed, oracle_kit.turn)


KITS = [(kit, _kit(kit)) for kit in (oracle.PAPER_KIT, programs.WIDE_KIT)]
