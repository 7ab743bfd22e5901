"""The cases of `tsc doctor --conform` in this clone: git keeps none, so the tests create them."""

from __future__ import annotations

import hashlib
from functools import lru_cache, partial
from pathlib import Path

from tests.machines.host import BUILD_CACHE, make_once
from tests.support.casefile import ROOT
from tools.builds import conformance

# Sources of these files.
SOURCES = (
    "compiler/tiniscript/**/*.py", "compiler/tiniscript/robots/*.toml", "tests/cases/*.md",
    "tests/machines/*.py", "tests/oracle/*.py", "tests/support/*.py", "tools/generate/*_kit.py",
    "tools/builds/conformance.py", "bytecode_spec.md", "docs/develop/link.md",
)  # fmt: skip


@lru_cache(maxsize=1)
def have_kit() -> None:
    """Make the files of the kit from these sources, once for all users."""
    digest = hashlib.sha256()
    for path in sorted(path for pattern in SOURCES for path in ROOT.glob(pattern)):
        digest.update(bytes(path.relative_to(ROOT)) + path.read_bytes())
    for name in conformance.FILES:
        built_path = make_once(
            BUILD_CACHE / f"{digest.hexdigest()[:16]}-{name}", partial(_make, name)
        )
        _put(built_path.read_bytes(), conformance.FOLDER / name)


def _make(name: str, path: Path) -> None:
    path.write_bytes(conformance.text_of(name).encode())


def _put(text: bytes, target: Path) -> None:
    if not target.is_file() or target.read_bytes() != text:
        conformance.write(target, text.decode())
