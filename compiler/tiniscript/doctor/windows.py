"""Facts about a computer on Windows: pnputil, whose output is in the system's language.

It reads only the parts that are the same in every language: the numbers of devices.
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
    connected_devices = _query(system)
    problem_devices = _query(system, "/problem")
    adapters = None
    if connected_devices is not None:
        broken_chips = _chips(problem_devices or "")
        adapters = tuple(
            Adapter(chip, "", "", chip not in broken_chips)
            for chip in _chips(connected_devices + (problem_devices or ""))
        )
    bluetooth_devices = _query(system, "/class", "Bluetooth")
    bluetooth, paired_names = UNKNOWN, None
    if bluetooth_devices is not None:
        has_adapter = (
            re.search(r"(?:USB\\VID|PCI\\VEN|ACPI\\)", bluetooth_devices, re.I) is not None
        )
        bluetooth = ON if has_adapter else NONE
        paired_names = tuple(_names(bluetooth_devices))
    return Computer(system.platform, tuple(ports), adapters, bluetooth, paired_names)


def _query(system: System, *words: str) -> str | None:
    return system.output("pnputil", "/enum-devices", "/connected", *words)


def _chips(output: str) -> list[str]:
    chips = (chip_of(vendor.lower(), product.lower()) for vendor, product in _USB.findall(output))
    return list(dict.fromkeys(chip[0] for chip in chips if chip is not None))


def _names(output: str) -> list[str]:
    """Return the names of paired devices: the row after their number."""
    names = []
    rows = output.splitlines()
    for index, row in enumerate(rows[:-1]):
        match = _NAME.search(rows[index + 1])
        if _PAIRED.search(row) and match:
            names.append(match[1])
    return names
