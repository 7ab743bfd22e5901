"""`tsc check`: all mistakes and warnings, no output file; with --fix the sure repairs."""

from __future__ import annotations

import json
import sys
from argparse import Namespace

from tiniscript.cli import compilations, inputs, outputs, program_files
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import Input
from tiniscript.cli.texts import say, say_aside, text
from tiniscript.diagnostics.rendering import as_json, message
from tiniscript.library.compiling import Compilation
from tiniscript.robots.profile import Robot


def run(options: Namespace, language: str) -> int:
    names: list[str] = options.programs
    if program_files.are_several(names) and not options.texts:
        from tiniscript.cli import check_table

        return check_table.check(options, _robot(options, language), language)
    if options.csv is not None:
        raise CommandError(2, "no_table")
    if len(names) > 1:
        raise CommandError(2, "two_programs")
    options.program = names[0] if names else None
    program_input = inputs.program(options)
    inputs.robot_for(program_input, options, language)
    robot = _robot(options, language)
    if options.fix or options.diff:
        compilation, is_right = _repair(options, program_input, robot, language)
    else:
        compilation = compilations.compile_input(program_input, robot, is_strict=False)
        compilation = compilations.for_level(compilation, robot, options.text_level)
        is_right = compilation.is_right
    if options.json:
        messages = [
            message(diagnostic, compilation.source, language)
            for diagnostic in compilation.diagnostics
        ]
        print(json.dumps(as_json(messages), indent=2))
    else:
        outputs.print_diagnostics(compilation, language)
        if (
            compilation.is_right
            and not options.diff
            and (program_input.path is not None or not options.fix)
        ):
            say("no_mistakes", language, file=inputs.printable_name(program_input.name))
    return 0 if is_right else 1


def _repair(
    options: Namespace, program_input: Input, robot: Robot, language: str
) -> tuple[Compilation, bool]:
    """Make or show the certain repairs; return the remaining mistakes, and whether the program is
    right now.
    """
    from tiniscript.cli.repairing import print_difference, repair

    repaired_program = repair(program_input, robot)
    name = inputs.printable_name(program_input.name)
    prints_text = not options.json
    if options.diff:
        if prints_text and repaired_program.repair_count:
            print_difference(program_input.data, repaired_program.data, program_input.name)
        key = "would_repair" if repaired_program.repair_count else "nothing_repaired"
        if prints_text and (
            repaired_program.repair_count or not repaired_program.compilation.is_right
        ):
            key += "_one" if repaired_program.repair_count == 1 else ""
            say_aside(key, language, file=name, n=repaired_program.repair_count)
        return (
            repaired_program.compilation,
            repaired_program.compilation.is_right and not repaired_program.repair_count,
        )
    if program_input.path is None:
        if prints_text:
            outputs.write_output(None, repaired_program.data)
    elif repaired_program.repair_count:
        outputs.write(program_input.path, repaired_program.data, "unwritable_source")
    if prints_text and repaired_program.repair_count and program_input.path is not None:
        print_difference(program_input.data, repaired_program.data, program_input.name)
        key = "repaired_one" if repaired_program.repair_count == 1 else "repaired"
        say_aside(key, language, file=name, n=repaired_program.repair_count)
    if prints_text and not repaired_program.compilation.is_right:
        key = "not_repaired" if repaired_program.repair_count else "nothing_repaired"
        print(text(key, language).format(file=name) + "\n", file=sys.stderr)
    compilation = compilations.for_level(repaired_program.compilation, robot, options.text_level)
    return compilation, compilation.is_right


def _robot(options: Namespace, language: str) -> Robot:
    """Return the robot that is named, or the one on a port, if its profile is known."""
    robot = inputs.robot(options, language)
    if options.port is None and not options.virtual:
        return robot
    from tiniscript.cli.robot import own_kit
    from tiniscript.cli.robot.connect import Connection

    with Connection(options, robot, language) as connection:
        connection.meet()
        own_kit.use_answering_profile(connection, options)
        return connection.profile
