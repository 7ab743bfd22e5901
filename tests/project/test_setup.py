"""The scripts that set TiniScript up and test it: on a machine that has nothing special."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.support.casefile import ROOT

pytestmark = pytest.mark.skipif(not shutil.which("sh"), reason="no sh: Windows has no such scripts")

SPECIAL = ("PYTHONDONTWRITEBYTECODE", "PYTHONUNBUFFERED", "PYTHONOPTIMIZE", "PYTEST_ADDOPTS")


def test_ci_runs_the_tests_as_users_do(tmp_path: Path) -> None:
    """Without what hides failing tests; with the pip configuration that the machine has."""
    for name, text in (("tools/test.sh", "env\n"), (".ci/run", (ROOT / ".ci/run").read_text())):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(text, encoding="utf-8")
    variables = {**os.environ, **dict.fromkeys(SPECIAL, "1"), "PIP_INDEX_URL": "file:///none"}
    done = subprocess.run(
        ["sh", ".ci/run"], cwd=tmp_path, env=variables, capture_output=True, text=True, check=True
    )
    seen = dict(row.partition("=")[::2] for row in done.stdout.splitlines())
    assert not set(SPECIAL) & set(seen)
    assert (seen["CI"], seen["PIP_INDEX_URL"]) == ("true", "file:///none")


def test_readme_says_what_stays_in_the_folder_for_temporary_files() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    kept = set()
    for path in [*ROOT.glob("tests/**/*.py"), *ROOT.glob("tools/**/*.py")]:
        text = path.read_text(encoding="utf-8")
        kept |= set(re.findall(r'gettempdir\(\)\) / f"([\w-]+-)\{', text))
    assert kept == {"tiniscript-host-", "tiniscript-uno-"}
    for name in kept:
        assert f"`{name}…`" in readme


# -- the virtual environment


INSTALLING = "Installing TiniScript"
FAKE_PYTHON = (
    '#!/bin/sh\ncase "$*" in *" install "*) echo "$*" >>"$(dirname "$0")/../asked";; esac\n'
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder as a clone, whose Python installs nothing and writes down what it should."""
    clone = tmp_path / "clone"
    (clone / "tools").mkdir(parents=True)
    (clone / ".venv" / "bin").mkdir(parents=True)
    shutil.copy(ROOT / "tools" / "venv.sh", clone / "tools")
    (clone / "tools" / "some.sh").write_text('. "$(dirname "$0")/venv.sh"\nmake_venv "[test]"\n')
    (clone / "pyproject.toml").write_text("one")
    python = clone / ".venv" / "bin" / "python"
    python.write_text(FAKE_PYTHON)
    python.chmod(0o755)
    return clone


def installed(clone: Path) -> bool:
    """Return whether the script has installed anything."""
    done = subprocess.run(
        ["sh", str(clone / "tools" / "some.sh")], capture_output=True, text=True, check=True
    )
    return INSTALLING in done.stderr


def test_what_is_installed_is_not_installed_again(folder: Path) -> None:
    assert installed(folder)
    assert not installed(folder)
    assert (folder / ".venv" / "asked").read_text().endswith(f"--editable {folder}[test]\n")


def test_another_pyproject_is_installed_whatever_its_time(folder: Path) -> None:
    """In the same second, or from an older state of the repository."""
    assert installed(folder)
    (folder / "pyproject.toml").write_text("two")
    os.utime(folder / "pyproject.toml", (1, 1))
    assert installed(folder)
    assert not installed(folder)


def test_a_folder_that_has_moved_is_installed_again(folder: Path) -> None:
    assert installed(folder)
    moved = folder.rename(folder.with_name("moved"))
    assert installed(moved)
