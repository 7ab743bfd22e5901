"""The compilation of an input's text, with its diagnostics."""

from __future__ import annotations

from tiniscript.base.kit import Kit
from tiniscript.base.source import Source
from tiniscript.cli import inputs
from tiniscript.diagnostics.codes import in_order
from tiniscript.library.compiling import Compilation, compile_source, text_of
from tiniscript.robots.profile import Robot
from tiniscript.robots.text_levels import LEVELS
from tiniscript.syntax.parser import parse


def compile_input(
    program_input: inputs.Input, robot: Robot, is_strict: bool, names_robots: bool = True
) -> Compilation:
    """Return the result of compiling an input, with or without a robot chosen by `--robot`."""
    return compile_source(
        program_input.data,
        robot,
        program_input.name,
        is_strict,
        names_robots=names_robots,
        is_chosen=program_input.has_robot,
    )


def for_level(compilation: Compilation, robot: Robot, name: str | None) -> Compilation:
    """Return a compilation with the features of the program that a robot of this level cannot read
    as text."""
    if name is None or compilation.program is None or not compilation.is_right:
        return compilation
    from tiniscript.library.text_fitting import find_misfits

    misfits = find_misfits(compilation.source, compilation.program, robot.kit, LEVELS[name])
    return compilation._replace(diagnostics=in_order([*compilation.diagnostics, *misfits]))


def parse_input(program_input: inputs.Input, kit: Kit) -> Compilation:
    """Return only the syntax mistakes of a program's text."""
    text = text_of(program_input.data, program_input.name)
    if not isinstance(text, str):
        return text
    source = Source(text, program_input.name)
    return Compilation(source, in_order(parse(source).diagnostics))
