"""The workflows for a forge: they cannot run here, so the tests check their text."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.support.casefile import ROOT
from tests.support.command import run_subprocess
from tools.release.__main__ import main as release
from tools.site.documents import FRONT_PAGE, sources

FOLDER = ROOT / ".github" / "workflows"
FILES = sorted(FOLDER.glob("*.yml"))
JOB = {"runs-on", "container", "timeout-minutes", "steps", "strategy", "env"}
STEP = {"name", "uses", "with", "run", "if", "env"}
# Programs that a runner has; the others are ours, or pip's.
THEIRS = {"apt-get", "git", "env", "sh", "py", "python", "python3", ".venv/bin/python", "tsc"}


def load_workflow(path: Path) -> dict[str, Any]:
    workflow: dict[str, Any] = yaml.load(path.read_text(encoding="utf-8"), Loader=yaml.BaseLoader)
    return workflow


def steps() -> Iterator[tuple[str, dict[str, Any]]]:
    for path in FILES:
        for job in load_workflow(path)["jobs"].values():
            for step in job["steps"]:
                yield path.name, step


def commands() -> list[list[str]]:
    """Return every command of every step, as words of a shell."""
    lines = []
    for _, step in steps():
        for line in step.get("run", "").replace("\\", "/").splitlines():
            lines += [shlex.split(part) for part in line.split("&&")]
    return lines


def test_a_workflow_is_well_formed_and_trusts_nobody() -> None:
    zizmor = Path(sys.executable).with_name("zizmor")
    if not zizmor.exists():
        pytest.skip("zizmor is not built for this processor")
    options = ("--offline", "--no-progress", "--strict-collection")
    completed = subprocess.run([zizmor, *options, FOLDER], capture_output=True, text=True)
    assert completed.returncode == 0, completed.stdout + completed.stderr


def test_a_job_has_a_form_that_forges_read_and_ends() -> None:
    for path in FILES:
        for job in load_workflow(path)["jobs"].values():
            assert set(job) <= JOB
            assert 0 < int(job["timeout-minutes"]) <= 120
            for step in job["steps"]:
                assert set(step) <= STEP
                assert ("uses" in step) != ("run" in step)


def test_each_commit_of_main_is_checked_to_its_end() -> None:
    for path in FILES:
        cancels = load_workflow(path)["concurrency"]["cancel-in-progress"]
        assert cancels == "${{ github.ref != 'refs/heads/main' }}"


def test_a_container_may_read_its_history() -> None:
    """Its checkout has another owner: without that it would draw one sample forever."""
    for path in FILES:
        for job in load_workflow(path)["jobs"].values():
            runs = " ".join(step.get("run", "") for step in job["steps"])
            assert "container" not in job or "--add safe.directory" in runs, path.name


def test_the_visitors_commands_are_those_of_the_readme() -> None:
    runs = [step.get("run", "") for name, step in steps() if name == "checks.yml"]
    texts = [
        (ROOT / name).read_text(encoding="utf-8") for name in sources(ROOT, FRONT_PAGE).values()
    ]
    for line in (r"py tools\try.py", "python3 tools/try.py", "sh tools/try.sh"):
        assert all(f"| `{line}` |" in text for text in texts)
        assert line in runs
    assert all("`sh tools/test.sh`" in text for text in texts)
    assert "env -u CI sh tools/test.sh" in runs
    assert all('pip install ".[virtual]"' in text for text in texts)
    assert 'python -m pip install ".[virtual]"' in runs


def test_commands_run_by_a_workflow_exist() -> None:
    pyproject_text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    count = 0
    for words in commands():
        assert words[0] in THEIRS, words
        for word in words:
            if word.startswith("tools/"):
                assert (ROOT / word).is_file(), word
                count += 1
        if "-m" in words:
            name = words[words.index("-m") + 1]
            assert find_spec(name) is not None, name
            count += 1
        for extras in re.findall(r"\[([a-z,]+)\]", " ".join(words)):
            for extra in extras.split(","):
                assert f"\n{extra} = [" in pyproject_text, extra
    assert count >= 6


def test_tsc_lines_of_workflows_work() -> None:
    tsc_commands = [words for words in commands() if words[0] == "tsc"]
    assert len(tsc_commands) == 2
    for words in tsc_commands:
        result = run_subprocess(*words[1:])
        assert result.code == 0, result.err
    assert "drove" in result.out + result.err


def test_the_rehearsal_knows_its_options(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        release(["--help"])
    known_text = capsys.readouterr().out
    (words,) = [words for words in commands() if "tools.release" in words]
    options = [word for word in words if word.startswith("--")]
    options += re.findall(r"'(--[a-z-]+)'", (FOLDER / "release.yml").read_text(encoding="utf-8"))
    assert len(options) == 2
    for option in options:
        assert option in known_text
