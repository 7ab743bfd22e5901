"""Imports point one way: a stage knows its input, its output and the shared tables."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.imported_modules import modules_imported_by
from tiniscript.base.languages import catalogue, languages
from tools import measures

PACKAGE = Path(__file__).resolve().parent.parent.parent / "compiler" / "tiniscript"

FILES = sorted(PACKAGE.rglob("*.py"))


def test_a_stage_imports_only_lower_stages() -> None:
    """`[tool.importlinter]` in pyproject.toml defines the order."""
    command = Path(sys.executable).with_name("lint-imports")
    completed = subprocess.run(
        [command, "--no-cache"], capture_output=True, text=True, cwd=PACKAGE.parent.parent
    )
    assert completed.returncode == 0, completed.stdout + completed.stderr


def test_there_are_no_import_cycles() -> None:
    """This includes imports at the top, inside functions, and for types alone."""
    assert not measures.import_cycles(measures.imports_of(FILES))


def test_the_compiler_needs_only_the_standard_library() -> None:
    """Therefore it runs in a browser, and starts fast."""
    modules = modules_imported_by(
        "from tiniscript import compile_text, robots; "
        "assert compile_text('SI|F(5,80)', robots.load('tinibot').kit).image"
    )
    unwanted_modules = {"tomllib", "tomli", "rich", "platformdirs", "serial", "dataclasses",
                "argparse", "json", "difflib",
                "tiniscript.diagnostics.rendering", "tiniscript.vm.machine",
                "tiniscript.recovery", "tiniscript.diagnostics.fixing"}  # fmt: skip
    assert not unwanted_modules & modules


def test_importing_the_package_imports_nothing_else() -> None:
    """The library imports its parts on demand."""
    modules = {
        name for name in modules_imported_by("import tiniscript") if name.startswith("tiniscript")
    }
    assert modules == {"tiniscript"}


# Features of a correct program: names of all kinds, every block, a comment, and a warning.
RIGHT = """SB|SPEED = 40; // fast
DEF TURN; R(0.5, SPEED + 10); END_DEF
LOOP(3);
  IF(DISTANCE < 10 AND NOT (SPEED > 3 OR BUTTON)); B(1, 50); TURN;
  ELSEIF(ABS(SPEED - 3) > 50 % 7); DISTANCE; SHOW(DISTANCE); ELSE; F(1, 80); ENDIF
END_LOOP
WHILE(TRUE); W(1) UNTIL(DISTANCE < SPEED); BREAK; END_WHILE
LED(TRUE); GRIPPER(90); BEEP(1, 440); M(-5, 5); S
"""
# Modules that only wrong programs need.
OF_WRONG = re.compile(
    r"tiniscript\.(base\.spelling|diagnostics\.(fixing|placing)|recovery"
    r"|semantics\.(wrong_|unknown_|joining)"
    r"|syntax\.(\w*recovery|\w*suggestions|phrases|outline|vocabulary|units|pasted|checksums))"
)


@pytest.mark.parametrize("verb", ["compile", "check"])
def test_a_right_program_loads_no_modules_for_wrong_ones_or_other_verbs(
    verb: str, tmp_path: Path
) -> None:
    program = tmp_path / "right.ts"
    program.write_text(RIGHT)
    for language in languages():  # make the requirements of a command, as in a package
        for name in ("command", "messages"):
            catalogue(name, language)
    modules = modules_imported_by(
        "from tiniscript.cli import main; "
        f"assert main([{verb!r}, '--robot', 'grabber', {str(program)!r}]) == 0"
    )
    own_modules = {module for module in modules if module.startswith("tiniscript")}
    assert not {word for word in own_modules if OF_WRONG.match(word)}
    assert len(own_modules) <= 68
    unwanted_modules = {"cobs", "serial", "tomllib", "tomli", "rich", "dataclasses",
                "tiniscript.link", "tiniscript.base.translations",
                "tiniscript.vm.machine", "tiniscript.vm.runner", "tiniscript.bytecode.disassembly",
                "tiniscript.syntax.formatter"}  # fmt: skip
    if sys.platform == "linux":  # modules that only locate the cache
        unwanted_modules |= {"platformdirs", "tempfile", "shutil", "random"}
    assert not unwanted_modules & modules


def test_programs_import_no_link() -> None:
    uses = "compile('SI|F(5,80)'), check('SI|F(5,'), run('SI|F(5,80)'), show('SI|F(5,80)')"
    modules = modules_imported_by(f"from tiniscript import check, compile, run, show; {uses}")
    unwanted_modules = {"serial", "cobs", "wasmtime", "tiniscript.link", "tiniscript.virtual",
                "tiniscript.cli"}  # fmt: skip
    assert not unwanted_modules & modules


def test_every_command_can_be_imported_without_the_extras() -> None:
    """A real robot needs no part of a virtual one, and a user without a radio has a cable."""
    verbs = [path.stem for path in (PACKAGE / "cli" / "commands").glob("*.py")]
    modules_imported_by(
        "sys.modules.update(dict.fromkeys(('bleak', 'paho', 'PIL', 'wasmtime', 'zeroconf'))); "
        "from importlib import import_module; "
        f"[import_module('tiniscript.cli.commands.' + each) for each in {verbs}]"
    )


@pytest.mark.parametrize(("arguments", "is_frozen"), [("", True), ("sys.argv[1:]", False)])
def test_the_end_of_a_process_collects_no_garbage(arguments: str, is_frozen: bool) -> None:
    """A program that calls `main` keeps its collector as it was."""
    code = (
        "import gc, sys; from tiniscript.cli import main; sys.argv = ['tsc', '--version']; "
        f"before = gc.get_threshold(); main({arguments}); "
        "print(gc.get_freeze_count() > 0, gc.get_threshold() != before)"
    )
    completed = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=PACKAGE.parent
    )
    assert completed.stdout.splitlines()[-1] == f"{is_frozen} {is_frozen}"


def test_the_link_has_no_port_and_no_clock() -> None:
    """Bytes and times are arguments: so a second takes no time in a test.

    Around it are real ports in `transports/`, the connection with its clock, and the file of keys.
    """
    for path in sorted((PACKAGE / "link").glob("*.py")):
        if path.stem in ("port_connection", "keys"):
            continue
        names = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                names.add((node.module or "").split(".")[0])
        assert not names & {"serial", "socket", "time", "threading", "asyncio", "select"}, path.name


def test_a_virtual_robot_without_a_terminal_loads_no_drawing() -> None:
    """It moves as soon as its thread has begun, and an import would delay it."""
    modules = modules_imported_by(
        "from tiniscript.cli import main; "
        "assert main(['upload', '-e', 'SI|S', '--virtual', '--hurry', 'max']) == 0"
    )
    assert not {"rich", "rich.console"} & modules


def test_waits_use_no_threading_primitive_written_in_python() -> None:
    """Waits use a Bell: an interrupted Condition keeps its lock, or releases it twice."""
    python_primitives = {"Barrier", "BoundedSemaphore", "Condition", "Event", "Semaphore", "Timer"}
    for stage in ("base", "cli", "doctor", "library", "link", "virtual"):
        for path in (PACKAGE / stage).rglob("*.py"):
            imported_modules = {
                alias.name
                for node in ast.walk(ast.parse(path.read_text("utf-8")))
                if isinstance(node, ast.ImportFrom) and node.module == "threading"
                for alias in node.names
            }
            assert not imported_modules & python_primitives, path
