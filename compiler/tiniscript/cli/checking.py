"""`tsc check`: all mistakes and warnings, no output file."""

from __future__ import annotations

from tiniscript.cli import inputs, outputs
from tiniscript.cli.options import Options
from tiniscript.cli.texts import text

HELP = (
    """\
tsc check PROGRAM [--json] [--robot NAME|FILE]

Shows all mistakes and warnings of a program.
  --json        as a list of {code, severity, line, column, end_line, end_column, message, fix};
                lines and columns count from 1, columns in characters, the end is not included
""",
    """\
tsc check PROGRAMA [--json] [--robot NOMBRE|ARCHIVO]

Muestra todos los errores y avisos de un programa.
  --json        como lista de {code, severity, line, column, end_line, end_column, message, fix};
                líneas y columnas desde 1, columnas en caracteres, el final no se incluye
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("check", language, HELP)
    parser.takes_program()
    parser.add_argument("--json", action="store_true")
    options = parser.read(arguments)
    if options is None:
        return 0
    given = inputs.program(options)
    robot = inputs.robot(options, language)
    compiled = inputs.compiled(given, robot, is_strict=False)
    if options.json:
        import json

        from tiniscript.messages import as_json, message

        said = [message(problem, compiled.source, language) for problem in compiled.problems]
        print(json.dumps(as_json(said), indent=2))
    else:
        outputs.print_problems(compiled, language)
        if compiled.is_right:
            print(text("no_mistakes", language).format(file=inputs.shown(given.name)))
    return 0 if compiled.is_right else 1
