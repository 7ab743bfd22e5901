"""`python -m tools.campaign` goes on where it was, tells what fails, adds up no other code."""

from __future__ import annotations

import runpy
import subprocess
import sys
from datetime import datetime, timedelta, timezone
from importlib.util import find_spec
from pathlib import Path
from shutil import which

import pytest

from tests.support.casefile import ROOT
from tools.campaign import __main__ as campaign
from tools.campaign import goals, results
from tools.campaign.goals import GOALS, Goal
from tools.campaign.results import Result

HERE = "tests.campaign.stand_in"  # a campaign that takes no time
DONE = Goal("done", "It ends.", "things", 25, 10, f"{HERE} {{count}} --seed {{seed}}", 5)
BAD = Goal("bad", "It does not.", "things", 10, 5, f"{HERE} {{count}} --seed {{seed}} --fails", 5)


@pytest.fixture(autouse=True)
def own_goals(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two goals, results in a folder of the test, and code that is committed."""
    written = tmp_path / "results.json"
    for module in (campaign, goals, results):
        monkeypatch.setattr(module, "GOALS", (DONE, BAD), raising=False)
    monkeypatch.setattr(campaign, "BY_NAME", {"done": DONE, "bad": BAD})
    monkeypatch.setattr(results, "WRITTEN", written)
    monkeypatch.setattr(results, "commit", lambda: "a" * 10)
    monkeypatch.setattr(campaign, "FIRST_SEED", 7)
    return written


def kept(name: str) -> Result:
    return results.read(results.kept())[name]


def test_it_goes_on_where_it_was(capsys: pytest.CaptureFixture[str]) -> None:
    assert campaign.main(["done", "--pieces", "1"]) == 0
    assert (kept("done").done, kept("done").seed, kept("done").next_seed) == (10, 7, 12)
    assert "10: less" in capsys.readouterr().out
    assert campaign.main(["done"]) == 0
    assert (kept("done").done, kept("done").seed, kept("done").next_seed) == (25, 7, 22)
    said = capsys.readouterr().out
    assert [line.split("; ")[1] for line in said.splitlines()[:2]] == [
        f"-m {HERE} 10 --seed 12",
        f"-m {HERE} 5 --seed 17",
    ]
    assert campaign.main(["done"]) == 0
    assert "--seed" not in capsys.readouterr().out, "nothing is left to do"


def test_a_failure_is_told_with_its_seed_and_run_again(capsys: pytest.CaptureFixture[str]) -> None:
    assert campaign.main(["bad"]) == 1
    assert "this one is wrong" in capsys.readouterr().out
    assert kept("bad").done == 0 and "seed 7" in kept("bad").wrong
    assert campaign.main(["bad"]) == 1
    assert "--seed 7" in capsys.readouterr().out


def test_what_other_code_has_reached_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    campaign.main(["done", "--pieces", "2"])
    monkeypatch.setattr(results, "commit", lambda: "b" * 10)
    campaign.main(["done", "--pieces", "1"])
    assert (kept("done").done, kept("done").commit) == (10, "b" * 10)


def test_a_campaign_that_is_interrupted_keeps_what_was_done(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = subprocess.run
    calls = []

    def interrupted(*words: object, **how: object) -> object:
        calls.append(words)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return run(*words, **how)  # type: ignore[call-overload]

    monkeypatch.setattr(subprocess, "run", interrupted)
    assert campaign.main(["done"]) == 2
    assert kept("done").done == 10
    assert "goes on from here" in capsys.readouterr().out


def test_it_says_for_how_long_a_goal_was_not_run(
    own_goals: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also of what another computer has run, which is in the document."""
    today = datetime.now(timezone.utc).date()
    old = Result(25, 1.0, 7, 22, (today - timedelta(days=9)).isoformat(), "a" * 10)
    results.write(own_goals, {"done": old, "bad": old._replace(date=today.isoformat())})
    campaign.main(["--list"])
    first, second = capsys.readouterr().out.splitlines()
    assert "25 in 1 s" in first and first.endswith("; run 9 days ago")
    assert second.endswith("; run today")
    results.write(own_goals, {})
    campaign.main(["--list"])
    assert "not run yet" in capsys.readouterr().out


def test_the_table_says_what_was_not_run_and_what_is_less(
    own_goals: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert [row[3] for row in results.rows()] == ["not run yet"] * 2
    campaign.main(["done", "--pieces", "2"])
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: subprocess.CompletedProcess([], 0))
    assert campaign.main(["--write"]) == 0
    row = results.rows()[0]
    assert row[2:] == ("25 things", "20: less", "7 to 12", kept("done").date, "a" * 10)


@pytest.mark.parametrize(("commit", "is_ancestor"), [("a" * 10 + "+", True), ("a" * 10, False)])
def test_figures_of_code_that_nobody_can_look_at_are_left_out(
    commit: str, is_ancestor: bool, own_goals: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """Changed since it was committed, or of a commit that did not lead here; old rows, too."""
    monkeypatch.setattr(results, "commit", lambda: commit)
    campaign.main(["done", "--pieces", "1"])
    results.write(own_goals, {"bad": kept("done")})
    code = 0 if is_ancestor else 1
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: subprocess.CompletedProcess([], code))
    campaign.main(["--write"])
    assert results.read(own_goals) == {}
    assert "no commit that led here: bad, done" in capsys.readouterr().err


def test_each_figure_is_of_a_commit_that_led_here() -> None:
    is_shallow = ("rev-parse", "--is-shallow-repository")
    if not which("git") or results.git(*is_shallow).stdout.strip() != "false":
        pytest.skip("the commits of this copy are not here: nobody can tell which led to it")
    figures = results.read(ROOT / "tools" / "campaign" / "results.json")
    assert figures
    lost = {name: each.commit for name, each in figures.items()
            if not results.is_in_history(each.commit)}  # fmt: skip
    assert lost == {}, "run these again: python -m tools.campaign NAME, and then --write"


@pytest.mark.parametrize("goal", GOALS, ids=lambda goal: goal.name)
def test_each_goal_has_a_command_that_takes_its_words(
    goal: Goal, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Only its options are read: `--help` ends it."""
    name, *words = goal.command.format(count=1, seed=1).split()
    monkeypatch.setattr(sys, "argv", [name, *words, "--help"])
    spec = find_spec(name)
    if spec is not None and spec.submodule_search_locations:
        spec = find_spec(f"{name}.__main__")
    assert spec is not None and spec.origin
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(spec.origin, run_name="__main__")
    assert not ended.value.code
    printed = capfd.readouterr().out
    assert all(word in printed for word in words if word.startswith("--"))
    assert 0 < goal.piece <= goal.shall
