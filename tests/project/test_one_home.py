"""A fact that was once written down in several places has one home, and stays there."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.support.casefile import ROOT

PACKAGE = ROOT / "compiler" / "tiniscript"
FILES = sorted(PACKAGE.rglob("*.py"))


def nodes(path: Path) -> Iterator[ast.AST]:
    yield from ast.walk(ast.parse(path.read_text(encoding="utf-8")))


def homes(is_it: Callable[[ast.AST], bool]) -> set[str]:
    """Return the files in which a node is such a one."""
    return {
        path.relative_to(PACKAGE).as_posix()
        for path in FILES
        if any(is_it(node) for node in nodes(path))
    }


def is_text(node: ast.AST, pattern: str) -> bool:
    """Whether it is a literal text that matches as a whole."""
    return (
        isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and re.fullmatch(pattern, node.value) is not None
    )


def test_the_cache_folder_has_one_home() -> None:
    found = homes(lambda node: isinstance(node, ast.Name) and node.id == "user_cache_path")
    assert found == {"files.py"}
