"""What a verb leaves behind: files that are whole or not there, and problems in words."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from tiniscript.cli.errors import Trouble
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript import Compiled

SHOWN = 20  # problems that are printed; a person mends the first ones first


def write(path: Path, data: bytes, key: str) -> None:
    """Write a file, all of it or nothing: what was there stays until the new one is whole.

    Raises Trouble with the sentence `key` where that is not possible.
    """
    from tiniscript import files
    from tiniscript.cli.inputs import shown

    try:
        files.replace(path, data)
    except (OSError, ValueError, RuntimeError) as why:  # RuntimeError: a link to itself
        if isinstance(why, BrokenPipeError):
            raise
        reason = why.strerror if isinstance(why, OSError) and why.strerror else str(why)
        raise Trouble(2, key, file=shown(str(path)), why=reason) from None


def print_problems(compiled: Compiled, language: str) -> None:
    """Print what is wrong with a program, the first problems in full, to standard error."""
    if not compiled.problems:
        return
    from tiniscript.diagnostics.rendering import as_text, message

    color = sys.stderr.isatty() and not os.environ.get("NO_COLOR")
    for problem in compiled.problems[:SHOWN]:
        said = message(problem, compiled.source, language)
        print(as_text(said, compiled.source, language, color) + "\n", file=sys.stderr)
    if len(compiled.problems) > SHOWN:
        more = text("and_more", language).format(n=len(compiled.problems) - SHOWN)
        print(more, file=sys.stderr)
    if len(compiled.problems) > 1:
        print(_count(compiled, language), file=sys.stderr)


def _count(compiled: Compiled, language: str) -> str:
    mistakes = sum(problem.is_mistake for problem in compiled.problems)
    counted = []
    for n, word in ((mistakes, "mistake"), (len(compiled.problems) - mistakes, "warning")):
        if n:
            key = f"count_{word}" if n == 1 else f"count_{word}s"
            counted.append(text(key, language).format(n=n))
    return ", ".join(counted) + "."
