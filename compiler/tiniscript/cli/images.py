"""A program that is ready to run: compiled now, or read from an image and verified."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import Trouble

if TYPE_CHECKING:
    from tiniscript import Compiled
    from tiniscript.bytecode.image import Image
    from tiniscript.codegen.source_map import Map
    from tiniscript.robots.profile import Robot


class Ready(NamedTuple):
    """`places` is None where nobody knows the text any more."""

    image: Image
    image_bytes: int
    places: Map | None


class OtherRobot(Exception):
    """A program has words of another robot; its mistakes have not been printed."""

    def __init__(self, compiled: Compiled) -> None:
        super().__init__()
        self.compiled = compiled


def ready(
    given: inputs.Input, robot: Robot, language: str, is_strict: bool = False,
    is_open: bool = False,
) -> Ready | None:  # fmt: skip
    """Return the program of an input, or None where its mistakes have just been printed.

    `is_strict`: a program that is too large for the robot is a mistake. `is_open`: it may be for
    another robot; then OtherRobot is raised. Raises Trouble where an image is refused.
    """
    from tiniscript.codegen import source_map

    if given.is_image:
        image = _read(given, robot.kit.fingerprint, robot.name)
        _verify(given, image, robot)
        return Ready(image, len(given.data), source_map.recall(image.checksum))
    compiled = inputs.compiled(given, robot, is_strict)
    if is_open and not compiled.is_right:
        from tiniscript.cli.robot.own_kit import is_other_robots

        if is_other_robots(compiled):
            raise OtherRobot(compiled)
    outputs.print_problems(compiled, language)
    if not compiled.is_right:
        return None
    from tiniscript.library.compiling import image_of

    image = image_of(compiled, robot)
    return Ready(image, len(compiled.image), source_map.from_compiled(compiled))


def _read(given: inputs.Input, kit: int | None, robot: str) -> Image:
    from tiniscript.bytecode.image import ImageRefused, unpack
    from tiniscript.library.known_kits import shipped_of_kit

    try:
        return unpack(given.data, kit)
    except ImageRefused as refused:
        values = {"file": inputs.shown(given.name), "robot": robot, **refused.values}
        if refused.name == "OTHER_KIT":
            values["theirs"] = shipped_of_kit(int(refused.values["theirs"], 16)) or "FILE"
        raise Trouble(1, f"image_{refused.name}", **values) from None


def _verify(given: inputs.Input, image: Image, robot: Robot) -> None:
    from tiniscript.bytecode.verify import Refused
    from tiniscript.library.compiling import verify_for

    try:
        verify_for(image, robot)
    except Refused as refused:
        values = {"name": refused.name, "number": str(refused.number)}
        where = f"{refused.offset:04x}"
        file = inputs.shown(given.name)
        raise Trouble(1, "image_code", file=file, offset=where, **values) from None


def robot_for(given: inputs.Input, robot: Robot) -> Robot:
    """Return the shipped robot whose kit an image names, or `robot` where none does."""
    from tiniscript import robots
    from tiniscript.library.known_kits import shipped_of_kit

    image = _read(given, None, robot.name)
    name = shipped_of_kit(image.kit) if image.kit else None
    return robot if name is None else robots.load(name)
