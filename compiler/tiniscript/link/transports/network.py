"""Robots that announce themselves in the network, by multicast DNS: finds one, or lists them.

Knows zeroconf; importing this fails without it. Anyone in the network can announce anything: an
address outside a local network is refused, and a name proves nothing.
"""

from __future__ import annotations

from ipaddress import ip_address
from time import monotonic, sleep
from typing import NamedTuple

from zeroconf import DNSQuestionType, Error, IPVersion, ServiceBrowser, ServiceInfo, Zeroconf

from tiniscript.link import errors
from tiniscript.link.errors import PortError
from tiniscript.link.port_names import name_in
from tiniscript.link.transports import Port, serial

SERVICE = "_tiniscript._tcp.local."
SEARCH_S = 5.0  # time to search for one robot
LIST_S = 2.0  # time to list all robots
ROBOT_MS = 1000  # time for each address that did not arrive with its name
ADDRESSES_S = 3.0  # time for all addresses
MAX_NAME_BYTES = 63  # bytes of a name
MAX_ROBOTS = 1000  # most robots in a list


class AnnouncedRobot(NamedTuple):
    """A robot's name, and its address as a port."""

    name: str
    port: str


def resolve(port: str) -> str:
    """Return the address, `socket://…`, of the robot that announces a name. Raises PortError."""
    name = name_in(port).removesuffix(".local")
    if not 0 < len(name.encode()) <= MAX_NAME_BYTES:
        raise PortError(errors.NOT_ANNOUNCED)
    with _network() as network:
        info = query_service(network, f"{name}.{SERVICE}", int(SEARCH_S * 1000))
    if info is None:
        raise PortError(errors.NOT_ANNOUNCED)
    return _address(info)


def open_port(port: str, baud: int, timeout_s: float) -> Port:
    """Open the address of a name, which is searched first. Raises PortError."""
    opened_port: Port = serial.open_port(resolve(port), baud, timeout_s)
    return opened_port


def list_robots() -> list[AnnouncedRobot]:
    """Return the robots that announce themselves. Raises PortError."""
    names: set[str] = set()

    class Listener:
        def add_service(self, _: Zeroconf, __: str, name: str) -> None:
            if len(names) < MAX_ROBOTS:
                names.add(name)

        def update_service(self, *_: object) -> None:
            pass

        def remove_service(self, _: Zeroconf, __: str, name: str) -> None:
            names.discard(name)

    robots = []
    with _network() as network:
        browser = ServiceBrowser(network, SERVICE, listener=Listener())  # type: ignore[arg-type]
        sleep(LIST_S)
        browser.cancel()
        until_s = monotonic() + ADDRESSES_S
        for name in sorted(names):
            left_ms = int((until_s - monotonic()) * 1000)
            info = query_service(network, name, max(1, min(left_ms, ROBOT_MS)))
            if info is None:
                continue
            try:
                robots.append(AnnouncedRobot(name.removesuffix(f".{SERVICE}"), _address(info)))
            except PortError:  # an address that no robot has
                continue
    return robots


def query_service(network: Zeroconf, name: str, limit_ms: int) -> ServiceInfo | None:
    """Return the announcement of a name, or None.

    The answer goes to all: of several programs of a computer, one alone would get its own.
    """
    try:
        return network.get_service_info(SERVICE, name, limit_ms, question_type=DNSQuestionType.QM)
    except Error:  # a name that no device in a network may have
        return None


def _network() -> Zeroconf:
    try:
        return Zeroconf(ip_version=IPVersion.V4Only)
    except (OSError, RuntimeError) as error:  # RuntimeError: without any interface
        reason = error.strerror if isinstance(error, OSError) else None
        raise PortError(errors.NO_MULTICAST, reason or str(error)) from None


def _address(info: ServiceInfo) -> str:
    """Return the port that a robot announces. It raises PortError if it is not of a local
    network."""
    for parsed_address in info.parsed_addresses(IPVersion.V4Only):
        address = ip_address(parsed_address)
        is_local = address.is_private or address.is_link_local or address.is_loopback
        if is_local and not address.is_unspecified and info.port:
            return f"socket://{address}:{info.port}"
    raise PortError(errors.STRANGE, ", ".join(info.parsed_addresses()[:3]))
