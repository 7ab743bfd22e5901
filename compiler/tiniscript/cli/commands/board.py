"""`tsc board`: the header that tells the firmware how a robot is wired."""

from __future__ import annotations

import os.path
import sys
from pathlib import Path

from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.options import Options
from tiniscript.cli.texts.common import text

SKETCH, HOME = Path("vm_arduino"), Path("src/boards/kits/own.h")  # and the place in it

HELP = (
    """\
tsc board ROBOT [-o FILE]

Writes the header that tells the firmware how a robot is wired: a name (tinibot, ...) or a
profile's file. The sketch in vm_arduino is for your robot when the header is its file
src/boards/kits/own.h.
  -o FILE       where to; standard output if it is not given
""",
    """\
tsc board ROBOT [-o ARCHIVO]

Escribe la cabecera que le dice al firmware cómo está conectado un robot: un nombre
(tinibot, ...) o el archivo de un perfil. El sketch de vm_arduino es para tu robot cuando la
cabecera es su archivo src/boards/kits/own.h.
  -o ARCHIVO    a dónde; la salida estándar si no se da
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("board", language, HELP)
    parser.add_argument("robot")
    parser.add_argument("-o", dest="output")
    options = parser.read(arguments)
    if options is None:
        return 0
    from tiniscript.robots import firmware

    robot = inputs.robot(options, language)
    if not firmware.fits(robot):
        raise Trouble(2, "no_firmware", chip=robot.board.chip, known=", ".join(firmware.BOARDS))
    header = firmware.header([robot], "tsc board, from a robot profile.")
    if options.output in (None, "-"):
        sys.stdout.write(header)
        return 0
    outputs.write(Path(options.output), header.encode(), "unwritable")
    now = _next(options.robot, Path(options.output), robot.board.chip, language)
    print(text("board", language).format(
        file=inputs.shown(options.output), robot=robot.name, chip=robot.board.chip, now=now
    ))  # fmt: skip
    return 0


def _next(robot: str, output: Path, chip: str, language: str) -> str:
    """Return what to do with a header: the build finds it in one place alone."""
    path = output.absolute()
    folder = path.parents[3] if len(path.parents) > 3 else path.parent
    if path == folder / HOME and (folder / "platformio.ini").is_file():
        build = f"pio run -d {_name(_from_here(folder))} -e {chip}"
        return text("board_here", language).format(build=build)
    build = f"pio run -d {SKETCH} -e {chip}"
    return text("board_elsewhere", language).format(
        robot=_name(Path(robot)), home=(SKETCH / HOME).as_posix(), build=build
    )


def _from_here(folder: Path) -> Path:
    try:
        return Path(os.path.relpath(folder))
    except ValueError:  # Windows: it is on another drive
        return folder


def _name(path: Path) -> str:
    """Return a path as it can be copied into a command."""
    found = inputs.shown(str(path))
    return f'"{found}"' if " " in found else found
