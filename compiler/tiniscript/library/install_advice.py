"""The command that installs the packages of an extra, for the tsc that is running.

Depends on how tsc was installed: from a clone, by pip, by pipx. A clone installs its own extras;
an installed package names the packages behind an extra, so that `tiniscript` itself is named only
where that is needed.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
import sysconfig
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent
CLONE = PACKAGE.parent.parent
# The extras of pyproject.toml.
VIRTUAL, FIRMWARE, RADIO, BROKER, STUDIO = "virtual", "firmware", "radio", "broker", "studio"
# Of an extra that only a clone needs: each file that pip may fetch, by its digest.
LOCKS = {STUDIO: CLONE / "tools" / "studio" / "requirements.txt"}


def command(extra: str) -> str:
    """Return the command to type."""
    expected = " ".join(map(quote, requirements(extra)))
    if is_pipx() and expected:
        return f"pipx inject tiniscript {expected}"
    if is_clone(CLONE):
        place = quote(f"{CLONE}[{extra}]")
        return f"pipx install {place}" if is_managed() else f"{_pip()} install -e {place}"
    return f"{_pip()} install {expected or quote(f'tiniscript[{extra}]')}"


def install_command(extra: str) -> list[str] | None:
    """Return the command with which this Python installs the packages of an extra for itself.

    None where that is not its business: it has no pip, or pipx or the system manages it.
    """
    expected = requirements(extra)
    if not expected or is_pipx() or is_managed() or find_spec("pip") is None:
        return None
    lock = LOCKS.get(extra)
    package_names = (
        ["--require-hashes", "-r", str(lock)] if lock is not None and lock.is_file() else expected
    )
    return [sys.executable, "-m", "pip", "install", "--no-input", *package_names]


def is_clone(folder: Path) -> bool:
    """Whether tsc runs from a clone of its repository."""
    return (folder / "pyproject.toml").is_file() and (folder / "compiler" / "tiniscript").is_dir()


def is_pipx() -> bool:
    return (Path(sys.prefix) / "pipx_metadata.json").is_file()


def is_managed() -> bool:
    """Whether pip refuses to install because the system manages this Python, as on Debian 12."""
    marker = Path(sysconfig.get_path("stdlib")) / "EXTERNALLY-MANAGED"
    return sys.prefix == sys.base_prefix and marker.is_file()


def requirements(extra: str) -> list[str]:
    """Return the requirements of an extra in the installed package, such as `wasmtime>=20`."""
    try:
        rows = metadata.requires("tiniscript") or []
    except metadata.PackageNotFoundError:
        return []
    marked = re.compile(rf"\bextra\s*==\s*['\"]{extra}['\"]")
    return [row.partition(";")[0].strip() for row in rows if marked.search(row)]


def _pip() -> str:
    """Return `pip` if the shell finds this Python's pip, else the command with its full path."""
    active = os.environ.get("VIRTUAL_ENV")
    if active and Path(active).resolve() == Path(sys.prefix).resolve():
        return "pip"
    return f"{quote(sys.executable)} -m pip"


def quote(word: str) -> str:
    """Return a word quoted for the shell of this system."""
    plain = r"[\w./:=,@+-]+" if sys.platform != "win32" else r"[\w./:=,@+\\-]+"
    if re.fullmatch(plain, word):
        return word
    if sys.platform == "win32" or not re.search(r'["$`\\!]', word):
        return f'"{word}"'
    return shlex.quote(word)
