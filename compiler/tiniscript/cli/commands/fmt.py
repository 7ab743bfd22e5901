"""`tsc fmt`: the usual layout of a program."""

from __future__ import annotations

import sys
from argparse import Namespace

from tiniscript.base.source import LARGEST_SOURCE_BYTES
from tiniscript.cli import compilations, inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import say, text
from tiniscript.syntax.formatter import format_source


def run(options: Namespace, language: str) -> int:
    program_input = inputs.program(options)
    if program_input.is_image:
        raise CommandError(
            2, "needs_text", file=inputs.printable_name(program_input.name), verb="fmt"
        )
    compilation = compilations.parse_input(program_input, inputs.robot(options, language).kit)
    if not compilation.is_right:
        outputs.print_diagnostics(compilation, language)
        return 1
    formatted_text = format_source(compilation.source)
    if len(formatted_text.encode()) > LARGEST_SOURCE_BYTES:
        raise CommandError(2, "fmt_too_large", file=inputs.printable_name(program_input.name))
    name = inputs.printable_name(program_input.name)
    is_formatted = formatted_text.encode() == program_input.data
    if options.check:
        key = "is_formatted" if is_formatted else "would_format"
        print(
            text(key, language).format(file=name), file=sys.stdout if is_formatted else sys.stderr
        )
        return 0 if is_formatted else 1
    if program_input.path is None:
        outputs.write_output(None, formatted_text.encode())
    elif not is_formatted:
        outputs.write(program_input.path, formatted_text.encode(), "unwritable_source")
        say("formatted", language, file=name)
    return 0
