"""Ports: lists them, opens one, and says why one cannot be opened.

Finds the transport of a port by how its name begins, and imports it with its first use: its package
may be missing. It knows no robot and no sentences: each failure has a name in `errors`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple, cast

from tiniscript.base.source import printable
from tiniscript.link.errors import NOT_INSTALLED, PortError
from tiniscript.link.port_names import is_address, is_at_broker, is_bluetooth_le, is_network_name
from tiniscript.link.transports import Port, Transport

if TYPE_CHECKING:
    from tiniscript.link.transports.bluetooth_search import SeenDevice
    from tiniscript.link.transports.network import AnnouncedRobot

OPEN_S = 20.0  # timeout of opening, which is long for a radio out of reach
# The ports of each transport; all others belong to `serial`.
_TRANSPORTS = (
    (is_bluetooth_le, "bluetooth"),
    (is_at_broker, "broker"),
    (is_network_name, "network"),
)


class ListedPort(NamedTuple):
    """A port that the system lists, and the system's description of it."""

    port: str
    description: str


def list_ports() -> list[ListedPort]:
    """Return the ports that the system knows. It opens none of them, because that resets boards."""
    from tiniscript.link.transports import serial

    ports = []
    for serial_port in serial.list_serial_ports():
        description = serial_port.description if serial_port.description != "n/a" else ""
        # A device reports this.
        ports.append(ListedPort(serial_port.device, printable(description)))
    return sorted(ports)


def is_radio(port: str) -> bool:
    """Return whether a port is wireless: opening it does not reset a board."""
    name = port.lower()
    if is_address(port) or "rfcomm" in name:
        return True
    if sys.platform == "darwin":
        return "usb" not in name
    if sys.platform == "win32":
        from tiniscript.link.transports import serial

        hardware_by_name = {
            serial_port.device.lower(): serial_port.hwid or ""
            for serial_port in serial.list_serial_ports()
        }
        return "BTHENUM" in hardware_by_name.get(name, "")
    return False


def resolve(port: str) -> str:
    """Return the address of the robot that `ble://name` or `tcp://name` means: a port, too.

    Any other port is its own address. Raises PortError.
    """
    return _transport(port).resolve(port)


def open_port(port: str, baud: int, timeout_s: float = OPEN_S) -> Port:
    """Open a port for exclusive use. Raises PortError, at the latest after `timeout_s`.

    A connection by Bluetooth LE has limits of its own.
    """
    return _transport(port).open_port(port, baud, timeout_s)


def open_past_lock(port: str, baud: int, timeout_s: float = OPEN_S) -> Port:
    """Open a serial port that another program has locked: both hear then. Raises PortError."""
    from tiniscript.link.transports import serial

    return cast(Port, serial.open_port(port, baud, timeout_s, is_exclusive=False))


def find_bluetooth_robots() -> list[SeenDevice]:
    """Search with Bluetooth LE for some seconds, and return the robots. Raises PortError."""
    with _convert_import_error():
        from tiniscript.link.transports import bluetooth
    return bluetooth.list_robots()


def find_announced_robots() -> list[AnnouncedRobot]:
    """Return the robots that announce themselves in the network. Raises PortError."""
    with _convert_import_error():
        from tiniscript.link.transports import network
    return network.list_robots()


def _transport(port: str) -> Transport:
    name = next((name for matches, name in _TRANSPORTS if matches(port)), "serial")
    with _convert_import_error():
        return cast(Transport, import_module(f"tiniscript.link.transports.{name}"))


@contextmanager
def _convert_import_error() -> Iterator[None]:
    """Raise PortError where a package is missing."""
    try:
        yield
    except ImportError as error:
        raise PortError(NOT_INSTALLED, error.name or str(error)) from None
