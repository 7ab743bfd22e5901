"""A program's bytes become what the compiler makes of them, for one robot; images are read.

The command and the functions of the library both use it. As light as the compiler itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tiniscript import Compiled
    from tiniscript.bytecode.image import Image
    from tiniscript.robots.profile import Robot


def compiled(
    data: bytes, robot: Robot, name: str, is_strict: bool, optimize: bool = True
) -> Compiled:
    """Return what became of a program's text.

    `is_strict`: a program that is too large for the robot is a mistake, else a warning.
    """
    from tiniscript import compile_text, fitting

    text = text_of(data, name)
    if not isinstance(text, str):
        return text
    found = compile_text(text, robot.kit, name, optimize)
    if not found.is_right:
        from tiniscript.library.known_kits import naming

        return naming(found, robot)
    return fitting(found, robot, is_strict)


def text_of(data: bytes, name: str) -> str | Compiled:
    """Return a program's text; where the bytes are no text, that as its one problem."""
    from tiniscript.source import Unreadable, decode

    try:
        return decode(data)
    except Unreadable as unreadable:
        from tiniscript import Compiled
        from tiniscript.diagnostics import codes
        from tiniscript.source import Source, Span

        reasons = {"too_large": codes.TOO_LARGE, "binary": codes.BINARY}
        code = reasons.get(unreadable.reason, codes.NOT_UTF8)
        return Compiled(Source("", name), [codes.Problem(code, Span(0, 0))])


def image_of(compiled: Compiled, robot: Robot) -> Image:
    """Return the image of a program that is right."""
    from tiniscript.bytecode.image import Image, checksum
    from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR

    assert compiled.program is not None
    return Image(compiled.program.start, kit_of(compiled, robot), compiled.code,
                 checksum(compiled.image), (ISA_MAJOR, ISA_MINOR))  # fmt: skip


def kit_of(compiled: Compiled, robot: Robot) -> int:
    """Return the fingerprint of the kit whose words a program uses, or 0 for none."""
    assert compiled.verdict is not None
    return robot.kit.fingerprint if compiled.verdict.uses_kit else 0


def verify_for(image: Image, robot: Robot) -> None:
    """Verify the code of an image for the robot whose kit it has. Raises `verify.Refused`."""
    from tiniscript.bytecode.verify import verify

    kit = robot.kit if image.kit else None
    verify(image.code, len(kit.sensors) if kit else 0, len(kit.actuators) if kit else 0)
