"""`python -m tools.bench` prints the figures of the page, in its order, and no others."""

from __future__ import annotations

import subprocess
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from tools.bench import __main__ as bench

PAGE = """From `python -m tools.bench.link`, and `python -m tools.bench.ways`;
again `python -m tools.bench.link`, (`python -m
tools.bench.ways 20 --uno`), and `python -m tests.link.test_typed_stops 1000000`.
"""


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """What it runs, instead of running it: `ways` fails."""
    found: list[list[str]] = []

    def run(command: list[str], **_: Any) -> subprocess.CompletedProcess[str]:
        found.append(command[2:])
        return subprocess.CompletedProcess(command, int("tools.bench.ways" in command))

    monkeypatch.setattr(subprocess, "run", run)
    return found


def test_it_runs_what_the_page_names(
    ran: list[list[str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.setattr(bench, "PAGE", tmp_path / "figures.md")
    bench.PAGE.write_text(PAGE, encoding="utf-8")
    ways = [["tools.bench.ways"], ["tools.bench.ways", "20", "--uno"]]
    assert bench.main([]) == 1
    assert ran == [["tools.bench.link"], *ways]
    assert "not done: ways, ways 20 --uno" in capsys.readouterr().err
    ran.clear()
    assert bench.main(["link"]) == 0
    assert ran == [["tools.bench.link"]]
    with pytest.raises(SystemExit):
        bench.main(["sizes"])


def test_all_that_the_page_names_is_there() -> None:
    names = [name for name, *_ in bench.commands()]
    assert {"compiler", "machine", "link", "studio"} <= {*names}
    for name in names:
        assert find_spec(f"tools.bench.{name}"), name
