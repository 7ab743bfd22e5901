"""The command `tsc`.

Finds the verb, runs it, and turns whatever goes wrong into a sentence and an exit code:
0 done, 1 the program is wrong, 2 wrong use of `tsc`, 3 the robot or the link. Where whoever read
the output has gone, it is CLOSED, without a word, as a shell has it from any other command.
"""

from __future__ import annotations

import os
import sys

# each is a module of `commands`
VERBS = (
    "compile",
    "check",
    "run",
    "show",
    "fmt",
    "explain",
    "wiring",
    "board",
    "firmware",
    "ports",
    "ping",
    "upload",
    "live",
    "link",
    "stop",
    "start",
    "info",
    "monitor",
    "fetch",
    "name",
    "trim",
    "robot",
)


CLOSED = 141  # 128 and the number of SIGPIPE


def main(arguments: list[str] | None = None) -> int:
    """Run `tsc` with these arguments (those of the process if None); return the exit code."""
    try:
        return _main(arguments)
    except BrokenPipeError:
        _drop_output()
        return CLOSED


def _main(arguments: list[str] | None) -> int:
    arguments = sys.argv[1:] if arguments is None else arguments
    _mend_streams()
    from tiniscript.cli.texts.common import language_of, text

    language = language_of(arguments)
    try:
        code = _verb(arguments, language)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        print("\n" + text("stopped", language), file=sys.stderr)
        return 2
    except BrokenPipeError:
        raise
    except OSError as trouble:  # files have sentences of their own; this is the output
        why = str(trouble.strerror or trouble)
        print(text("full", language).format(why=why), file=sys.stderr, flush=True)
        _drop_output()
        return 2
    except Exception as bug:
        return _explain_bug(bug, language)


def _mend_streams() -> None:
    """Put something in place of standard streams that are closed, and take any letter."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: PTH123, SIM115
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    if hasattr(sys.stdin, "reconfigure"):
        sys.stdin.reconfigure(errors="backslashreplace")  # what is no text is a mistake as any


def _drop_output() -> None:
    """What is still in the buffers has nowhere to go."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)


def _verb(arguments: list[str], language: str) -> int:
    from tiniscript.cli.errors import Trouble
    from tiniscript.cli.texts.common import text

    words = [word for word in arguments if not word.startswith("-")]
    if arguments and arguments[0] in ("help", "ayuda"):
        from tiniscript.cli.verbless import asked_about

        verb = asked_about(arguments[1:])
        arguments = [verb, "--help"] if verb else []
    if not arguments or arguments[0] in ("-h", "--help"):
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
            found = name[7:] if "=" in name else arguments[1] if len(arguments) > 1 else ""
            if found not in ("en", "es"):
                raise Trouble(2, "bad_language", found=found or "''")
            rest = arguments[skip:]
            return _verb([*rest, *arguments[:skip]] if rest else [], language)
        if name not in VERBS:
            from tiniscript.cli.verbless import refuse_program
            from tiniscript.words import nearest

            refuse_program(name)
            near = nearest(name, VERBS) or ""
            raise Trouble(2, "no_verb", found=name, near=near, example=words[0] if words else "")
        from importlib import import_module

        return int(import_module(f"tiniscript.cli.commands.{name}").run(arguments[1:], language))
    except Trouble as trouble:
        print(trouble.sentence(language), file=sys.stderr)
        return trouble.exit_code


def _explain_bug(bug: Exception, language: str) -> int:
    from tiniscript.cli.texts.common import text

    if os.environ.get("TINISCRIPT_DEBUG"):
        raise bug
    what = " ".join(f"{type(bug).__name__}: {bug}".split())
    print(text("bug", language).format(what=what[:300]), file=sys.stderr)
    return 2
