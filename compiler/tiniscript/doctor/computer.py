"""The equipment of a computer: USB adapters with drivers, Bluetooth, and users of a port.

The same for all systems; `systems` asks each one.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

from tiniscript.link.ports import ListedPort

ON, OFF, NONE, UNKNOWN = "on", "off", "none", "unknown"  # Bluetooth

# USB adapters of boards: vendor and product, the common name, the driver of Linux.
CHIPS: dict[tuple[str, str], tuple[str, str]] = {
    ("1a86", "7523"): ("CH340", "ch341"),
    ("1a86", "5523"): ("CH341", "ch341"),
    ("1a86", "7522"): ("CH340", "ch341"),
    ("1a86", "55d4"): ("CH9102", "cdc_acm"),
    ("0403", "6001"): ("FT232", "ftdi_sio"),
    ("0403", "6015"): ("FT231", "ftdi_sio"),
    ("10c4", "ea60"): ("CP2102", "cp210x"),
    ("067b", "2303"): ("PL2303", "pl2303"),
}
ARDUINO_VENDORS = ("2341", "2a03")  # vendors
# Names that modules have from the factory, and from `tsc doctor --module`.
_MODULE_NAME = re.compile(
    r"HC-0[56]|HC0[56]|linvor|HMSoft|BT05|BT-05|MLT|CC41|SPP-C|JDY|Tini-", re.I
)


class Adapter(NamedTuple):
    """A USB adapter: its chip, the driver that it needs, and the one in use (or none)."""

    chip: str
    wanted_driver: str
    driver: str
    has_port: bool


class Computer(NamedTuple):
    """`adapters` and `paired_names` are None if the system does not report them.

    `paired_names` are names of Bluetooth devices: they may be those of people's phones, and are
    never reported. `programs` are those of interest that run.
    """

    platform: str
    ports: tuple[ListedPort, ...]
    adapters: tuple[Adapter, ...] | None
    bluetooth: str
    paired_names: tuple[str, ...] | None
    programs: frozenset[str] = frozenset()

    @property
    def has_module(self) -> bool | None:
        """Return whether a device that looks like a robot's module is paired; None if unknown."""
        return None if self.paired_names is None else any(map(is_module, self.paired_names))


class Access(NamedTuple):
    """The access rights of a port, and the names of the programs that use it, if known.

    `is_joined`: the user is in the group, but logged in before that.
    """

    may_use: bool
    group: str
    is_joined: bool
    using_programs: tuple[str, ...]


FREE_ACCESS = Access(True, "", False, ())


def chip_of(vendor: str, product: str) -> tuple[str, str] | None:
    """Return the name of an adapter and its driver, or None for any other USB device."""
    if vendor in ARDUINO_VENDORS:
        return "Arduino", "cdc_acm"
    return CHIPS.get((vendor, product))


def is_module(name: str) -> bool:
    return _MODULE_NAME.search(name) is not None


def looks_wireless(port: str, description: str = "") -> bool:
    """Return whether a port is Bluetooth, by its name or the system's description."""
    text = f"{port} {description}".lower()
    return any(word in text for word in ("rfcomm", "bluetooth", "bthenum")) or is_module(text)


def adapters_without_driver(adapters: Iterable[Adapter]) -> list[Adapter]:
    return [adapter for adapter in adapters if not adapter.has_port]
