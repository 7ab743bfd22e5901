"""`tsc firmware`: writes a robot's firmware to a board, and shows the robot that answers then."""

from __future__ import annotations

import sys
from argparse import Namespace

from tiniscript.cli import firmware_build, inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import bad_choice
from tiniscript.cli.robot.connect import Connection, convert_port_error
from tiniscript.cli.robot.description import describe_robot
from tiniscript.cli.terminal.progress import Progress, show_wait
from tiniscript.cli.texts import say, say_aside, text
from tiniscript.flash import avrdude
from tiniscript.flash.avrdude import StepProgress, WriteResult
from tiniscript.flash.bootloaders import BOARDS, UNO, Bootloader
from tiniscript.flash.ready import ReadyFile
from tiniscript.link import ports
from tiniscript.link.port_names import is_address
from tiniscript.robots.ports import ESP32S
from tiniscript.robots.profile import Robot

INSTALLS = {
    "win32": "pip install avrdude-windows",
    "darwin": "brew install avrdude",
    "linux": "sudo apt install avrdude",
}


def run(options: Namespace, language: str) -> int:
    if options.list:
        firmware_build.print_list(language)
        return 0
    if options.chip is None and inputs.robot(options, language).board.chip in ESP32S:
        return _esp32(options, language)
    robot, bootloaders = _selected_robot(options, language)
    if options.breakpoints:
        firmware_build.require_breakpoints(robot)
        say_aside("flash_breakpoints", language)
    if options.build:
        firmware = firmware_build.firmware(robot, options, language, options.breakpoints)
        print(firmware_build.firmware_row(robot, firmware, language))
        return 0
    command = avrdude.find_avrdude()
    if command is None:
        raise CommandError(2, "flash_no_avrdude", how=INSTALLS.get(sys.platform, INSTALLS["linux"]))
    port = _port(options)
    firmware = firmware_build.firmware(robot, options, language, options.breakpoints)
    _write(command, bootloaders, port, firmware, language)
    size = f"{firmware.flash_bytes:,}"
    values = {"robot": robot.name, "board": firmware.board, "bytes": size}
    print(text("flash_done", language).format(**values), flush=True)
    _introduce(port, robot, firmware.board, language)
    return 0


def _esp32(options: Namespace, language: str) -> int:
    """Build and write the firmware of a robot with an ESP32, by PlatformIO alone."""
    robot = inputs.robot(options, language).with_language(language)
    if options.breakpoints:
        firmware_build.require_breakpoints(robot)
    values = {"robot": robot.name, "board": robot.board.chip}
    if options.build:
        firmware_build.upload(robot, None, options, language)
        say("flash_built", language, **values)
        return 0
    port = _port(options)
    firmware_build.upload(robot, port, options, language)
    print(text("flash_written", language).format(**values), flush=True)
    _introduce(port, robot, robot.board.chip, language)
    return 0


def _selected_robot(options: Namespace, language: str) -> tuple[Robot, tuple[Bootloader, ...]]:
    """Return the robot of the options, on its board, and the bootloaders that it may have."""
    if options.chip is not None and options.chip not in BOARDS:
        raise bad_choice("--chip", list(BOARDS), options.chip, language)
    robot = inputs.robot(options, language)
    board, bootloaders = BOARDS[options.chip or robot.board.chip]
    fitting_robots = firmware_build.robots_on_boards(options.robot, language, [board])
    if not fitting_robots:
        fitting_boards = ", ".join(
            board.board.chip for board in firmware_build.robots_on_boards(options.robot, language)
        )
        raise CommandError(2, "flash_no_fit", robot=robot.name, board=board, known=fitting_boards)
    return fitting_robots[0], bootloaders


def _port(options: Namespace) -> str:
    """Return the port, which can be opened. It never uses the last port: that may be a radio's."""
    if options.port is None:
        raise CommandError(2, "flash_no_port")
    port = inputs.check_port(options.port)
    if is_address(port):
        raise CommandError(2, "flash_address", port=printable_name(port))
    with convert_port_error(port):
        ports.open_port(port, UNO.baud).close()
    return port


def _write(
    command: list[str],
    bootloaders: tuple[Bootloader, ...],
    port: str,
    firmware: ReadyFile,
    language: str,
) -> None:
    """Write a firmware with the first bootloader that answers. Raises CommandError."""
    for bootloader in bootloaders:
        if bootloader is not bootloaders[0]:
            say_aside("flash_older", language)
        write_result = _write_firmware(command, bootloader, port, firmware, language)
        if write_result.outcome != avrdude.NOBODY:
            break
    if write_result.outcome != avrdude.DONE:
        values = {
            "port": printable_name(port),
            "board": firmware.board,
            "why": printable_name(write_result.output),
        }
        raise CommandError(3, f"flash_{write_result.outcome}", **values)


def _write_firmware(
    command: list[str], bootloader: Bootloader, port: str, firmware: ReadyFile, language: str
) -> WriteResult:
    progress = Progress(language, 100)
    has_begun = False

    def on_step(step: StepProgress | None) -> None:
        nonlocal has_begun
        if step is not None:
            has_begun = True
            notice.cancel()
            label = "flash_writing" if step.phase == avrdude.WRITING else "flash_reading"
            progress.label = text(label, language)
            progress.draw(step.percent)

    try:
        with show_wait("flash_waits", language, port) as notice:
            return avrdude.write(command, bootloader, port, firmware.path, on_step)
    except KeyboardInterrupt:
        if not has_begun:
            raise
        raise CommandError(2, "flash_stopped") from None
    finally:
        progress.end()


def _introduce(port: str, robot: Robot, chip: str, language: str) -> None:
    """Send HELLO to the robot, and print its answer."""
    try:
        options = Namespace(verb="firmware", port=port, baud=None, virtual=False)
        with Connection(options, robot, language) as connection:
            connection.meet(chip)
            print(describe_robot(connection).text())
    except CommandError as error:
        if error.exit_code != 3:
            raise
        raise CommandError(3, "flash_silent", port=printable_name(port)) from None
