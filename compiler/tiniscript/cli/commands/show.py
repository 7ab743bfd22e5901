"""`tsc show`: the disassembly of a program, or the program as an Arduino sketch."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli import compilations, images, inputs, outputs
from tiniscript.cli.disassembling import print_disassembly, print_json
from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import say
from tiniscript.codegen.sketch.writing import BOARD_TITLES, missing_feature, sketch_of
from tiniscript.robots.profile import Robot


def run(options: Namespace, language: str) -> int:
    program_input = inputs.program(options)
    robot = inputs.robot_for(program_input, options, language)
    if options.arduino:
        return _sketch(options, program_input, robot, language)
    if options.output is not None:
        raise CommandError(2, "output_needs_arduino", file=inputs.printable_name(options.output))
    if program_input.is_image and options.robot is None:
        robot = images.robot_for(program_input, robot)
    ready_program = images.ready_program(program_input, robot, language)
    if ready_program is None:
        return 1
    if options.json:
        print_json(ready_program, robot)
    else:
        print_disassembly(ready_program, robot, inputs.printable_name(program_input.name), language)
    return 0


def _sketch(options: Namespace, program_input: inputs.Input, robot: Robot, language: str) -> int:
    if options.json:
        raise CommandError(2, "sketch_or_json")
    if program_input.is_image:
        raise CommandError(2, "sketch_needs_text", file=inputs.printable_name(program_input.name))
    if robot.board.chip not in BOARD_TITLES:
        boards_text = ", ".join(BOARD_TITLES)
        raise CommandError(2, "sketch_no_board", chip=robot.board.chip, known=boards_text)
    compilation = compilations.compile_input(program_input, robot, is_strict=False)
    outputs.print_diagnostics(compilation, language)
    if not compilation.is_right:
        return 1
    assert compilation.program is not None
    if missing_name := missing_feature(compilation.program, robot.kit):
        raise CommandError(
            2, f"sketch_no_{missing_name}", file=inputs.printable_name(program_input.name)
        )
    sketch = sketch_of(compilation.source, compilation.program, robot, language).encode()
    if outputs.write_output(options.output, sketch):
        name = inputs.printable_name(robot.labels[language]["robot"])
        say("sketch", language, file=inputs.printable_name(options.output), robot=name)
    return 0
