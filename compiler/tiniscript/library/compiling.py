"""Compiles a program's bytes for one robot, and reads images.

The command and the functions of the library both use it. Imports no more than the compiler does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from tiniscript import Compiled
    from tiniscript.bytecode.image import Image
    from tiniscript.robots.profile import Robot


def compiled(
    data: bytes,
    robot: Robot,
    name: str,
    is_strict: bool,
    optimize: bool = True,
    names_robots: bool = True,
) -> Compiled:
    """Return the result of compiling a program's text.

    `is_strict`: a program that is too large for the robot is a mistake, else a warning.
    `names_robots`: a word of another robot is said to be that; not where no other can be chosen.
    """
    from tiniscript import compile_text, fitting

    text = text_of(data, name)
    if not isinstance(text, str):
        return text
    found = compile_text(text, robot.kit, name, optimize)
    if not found.is_right:
        if not names_robots:
            return found
        from tiniscript.library.known_kits import naming

        return naming(found, robot)
    return fitting(found, robot, is_strict)


def text_of(data: bytes, name: str) -> str | Compiled:
    """Return a program's text, or a result with one diagnostic where the bytes are no text."""
    from tiniscript.source import Unreadable, decode

    try:
        return decode(data)
    except Unreadable as unreadable:
        from tiniscript import Compiled
        from tiniscript.diagnostics import codes
        from tiniscript.source import Source, Span

        reasons = {"too_large": codes.TOO_LARGE, "binary": codes.BINARY}
        code = reasons.get(unreadable.reason, codes.NOT_UTF8)
        return Compiled(Source("", name), [codes.Diagnostic(code, Span(0, 0))])


def image_of(compiled: Compiled, robot: Robot) -> Image:
    """Return the image of a program without mistakes."""
    from tiniscript.bytecode.image import Image, checksum
    from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR

    assert compiled.program is not None and compiled.verdict is not None
    devices = robot.kit.hash_of_used(compiled.verdict.uses)
    return Image(compiled.program.start, devices, compiled.code,
                 checksum(compiled.image), (ISA_MAJOR, ISA_MINOR))  # fmt: skip


def maker(robot: Robot) -> Callable[[str], Image | None]:
    """Return what makes the image of a text for a robot, or None where the text has mistakes."""

    def made(text: str) -> Image | None:
        found = compiled(text.encode(), robot, "", is_strict=True)
        return image_of(found, robot) if found.is_right else None

    return made


def kit_of(compiled: Compiled, robot: Robot) -> int:
    """Return the fingerprint of the kit whose words a program uses, or 0 for none."""
    assert compiled.verdict is not None
    return robot.kit.fingerprint if compiled.verdict.uses else 0


def fits(image: Image, robot: Robot) -> bool:
    """Return whether a robot may run an image that `unpack` has read."""
    from tiniscript.bytecode.image import ImageRefused
    from tiniscript.bytecode.loading import check
    from tiniscript.bytecode.verify import Refused

    try:
        check(image, robot.kit)
    except (ImageRefused, Refused):
        return False
    return True
