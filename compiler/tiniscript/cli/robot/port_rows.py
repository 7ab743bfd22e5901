"""The ports of this computer, as data and as lines, with facts known without asking there."""

from __future__ import annotations

from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import describe_port, describe_virtual_robot
from tiniscript.cli.robot.in_reach import ReachableRobots, running_servers
from tiniscript.cli.texts import text
from tiniscript.link import known_ports, ports
from tiniscript.link.port_names import canonical_port, exists
from tiniscript.virtual import directory

EMPTY_REACH = ReachableRobots({}, [], [], [])  # result of no search

Row = dict[str, object]  # a port as data


def list_rows(
    language: str, only_port: str | None = None, reachable_robots: ReachableRobots = EMPTY_REACH
) -> list[Row]:
    """Return the ports that the system lists, those in reach, and others that had a robot."""
    remembered_ports = known_ports.remembered_ports()
    virtual_by_address = {entry.address: entry for entry in directory.running_robots()}
    description_by_port = {
        entry.port: describe_port(entry, language) for entry in ports.list_ports()
    }
    description_by_port |= reachable_robots.description_by_port
    verb_of_port = {registration.port: registration.verb for registration in running_servers()}
    shown_ports = [only_port] if only_port is not None else list(description_by_port)
    if only_port is None:
        shown_ports += [
            port
            for port in remembered_ports.name_by_port
            if port not in description_by_port
            and exists(port)
            and port not in reachable_robots.other_ports
            and not directory.is_gone(port)
        ]
        shown_ports += [
            port
            for port in virtual_by_address
            if port not in (*shown_ports, *reachable_robots.other_ports)
        ]
        canonical_ports = {canonical_port(port) for port in shown_ports}
        shown_ports += [port for port in verb_of_port if port not in canonical_ports]
    description_by_port |= {
        port: describe_virtual_robot(entry, language) for port, entry in virtual_by_address.items()
    }
    return [
        {
            "port": port,
            "description": description_by_port.get(port, ""),
            "remembered": remembered_ports.name_by_port.get(port),
            "is_last_used": remembered_ports.last_port == port,
            "is_virtual": port in virtual_by_address,
            "held_by": verb_of_port.get(canonical_port(port)),
        }
        for port in shown_ports
    ]


def lines(rows: list[Row], language: str) -> list[str]:
    return [_line(row, language) for row in rows] or [text("no_port_listed", language)]


def _line(row: Row, language: str) -> str:
    """Return a port as a line: its name, the system's description, and the robot there."""
    parts = [printable_name(str(row["port"])), printable_name(str(row["description"]))]
    if "said" in row:
        parts.append(str(row["said"]))
    elif row["remembered"]:
        name = printable_name(str(row["remembered"]))
        parts.append(text("port_remembered", language).format(name=name))
    if row["held_by"]:
        parts.append(text("port_held", language).format(verb=row["held_by"]))
    if row["is_last_used"]:
        parts.append(text("port_last", language))
    return "   ".join(part for part in parts if part)
