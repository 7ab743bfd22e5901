"""`tsc firmware`: puts a robot's firmware on a board, and asks who is there then."""

from __future__ import annotations

import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from tiniscript.cli import inputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options
from tiniscript.cli.robot.connect import Connection, port_trouble
from tiniscript.cli.terminal.progress import Progress
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.flash.avrdude import Ended, Seen
    from tiniscript.flash.bootloaders import Bootloader
    from tiniscript.flash.ready import Ready
    from tiniscript.robots.profile import Robot

HELP = (
    """\
tsc firmware --port P [--robot NAME|FILE] [--board BOARD]
tsc firmware --build [--robot NAME|FILE] [--board BOARD]
tsc firmware --list

Writes the firmware of a robot on its board, over the USB cable, and reads it back. Unplug the
HC-05, or whatever else is on pins 0 and 1, as long as that takes. Firmware that is not ready yet is
built first, with PlatformIO; the first time that needs the internet.
  --port P      the port of the board's USB cable: tsc ports lists them
  --robot NAME|FILE tinibot (if none is named), liner, grabber, or a profile of your own
  --board BOARD uno, nano, nano-old (with the bootloader of before 2018) or mega; if none is
                named, the one that the robot has
  --build       makes the firmware ready and writes nothing: for later, without internet
  --list        lists which firmware is ready

It needs avrdude.
""",
    """\
tsc firmware --port P [--robot NOMBRE|ARCHIVO] [--board PLACA]
tsc firmware --build [--robot NOMBRE|ARCHIVO] [--board PLACA]
tsc firmware --list

Escribe el firmware de un robot en su placa, por el cable USB, y lo lee de vuelta. Desconecta el
HC-05, o lo que esté en los pines 0 y 1, mientras eso dure. Si el firmware todavía no está listo,
primero se construye, con PlatformIO; la primera vez hace falta internet.
  --port P      el puerto del cable USB de la placa: tsc ports los lista
  --robot NOMBRE|ARCHIVO tinibot (si no se nombra ninguno), liner, grabber, o un perfil propio
  --board PLACA uno, nano, nano-old (con el cargador de arranque de antes de 2018) o mega; si no
                se nombra ninguna, la que tiene el robot
  --build       deja listo el firmware y no escribe nada: para después, sin internet
  --list        lista qué firmware está listo

Necesita avrdude.
""",
)

INSTALLS = {
    "win32": "pip install avrdude-windows",
    "darwin": "brew install avrdude",
    "linux": "sudo apt install avrdude",
}


def run(arguments: list[str], language: str) -> int:
    parser = Options("firmware", language, HELP)
    parser.add_argument("--port")
    parser.add_argument("--robot")
    parser.add_argument("--board")
    parser.add_argument("--build", action="store_true")
    parser.add_argument("--list", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    from tiniscript.cli import firmware_build

    if options.list:
        firmware_build.print_list(language)
        return 0
    robot, bootloaders = _chosen(options, language)
    if options.build:
        print(firmware_build.row(robot, firmware_build.firmware(robot, language), language))
        return 0
    command = _avrdude()
    port = _port(options)
    firmware = firmware_build.firmware(robot, language)
    _write(command, bootloaders, port, firmware, language)
    size = f"{firmware.bytes:,}"
    values = {"robot": robot.name, "board": firmware.board, "bytes": size}
    print(text("flash_done", language).format(**values), flush=True)
    _introduce(port, robot, firmware.board, language)
    return 0


def _chosen(options: Namespace, language: str) -> tuple[Robot, tuple[Bootloader, ...]]:
    """Return the robot that the options name, on its board, and how that may be written."""
    from tiniscript.cli import firmware_build
    from tiniscript.flash.bootloaders import BOARDS

    if options.board is not None and options.board not in BOARDS:
        raise Trouble(2, "flash_bad_board", known=", ".join(BOARDS), found=shown(options.board))
    robot = inputs.robot(options, language)
    board, bootloaders = BOARDS.get(options.board or robot.board.chip, ("", ()))
    if not board:
        raise Trouble(
            2, "no_firmware", chip=robot.board.chip, known=", ".join(firmware_build.BOARDS)
        )
    there = firmware_build.on_boards(options.robot, [board])
    if not there:
        fits = ", ".join(each.board.chip for each in firmware_build.on_boards(options.robot))
        raise Trouble(2, "flash_no_fit", robot=robot.name, board=board, known=fits)
    return there[0], bootloaders


def _avrdude() -> list[str]:
    from tiniscript.flash import avrdude

    command = avrdude.found()
    if command is None:
        raise Trouble(2, "flash_no_avrdude", how=INSTALLS.get(sys.platform, INSTALLS["linux"]))
    return command


def _port(options: Namespace) -> str:
    """Return the port, which can be opened. Never the last used one: that may be a radio's."""
    from tiniscript.flash.bootloaders import UNO
    from tiniscript.link import ports
    from tiniscript.link.port_names import is_address

    port: str | None = options.port
    if port is None:
        raise Trouble(2, "flash_no_port")
    if not port.strip() or not port.isprintable():
        raise Trouble(2, "no_such_port", found=shown(port) or "''")
    if is_address(port):
        raise Trouble(2, "flash_address", port=shown(port))
    try:
        ports.opened(port, UNO.baud).close()
    except ports.PortTrouble as trouble:
        raise port_trouble(port, trouble) from None
    return port


def _write(
    command: list[str],
    bootloaders: tuple[Bootloader, ...],
    port: str,
    firmware: Ready,
    language: str,
) -> None:
    """Write a firmware with the first bootloader that answers. Raises Trouble."""
    from tiniscript.flash import avrdude

    for bootloader in bootloaders:
        if bootloader is not bootloaders[0]:
            print(text("flash_older", language), file=sys.stderr)
        ended = _written(command, bootloader, port, firmware, language)
        if ended.how != avrdude.NOBODY:
            break
    if ended.how != avrdude.DONE:
        values = {"port": shown(port), "board": firmware.board, "why": shown(ended.said)}
        raise Trouble(3, f"flash_{ended.how}", **values)


def _written(
    command: list[str], bootloader: Bootloader, port: str, firmware: Ready, language: str
) -> Ended:
    from tiniscript.flash import avrdude

    progress = Progress(language, 100)
    has_begun = False

    def look(seen: Seen | None) -> None:
        nonlocal has_begun
        if seen is not None:
            has_begun = True
            label = "flash_writing" if seen.phase == avrdude.WRITING else "flash_reading"
            progress.label = text(label, language)
            progress.draw(seen.percent)

    try:
        return avrdude.write(command, bootloader, port, firmware.path, look)
    except KeyboardInterrupt:
        if not has_begun:
            raise
        raise Trouble(2, "flash_stopped") from None
    finally:
        progress.end()


def _introduce(port: str, robot: Robot, board: str, language: str) -> None:
    """Ask the robot who it is, and print that."""
    from tiniscript.cli.commands.info import Description

    try:
        options = Namespace(verb="firmware", port=port, baud=None, virtual=False)
        with Connection(options, robot, language) as connection:
            connection.meet(board)
            print(Description(connection).text())
    except Trouble as trouble:
        if trouble.exit_code != 3:
            raise
        raise Trouble(3, "flash_silent", port=shown(port)) from None
