"""Names in string literals of tests and tools exist, which no linter checks."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from tests.support.casefile import ROOT
from tests.support.rows import go_through

FOLDERS = ("tests", "tools")
QUOTED_IMPORT = re.compile(r"from (tiniscript(?:\.\w+)*) import ([\w ]+(?:,[\w ]+)*)")
ALIAS = re.compile(r"(\w+)(?: as (\w+))?")
DOTTED_NAME = re.compile(r"tiniscript(?:\.\w+)+")


def list_quoted_texts() -> Iterator[tuple[str, str]]:
    """Yield each string literal, and its place."""
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*.py")):
            if "node_modules" in path.parts or path == Path(__file__):
                continue
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Constant) and isinstance(node.value, str):
                    yield f"{path.relative_to(ROOT)}:{node.lineno}", node.value


def test_names_in_quoted_scripts_exist() -> None:
    rows = [row for row in list_quoted_texts() if QUOTED_IMPORT.search(row[1])]
    assert len(rows) > 20

    def check_imported_names_exist(row: tuple[str, str]) -> None:
        for module_name, imported_modules in QUOTED_IMPORT.findall(row[1]):
            module = import_module(module_name)
            for name, alias in ALIAS.findall(imported_modules):
                if not hasattr(module, name):
                    import_module(f"{module_name}.{name}")
                owner = getattr(module, name)
                if not isinstance(owner, type(module)):
                    continue
                for attribute in re.findall(rf"(?<![\w.]){alias or name}\.(\w+)", row[1]):
                    assert hasattr(owner, attribute), f"{name}.{attribute}"

    go_through(check_imported_names_exist, rows, lambda row: row[0])


def test_dotted_names_exist() -> None:
    """Names as in `monkeypatch.setattr`; others do not begin with a module of ours."""
    rows = [
        row for row in list_quoted_texts() if DOTTED_NAME.fullmatch(row[1])
        and find_spec(".".join(row[1].split(".")[:2])) is not None
    ]  # fmt: skip
    assert len(rows) > 20

    def check_resolves(row: tuple[str, str]) -> None:
        owner = import_module("tiniscript")
        for number, name in enumerate(row[1].split(".")[1:], 2):
            if not hasattr(owner, name):
                import_module(".".join(row[1].split(".")[:number]))
            owner = getattr(owner, name)

    go_through(check_resolves, rows, lambda row: row[0])
