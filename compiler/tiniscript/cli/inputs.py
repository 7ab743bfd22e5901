"""The inputs of a verb: a program from a file, standard input or the command line; a robot."""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from pathlib import Path
from typing import NamedTuple

from tiniscript import robots
from tiniscript.base.files import is_pipe
from tiniscript.base.source import LARGEST_SOURCE_BYTES, printable
from tiniscript.cli.errors import CommandError
from tiniscript.cli.paths import real_name
from tiniscript.cli.texts import Sentence, say_aside
from tiniscript.library import named_robot
from tiniscript.robots.profile import ProfileRefused, Robot

MAX_NAME_CHARACTERS = 200  # characters of a file's name


class Input(NamedTuple):
    """The bytes of a program. `path` is None if they come from no file.

    `has_robot`: `--robot` has chosen the robot, so the robot that the program names is ignored.
    """

    name: str
    data: bytes
    path: Path | None
    has_robot: bool = False

    @property
    def is_image(self) -> bool:
        """Return whether the bytes, or their file's name, are those of a compiled program."""
        is_binary = self.data[:2] == b"TS" and self.data[2:3] < b" " and len(self.data) > 2
        has_image_name = self.path is not None and self.path.suffix.lower() == ".bin"
        return has_image_name or (is_binary and self.data[2:3] not in (b"\t", b"\n", b"\r"))


def program(options: Namespace) -> Input:
    """Return the program that the options name. Raises CommandError if there is none."""
    has_robot = getattr(options, "robot", None) is not None  # tsc lesson has no such option
    return _program(options)._replace(has_robot=has_robot)


def _program(options: Namespace) -> Input:
    texts: list[str] = options.texts
    if options.program is None and not texts:
        raise CommandError(2, "no_program")
    if options.program is not None and texts:
        raise CommandError(2, "two_programs")
    if len(texts) > 1:
        raise CommandError(2, "two_texts")
    if texts:
        return Input("-e", texts[0].encode("utf-8", "surrogateescape"), None)
    if options.program == "-":
        return Input("-", sys.stdin.buffer.read(LARGEST_SOURCE_BYTES + 1), None)
    name = real_name(options.program)
    if name != options.program:
        say_aside("file_really", options.language, file=options.program, real=name)
    return read_file(name, options.program)


def read_file(name: str, typed_name: str | None = None) -> Input:
    """Return the content of a file. Raises CommandError with the name as it was typed."""
    path, shown_name = Path(name), printable_name(name if typed_name is None else typed_name)
    if sys.platform == "win32":
        from tiniscript.cli.windows_names import is_device

        if is_device(name):
            raise CommandError(2, "file_missing", file=shown_name)
    if is_pipe(name):
        raise CommandError(2, "file_no_file", file=shown_name)
    try:
        with path.open("rb") as stream:
            return Input(name, stream.read(LARGEST_SOURCE_BYTES + 1), path)
    except FileNotFoundError:
        raise CommandError(2, "file_missing", file=shown_name) from None
    except IsADirectoryError:
        raise CommandError(2, "file_directory", file=shown_name) from None
    except PermissionError:
        key = "file_directory" if path.is_dir() and os.access(path, os.R_OK) else "file_forbidden"
        raise CommandError(2, key, file=shown_name) from None
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        raise CommandError(2, "file_unreadable", file=shown_name, why=error) from None


def check_port(name: str) -> str:
    """Return the name of a port that a person has typed. It raises CommandError if it is not
    one."""
    if not name.strip() or not name.isprintable():
        raise CommandError(2, "no_such_port", found=printable_name(name) or "''")
    return name


def printable_name(name: str) -> str:
    """Return a file's name as a message can print it."""
    return printable(name, MAX_NAME_CHARACTERS)


def robot(options: Namespace, language: str) -> Robot:
    """Return the robot that `--robot` names, or the default one."""
    try:
        return robots.load(robots.DEFAULT if options.robot is None else options.robot)
    except ProfileRefused as error:
        raise refusal(
            error, language, "profile_refused", file=printable_name(options.robot)
        ) from None


def wired_robot(options: Namespace, language: str) -> Robot:
    """Return the robot of the options. Raises CommandError if no firmware fits its board."""
    from tiniscript.robots.firmware import BOARDS  # boards with all drivers

    profile = robot(options, language)
    if profile.board.chip not in BOARDS:
        known_text = ", ".join(BOARDS)
        raise CommandError(2, "no_firmware", chip=profile.board.chip, known=known_text)
    return profile


def robot_for(program_input: Input, options: Namespace, language: str) -> Robot:
    """Return the robot that `--robot` names, else the one that the program names, else the default.

    From then on, a robot that the program names counts as if `--robot` had named it.
    """
    robot_name = named_robot.shipped_name_in(program_input.data)
    if options.robot is None:
        options.robot = robot_name
    chosen_robot = robot(options, language)
    if program_input.has_robot:
        warn_of_other_robot(program_input, chosen_robot, language)
    return chosen_robot


def warn_of_other_robot(program_input: Input, chosen_robot: Robot, language: str) -> None:
    """Say on standard error that `--robot` wins, where the program names another robot."""
    robot_name = named_robot.robot_name(program_input.data)
    if robot_name is not None and robot_name.lower() != chosen_robot.name.lower():
        values = {
            "file": printable_name(program_input.name),
            "robot": printable_name(chosen_robot.name),
            "named": printable_name(robot_name),
        }
        say_aside("robot_chosen", language, **values)


def refusal(
    error: ProfileRefused, language: str, key: str,
    full_reasons: tuple[str, ...] = ("file_", "no_such_robot", "no_such_world"), **values: str,
) -> CommandError:  # fmt: skip
    """Return the refusal of a profile, a world or a lesson: the sentence `key` with all reasons.

    A single reason that begins with one of `full_reasons` says it all.
    """
    from tiniscript.robots.refusals import describe

    lines = describe(error, language)
    if len(lines) == 1 and error.reasons[0][0].startswith(full_reasons):
        return CommandError(2, "plain", said=lines[0])
    return CommandError(
        2, key, reasons=Sentence("\n".join("  " + line for line in lines)), **values
    )
