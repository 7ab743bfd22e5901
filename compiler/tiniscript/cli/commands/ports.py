"""`tsc doctor --ports`: the ports of this computer, and which robots answer there."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.connect import about_port, about_virtual, baud_of, opened_client
from tiniscript.cli.robot.in_reach import AT_ONCE, InReach, alive, found
from tiniscript.cli.texts import text
from tiniscript.library import opening
from tiniscript.library.errors import RobotError
from tiniscript.library.known_kits import shipped_of_kit
from tiniscript.link import known_ports, ports
from tiniscript.link.authority import whose
from tiniscript.link.port_names import is_there, same_for_all
from tiniscript.link.requests import OK
from tiniscript.link.sharing.protocol import LOOKER
from tiniscript.robots.profile import Robot
from tiniscript.virtual import directory

OPEN_S = 12.0
NOWHERE = InReach({}, [], [], [])  # nothing was searched

Row = dict[str, object]  # a port as data


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    baud = None if options.baud is None else baud_of(options, robot, language)
    in_reach = NOWHERE
    if options.ask and options.port is None:
        in_reach = found(list(known_ports.known().names), language)
        for note in in_reach.notes:  # what could not be searched
            print(note, file=sys.stderr, flush=True)
    rows = listed(language, options.port, in_reach)
    if options.ask:
        absent: Row = {"answer": None, "said": text("out_of_reach", language)}

        def ask(row: Row) -> Row:
            port = str(row["port"])
            is_absent = port in in_reach.absent and row["held_by"] is None
            return absent if is_absent else _ask(port, baud, robot, language)

        with ThreadPoolExecutor(AT_ONCE) as pool:
            for row, answer in zip(rows, pool.map(ask, rows), strict=True):
                row.update(answer)
    if options.json:
        print(json.dumps(rows, indent=2))
    else:
        print("\n".join(lines(rows, language)))
    return 0


def listed(language: str, only: str | None = None, in_reach: InReach = NOWHERE) -> list[Row]:
    """Return the ports that the system lists, those in reach, and others that had a robot."""
    known = known_ports.known()
    virtual = {each.address: each for each in directory.running()}
    about = {each.port: about_port(each, language) for each in ports.listed()}
    about |= in_reach.about
    held = {registration.port: registration.verb for registration in alive()}
    names = [only] if only is not None else list(about)
    if only is None:
        names += [port for port in known.names if port not in about and is_there(port)
                  and port not in in_reach.others and not directory.is_gone(port)]  # fmt: skip
        names += [port for port in virtual if port not in (*names, *in_reach.others)]
        listed = {same_for_all(port) for port in names}
        names += [port for port in held if port not in listed]
    about |= {port: about_virtual(value, language) for port, value in virtual.items()}
    return [
        {
            "port": port,
            "description": about.get(port, ""),
            "remembered": known.names.get(port),
            "is_last_used": known.last == port,
            "is_virtual": port in virtual,
            "held_by": held.get(same_for_all(port)),
        }
        for port in names
    ]


def _ask(port: str, baud: int | None, robot: Robot, language: str) -> Row:
    """Return the robot that answers on a port, or why none does."""
    try:
        with closing(opened_client(port, robot, LOOKER, baud, language, OPEN_S)) as client:
            reply = client.hello()
            device_info, heard = client.line.robot, client.line.heard
    except CommandError as failure:
        return {"answer": None, "said": failure.plain(language)}
    except RobotError as gone:
        return {"answer": None, "said": str(gone)}
    if reply.status == OK and device_info is not None:
        opening.remember(port, device_info.name, is_used=False)
        called = (
            shown(device_info.name) or shipped_of_kit(device_info.kit) or f"{device_info.id:08x}"
        )
        owner = whose(device_info)
        sentence = text("port_whose", language).format(
            said=text("port_robot", language).format(name=called),
            whose=text(f"whose_{owner}", language),
        )
        return {
            "answer": device_info.name,
            "id": f"{device_info.id:08x}",
            "kit": f"{device_info.kit:04x}",
            "owner": owner,
            "said": sentence,
        }
    return {"answer": None, "said": text("port_other" if heard else "port_quiet", language)}


def lines(rows: list[Row], language: str) -> list[str]:
    return [_line(row, language) for row in rows] or [text("no_port_listed", language)]


def _line(row: Row, language: str) -> str:
    """Return a port as a line: its name, the system's description, and the robot there."""
    parts = [shown(str(row["port"])), shown(str(row["description"]))]
    if "said" in row:
        parts.append(str(row["said"]))
    elif row["remembered"]:
        name = shown(str(row["remembered"]))
        parts.append(text("port_remembered", language).format(name=name))
    if row["held_by"]:
        parts.append(text("port_held", language).format(verb=row["held_by"]))
    if row["is_last_used"]:
        parts.append(text("port_last", language))
    return "   ".join(part for part in parts if part)
