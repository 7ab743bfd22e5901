"""Prints how large the repository is and how its package hangs together.

    python -m tools.measures

A module is a folder of the package, or a single file in it; an arrow says that one imports another,
at the top of a file, inside a function or for types; a circle is a group of files each of which
imports all others, if only through others. An import that is indented is one inside a function, or
one for types. Languages other than English and Spanish are not counted.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "compiler" / "tiniscript"
Graph = dict[str, set[str]]  # the imports of each file, or of each module
Import = ast.Import | ast.ImportFrom


def main() -> int:
    tracked_paths = _tracked_files()
    package_paths = [
        path for path in tracked_paths if PACKAGE in path.parents and path.suffix == ".py"
    ]
    tests = [path for path in tracked_paths if ROOT / "tests" in path.parents]
    trees = {_import_name(path): ast.parse(path.read_bytes()) for path in package_paths}
    graph = _import_graph(trees)
    indented_count = sum(
        is_indented for tree in trees.values() for _, is_indented in _imports(tree)
    )
    for label, count in (
        ("tracked lines", _line_count(tracked_paths)),
        ("tracked files", len(tracked_paths)),
        ("Python of the package, lines", _line_count(package_paths)),
        ("tests, lines", _line_count(tests)),
        ("modules of the package", len({_module_name(name) for name in graph} - {""})),
        ("imports between them", sum(map(len, module_imports(graph).values()))),
        ("cycles of files", len(import_cycles(graph))),
        ("imports that are indented", indented_count),
        ("words of documents, by hand", _word_count(tracked_paths)),
    ):
        print(f"{label:38}{count:9,}")
    return 0


def module_imports(graph: Graph) -> Graph:
    """Return the modules that each module imports."""
    imports_of_module: Graph = {}
    for name, targets in graph.items():
        module_targets = imports_of_module.setdefault(_module_name(name), set())
        module_targets |= {_module_name(target) for target in targets} - {_module_name(name)}
    return imports_of_module


def direct_imports(graph: Graph) -> Graph:
    """Return the imports without those that a path of others replaces; there is no cycle."""
    return {
        name: {target for target in targets
               if not any(target in _reachable(graph, other_target) for other_target in targets)}
        for name, targets in graph.items()
    }  # fmt: skip


def imports_of(paths: Iterable[Path]) -> Graph:
    """Return the imports of some files of the package."""
    return _import_graph({_import_name(path): ast.parse(path.read_bytes()) for path in paths})


def _import_graph(trees: dict[str, ast.Module]) -> Graph:
    return {
        name: {
            target
            for import_node, _ in _imports(tree)
            for target in _targets(import_node, name, trees)
        }
        for name, tree in trees.items()
    }


def _tracked_files() -> list[Path]:
    """Return the files that git knows and that are here, in English, Spanish or no language."""
    process = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True)
    paths = (ROOT / name for name in process.stdout.decode().split("\0") if name)
    languages = PACKAGE / "languages"
    other_languages = {path.name for path in languages.iterdir() if path.is_dir()} - {"en", "es"}
    return [
        path for path in paths
        if path.is_file()
        and not other_languages & {suffix[1:] for suffix in path.suffixes}
        and not any(languages / other in path.parents for other in other_languages)
    ]  # fmt: skip


def _word_count(tracked_paths: list[Path]) -> int:
    """Count the words of documents without the spec, the changelog, lessons, cases and generated
    text.
    """
    not_counted = (
        ROOT / "bytecode_spec.md",
        ROOT / "CHANGELOG.md",
        ROOT / "compiler" / "tiniscript" / "lessons",
        ROOT / "tests" / "cases",
    )
    count = 0
    for path in tracked_paths:
        if path.suffix == ".md" and not {path, *path.parents} & set(not_counted):
            text = path.read_text(encoding="utf-8")
            text = "" if text.startswith("<!-- Generated") else text
            generated_pattern = r"<!-- begin generated.*?<!-- end generated"
            count += len(re.sub(generated_pattern, "", text, flags=re.DOTALL).split())
    return count


def _line_count(paths: list[Path]) -> int:
    return sum(path.read_bytes().count(b"\n") for path in paths)


def _import_name(path: Path) -> str:
    """Return the name of a file as Python imports it, without the package's: `link.frames`."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _module_name(name: str) -> str:
    return name.partition(".")[0].removeprefix("__main__")


def _imports(tree: ast.AST, is_indented: bool = False) -> Iterator[tuple[Import, bool]]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, Import):
            yield node, is_indented
        else:
            yield from _imports(node, True)


def _targets(import_node: Import, name: str, files: dict[str, ast.Module]) -> Iterator[str]:
    """Yield the files of the package, other than `name`, that an import names."""
    if isinstance(import_node, ast.Import):
        base_and_member = [(alias.name, "") for alias in import_node.names]
    else:
        assert not import_node.level, f"{name}: a relative import"
        base_and_member = [(import_node.module or "", alias.name) for alias in import_node.names]
    for base, member in base_and_member:
        top, _, inner = base.partition(".")
        if top == PACKAGE.name:
            full_name = f"{inner}.{member}".strip(".")
            target = full_name if full_name in files else inner
            if target != name:
                yield target


def import_cycles(graph: Graph) -> set[frozenset[str]]:
    """Return the groups of files that import each other."""
    reachable_files = {name: _reachable(graph, name) for name in graph}
    groups = (frozenset(other for other in imports if name in reachable_files[other])
              for name, imports in reachable_files.items())  # fmt: skip
    return {group for group in groups if len(group) > 1}


def _reachable(graph: Graph, start: str) -> set[str]:
    reached_names: set[str] = set()
    names_left = [start]
    while names_left:
        new_names = graph[names_left.pop()] - reached_names
        reached_names |= new_names
        names_left += new_names
    return reached_names


if __name__ == "__main__":
    sys.exit(main())
