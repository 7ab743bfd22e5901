"""`python -m tools.windows` as far as it goes without wine."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tools.windows import __main__ as command
from tools.windows import computer, tries


@pytest.fixture
def windows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> computer.Computer:
    """A computer whose programs are not run, on which tsc is installed."""
    found = computer.Computer(tmp_path)
    scripts = found.drive / "users" / "ada" / "TiniScript" / "tsc" / "Scripts"
    scripts.mkdir(parents=True)
    (found.drive / "users" / "Public").mkdir()
    (scripts / "tsc.exe").touch()
    monkeypatch.setattr(computer, "make", lambda folder: found)
    monkeypatch.setattr(command, "_wheel", lambda folder: tmp_path / "x.whl")
    monkeypatch.setattr(computer.Computer, "end", lambda self: None)
    return found


def works(place: tries.Place) -> str:
    assert place.desk.is_dir() and place.desk.parent.parent == place.computer.home
    return "it works"


def breaks(place: tries.Place) -> str:
    raise tries.Failed("another image")


def hangs(place: tries.Place) -> str:
    raise subprocess.TimeoutExpired("wine", 120)


ALL: dict[str, Callable[[tries.Place], str]] = {
    "install": works, "breaks": breaks, "hangs": hangs, "programs": works,
}  # fmt: skip


@pytest.mark.parametrize(
    ("chosen", "code", "said"),
    [
        ([], 1, ["install: it", "breaks: FAILED: another image", "hangs: FAILED", "programs: it"]),
        (["programs"], 0, ["programs: it works"]),
        (["hangs", "install"], 1, ["install: it works", "hangs: FAILED"]),
    ],
)
def test_each_try_has_a_line_and_one_that_fails_stops_none(
    chosen: list[str], code: int, said: list[str], windows: computer.Computer,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.setattr(tries, "TRIES", ALL)
    assert command.main(chosen) == code
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(said)
    assert all(line.startswith(begin) for line, begin in zip(lines, said, strict=True))


def test_without_tsc_nothing_else_is_tried(
    windows: computer.Computer, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (windows.home / "TiniScript" / "tsc" / "Scripts" / "tsc.exe").unlink()
    monkeypatch.setattr(tries, "TRIES", {**ALL, "install": breaks})
    for chosen in (["programs"], []):
        assert command.main(chosen) == 1
        [line] = capsys.readouterr().out.splitlines()
        assert line.startswith("install: FAILED: another image")


def test_a_computer_without_wine_says_what_to_install(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tools.windows", "--folder", str(tmp_path / "w")], cwd=ROOT,
        env={**os.environ, "PATH": str(tmp_path)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 2
    assert "apt-get install wine" in done.stderr and "Traceback" not in done.stderr
    assert not (tmp_path / "w").exists()


def test_windows_sees_nothing_of_this_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its folders, paths and language would be those of the tests."""
    for name in ("PYTHONPATH", "VIRTUAL_ENV", "XDG_CACHE_HOME", "LC_MESSAGES", "PIP_FIND_LINKS"):
        monkeypatch.setenv(name, "/here")
    variables = computer.Computer(tmp_path).variables({"LC_ALL": "es"})
    assert "/here" not in variables.values()
    assert variables["WINEPREFIX"] == str(tmp_path / "prefix") and variables["LC_ALL"] == "es"
