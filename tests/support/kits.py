"""The kits of the random programs, as the oracle and as the compiler know them."""

from __future__ import annotations

from tests.oracle import interpreter as oracle
from tests.oracle import programs
from tiniscript.base.kit import NUMBER, YES_NO, Device, Kit


def _devices(theirs: tuple[oracle.Device, ...]) -> tuple[Device, ...]:
    return tuple(
        Device(device.name, YES_NO if device.is_yes_no else NUMBER, "", device.low, device.high)
        for device in theirs
    )


def _kit(theirs: oracle.Kit) -> Kit:
    devices = _devices(theirs.sensors), _devices(theirs.actuators)
    return Kit(*devices, theirs.speed, theirs.turn)


KITS = [(kit, _kit(kit)) for kit in (oracle.PAPER_KIT, programs.WIDE_KIT)]
