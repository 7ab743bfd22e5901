"""`tsc firmware --board`: the header that tells the firmware how a robot is wired."""

from __future__ import annotations

import os.path
from argparse import Namespace
from pathlib import Path

from tiniscript import robots
from tiniscript.base.kit import MAX_SENSORS_BESIDE_REMOTE
from tiniscript.cli import inputs, outputs
from tiniscript.cli.texts import say, say_aside, text
from tiniscript.robots import firmware
from tiniscript.robots.nearness import nearest_to
from tiniscript.robots.profile import Robot

SKETCH_FOLDER = Path("vm_arduino")
HEADER_PATH = Path("src/boards/kits/own.h")  # relative to the project


def run(options: Namespace, language: str) -> int:
    robot = inputs.wired_robot(options, language).with_language(language)
    if not robot.kit.has_remote:
        say_aside(
            "board_no_remote", language, robot=robot.name, most=str(MAX_SENSORS_BESIDE_REMOTE)
        )
    if robots.is_path(options.robot):
        _compare(robot, language)
    header = firmware.header([robot], "tsc firmware --board, from a robot profile.")
    if not outputs.write_output(options.output, header.encode()):
        return 0
    next_command = _next_step(options.robot, Path(options.output), robot.board.chip, language)
    say("board", language, file=inputs.printable_name(options.output), robot=robot.name,
        chip=robot.board.chip, now=next_command)  # fmt: skip
    return 0


def _compare(robot: Robot, language: str) -> None:
    """Print the shipped robot most similar to the user's own."""
    nearest_robot = nearest_to(robot)
    if nearest_robot.is_same:
        say_aside("board_same_kit", language, kit=nearest_robot.name)
        return
    names_by_place = {
        "shared": nearest_robot.shared_devices,
        "there": nearest_robot.devices_only_there,
        "here": nearest_robot.devices_only_here,
    }
    values = {key: ", ".join(names) or "–" for key, names in names_by_place.items()}
    say_aside("board_nearest_kit", language, kit=nearest_robot.name, **values)


def _next_step(robot: str, output: Path, chip: str, language: str) -> str:
    """Return the next step with a header: the build finds it in only one place."""
    path = output.absolute()
    folder = path.parents[3] if len(path.parents) > 3 else path.parent
    if path == folder / HEADER_PATH and (folder / "platformio.ini").is_file():
        build = f"pio run -d {_quote(_relative_to_cwd(folder))} -e {chip}"
        return text("board_here", language).format(build=build)
    build = f"pio run -d {SKETCH_FOLDER} -e {chip}"
    return text("board_elsewhere", language).format(
        robot=_quote(Path(robot)), home=(SKETCH_FOLDER / HEADER_PATH).as_posix(), build=build
    )


def _relative_to_cwd(folder: Path) -> Path:
    try:
        return Path(os.path.relpath(folder))
    except ValueError:  # Windows: the path is on another drive
        return folder


def _quote(path: Path) -> str:
    """Return a path quoted for a command."""
    shown_path = inputs.printable_name(str(path))
    return f'"{shown_path}"' if " " in shown_path else shown_path
