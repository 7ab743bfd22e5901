"""Robots that no system lists: in reach of Bluetooth LE, announced in the network, or in use.

In use are those on a port that a command holds, and virtual ones. It connects to none of them. If a
search is impossible, it says why.
"""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from itertools import compress
from typing import NamedTuple

from tiniscript.cli.robot.connect import error_for_port
from tiniscript.cli.texts import text
from tiniscript.library import opening
from tiniscript.link import ports
from tiniscript.link.errors import PortError
from tiniscript.link.port_names import (
    BLE,
    TCP,
    canonical_name,
    canonical_port,
    is_bluetooth_le,
    is_network_name,
    name_in,
)
from tiniscript.link.sharing.registry import Registration, find_all
from tiniscript.link.sharing.shared_connection import is_alive
from tiniscript.virtual import directory


class ReachableRobots(NamedTuple):
    """`other_ports` are further ports of the described robots; `absent_ports` are known ports
    without a robot; `notes` list what was not searched, and why."""

    description_by_port: dict[str, str]
    other_ports: list[str]
    absent_ports: list[str]
    notes: list[str]


def find_robots(known_ports: list[str], language: str) -> ReachableRobots:
    """Search for some seconds. A robot that is known by a port of `known_ports` keeps it."""
    reach = ReachableRobots({}, [], [], [])
    reasons = set()  # one note covers two missing packages
    with ThreadPoolExecutor(2) as pool:
        searches = [
            (kind, pool.submit(search, known_ports, language))
            for kind, search in ((BLE, _find_on_bluetooth), (TCP, _find_on_network))
        ]
        for kind, search in searches:
            try:
                reach_part = search.result()
            except PortError as error:
                if error.reason not in reasons:
                    reach.notes.append(error_for_port(kind, error).sentence(language))
                reasons.add(error.reason)
                continue
            reach.description_by_port.update(reach_part.description_by_port)
            reach.other_ports.extend(reach_part.other_ports)
            reach.absent_ports.extend(reach_part.absent_ports)
    return reach


def _find_on_bluetooth(known_ports: list[str], language: str) -> ReachableRobots:
    devices = ports.find_bluetooth_robots()
    names = [canonical_name(device.name) for device in devices]
    rows = []
    for device, name in zip(devices, names, strict=True):
        sentence = text("radio_port", language)
        sentence = f"{device.name}, {sentence}" if device.name else sentence
        meanings = {canonical_name(device.address)} | ({name} if names.count(name) == 1 else set())
        rows.append((BLE + device.address, {BLE + device for device in meanings}, sentence))
    canonical_of = {port: BLE + name_in(port) for port in known_ports if is_bluetooth_le(port)}
    return _name_robots(rows, canonical_of)


def _find_on_network(known_ports: list[str], language: str) -> ReachableRobots:
    announced_robots = ports.find_announced_robots()
    rows = []
    for announced_robot in announced_robots:
        name = (
            TCP + announced_robot.name
            if announced_robot.name.isprintable()
            else announced_robot.port
        )
        sentence = text("announced_port", language).format(port=announced_robot.port)
        rows.append((name, {canonical_port(name), canonical_port(announced_robot.port)}, sentence))
    canonical_of = {port: canonical_port(port) for port in known_ports if is_network_name(port)}
    reach = _name_robots(rows, canonical_of)
    reach.other_ports.extend(
        announced_robot.port
        for announced_robot in announced_robots
        if announced_robot.port not in reach.description_by_port
    )
    return reach


def _name_robots(
    rows: list[tuple[str, set[str], str]], canonical_of: dict[str, str]
) -> ReachableRobots:
    """Name each robot by the port that the user knows: `rows` have a port, its other names, and a
    description; `canonical_of` maps known ports to their canonical names."""
    reach = ReachableRobots({}, [], list(canonical_of), [])
    for port, names, description in rows:
        known_ports = [
            given_port for given_port, canonical in canonical_of.items() if canonical in names
        ]
        reach.description_by_port[known_ports[0] if known_ports else port] = description
        reach.other_ports.extend(known_ports[1:])
        for known_port in known_ports:
            reach.absent_ports.remove(known_port)
    return reach


MAX_CHECKS_AT_ONCE = 16  # servers that are checked at the same time


def ports_in_use(is_virtual: bool = False) -> list[str]:
    """Return the port of each robot that is in use, once; `is_virtual`: of virtual ones alone."""
    server_ports = [registration.port for registration in running_servers()]
    robot_ports = [] if is_virtual else server_ports[:]
    for robot in directory.running_robots():
        port_names = [robot.address, *([robot.terminal] if robot.terminal else [])]
        shared_ports = [port for port in port_names if canonical_port(port) in server_ports]
        robot_ports.append(
            shared_ports[0] if shared_ports else robot.address
        )  # each robot has one port
    return _unique_ports(robot_ports)


def running_servers() -> list[Registration]:
    """Return the servers that still run; a hanging one delays no other check."""
    registrations = find_all()
    if len(registrations) < 2:  # starting threads takes longer than one answer
        return list(filter(is_alive, registrations))
    with ThreadPoolExecutor(MAX_CHECKS_AT_ONCE) as pool:
        return list(compress(registrations, pool.map(is_alive, registrations)))


def ports_to_stop(is_virtual: bool = False) -> list[str]:
    """Return the ports for `tsc stop` without `--port`.

    They include that of the last used robot, which may drive on without any command.
    """
    used_ports = ports_in_use(is_virtual)
    last_port = None if is_virtual else opening.usable_last_port()
    return _unique_ports([*used_ports, *([last_port] if last_port is not None else [])])


def _unique_ports(ports: Iterable[str]) -> list[str]:
    return list({canonical_port(port): port for port in ports}.values())
