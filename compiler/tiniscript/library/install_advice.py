"""The command that installs the packages of an extra, for the tsc that is running.

Depends on how tsc was installed: from a clone, by pip, by pipx. A clone installs its own extras;
an installed package names the packages behind an extra, so that `tiniscript` itself is named only
if that is needed.
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
# The lock file of each extra that only a clone needs, with the digest of every file pip may fetch.
LOCKS = {STUDIO: CLONE / "tools" / "studio" / "requirements.txt"}


def command(extra: str) -> str:
    """Return the command to type."""
    needed_packages = " ".join(map(quote, requirements(extra)))
    if is_pipx() and needed_packages:
        return f"pipx inject tiniscript {needed_packages}"
    if is_clone(CLONE):
        target = quote(f"{CLONE}[{extra}]")
        return f"pipx install {target}" if is_managed() else f"{_pip()} install -e {target}"
    return f"{_pip()} install {needed_packages or quote(f'tiniscript[{extra}]')}"


def install_command(extra: str) -> list[str] | None:
    """Return the command with which this Python installs the packages of an extra for itself.

    None if this Python cannot do it: it has no pip, or pipx or the system manages it.
    """
    needed_packages = requirements(extra)
    if not needed_packages or is_pipx() or is_managed() or find_spec("pip") is None:
        return None
    lock = LOCKS.get(extra)
    package_arguments = (
        ["--require-hashes", "-r", str(lock)]
        if lock is not None and lock.is_file()
        else needed_packages
    )
    return [sys.executable, "-m", "pip", "install", "--no-input", *package_arguments]


def is_clone(folder: Path) -> bool:
    """Return whether tsc runs from a clone of its repository."""
    return (folder / "pyproject.toml").is_file() and (folder / "compiler" / "tiniscript").is_dir()


def is_pipx() -> bool:
    return (Path(sys.prefix) / "pipx_metadata.json").is_file()


def is_managed() -> bool:
    """Return whether pip refuses to install because the system manages this Python, as on Debian
    12.
    """
    marker = Path(sysconfig.get_path("stdlib")) / "EXTERNALLY-MANAGED"
    return sys.prefix == sys.base_prefix and marker.is_file()


def requirements(extra: str) -> list[str]:
    """Return the requirements of an extra in the installed package, such as `wasmtime>=20`."""
    try:
        lines = metadata.requires("tiniscript") or []
    except metadata.PackageNotFoundError:
        return []
    extra_marker = re.compile(rf"\bextra\s*==\s*['\"]{extra}['\"]")
    return [line.partition(";")[0].strip() for line in lines if extra_marker.search(line)]


def _pip() -> str:
    """Return `pip` if the shell finds this Python's pip, else the command with its full path."""
    venv_path = os.environ.get("VIRTUAL_ENV")
    if venv_path and Path(venv_path).resolve() == Path(sys.prefix).resolve():
        return "pip"
    return f"{quote(sys.executable)} -m pip"


def quote(word: str) -> str:
    """Return a word quoted for the shell of this system."""
    plain_pattern = r"[\w./:=,@+-]+" if sys.platform != "win32" else r"[\w./:=,@+\\-]+"
    if re.fullmatch(plain_pattern, word):
        return word
    if sys.platform == "win32" or not re.search(r'["$`\\!]', word):
        return f'"{word}"'
    return shlex.quote(word)
