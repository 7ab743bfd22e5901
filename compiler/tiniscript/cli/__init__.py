"""The command `tsc`.

Finds the verb, runs it, and turns whatever goes wrong into a sentence and an exit code:
0 done, 1 the program is wrong, 2 wrong use of `tsc`, 3 the robot or the link.
"""

from __future__ import annotations

import os
import sys

# verb -> the module of this package that does it
VERBS = {
    "compile": "compiling",
    "check": "checking",
    "run": "running",
    "show": "showing",
    "fmt": "formatting",
    "explain": "explaining",
}


def main(arguments: list[str] | None = None) -> int:
    """Run `tsc` with these arguments (those of the process if None); return the exit code."""
    arguments = sys.argv[1:] if arguments is None else arguments
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    from tiniscript.cli.texts import language_of, text

    language = language_of(arguments)
    try:
        code = _verb(arguments, language)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        print("\n" + text("stopped", language), file=sys.stderr)
        return 2
    except BrokenPipeError:
        # what is still in the buffer has nowhere to go
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        print(text("closed_pipe", language), file=sys.stderr)
        return 2
    except Exception as bug:
        return _explain_bug(bug, language)


def _verb(arguments: list[str], language: str) -> int:
    from tiniscript.cli.texts import text
    from tiniscript.cli.trouble import Trouble

    words = [word for word in arguments if not word.startswith("-")]
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(text("help", language), end="")
        return 0
    if arguments[0] in ("-V", "--version"):
        from tiniscript import __version__

        print(f"tsc (TiniScript) {__version__}")
        return 0
    try:
        name = arguments[0]
        if name == "--lang" or name.startswith("--lang="):  # before the verb, too
            skip = 1 if "=" in name else 2
            return _verb([*arguments[skip:], *arguments[:skip]], language) if (
                len(arguments) > skip
            ) else _verb([], language)  # fmt: skip
        if name not in VERBS:
            from tiniscript.words import nearest

            near = nearest(name, list(VERBS)) or ""
            raise Trouble(2, "no_verb", found=name, near=near, example=words[0] if words else "")
        from importlib import import_module

        return int(import_module(f"tiniscript.cli.{VERBS[name]}").run(arguments[1:], language))
    except Trouble as trouble:
        print(trouble.sentence(language), file=sys.stderr)
        return trouble.exit_code


def _explain_bug(bug: Exception, language: str) -> int:
    from tiniscript.cli.texts import text

    if os.environ.get("TINISCRIPT_DEBUG"):
        raise bug
    what = f"{type(bug).__name__}: {bug}"
    print(text("bug", language).format(what=what[:300]), file=sys.stderr)
    return 2
