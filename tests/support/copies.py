"""Copies of this repository's folders, for tests that add files to them and change few."""

from __future__ import annotations

import os
import shutil
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory


def link_copy(source: Path, target: Path, *ignored_patterns: str) -> Path:
    """Return a copy of a folder without files of these names.

    It is made of links to the one copy that a process has, in a thirtieth of the time. So no test
    writes into a file of it, as root could: it replaces the file.
    """
    kept_path = Path(_make_copy(source, ignored_patterns).name) / source.name
    return Path(shutil.copytree(kept_path, target, copy_function=_link))


def _link(kept_text: str, target: str) -> None:
    try:
        os.link(kept_text, target)
    except OSError:  # the target is on another file system
        shutil.copy2(kept_text, target)


@lru_cache
def _make_copy(source: Path, ignored_patterns: tuple[str, ...]) -> TemporaryDirectory[str]:
    folder = TemporaryDirectory()
    copy = Path(folder.name) / source.name
    shutil.copytree(source, copy, ignore=shutil.ignore_patterns(*ignored_patterns))
    for path in copy.rglob("*"):
        if path.is_file():
            path.chmod(0o444 | path.stat().st_mode & 0o111)
    return folder
