"""What a person means who names no verb first: `tsc help upload`, `tsc prog.ts`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown

PROGRAMS = (".ts", ".ts.txt", ".bin")


def asked_about(arguments: Sequence[str]) -> str:
    """Return the verb that `help` is asked about, or nothing."""
    rest = list(arguments)
    while rest and rest[0].startswith("-"):
        del rest[: 2 if rest[0] == "--lang" else 1]
    return rest[0] if rest else ""


def refuse_program(name: str) -> None:
    """Raise Trouble that names verbs where a program stands in place of one.

    tsc does not choose: a robot moves only where somebody has said so.
    """
    if name.lower().endswith(PROGRAMS) or _is_file(name):
        raise Trouble(2, "file_without_verb", found=_quoted(name))
    if "(" in name or "|" in name:
        raise Trouble(2, "text_without_verb", found=_quoted(name, always=True))


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):  # a name that no file can have
        return False


def _quoted(name: str, always: bool = False) -> str:
    """Return a name as it can be copied into a command."""
    found = shown(name)
    return f'"{found}"' if always or " " in found else found
