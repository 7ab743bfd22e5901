"""`tsc compile`: a program becomes an image, or a line for a robot that reads text."""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path

from tiniscript.base.fixed_point import as_text
from tiniscript.base.kit import Kit
from tiniscript.base.limits import STACK_VALUES
from tiniscript.cli import compilations, inputs, outputs, paths
from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import text
from tiniscript.diagnostics.codes import WILL_FAULT
from tiniscript.library import source_map
from tiniscript.library.compiling import fit_to_robot
from tiniscript.semantics.duration import duration_of_program
from tiniscript.semantics.ir import Program


def run(options: Namespace, language: str) -> int:
    program_input = inputs.program(options)
    if options.text:
        return _compile_line(options, program_input, language)
    if options.text_level is not None:
        raise CommandError(2, "level_needs_text", level=options.text_level)
    target = _target(program_input, options.output)
    if options.map == "-":
        raise CommandError(2, "over_map", file="-")
    robot = inputs.robot_for(program_input, options, language)
    compilation = compilations.compile_input(program_input, robot, is_strict=True)
    outputs.print_diagnostics(compilation, language)
    if not compilation.is_right:
        return 1
    program_map = source_map.map_of_compiled(compilation)
    outputs.write_output(target, compilation.image)
    if options.map is not None:
        data = (source_map.as_json(program_map) + "\n").encode(errors="backslashreplace")
        outputs.write(Path(options.map), data, "unwritable_at --map")
    source_map.remember(compilation.image, program_map)
    will_fault = any(diagnostic.code is WILL_FAULT for diagnostic in compilation.diagnostics)
    sentence = text("compiled", language).format(
        source=inputs.printable_name(program_input.name),
        target=inputs.printable_name(target or "-"),
        image=len(compilation.image),
        code=len(compilation.code),
        stack=compilation.verdict.stack_values if compilation.verdict else 0,
        stacks=STACK_VALUES,
        runs="" if will_fault else _run_time_text(compilation.lowered_program, robot.kit, language),
    )
    print(sentence, file=sys.stderr if target is None else sys.stdout)
    return 0


def _compile_line(options: Namespace, program_input: inputs.Input, language: str) -> int:
    """Write the program as one line of text."""
    if options.map is not None:
        raise CommandError(2, "text_has_no_map")
    robot = inputs.robot_for(program_input, options, language)
    compilation = fit_to_robot(
        compilations.compile_input(program_input, robot, is_strict=True), robot
    )
    compilation = compilations.for_level(compilation, robot, options.text_level)
    outputs.print_diagnostics(compilation, language)
    if not compilation.is_right:
        return 1
    from tiniscript.codegen.text.line import line_of, plain_code

    assert compilation.program is not None
    line = (line_of(compilation.source) + "\n").encode()
    is_printed = not outputs.write_output(options.output, line)
    sentence = text("compiled_text", language).format(
        source=inputs.printable_name(program_input.name),
        target="-" if is_printed else inputs.printable_name(options.output),
        bytes=len(line),
        code=plain_code(compilation.program).short_length,
    )
    print(sentence, file=sys.stderr if is_printed else sys.stdout)
    return 0


def _target(program_input: inputs.Input, output: str | None) -> str | None:
    """Return the file to write, or None for standard output."""
    if output == "-":
        return None
    if output is None and program_input.path is None:
        raise CommandError(2, "needs_output")
    return paths.default_output(program_input.name) if output is None else output


def _run_time_text(program: Program | None, kit: Kit, language: str) -> str:
    assert program is not None
    run_time = duration_of_program(program, kit)
    if run_time.never_ends:
        key = "runs_forever"
    elif run_time.most_ms is None:
        if not run_time.least_ms:
            return ""
        key = "runs_at_least"
    else:
        key = "runs_exactly" if run_time.most_ms == run_time.least_ms else "runs_between"
    least, most = as_text(run_time.least_ms), as_text(run_time.most_ms or 0)
    sentence = text(key, language).format(least=least, most=most)
    return text("runs", language).format(how=sentence)
