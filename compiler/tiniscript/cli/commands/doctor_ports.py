"""`tsc doctor --ports`: the ports of this computer, and which robots answer there."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import baud_of, open_client
from tiniscript.cli.robot.in_reach import MAX_CHECKS_AT_ONCE, find_robots
from tiniscript.cli.robot.port_rows import EMPTY_REACH, Row, lines, list_rows
from tiniscript.cli.texts import Sentence, text
from tiniscript.library import opening
from tiniscript.library.errors import RobotError
from tiniscript.library.known_kits import shipped_name_of_kit
from tiniscript.link import known_ports
from tiniscript.link.authority import ownership_of
from tiniscript.link.connection import find_stranger
from tiniscript.link.foreign import explain
from tiniscript.link.requests import OK
from tiniscript.link.sharing.protocol import LOOKING_VERB
from tiniscript.robots.profile import Robot

OPEN_TIMEOUT_S = 12.0


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    baud = None if options.baud is None else baud_of(options, robot, language)
    reachable_robots = EMPTY_REACH
    if options.ask and options.port is None:
        reachable_robots = find_robots(list(known_ports.remembered_ports().name_by_port), language)
        for note in reachable_robots.notes:  # transports that could not be searched
            print(note, file=sys.stderr, flush=True)
    rows = list_rows(language, options.port, reachable_robots)
    if options.ask:
        absent_row: Row = {"answer": None, "said": text("out_of_reach", language)}

        def ask(row: Row) -> Row:
            port = str(row["port"])
            is_absent = port in reachable_robots.absent_ports and row["held_by"] is None
            return absent_row if is_absent else _ask(port, baud, robot, language)

        with ThreadPoolExecutor(MAX_CHECKS_AT_ONCE) as pool:
            for row, answer in zip(rows, pool.map(ask, rows), strict=True):
                row.update(answer)
    if options.json:
        print(json.dumps(rows, indent=2))
    else:
        print("\n".join(lines(rows, language)))
    return 0


def _ask(port: str, baud: int | None, robot: Robot, language: str) -> Row:
    """Return the robot that answers on a port, or the reason why none does."""
    try:
        with closing(
            open_client(port, robot, LOOKING_VERB, baud, language, OPEN_TIMEOUT_S)
        ) as client:
            reply = client.hello()
            device_info, has_bytes = client.connection.robot, client.connection.heard_count
            foreign_board = find_stranger(client.connection)
    except CommandError as error:
        return {"answer": None, "said": error.plain_sentence(language)}
    except RobotError as error:
        return {"answer": None, "said": str(error)}
    if reply.status == OK and device_info is not None:
        opening.remember(port, device_info.name, is_used=False)
        robot_name = (
            printable_name(device_info.name)
            or shipped_name_of_kit(device_info.kit)
            or f"{device_info.id:08x}"
        )
        owner = ownership_of(device_info)
        sentence = text("port_whose", language).format(
            said=text("port_robot", language).format(name=robot_name),
            whose=text(f"whose_{owner}", language),
        )
        return {
            "answer": device_info.name,
            "id": f"{device_info.id:08x}",
            "kit": f"{device_info.kit:04x}",
            "owner": owner,
            "said": sentence,
        }
    if foreign_board is not None and (foreign_board.has_row or foreign_board.is_sure):
        return {
            "answer": None,
            "said": Sentence(explain(foreign_board, language).meaning.rstrip(".")),
        }
    return {"answer": None, "said": text("port_other" if has_bytes else "port_quiet", language)}
