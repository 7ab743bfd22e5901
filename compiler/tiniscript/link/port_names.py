"""The names of ports: which are addresses, and which names mean the same port.

`ble://` names a robot in reach of Bluetooth LE, `tcp://` one that announces itself in the network,
`mqtt://host:port/class/id` one at a broker.
It opens nothing, and needs no pyserial.
"""

from __future__ import annotations

import os.path
import re
import sys
import unicodedata

BLE, TCP, MQTT = "ble://", "tcp://", "mqtt://"
PSEUDO_TERMINALS = ("/dev/pts/", "/dev/ttys")  # pseudo-terminals: opening them restarts nothing
_LOCAL_HOSTS = ("localhost", "[::1]")


def is_address(port: str) -> bool:
    """Return whether a port is reached over a network or a radio: no system lists such ports."""
    return "://" in port


def is_built_in(port: str) -> bool:
    """Return whether a port is one that a computer with Linux has without any cable."""
    return re.fullmatch(r"/dev/tty(S|AMA)\d+", port) is not None


def is_bluetooth_le(port: str) -> bool:
    """Return whether a port is reached by Bluetooth LE."""
    return port[: len(BLE)].lower() == BLE


def is_network_name(port: str) -> bool:
    """Return whether a port is the name of a robot that announces itself in the network."""
    return port[: len(TCP)].lower() == TCP


def is_at_broker(port: str) -> bool:
    """Return whether a port is a robot at an MQTT broker."""
    return port[: len(MQTT)].lower() == MQTT


def is_name(port: str) -> bool:
    """Return whether a port is a robot's name, whose address has to be found first."""
    return is_network_name(port) or (is_bluetooth_le(port) and not is_device_address(name_in(port)))


def name_in(port: str) -> str:
    """Return the name or address after `://`, in its canonical form."""
    return canonical_name(port.partition("://")[2])


def canonical_name(name: str) -> str:
    """Return a name such that two names of one robot are equal: they ignore case."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name.strip()).casefold())


def is_device_address(name: str) -> bool:
    """Return whether a name is the address of a Bluetooth device: six bytes, on macOS a UUID."""
    uuid = r"[0-9A-Fa-f]{8}(-[0-9A-Fa-f]{4}){3}-[0-9A-Fa-f]{12}"
    return re.fullmatch(rf"[0-9A-Fa-f]{{2}}(:[0-9A-Fa-f]{{2}}){{5}}|{uuid}", name) is not None


def exists(port: str) -> bool:
    """Return whether a port exists, as far as this is known without opening it."""
    if is_address(port) or sys.platform == "win32":
        return True
    return os.path.exists(port)  # noqa: PTH110 - Path raises for a name that no file can have


def canonical_port(port: str) -> str:
    """Return the canonical name of a port that has several.

    A udev link (`/dev/serial/by-id/...`) becomes its target, `/dev/cu.X` of macOS becomes
    `/dev/tty.X`, and Windows ignores case; so do the names of robots.
    """
    if is_bluetooth_le(port):
        return BLE + name_in(port)
    if is_network_name(port):
        return TCP + name_in(port).removesuffix(".local")
    if is_address(port):
        scheme, _, address = port.partition("://")
        host, colon, port_number = address.rpartition(":")
        host = "127.0.0.1" if host.lower() in _LOCAL_HOSTS else host.lower()
        return f"{scheme.lower()}://{host}{colon}{port_number}"
    if sys.platform == "win32":
        return port.upper().removeprefix("\\\\.\\")
    try:
        path = os.path.realpath(port)
    except (OSError, ValueError):  # the name is not valid for a file
        return port
    return path.replace("/dev/cu.", "/dev/tty.", 1) if path.startswith("/dev/cu.") else path
