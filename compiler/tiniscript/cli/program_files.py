"""The programs that a command names: files, and all programs in folders.

It follows no link to a folder, and opens only regular files: a folder may contain anything.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from tiniscript.base.source import PROGRAM_SUFFIXES
from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.paths import real_name


class ProgramFile(NamedTuple):
    """A program's file, or, if it cannot be read, why."""

    name: str
    data: bytes
    problem: CommandError | None = None


def are_several(names: Sequence[str]) -> bool:
    """Return whether these names are more than one program."""
    return len(names) > 1 or any(_is_folder(name) for name in names)


def programs(names: Sequence[str]) -> Iterator[ProgramFile]:
    """Yield the programs that are named, each once. Raises CommandError for an empty folder."""
    seen_paths: set[str] = set()
    for name in names:
        paths = list(in_folder(name)) if _is_folder(name) else [real_name(name)]
        if not paths:
            raise CommandError(2, "no_programs", file=inputs.printable_name(name))
        for path in paths:
            real_path = os.path.realpath(path)
            if real_path not in seen_paths:
                seen_paths.add(real_path)
                yield read(path)


def _is_folder(name: str) -> bool:
    return os.path.isdir(name)  # noqa: PTH112 - a name that no file can have gets no Path


def in_folder(folder: str, suffixes: tuple[str, ...] = PROGRAM_SUFFIXES) -> Iterator[str]:
    """Yield the names of visible programs in a folder and its subfolders, in order.

    `suffixes` are the ends of their names. A folder that cannot be read is yielded itself.
    """
    pending_folders = [folder]
    while pending_folders:
        folder = pending_folders.pop()
        try:
            with os.scandir(folder) as entries:
                sorted_entries = sorted(entries, key=lambda entry: entry.name)
        except OSError:
            yield folder  # reading the file reports the reason
            continue
        for entry in sorted_entries:
            if not entry.name.startswith(".") and entry.name.lower().endswith(suffixes):
                if not entry.is_dir(follow_symlinks=False):
                    yield entry.path
        subfolders = (entry for entry in sorted_entries if entry.is_dir(follow_symlinks=False))
        pending_folders += [
            entry.path for entry in reversed(list(subfolders)) if not entry.name.startswith(".")
        ]


def read(name: str) -> ProgramFile:
    """Return the content of a file, or the reason why it cannot be read. Pipes and devices are not
    opened.
    """
    try:
        stat_result = Path(name).stat()
        if not (stat.S_ISREG(stat_result.st_mode) or stat.S_ISDIR(stat_result.st_mode)):
            return ProgramFile(
                name, b"", CommandError(2, "file_no_file", file=inputs.printable_name(name))
            )
    except (OSError, ValueError):
        pass  # reading the file reports the reason
    try:
        return ProgramFile(name, inputs.read_file(name).data)
    except CommandError as error:
        return ProgramFile(name, b"", error)
