"""Suggestions for a command without a verb: `tsc uplod`, `tsc prog.ts`."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.verbs import VERBS
from tiniscript.source import PROGRAM_ENDS
from tiniscript.words import nearest

MEANT = {  # what the same is called elsewhere
    "flash": "firmware", "burn": "firmware", "serial": "monitor", "repl": "live", "shell": "live",
    "simulate": "robot", "simulator": "robot", "sim": "robot", "version": "--version",
    "rename": "name", "owner": "claim", "diagram": "wiring", "send": "upload", "halt": "stop",
    "nombre": "name", "dueño": "claim", "conexiones": "wiring", "enviar": "upload",
    "cargar": "upload", "subir": "upload", "parar": "stop", "detener": "stop",
    "compilar": "compile", "revisar": "check", "corregir": "check", "ejecutar": "run",
    "lección": "lesson", "leccion": "lesson", "estudio": "studio", "puertos": "ports",
}  # fmt: skip


def refuse(name: str) -> NoReturn:
    """Raise CommandError where a word stands in place of a verb."""
    refuse_program(name)
    raise CommandError(2, "no_verb", found=name, near=meant(name))


def meant(name: str) -> str:
    """Return the verb that somebody means with a word that is none, or nothing."""
    return MEANT.get(name.lower()) or nearest(name, VERBS) or ""


def refuse_program(name: str) -> None:
    """Raise CommandError that names verbs where a program stands in place of one.

    tsc does not choose a verb: a robot moves only when the user has asked for it.
    """
    if name.lower().endswith((*PROGRAM_ENDS, ".bin")) or _is_file(name):
        raise CommandError(2, "file_without_verb", found=_quoted(name))
    if "(" in name or "|" in name:
        raise CommandError(2, "text_without_verb", found=_quoted(name, always=True))


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):  # a name that no file can have
        return False


def _quoted(name: str, always: bool = False) -> str:
    """Return a name as it can be copied into a command."""
    found = shown(name)
    return f'"{found}"' if always or " " in found else found
