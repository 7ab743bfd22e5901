"""`python -m tools.campaign` resumes, reports failures, and does not add up results of other
code.
"""

from __future__ import annotations

import runpy
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from typing import Any

import pytest

from tests.support.casefile import ROOT
from tools.campaign import __main__ as campaign
from tools.campaign import goals, results
from tools.campaign.goals import GOALS, Goal
from tools.campaign.results import Result

STAND_IN_MODULE = "tests.campaign.stand_in"  # a campaign without any duration
REAL_IS_OLD = results.is_old
COMMAND, PATHS = f"{STAND_IN_MODULE} {{count}} --seed {{seed}}", ("tried",)
PASSING_GOAL = Goal("done", "It ends.", "things", 25, 10, COMMAND, PATHS, 5)
FAILING_GOAL = Goal("bad", "It does not.", "things", 10, 5, f"{COMMAND} --fails", PATHS, 5)


@pytest.fixture(autouse=True)
def own_goals(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two goals, results in a folder of the test, and code that is committed."""
    (tmp_path / "results.json").write_text("{}")
    for module in (campaign, goals, results):
        monkeypatch.setattr(module, "GOALS", (PASSING_GOAL, FAILING_GOAL), raising=False)
    monkeypatch.setattr(campaign, "BY_NAME", {"done": PASSING_GOAL, "bad": FAILING_GOAL})
    monkeypatch.setattr(results, "RESULTS_FILE", tmp_path / "results.json")
    monkeypatch.setattr(results, "current_commit", lambda: "a" * 10)
    monkeypatch.setattr(results, "is_old", lambda goal, result: False)
    monkeypatch.setattr(campaign, "FIRST_SEED", 7)
    run = subprocess.run

    def run_unless_generating(words: list[str], **how: object) -> object:
        return None if "tools.generate" in words else run(words, **how)  # type: ignore[call-overload]

    monkeypatch.setattr(subprocess, "run", run_unless_generating)


def result_of(name: str) -> Result:
    return results.read_results()[name]


def test_a_campaign_resumes_where_it_stopped(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    interrupt_after(monkeypatch, 1)
    assert campaign.main(["done"]) == 2
    assert (result_of("done").done, result_of("done").seed, result_of("done").next_seed) == (
        10,
        7,
        12,
    )
    output = capsys.readouterr().out
    assert "goes on from here" in output and "10: less" in output
    assert campaign.main(["done"]) == 0
    assert (result_of("done").done, result_of("done").seed, result_of("done").next_seed) == (
        25,
        7,
        22,
    )
    output = capsys.readouterr().out
    assert [line.split("; ")[1] for line in output.splitlines()[:2]] == [
        f"-m {STAND_IN_MODULE} 10 --seed 12",
        f"-m {STAND_IN_MODULE} 5 --seed 17",
    ]
    assert campaign.main(["done"]) == 0
    assert "--seed" not in capsys.readouterr().out, "nothing is left to do"
    row = results.rows()[0]
    assert row[2:] == ("25 things", "25", "7 to 17", result_of("done").date, "a" * 10)
    assert results.rows()[1][3] == "not run yet"


def interrupt_after(monkeypatch: pytest.MonkeyPatch, pieces: int) -> None:
    """Raise Ctrl-C once, after so many pieces."""
    piece, pieces_left = campaign.run_piece, [pieces]

    def interrupt_piece(*arguments: Any) -> Result:
        pieces_left[0] -= 1
        if pieces_left[0] == -1:
            raise KeyboardInterrupt
        return piece(*arguments)

    monkeypatch.setattr(campaign, "run_piece", interrupt_piece)


def test_a_failure_is_reported_with_its_seed_and_rerun(capsys: pytest.CaptureFixture[str]) -> None:
    assert campaign.main(["bad"]) == 1
    assert "this one is wrong" in capsys.readouterr().out
    assert result_of("bad").done == 0 and "seed 7" in result_of("bad").wrong
    assert campaign.main(["bad"]) == 1
    assert "--seed 7" in capsys.readouterr().out


def test_results_of_other_code_do_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupt_after(monkeypatch, 2)
    campaign.main(["done"])
    monkeypatch.setattr(results, "current_commit", lambda: "b" * 10)
    interrupt_after(monkeypatch, 1)
    campaign.main(["done"])
    assert (result_of("done").done, result_of("done").commit) == (10, "b" * 10)


def test_results_of_uncommitted_code_are_not_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(results, "current_commit", lambda: "a" * 10 + "+")
    campaign.main(["bad"])
    assert results.read_results() == {}


def test_a_figure_is_stale_once_the_tested_code_has_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def commit_file(name: str, text: str) -> str:
        (tmp_path / name).write_text(text)
        for words in (("add", "."), ("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-mx")):
            assert results.git(*words).returncode == 0
        return results.git("rev-parse", "--short=10", "HEAD").stdout.strip()

    monkeypatch.setattr(results, "is_old", REAL_IS_OLD)
    monkeypatch.setattr(results, "ROOT", tmp_path)
    monkeypatch.setattr(results, "DOCUMENT", tmp_path / "page")
    results.git("init")
    first = commit_file("tried", "1")
    second = commit_file("other", "2")

    def figure_in(commit: str) -> str:
        return results.figure_text(PASSING_GOAL, Result(25, 1, 7, 22, "", commit))

    assert figure_in(first) == figure_in(second) == "25"
    assert figure_in("b" * 10) == figure_in(f"{second}+") == "25, old"
    (tmp_path / "tried").write_text("3")
    assert figure_in(first) == figure_in(second) == "25, old"
    results.write_results({"done": Result(25, 1, 7, 22, "", first)})
    assert results.outdated_goals() == ["done"]
    third = commit_file("tried", "3")
    assert (figure_in(second), figure_in(third)) == ("25, old", "25")
    monkeypatch.setattr(results, "ROOT", tmp_path / "none")  # without a repository, as on the page
    (tmp_path / "none").mkdir()
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path))
    (tmp_path / "page").write_text("| `done` | It ends. | 25 things | 25, old | 7 |\n")
    assert figure_in(third) == "25, old"
    (tmp_path / "page").write_text("| `done` | It ends. | 25 things | 25 | 7 |\n")
    assert figure_in(first) == "25"


@pytest.mark.parametrize("goal", GOALS, ids=lambda goal: goal.name)
def test_each_goal_names_the_code_that_it_tests(goal: Goal) -> None:
    assert goal.paths
    assert [path for path in goal.paths if not (ROOT / path).exists()] == []


def test_each_figure_is_of_an_ancestor_commit(monkeypatch: pytest.MonkeyPatch) -> None:
    is_shallow = ("rev-parse", "--is-shallow-repository")
    if not which("git") or results.git(*is_shallow).stdout.strip() != "false":
        pytest.skip("the commits of this copy are not here: nobody can tell which led to it")
    monkeypatch.setattr(results, "RESULTS_FILE", ROOT / "tools" / "campaign" / "results.json")
    figures = results.read_results()
    assert figures
    is_there = ("merge-base", "--is-ancestor")
    lost = {name: result.commit for name, result in figures.items()
            if results.git(*is_there, result.commit, "HEAD").returncode}  # fmt: skip
    assert lost == {}, "run these again: python -m tools.campaign NAME"


@pytest.mark.parametrize("goal", GOALS, ids=lambda goal: goal.name)
def test_each_goal_has_a_command_that_accepts_its_arguments(
    goal: Goal, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Only its options are read: `--help` ends it."""
    name, *words = goal.command.format(count=1, seed=1).split()
    monkeypatch.setattr(sys, "argv", [name, *words, "--help"])
    spec = find_spec(name)
    if spec is not None and spec.submodule_search_locations:
        spec = find_spec(f"{name}.__main__")
    assert spec is not None and spec.origin
    with pytest.raises(SystemExit) as exception_info:
        runpy.run_path(spec.origin, run_name="__main__")
    assert not exception_info.value.code
    printed_text = capfd.readouterr().out
    assert all(word in printed_text for word in words if word.startswith("--"))
    assert 0 < goal.piece_size <= goal.target
