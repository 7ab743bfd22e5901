"""`tsc compile`: a program becomes an image."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from tiniscript.cli import inputs, outputs, paths
from tiniscript.cli.errors import Trouble
from tiniscript.cli.options import Options
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript import Compiled

HELP = (
    """\
tsc compile PROGRAM [-o FILE] [--robot NAME|FILE] [--map FILE]

Compiles a program into an image for the robot, beside the program if -o is not given.
  -o FILE       where to; - is standard output
  --robot R     for which robot: a name (tinibot, ...) or a profile's file
  --map FILE    writes which instruction comes from which line, as JSON
Says how many bytes it has, how deep its stack gets and, where that can be known, how long it
runs. Where the program has mistakes, FILE stays as it was.
""",
    """\
tsc compile PROGRAMA [-o ARCHIVO] [--robot NOMBRE|ARCHIVO] [--map ARCHIVO]

Compila un programa en una imagen para el robot, junto al programa si no se da -o.
  -o ARCHIVO    a dónde; - es la salida estándar
  --robot R     para qué robot: un nombre (tinibot, ...) o el archivo de un perfil
  --map ARCHIVO escribe qué instrucción viene de qué línea, como JSON
Dice cuántos bytes tiene, cuánto usa de la pila y, si se puede saber, cuánto dura. Si el
programa tiene errores, ARCHIVO queda como estaba.
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("compile", language, HELP)
    parser.takes_program()
    parser.add_argument("-o", dest="output")
    parser.add_argument("--map")
    options = parser.read(arguments)
    if options is None:
        return 0
    given = inputs.program(options)
    target = _target(given, options.output)
    if options.map == "-":
        raise Trouble(2, "over_map", file="-")
    robot = inputs.robot(options, language)
    compiled = inputs.compiled(given, robot, is_strict=True)
    outputs.print_problems(compiled, language)
    if not compiled.is_right:
        return 1
    from tiniscript.codegen import source_map

    places = source_map.from_compiled(compiled)
    if target is None:
        sys.stdout.buffer.write(compiled.image)
        sys.stdout.flush()
    else:
        outputs.write(target, compiled.image, "unwritable")
    if options.map is not None:
        data = (source_map.as_json(places) + "\n").encode(errors="backslashreplace")
        outputs.write(Path(options.map), data, "unwritable_map")
    source_map.remember(compiled.image, places)
    said = text("compiled", language).format(
        source=inputs.shown(given.name),
        target=inputs.shown(str(target or "-")),
        image=len(compiled.image),
        code=len(compiled.code),
        stack=compiled.verdict.stack_values if compiled.verdict else 0,
        stacks=_stack_values(),
        runs="" if _will_fault(compiled) else _runs(compiled.program, language),
    )
    print(said, file=sys.stderr if target is None else sys.stdout)
    return 0


def _target(given: inputs.Input, output: str | None) -> Path | None:
    """Return the file to write, or None for standard output."""
    if output == "-":
        return None
    if output is None and given.path is None:
        raise Trouble(2, "needs_output")
    return Path(paths.default_output(given.name) if output is None else output)


def _stack_values() -> int:
    from tiniscript.bytecode.opcodes import STACK_VALUES

    return STACK_VALUES


def _will_fault(compiled: Compiled) -> bool:
    from tiniscript.diagnostics.codes import WILL_FAULT

    return any(problem.code is WILL_FAULT for problem in compiled.problems)


def _runs(program: object, language: str) -> str:
    from tiniscript.fixed_point import as_text
    from tiniscript.semantics.duration import duration
    from tiniscript.semantics.ir import Program
    from tiniscript.semantics.optimizer import optimized

    assert isinstance(program, Program)
    how = duration(optimized(program))
    if how.never_ends:
        key = "runs_forever"
    elif how.most is None:
        if not how.least:
            return ""
        key = "runs_at_least"
    else:
        key = "runs_exactly" if how.most == how.least else "runs_between"
    least, most = as_text(how.least), as_text(how.most or 0)
    said = text(key, language).format(least=least, most=most)
    return text("runs", language).format(how=said)
