"""`tsc ports`: the ports of this computer, and which robots answer there."""

from __future__ import annotations

import json
from argparse import Namespace
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from tiniscript.cli import inputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options
from tiniscript.cli.robot.connect import baud_of, opened_way, robot_of_kit
from tiniscript.cli.texts.common import text
from tiniscript.library import way

if TYPE_CHECKING:
    from tiniscript.robots.profile import Robot
    from tiniscript.virtual.directory import Running

HELP = (
    """\
tsc ports [--ask] [--json]

Lists the serial ports of this computer, which robots have answered there before, and which tsc
holds one. Opens none of them: opening a port resets most boards.
  --ask         opens each and says which robot answers there
  --port P      with --ask: this one alone
  --baud N      with --ask: their speed (the one of the profile that --robot NAME|FILE chooses)
  --json        the same as data
""",
    """\
tsc ports [--ask] [--json]

Lista los puertos serie de esta computadora, qué robots respondieron ahí antes, y qué tsc tiene
uno. No abre ninguno: abrir un puerto reinicia la mayoría de las placas.
  --ask         abre cada uno y dice qué robot responde ahí
  --port P      con --ask: solo este
  --baud N      con --ask: su velocidad (la del perfil que --robot NOMBRE|ARCHIVO elige)
  --json        lo mismo como datos
""",
)

OPEN_S = 12.0
AT_ONCE = 16  # ports that are asked at the same time


def run(arguments: list[str], language: str) -> int:
    parser = Options("ports", language, HELP)
    parser.add_argument("--ask", action="store_true")
    parser.add_argument("--port")
    parser.add_argument("--baud")
    parser.add_argument("--robot")
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    robot = inputs.robot(options, language)
    baud = baud_of(options, robot, language)
    rows = _rows(options, language)
    if options.ask:
        with ThreadPoolExecutor(AT_ONCE) as pool:
            answers = pool.map(lambda row: _ask(str(row["port"]), baud, robot, language), rows)
            for row, answer in zip(rows, answers, strict=True):
                row.update(answer)
    if options.json:
        print(json.dumps(rows, indent=2))
    elif not rows:
        print(text("no_port_listed", language))
    for row in [] if options.json else rows:
        print(_line(row, language))
    return 0


def _rows(options: Namespace, language: str) -> list[dict[str, object]]:
    """Return the ports of the system, and those that it does not list but a robot had."""
    from tiniscript.link import known_ports, ports
    from tiniscript.link.port_names import is_there, same_for_all
    from tiniscript.sharing.client import is_alive
    from tiniscript.sharing.registry import all_found
    from tiniscript.virtual import directory

    known = known_ports.known()
    virtual = {each.address: each for each in directory.running()}
    about = {each.port: each.description for each in ports.listed()}
    held = {holder.port: holder.verb for holder in all_found() if is_alive(holder)}
    names = [options.port] if options.port is not None else list(about)
    if options.port is None:
        names += [port for port in known.names if port not in about and is_there(port)
                  and not directory.is_gone(port)]  # fmt: skip
        names += [port for port in virtual if port not in names]
        listed = {same_for_all(port) for port in names}
        names += [port for port in held if port not in listed]
    about |= {port: _virtual(each, language) for port, each in virtual.items()}
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


def _virtual(running: Running, language: str) -> str:
    """Return what a virtual robot is."""
    said = text("virtual_port", language).format(robot=running.robot, world=running.world)
    return f"{running.name}: {said}" if running.name else said


def _ask(port: str, baud: int, robot: Robot, language: str) -> dict[str, object]:
    """Return who answers on a port, or why nobody does."""
    from contextlib import closing

    from tiniscript.link.outcomes import Gone
    from tiniscript.link.requests import OK

    try:
        with closing(opened_way(port, baud, robot, "ports", OPEN_S)) as line:
            reply = way.met(line, port, robot.board.chip, line.wait)
            card = line.robot
            heard = line.heard
    except Trouble as trouble:
        return {"answer": None, "said": trouble.sentence(language).removeprefix("tsc: ")}
    except Gone as gone:
        return {"answer": None, "said": gone.why}
    if reply.status == OK and card is not None:
        way.remember(port, card.name, is_used=False)
        called = shown(card.name) or robot_of_kit(card.kit) or f"{card.id:08x}"
        said = text("port_robot", language).format(name=called)
        return {"answer": card.name, "id": f"{card.id:08x}", "kit": f"{card.kit:04x}", "said": said}
    return {"answer": None, "said": text("port_other" if heard else "port_quiet", language)}


def _line(row: dict[str, object], language: str) -> str:
    """Return a port as a line: its name, what the system says of it, and what is known of it."""
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
