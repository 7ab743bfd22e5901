"""The kits of the random programs, as the oracle and as the compiler know them."""

from __future__ import annotations

from tests.oracle import interpreter as oracle
from tests.oracle import programs
from tiniscript.base.kit import NUMBER, YES_NO, Device, Kit


def _devices(theirs: tuple[oracle.Device, ...]) -> tuple[Device, ...]:
    return tuple(
        Device(each.name, YES_NO if each.is_yes_no else NUMBER, "", each.low, each.high)
        for each in theirs
    )


def _kit(theirs: oracle.Kit) -> Kit:
    devices = _devices(theirs.sensors), _devices(theirs.actuators)
    return Kit(*devices, theirs.speed, theirs.turn)


KITS = [(each, _kit(each)) for each in (oracle.PAPER_KIT, programs.WIDE_KIT)]
