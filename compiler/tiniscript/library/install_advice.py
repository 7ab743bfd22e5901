"""The command that installs what a part of tsc needs, for the tsc that is running.

Knows how tsc got here: from a clone, by pip, by pipx. Names what PyPI has, never `tiniscript`
itself where that is not needed: a clone knows its extras, and an installed package those packages
that an extra stands for.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
import sysconfig
from importlib import metadata
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent
CLONE = PACKAGE.parent.parent
VIRTUAL, FIRMWARE = "virtual", "firmware"  # the extras of pyproject.toml


def command(extra: str) -> str:
    """Return what to type."""
    wanted = " ".join(map(quoted, requirements(extra)))
    if is_pipx() and wanted:
        return f"pipx inject tiniscript {wanted}"
    if is_clone(CLONE):
        place = quoted(f"{CLONE}[{extra}]")
        return f"pipx install {place}" if is_managed() else f"{_pip()} install -e {place}"
    return f"{_pip()} install {wanted or quoted(f'tiniscript[{extra}]')}"


def is_clone(folder: Path) -> bool:
    """Whether tsc runs from a clone of its repository."""
    return (folder / "pyproject.toml").is_file() and (folder / "compiler" / "tiniscript").is_dir()


def is_pipx() -> bool:
    return (Path(sys.prefix) / "pipx_metadata.json").is_file()


def is_managed() -> bool:
    """Whether pip refuses to install here: Python is the system's, as on Debian 12."""
    marker = Path(sysconfig.get_path("stdlib")) / "EXTERNALLY-MANAGED"
    return sys.prefix == sys.base_prefix and marker.is_file()


def requirements(extra: str) -> list[str]:
    """Return what the installed package says that an extra needs, `wasmtime>=20`."""
    try:
        rows = metadata.requires("tiniscript") or []
    except metadata.PackageNotFoundError:
        return []
    marked = re.compile(rf"\bextra\s*==\s*['\"]{extra}['\"]")
    return [row.partition(";")[0].strip() for row in rows if marked.search(row)]


def _pip() -> str:
    """Return `pip` where a shell finds the right one, else the one of this Python."""
    active = os.environ.get("VIRTUAL_ENV")
    if active and Path(active).resolve() == Path(sys.prefix).resolve():
        return "pip"
    return f"{quoted(sys.executable)} -m pip"


def quoted(word: str) -> str:
    """Return a word as the shell of this system takes it."""
    plain = r"[\w./:=,@+-]+" if sys.platform != "win32" else r"[\w./:=,@+\\-]+"
    if re.fullmatch(plain, word):
        return word
    if sys.platform == "win32" or not re.search(r'["$`\\!]', word):
        return f'"{word}"'
    return shlex.quote(word)
