"""`tsc wiring`: a page that shows how a robot is wired."""

from __future__ import annotations

import sys
from pathlib import Path
from shutil import get_terminal_size
from textwrap import wrap

from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.options import Options
from tiniscript.cli.texts.common import text

HELP = (
    """\
tsc wiring [--robot NAME|FILE] [-o PAGE.html]

Shows how a robot is wired: which wire goes from which pin to which part.
  --robot R     a name (tinibot, ...) or a profile's file
  -o FILE       writes a page with a drawing, all tables and a check list, to read in a
                browser and to print; without it the wires are listed here
""",
    """\
tsc wiring [--robot NOMBRE|ARCHIVO] [-o PÁGINA.html]

Muestra cómo se conecta un robot: qué cable va de qué pin a qué pieza.
  --robot R     un nombre (tinibot, ...) o el archivo de un perfil
  -o ARCHIVO    escribe una página con un dibujo, todas las tablas y una lista de control,
                para leerla en un navegador e imprimirla; sin esto se listan aquí los cables
""",
)

GAP = "  "  # between columns
NARROWEST = 16  # a column on a terminal that is too narrow for the table


def run(arguments: list[str], language: str) -> int:
    parser = Options("wiring", language, HELP)
    parser.add_argument("--robot")
    parser.add_argument("-o", dest="output")
    options = parser.read(arguments)
    if options is None:
        return 0
    from tiniscript.robots import firmware

    robot = inputs.robot(options, language)
    if not firmware.fits(robot):
        raise Trouble(2, "no_firmware", chip=robot.board.chip, known=", ".join(firmware.BOARDS))
    from tiniscript.wiring.plan import plan_of

    plan = plan_of(robot, language)
    if options.output is None:
        from tiniscript.wiring.page import wire_rows

        _print_rows(wire_rows(plan))
        print(text("wiring_page", language))
        return 0
    from tiniscript.wiring.html import html_of

    page = html_of(plan)
    if options.output == "-":
        sys.stdout.write(page)
        return 0
    outputs.write(Path(options.output), page.encode(), "unwritable")
    print(text("wiring", language).format(
        file=inputs.shown(options.output), robot=inputs.shown(plan.robot)
    ))  # fmt: skip
    return 0


def _print_rows(rows: list[tuple[str, ...]]) -> None:
    """Print a table; on a terminal its last column is broken where the lines end."""
    shown = [[inputs.shown(cell) for cell in row] for row in rows]
    widths = [max(len(row[k]) for row in shown) for k in range(len(shown[0]))]
    indent = sum(widths[:-1]) + len(GAP) * (len(widths) - 1)
    room = widths[-1]
    if sys.stdout.isatty():
        room = min(room, max(NARROWEST, get_terminal_size().columns - indent - 1))
    for *row, last in shown:
        cells = GAP.join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))
        first, *rest = wrap(last, room) or [""]
        print(f"{cells}{GAP}{first}".rstrip())
        for line in rest:
            print(" " * indent + line)
