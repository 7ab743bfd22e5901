"""`tsc explain`: a mistake's longer explanation."""

from __future__ import annotations

from tiniscript.cli.errors import Trouble
from tiniscript.cli.options import Options

HELP = (
    """\
tsc explain [CODE]

Says more about a mistake, with an example. Without a code it lists all.
""",
    """\
tsc explain [CÓDIGO]

Explica mejor un error, con un ejemplo. Sin código los lista todos.
""",
)


def run(arguments: list[str], language: str) -> int:
    parser = Options("explain", language, HELP)
    parser.add_argument("code", nargs="?")
    options = parser.read(arguments)
    if options is None:
        return 0
    from tiniscript.diagnostics.rendering import explain, titles

    if options.code is None:
        for code, title in titles(language):
            print(f"{code}  {title}")
        return 0
    said = explain(options.code, language)
    if said is None:
        from tiniscript.diagnostics.codes import CODES
        from tiniscript.words import nearest

        near = nearest(options.code.upper(), list(CODES)) or ""
        raise Trouble(2, "no_code", found=options.code, near=near)
    print(said, end="" if said.endswith("\n") else "\n")
    return 0
