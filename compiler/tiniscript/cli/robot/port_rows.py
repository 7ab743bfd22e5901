"""The ports of this computer, as data and as lines: what is known of each without asking there."""

from __future__ import annotations

from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import describe_port, describe_virtual_robot
from tiniscript.cli.robot.in_reach import InReach, running_servers
from tiniscript.cli.texts import text
from tiniscript.link import known_ports, ports
from tiniscript.link.port_names import canonical_port, is_there
from tiniscript.virtual import directory

EMPTY_REACH = InReach({}, [], [], [])  # nothing was searched

Row = dict[str, object]  # a port as data


def list_rows(language: str, only: str | None = None, in_reach: InReach = EMPTY_REACH) -> list[Row]:
    """Return the ports that the system lists, those in reach, and others that had a robot."""
    known = known_ports.remembered_ports()
    virtual = {each.address: each for each in directory.running_robots()}
    about = {each.port: describe_port(each, language) for each in ports.list_ports()}
    about |= in_reach.about
    held = {registration.port: registration.verb for registration in running_servers()}
    names = [only] if only is not None else list(about)
    if only is None:
        names += [port for port in known.names if port not in about and is_there(port)
                  and port not in in_reach.others and not directory.is_gone(port)]  # fmt: skip
        names += [port for port in virtual if port not in (*names, *in_reach.others)]
        listed = {canonical_port(port) for port in names}
        names += [port for port in held if port not in listed]
    about |= {port: describe_virtual_robot(each, language) for port, each in virtual.items()}
    return [
        {
            "port": port,
            "description": about.get(port, ""),
            "remembered": known.names.get(port),
            "is_last_used": known.last == port,
            "is_virtual": port in virtual,
            "held_by": held.get(canonical_port(port)),
        }
        for port in names
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
