"""The road runs one way: every room looks only into rooms upstream of it."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

HOUSE = Path(__file__).resolve().parent.parent / "compiler" / "tiniscript"

TABLES = {"source", "thousandths", "bytecode", "kit", "words", "problems"}
SUGGESTIONS = {"syntax.suggestions", "syntax.call_suggestions"}
READING = {  # what grammar and recovery share
    "syntax.lexer",
    "syntax.ast",
    "syntax.cursor",
    "syntax.reporter",
    "syntax.operators",
    "syntax.blocks",
}
ROOMS = {
    "source": set(),
    "thousandths": set(),
    "bytecode": set(),
    "kit": {"thousandths"},
    "words": {"thousandths"},
    "problems": {"source"},
    "printable": set(),
    "files": set(),
    "syntax.lexer": TABLES,
    "syntax.ast": {"source"},
    "syntax.call_suggestions": TABLES | {"syntax.lexer"},
    "syntax.suggestions": TABLES | {"syntax.lexer", "syntax.call_suggestions"},
    "syntax.cursor": {"source", "syntax.lexer"},
    "syntax.reporter": {"source", "problems", "syntax.lexer"},
    "syntax.operators": {"source", "syntax.lexer", "syntax.ast"},
    "syntax.blocks": TABLES | {"syntax.lexer", "syntax.ast", "syntax.reporter"},
    "syntax.expression_recovery": TABLES | READING | SUGGESTIONS,
    "syntax.expressions": TABLES | READING | {"syntax.expression_recovery"},
    "syntax.block_recovery": TABLES | READING | SUGGESTIONS,
    "syntax.foreign": TABLES | READING | SUGGESTIONS,
    "syntax.recovery": TABLES | READING | SUGGESTIONS | {"syntax.block_recovery", "syntax.foreign"},
    "syntax.parser": TABLES | READING | SUGGESTIONS | {"syntax.expressions", "syntax.recovery"},
    "syntax.formatter": TABLES | {"syntax.lexer"},
    "program": TABLES,
    "scope": TABLES | {"syntax.ast"},
    "kinds": TABLES | {"syntax.ast", "program", "scope"},
    "checker": TABLES | {"syntax.ast", "program", "kinds", "scope", "syntax.call_suggestions"},
    "optimizer": TABLES | {"program"},
    "advice": TABLES | {"program", "optimizer"},
    "duration": TABLES | {"program", "optimizer"},
    "lower_expression": TABLES | {"program", "optimizer"},
    "lower": TABLES | {"program", "optimizer", "lower_expression"},
    "verify": {"bytecode"},
    "image": {"bytecode"},
    "listing": {"bytecode", "kit"},
    "task": {"bytecode"},
    "vm_instructions": {"bytecode", "thousandths", "task"},
    "vm": {"bytecode", "thousandths", "task", "vm_instructions"},
    "run": TABLES | {"task", "vm"},
    "wasm_store": set(),
    "wasm_machine": TABLES | {"task", "image", "verify", "wasm_store"},
    "messages": TABLES,
    "maps": {"image", "files"},
    "other_kits": TABLES | {"syntax.lexer"},
}


FOLDERS = ("tiniscript.syntax",)  # stages whose files have rows of their own above


def room_of(path: Path) -> str:
    return ".".join(path.relative_to(HOUSE).with_suffix("").parts)


def rooms() -> list[Path]:
    folders = (HOUSE, *(HOUSE / name.rpartition(".")[2] for name in FOLDERS))
    files = (path for folder in folders for path in folder.glob("*.py"))
    return sorted(path for path in files if not path.stem.startswith("__"))


def looked_into(path: Path) -> set[str]:
    """Return the rooms that a file imports when it runs; imports for types alone don't count."""
    found = set()
    skipped: set[ast.AST] = set()
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            skipped |= set(ast.walk(node))
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node not in skipped:
            module = node.module or ""
            if module in ("tiniscript", *FOLDERS):
                prefix = module.removeprefix("tiniscript").lstrip(".")
                found |= {f"{prefix}.{alias.name}".lstrip(".") for alias in node.names}
            elif module.rpartition(".")[0] in FOLDERS:
                found.add(module.removeprefix("tiniscript."))
            elif module.startswith("tiniscript."):
                found.add(module.split(".")[1])
    return found


@pytest.mark.parametrize("path", rooms(), ids=room_of)
def test_room_looks_upstream_only(path: Path) -> None:
    allowed = ROOMS[room_of(path)]
    found = looked_into(path) - {room_of(path)}
    assert found <= allowed, f"{room_of(path)} looks into {sorted(found - allowed)}"


def test_every_room_has_its_place() -> None:
    assert {room_of(path) for path in rooms()} == set(ROOMS)


def test_only_the_command_prints() -> None:
    for path in HOUSE.rglob("*.py"):
        if path.parent.name != "cli":
            calls = [
                node
                for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
                if isinstance(node, ast.Call) and ast.unparse(node.func) == "print"
            ]
            assert not calls, f"{path.name} prints"


def test_rooms_have_one_screenful_of_job() -> None:
    """Four hundred lines is a full room; tables may be longer."""
    for path in HOUSE.rglob("*.py"):
        if path.name not in ("shipped.py",):
            lines = len(path.read_text(encoding="utf-8").splitlines())
            assert lines <= 460, f"{path.name} has {lines} lines: where is the wall?"


def imported_by(statement: str) -> set[str]:
    code = f"import sys; {statement}; print(' '.join(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=HOUSE.parent
    )
    return set(done.stdout.split())


def test_the_road_needs_the_standard_library_alone() -> None:
    """So that it runs in a browser, and starts fast."""
    modules = imported_by(
        "from tiniscript import compile_text, robots; "
        "assert compile_text('SI|F(5,80)', robots.load('tinibot').kit).image"
    )
    unwanted = {"construct", "tomllib", "tomli", "rich", "platformdirs", "serial", "dataclasses",
                "argparse", "json", "difflib", "tiniscript.messages", "tiniscript.vm",
                "tiniscript.syntax.recovery",
                "tiniscript.syntax.expression_recovery"}  # fmt: skip
    assert not unwanted & modules


def test_compile_imports_no_other_verb(tmp_path: Path) -> None:
    program = tmp_path / "drive.ts"
    program.write_text("SI|F(5,80)")
    modules = imported_by(
        f"from tiniscript.cli import main; assert main(['compile', {str(program)!r}]) == 0"
    )
    unwanted = {"cobs", "serial", "construct", "tomllib", "tomli", "rich", "dataclasses",
                "tiniscript.link", "tiniscript.cli.link_texts",
                "tiniscript.vm", "tiniscript.run", "tiniscript.listing",
                "tiniscript.syntax.formatter"}  # fmt: skip
    assert not unwanted & modules


def test_only_two_rooms_know_pyserial() -> None:
    for path in HOUSE.rglob("*.py"):
        if "import serial" in path.read_text(encoding="utf-8"):
            assert path.parent.name == "link" and path.stem in ("ports", "line"), path.name


def test_the_link_has_no_port_and_no_clock() -> None:
    """Bytes and times are arguments: so a second takes no time in a test.

    `ports` and `line` are what is around it: a real port and a real clock.
    """
    for path in sorted((HOUSE / "link").glob("*.py")):
        if path.stem in ("ports", "line"):
            continue
        names = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                names.add((node.module or "").split(".")[0])
        assert not names & {"serial", "socket", "time", "threading", "asyncio", "select"}, path.name
