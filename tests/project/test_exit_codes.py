"""If a step of `test.sh`, `try.sh`, a release or the generator fails, so does the whole.

Each step fails once; the others are stubs.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tests.support.first_command import load_first_command, set_terminals
from tools import CannotMake, environment
from tools.generate import __main__ as generate
from tools.release import __main__ as release
from tools.release import facts
from tools.release.parts import PARTS, Clone

needs_sh = pytest.mark.skipif(not shutil.which("sh"), reason="no sh: Windows has no such scripts")

# Writes down its steps; those in a file fail. With `-c`, it reports that a test has failed.
STEPS = """#!/bin/sh
printf '%s\\n' "$*" >>"$HERE/steps"
case "$1" in
-c) echo tests/x.py::test_y ;;
esac
[ "$(grep -Fxc -- "$*" "$HERE/fails")" = 0 ] || exit "${CODE:-3}"
"""
# Previews of the tests' results, or of the next step's output.
LOOKS = ("-m pytest --collect-only", "-m tools.builds.studio --check", "-m pip --version")


def folder_of(tmp_path: Path, *scripts: str) -> Path:
    """Return a folder with scripts of ours, and a Python in `.venv` that writes down its steps."""
    clone = tmp_path / "clone"
    (clone / "tools").mkdir(parents=True)
    (clone / ".venv" / "bin").mkdir(parents=True)
    for name in scripts:
        shutil.copy(ROOT / "tools" / name, clone / "tools")
    with (clone / "tools" / "venv.sh").open("a") as helps:
        helps.write("test_packages() { :; }\n")
    for name in ("environment.py", "try.py"):
        (clone / "tools" / name).touch()
    python = clone / ".venv" / "bin" / "python"
    python.write_text(STEPS)
    python.chmod(0o755)
    return clone


def run_script(clone: Path, words: list[str], fails: str, ci: str) -> tuple[int, list[str]]:
    """Run a script whose step `fails` does; return its exit code and all steps."""
    (clone / "steps").write_text("")
    (clone / "fails").write_text(f"{fails}\n")
    variables = {**os.environ, "HERE": str(clone), "CI": ci, "LC_ALL": "C"}
    completed = subprocess.run(["sh", *words], cwd=clone, env=variables, capture_output=True)
    return completed.returncode, (clone / "steps").read_text().splitlines()


@needs_sh
@pytest.mark.parametrize(
    ("words", "min_step_count"),
    [(["tools/test.sh"], 10), (["tools/test.sh", "--quick"], 6), (["tools/try.sh"], 2)],
    ids=["test.sh", "test.sh --quick", "try.sh"],
)
def test_a_script_fails_if_one_of_its_steps_fails(
    words: list[str], min_step_count: int, tmp_path: Path
) -> None:
    clone = folder_of(tmp_path, "venv.sh", "test.sh", "try.sh")
    code, steps = run_script(clone, words, "", "true")
    assert code == 0 and len(steps) >= min_step_count, steps
    for step in dict.fromkeys(steps):
        if not step.startswith(LOOKS):
            code, _ = run_script(clone, words, step, "true")
            assert code != 0, f"{step} fails, and nobody notices"


@needs_sh
@pytest.mark.parametrize(("first_word", "more"), [("", ""), ("--all", "--whole "), ("--quick", "")])
def test_further_options_go_to_pytest(first_word: str, more: str, tmp_path: Path) -> None:
    """No file of the script is left in the folder for temporary ones."""
    clone = folder_of(tmp_path, "venv.sh", "test.sh")
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    (clone / "steps").write_text("")
    (clone / "fails").write_text("")
    completed = subprocess.run(
        ["sh", "tools/test.sh", *first_word.split(), "-k", "a b"],
        cwd=clone,
        env={**os.environ, "HERE": str(clone), "CI": "true", "TMPDIR": str(temporary)},
        capture_output=True,
    )
    steps = (clone / "steps").read_text().splitlines()
    [step] = [step for step in steps if step.startswith("-m pytest -n ")]
    assert completed.returncode == 0
    assert step.endswith(f" {more}-k a b") and "--all" not in step and "--quick" not in step
    assert [*temporary.iterdir()] == []


@needs_sh
def test_outside_ci_an_unbuildable_page_is_not_a_failure(tmp_path: Path) -> None:
    """Its tests are skipped, and say so."""
    clone = folder_of(tmp_path, "venv.sh", "test.sh")
    (clone / "steps").write_text("")
    (clone / "fails").write_text("-m tools.builds.studio --check\n-m tools.builds.studio\n")
    for ci, code in (("", 0), ("true", 1)):
        variables = {**os.environ, "HERE": str(clone), "CI": ci}
        completed = subprocess.run(
            ["sh", "tools/test.sh"], cwd=clone, env=variables, capture_output=True
        )
        assert bool(completed.returncode) == bool(code), completed.stderr


@needs_sh
def test_the_tests_report_their_processor_time(tmp_path: Path) -> None:
    """In CI they also report when it exceeds the limit."""
    clone = folder_of(tmp_path, "venv.sh", "test.sh")
    for name in ("steps", "fails"):
        (clone / name).write_text("")
    usual = os.environ["PATH"]
    fake_awk = tmp_path / "much" / "awk"  # a fake awk with a larger count
    fake_awk.parent.mkdir()
    fake_awk.write_text("#!/bin/sh\necho 24.0\n")
    fake_awk.chmod(0o755)
    with_much = f"{fake_awk.parent}{os.pathsep}{usual}"
    for path, ci, minutes in (
        (usual, "true", "0.0"),
        (with_much, "", "24.0"),
        (with_much, "true", "24.0"),
    ):
        variables = {**os.environ, "HERE": str(clone), "CI": ci, "LC_ALL": "C", "PATH": path}
        completed = subprocess.run(
            ["sh", "tools/test.sh"], cwd=clone, env=variables, capture_output=True, text=True
        )
        assert f"The tests took {minutes} minutes of processor time." in completed.stderr
        assert ("more than the 20 minutes" in completed.stderr) == (ci + minutes == "true24.0")


@needs_sh
@pytest.mark.parametrize("fails_alone", [False, True])
def test_a_test_that_fails_beside_others_is_rerun_alone(
    fails_alone: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clone = folder_of(tmp_path, "venv.sh", "test.sh")
    _, steps = run_script(clone, ["tools/test.sh"], "", "true")
    parallel_step = next(step for step in steps if step.startswith("-m pytest -n 4"))
    single_step = "-m pytest --last-failed --last-failed-no-failures none"
    monkeypatch.setenv("CODE", "1")  # exit code of pytest after failures
    fails = f"{parallel_step}\n{single_step}" if fails_alone else parallel_step
    code, steps = run_script(clone, ["tools/test.sh"], fails, "true")
    assert single_step in steps and bool(code) == fails_alone


@pytest.mark.parametrize("fails", ["upload", "studio"])
def test_the_first_command_fails_like_its_child(
    fails: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(words: list[str], **options: object) -> subprocess.CompletedProcess[str]:
        return subprocess.CompletedProcess(words, 5 * (fails in words), "0\n", "")

    monkeypatch.setattr(subprocess, "run", run)
    monkeypatch.setattr(environment, "make", lambda extras: Path(sys.executable))
    monkeypatch.setattr("builtins.input", lambda question: "y")
    set_terminals(monkeypatch, "stdin", "stdout")
    assert load_first_command().main() == 5


def test_the_generator_fails_if_any_file_is_stale(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(generate, "ROOT", tmp_path)
    files = [tmp_path / f"{number}.md" for number in range(4)]
    outputs = [(file, partial(str, number)) for number, file in enumerate(files)]
    monkeypatch.setattr(generate, "OUTPUTS", outputs)
    assert generate.main(["--check"]) == 1 and not any(map(Path.exists, files))
    for file in files:
        assert generate.main([]) == 0 and generate.main(["--check"]) == 0
        file.write_text("old")
        assert generate.main(["--check"]) == 1 and file.read_text() == "old"
        file.unlink()
        assert generate.main(["--check"]) == 1


# -- a release ------------------------------------------------------------------------------------


class Stage:
    """A release in which the step named by `fails` fails, as `failure` says."""

    def __init__(
        self,
        tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch,
        fails: str,
        failure: type[BaseException] = CannotMake,
    ) -> None:
        self.fails, self.failure, self.steps = fails, failure, list[str]()
        self.folder = tmp_path / "made"
        monkeypatch.setattr(release, "_clones", self.clones)
        monkeypatch.setattr(
            facts,
            "release_problems",
            lambda root: self.complaints_of("not committed" if root == ROOT else "a fact"),
        )
        monkeypatch.setattr(
            release, "find_missing_tool", lambda parts: "".join(self.complaints_of("a tool"))
        )
        monkeypatch.setattr(release, "tag", lambda root, version: self.step("tag"))
        monkeypatch.setattr(
            Clone,
            "python",
            lambda clone, *words, **options: self.step(f"twine {Path(words[-1]).name}"),
        )
        for name in PARTS:
            monkeypatch.setitem(PARTS, name, PARTS[name]._replace(make=partial(self.make, name)))

    def step(self, name: str) -> str:
        self.steps.append(name)
        if name == self.fails:
            raise self.failure(f"{name} fails")
        return ""

    def complaints_of(self, name: str) -> list[str]:
        self.steps.append(name)
        return [name] * (name == self.fails)

    def clones(self, scratch: Path, *_: object) -> list[Clone]:
        self.step("git")
        made_clones = []
        for number in (1, 2):
            (scratch / str(number)).mkdir()
            made_clones.append(Clone(scratch, scratch / str(number), "1", "", 0, number, False))
        return made_clones

    def make(self, name: str, clone: Clone) -> list[Path]:
        self.step(f"{name} {clone.seed}")
        file = clone.parts / f"{name}.whl"
        differs = self.complaints_of(f"{name} is the same")
        file.write_text(str(clone.seed) if differs else name)
        return [file]

    def code(self) -> int:
        return release.main([str(self.folder), "--tag"])


def test_a_release_fails_if_one_of_its_steps_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """However it fails: it cannot be done, the disk is full, or somebody ends it. What was released
    stays as it is."""
    whole = Stage(tmp_path / "whole", monkeypatch, "")
    assert whole.code() == 0 and (whole.folder / release.SUMS_FILE).exists()
    steps = dict.fromkeys(whole.steps)
    assert len(steps) > 3 * len(PARTS)
    assert {"not committed", "twine wheel.whl", "twine sdist.whl", "tag"} <= {*steps}
    sums = (whole.folder / release.SUMS_FILE).read_bytes()
    assert whole.code() == 2 and (whole.folder / release.SUMS_FILE).read_bytes() == sums
    some_steps = ["git", "wheel 2", "twine wheel.whl", "tag"]
    for failure, failing_steps in (
        (CannotMake, [*steps]),
        (OSError, some_steps),
        (KeyboardInterrupt, some_steps),
    ):
        for step in failing_steps:
            stage = Stage(tmp_path / failure.__name__ / step, monkeypatch, step, failure)
            assert stage.code() != 0, f"{step} fails, and nobody notices"
            is_last = step.endswith("is the same") or step == "tag"
            assert (stage.folder / release.SUMS_FILE).exists() == is_last, step
    capsys.readouterr()
