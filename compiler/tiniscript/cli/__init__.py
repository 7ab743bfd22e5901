"""The command `tsc`.

Finds the verb, runs it, and turns each failure into a sentence and an exit code:
0 done, 1 the program is wrong, 2 wrong use of `tsc`, 3 the robot or the link. If the reader of a
pipe has left, the code is EXIT_OF_CLOSED_PIPE, without a sentence, as with other shell commands.
"""

from __future__ import annotations

import errno
import gc
import os
import stat
import sys
from importlib import import_module

from tiniscript.base.languages import WrongTexts
from tiniscript.cli import streams
from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import language_of, say, say_aside, text
from tiniscript.cli.texts.options import LANGUAGE, command_of
from tiniscript.cli.texts.verbs import VERBS

EXIT_OF_CLOSED_PIPE = 141  # 128 and the number of SIGPIPE
# Most commands end before there is garbage, and imported modules are not garbage. A collection
# after every 700 new objects, and a full one at the end, would take a sixth of the time of `tsc
# compile`.
GC_THRESHOLD = 50_000


def main(arguments: list[str] | None = None) -> int:
    """Run `tsc` with these arguments (those of the process if None); return the exit code."""
    if arguments is None:  # the process ends with this command
        gc.set_threshold(GC_THRESHOLD)
    try:
        return _main(sys.argv[1:] if arguments is None else arguments)
    except BrokenPipeError:
        _drop_output()
        return EXIT_OF_CLOSED_PIPE
    except KeyboardInterrupt:  # the language is not known yet
        return 2
    except WrongTexts as error:
        print(f"tsc: {error}", file=sys.stderr)
        return 2
    finally:
        if arguments is None:
            gc.freeze()


def _main(arguments: list[str]) -> int:
    _repair_streams()
    language = language_of(arguments)
    try:
        exit_code = _run_verb(arguments, language)
        sys.stdout.flush()
        return exit_code
    except KeyboardInterrupt:
        streams.drop_unread_output()
        print("\n" + text("stopped", language), file=sys.stderr)
        return 2
    except (BrokenPipeError, WrongTexts):
        raise
    except OSError as error:  # files have sentences of their own; this is the output
        if _is_closed_pipe(error):
            raise BrokenPipeError from None
        cause = str(error.strerror or error)
        say_aside("full", language, why=cause)
        _drop_output()
        return 2
    except Exception as bug:
        return _explain_bug(bug, language)


def _is_closed_pipe(error: OSError) -> bool:
    """Return whether the reader of the output has left: on Windows that is an EINVAL of a pipe."""
    if sys.platform != "win32" or error.errno != errno.EINVAL:
        return False
    if error.filename is not None or getattr(error, "winerror", None) is not None:
        return False  # a file, or a query to the system: the C library names neither
    try:
        return any(stat.S_ISFIFO(os.fstat(descriptor).st_mode) for descriptor in (1, 2))
    except OSError:  # closed
        return False


def _repair_streams() -> None:
    """Replace closed standard streams, and accept any character."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: PTH123, SIM115
    for name, stream in (("stdout", sys.stdout), ("stderr", sys.stderr)):
        if hasattr(stream, "reconfigure"):
            is_unicode = (stream.encoding or "").lower().startswith("utf")
            streams.register()
            stream.reconfigure(errors="backslashreplace" if is_unicode else streams.ERROR_HANDLER)
        if stream.isatty():
            setattr(sys, name, streams.WrappingStream(stream))
    if hasattr(sys.stdin, "reconfigure"):
        sys.stdin.reconfigure(errors="backslashreplace")  # invalid text becomes a mistake


def _drop_output() -> None:
    """Discard the output buffers, because they cannot be written."""
    null_descriptor = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null_descriptor, 1)
    os.dup2(null_descriptor, 2)


def _tell_missing_parts(language: str) -> None:
    """Say which parts that are made before a wheel are not in this installation."""
    from tiniscript.flash import ready
    from tiniscript.studio import building

    parts = {
        "version_page": building.has_page(),
        "version_firmware": any(ready.FOLDER.glob("*.hex")),
    }
    for key, is_installed in parts.items():
        if not is_installed:
            say(key, language)


def _run_verb(arguments: list[str], language: str) -> int:
    from tiniscript.cli.options import Options, bad_choice

    if not arguments or arguments[0] in ("-h", "--help"):
        arguments = ["help"]
    if arguments[0] in ("-V", "--version"):
        from tiniscript.base.version import __version__

        print(f"tsc (TiniScript) {__version__}")
        _tell_missing_parts(language)
        return 0
    try:
        name = arguments[0]
        if name == "--lang" or name.startswith("--lang="):  # --lang is allowed before the verb
            flag_word_count = 1 if "=" in name else 2
            language_name = name[7:] if "=" in name else arguments[1] if len(arguments) > 1 else ""
            if language_name not in LANGUAGE.choices:
                raise bad_choice("--lang", LANGUAGE.choices, language_name, language)
            words_after = arguments[flag_word_count:]
            return _run_verb(
                [*words_after, *arguments[:flag_word_count]] if words_after else [], language
            )
        if name not in VERBS:
            from tiniscript.cli.verbless import is_help, refuse

            name = "help" if is_help(name) else refuse(name, arguments[1:], language)
        command, words = command_of(name, arguments[1:])
        options = Options(command, language).read(words)
        if options is None:
            return 0
        return int(import_module(f"tiniscript.cli.commands.{command}").run(options, language))
    except CommandError as error:
        print(error.sentence(language), file=sys.stderr)
        return error.exit_code


def _explain_bug(bug: Exception, language: str) -> int:
    if os.environ.get("TINISCRIPT_DEBUG"):
        raise bug
    description = " ".join(f"{type(bug).__name__}: {bug}".split())
    say_aside("bug", language, what=description[:300])
    return 2
