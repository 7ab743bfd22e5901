"""What Windows tells of a computer: pnputil, whose words are in the language of the system.

Only what is the same in every language is read: the numbers of devices.
"""

from __future__ import annotations

import re

from tiniscript.doctor.computer import NONE, ON, UNKNOWN, Adapter, Computer, chip_of
from tiniscript.doctor.system import System

_USB = re.compile(r"USB\\VID_([0-9A-F]{4})&PID_([0-9A-F]{4})", re.I)
_PAIRED = re.compile(r"BTHENUM\\DEV_[0-9A-F]{12}", re.I)
_NAME = re.compile(r":\s*(.+?)\s*$")


def inspect_windows(system: System) -> Computer:
    ports = system.ports()
    connected = _query(system)
    problems = _query(system, "/problem")
    adapters = None
    if connected is not None:
        broken = _chips(problems or "")
        adapters = tuple(
            Adapter(chip, "", "", chip not in broken)
            for chip in _chips(connected + (problems or ""))
        )
    radio = _query(system, "/class", "Bluetooth")
    bluetooth, paired = UNKNOWN, None
    if radio is not None:
        has_adapter = re.search(r"(?:USB\\VID|PCI\\VEN|ACPI\\)", radio, re.I) is not None
        bluetooth = ON if has_adapter else NONE
        paired = tuple(_names(radio))
    return Computer(system.platform, tuple(ports), adapters, bluetooth, paired)


def _query(system: System, *words: str) -> str | None:
    return system.output("pnputil", "/enum-devices", "/connected", *words)


def _chips(output: str) -> list[str]:
    result = (chip_of(vendor.lower(), product.lower()) for vendor, product in _USB.findall(output))
    return list(dict.fromkeys(chip[0] for chip in result if chip is not None))


def _names(output: str) -> list[str]:
    """Return the names of paired devices: the row after their number."""
    names = []
    rows = output.splitlines()
    for number, row in enumerate(rows[:-1]):
        name = _NAME.search(rows[number + 1])
        if _PAIRED.search(row) and name:
            names.append(name[1])
    return names
