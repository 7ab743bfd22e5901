"""The outputs of a verb: files, each written whole or not at all, and diagnostics in words."""

from __future__ import annotations

import sys
from pathlib import Path

from tiniscript.cli.errors import unwritable_error
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.streams import has_colors
from tiniscript.cli.texts import Sentence, say_aside, text
from tiniscript.diagnostics.codes import MAX_DIAGNOSTICS
from tiniscript.library.compiling import Compilation

MAX_PRINTED_DIAGNOSTICS = 20  # diagnostics that are printed; a person mends the first ones first


def write(path: Path, data: bytes, error_key: str, mode: int | None = None) -> None:
    """Write a file, all of it or nothing: the old file stays until the new one is whole.

    `mode` is the permissions that it gets. Raises CommandError with the sentence of `error_key` if
    that is not possible.
    """
    from tiniscript.base import files

    try:
        files.replace(path, data, mode, is_lasting=True)
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: a link to itself
        if isinstance(error, BrokenPipeError):
            raise
        raise unwritable_error(error_key, printable_name(str(path)), error) from None


def write_output(output_path: str | None, data: bytes) -> bool:
    """Write into the file that `-o` names, or to standard output; return whether into a file.

    The text is UTF-8 there, whatever the locale. Raises CommandError.
    """
    if output_path not in (None, "-"):
        write(Path(output_path), data, "unwritable")
        return True
    sys.stdout.flush()
    sys.stdout.buffer.write(data)
    sys.stdout.flush()
    return False


def print_diagnostics(compilation: Compilation, language: str) -> None:
    """Print a program's diagnostics to standard error, the first ones in full."""
    if not compilation.diagnostics:
        return
    from tiniscript.diagnostics.rendering import as_text, message

    color = has_colors(sys.stderr)
    for diagnostic in compilation.diagnostics[:MAX_PRINTED_DIAGNOSTICS]:
        shown_message = message(diagnostic, compilation.source, language)
        lines = as_text(shown_message, compilation.source, language, color).split("\n")
        frame = lines[: 2 * bool(compilation.source.text)]
        print(*frame, *map(Sentence, lines[len(frame) :]), "", sep="\n", file=sys.stderr)
    count = len(compilation.diagnostics)
    if count > MAX_PRINTED_DIAGNOSTICS:
        key = "and_more" if count <= MAX_DIAGNOSTICS else "and_many_more"
        say_aside(key, language, n=min(count, MAX_DIAGNOSTICS) - MAX_PRINTED_DIAGNOSTICS)
    if 1 < count <= MAX_PRINTED_DIAGNOSTICS:
        print(_count(compilation, language), file=sys.stderr)


def _count(compilation: Compilation, language: str) -> str:
    mistake_count = sum(diagnostic.is_mistake for diagnostic in compilation.diagnostics)
    count_texts = []
    for n, word in (
        (mistake_count, "mistake"),
        (len(compilation.diagnostics) - mistake_count, "warning"),
    ):
        if n:
            key = f"count_{word}" if n == 1 else f"count_{word}s"
            count_texts.append(text(key, language).format(n=n))
    return ", ".join(count_texts) + "."
