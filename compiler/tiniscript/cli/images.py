"""A program that is ready to run: compiled now, or read from an image and verified."""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.bytecode.image import Image, ImageRefused, pack, unpack
from tiniscript.bytecode.verify import Refused, check
from tiniscript.cli import compilations, inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.library import source_map
from tiniscript.library.compiling import Compilation, fit_to_robot, image_of
from tiniscript.library.known_kits import find_robot_for, missing_need_key
from tiniscript.library.other_robots import has_words_of_other_robots
from tiniscript.library.source_map import SourceMap
from tiniscript.robots.profile import Robot


class ReadyProgram(NamedTuple):
    """`program_map` is None if the text is unknown."""

    image: Image
    image_bytes: int
    program_map: SourceMap | None


class OtherRobot(Exception):
    """A program has words of another robot; its mistakes have not been printed."""

    def __init__(self, compilation: Compilation) -> None:
        super().__init__()
        self.compilation = compilation


def ready_program(
    program_input: inputs.Input, robot: Robot, language: str, is_strict: bool = False,
    may_choose_robot: bool = False,
) -> ReadyProgram | None:  # fmt: skip
    """Return the program of an input, or None if it has mistakes, which it prints.

    `is_strict`: a program that is too large for the robot, or uses features that the robot lacks,
    is a mistake. `may_choose_robot`: a program for another robot raises OtherRobot. Raises
    CommandError if an image is refused.
    """
    if program_input.is_image:
        image = _read_image(program_input)
        _check_image(program_input, image, robot)
        if is_strict and (need_key := missing_need_key(image.needs, robot)):
            raise CommandError(
                1, need_key, robot=robot.name, file=inputs.printable_name(program_input.name)
            )
        return ReadyProgram(image, len(program_input.data), source_map.recall(image.checksum))
    compilation = compilations.compile_input(program_input, robot, is_strict)
    if may_choose_robot and not compilation.is_right:
        if has_words_of_other_robots(compilation.diagnostics):
            raise OtherRobot(compilation)
    if is_strict:
        compilation = fit_to_robot(compilation, robot)
    outputs.print_diagnostics(compilation, language)
    if not compilation.is_right:
        return None
    image = image_of(compilation, robot)
    program_map = source_map.map_of_compiled(compilation)
    return ReadyProgram(image, len(compilation.image), program_map)


def _read_image(program_input: inputs.Input) -> Image:
    try:
        return unpack(program_input.data)
    except ImageRefused as error:
        values = {"file": inputs.printable_name(program_input.name), **error.values}
        raise CommandError(1, f"image_{error.name}", **values) from None


def _check_image(program_input: inputs.Input, image: Image, robot: Robot) -> None:
    """Raise CommandError where the robot may not run an image, and say which known one may."""
    file = inputs.printable_name(program_input.name)
    try:
        check(image, robot.kit)
    except (ImageRefused, Refused) as error:
        # The robot has fewer devices.
        lacks_devices = error.name == "NO_SUCH_DEVICE" and image.devices
        if error.name == "OTHER_KIT" or lacks_devices:
            other_robot = find_robot_for(image, robot)
            other_name = "FILE" if other_robot is None else other_robot.name
            raise CommandError(
                1, "image_OTHER_KIT", file=file, robot=robot.name, theirs=other_name
            ) from None
        assert isinstance(error, Refused)
        values = {"name": error.name, "number": str(error.number)}
        offset_text = f"{error.offset:04x}"
        raise CommandError(1, "image_code", file=file, offset=offset_text, **values) from None


def robot_for(program_input: inputs.Input, robot: Robot) -> Robot:
    """Return `robot`, or a known robot that has the devices of an image if `robot` lacks them."""
    return find_robot_for(_read_image(program_input), robot) or robot


def keep_map(program: ReadyProgram) -> None:
    """Keep a program's source map for other commands, if it has one."""
    if program.program_map is not None:
        image = program.image
        image_data = pack(image.start, image.devices, image.code, needs=image.needs)
        source_map.remember(image_data, program.program_map)
