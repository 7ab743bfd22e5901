"""The sample of rows that a commit runs: fair, drawn again by its commit; `--whole` runs all."""

from __future__ import annotations

import inspect
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.support import sampling
from tests.support.rows import each_row

ROWS = """
import pytest
@pytest.mark.sampled("chip")
@pytest.mark.parametrize("chip", ["avr", "lx6", "lx106"])
@pytest.mark.parametrize("case", range(20))
def test_case(case, chip): ...
@pytest.mark.sampled("pin", keep=2)
@pytest.mark.parametrize("pin", range(9))
def test_pin(pin): ...
def test_usual(): ...
@pytest.mark.long
@pytest.mark.parametrize("minutes", range(20))
def test_long(minutes): ...
@pytest.mark.sampled(of="boards", keep=2)
@pytest.mark.parametrize("board", ["uno", "mega"])
def test_board(board): ...
@pytest.mark.sampled(of="boards", keep=2)
def test_other_board(): ...
@pytest.mark.sampled("kit", draw="kits")
@pytest.mark.parametrize("kit", range(4))
@pytest.mark.parametrize("tone", range(5))
def test_kit(kit, tone): ...
@pytest.mark.sampled("kit", draw="kits")
@pytest.mark.parametrize("kit", range(4))
def test_same_kit(kit): ...
"""

FILE = """
import pytest
pytestmark = pytest.mark.sampled(files="sides", keep=2)
@pytest.mark.sampled("way")
@pytest.mark.parametrize("way", ["keys", "mouse"])
def test_{0}(way): ...
def test_more_of_{0}(): ...
"""
SIDES = ("left", "right", "front", "back")


def test_an_unreadable_history_draws_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a container, the checkout may have another owner."""
    monkeypatch.setattr(sampling, "ROOT", tmp_path)
    assert sampling._commit.__wrapped__() == "none"
    (tmp_path / ".git").mkdir()
    with pytest.raises(pytest.UsageError, match="history"):
        sampling._commit.__wrapped__()


class Plugin:
    """A plugin like `tests/conftest.py` that records the remaining rows for each of these
    commits.
    """

    def __init__(self, commits: Sequence[str]) -> None:
        self.commits = commits
        self.drawn: list[tuple[list[str], str]] = []

    def pytest_addoption(self, parser: pytest.Parser) -> None:
        sampling.add_options(parser)

    def pytest_configure(self, config: pytest.Config) -> None:
        config.addinivalue_line("markers", "sampled: rows")
        config.addinivalue_line("markers", "long: tests")

    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        for config.option.sample in self.commits:
            items_left = list(items)
            sampling.leave_out(config, items_left)
            letters = sampling.sample_of(config, "letters", "abcd", 2)
            names = [item.name for item in items_left]
            self.drawn.append(([*names, *letters], sampling.how_to_repeat(config)))


def collect_tests(
    folder: Path, *words: str, of: str | None = "", commits: Sequence[str] = ("7",)
) -> list[tuple[list[str], str]]:
    (folder / "test_rows.py").write_text(ROWS, encoding="utf-8")
    for side in SIDES:
        (folder / f"test_{side}.py").write_text(FILE.format(side), encoding="utf-8")
    (folder / "pytest.ini").write_text("[pytest]", encoding="utf-8")
    selection = folder if of is None else f"{folder / 'test_rows.py'}{of}"
    plugin = Plugin(commits)
    options = ("-q", "--collect-only", "--import-mode=importlib", "-p", "no:cacheprovider",
               "-p", "no:xdist", *words, f"{selection}")  # fmt: skip
    assert pytest.main([*options], [plugin]) == pytest.ExitCode.OK
    return plugin.drawn


def test_each_value_is_in_each_sample_and_each_row_in_one(tmp_path: Path) -> None:
    commits = [*map(str, range(15)), "7"]
    collections = collect_tests(tmp_path, commits=commits)
    counts = Counter[str]()
    for commit, (names, output) in zip(commits, collections, strict=True):
        assert f"--sample {commit} " in output
        count = Counter(name.partition("[")[0] for name in names)
        assert (count["test_case"], count["test_pin"], count["test_usual"]) == (20, 2, 1)
        assert count["test_board"] + count["test_other_board"] == 2
        cases = [name[len("test_case[") : -1].split("-") for name in names if "_case" in name]
        assert [int(case) for case, _ in cases] == list(range(20))
        assert set(Counter(chip for _, chip in cases).values()) == {6, 7}
        kits = {name.split("[")[1][0] for name in names if "same_kit" in name}
        kits |= {name[:-1].split("-")[1] for name in names if "test_kit" in name}
        assert count["test_kit"] == 5 and len(kits) == 1
        assert sum(count[letter] for letter in "abcd") == 2
        counts.update(names)
    assert sum("_case" in name for name in counts) > 55
    assert sum("board" in name for name in counts) == 3
    assert sum("same_kit" in name for name in counts) == 4
    assert set("abcd") <= set(counts)
    assert collections[7] == collections[15]
    # `-k` with a name that no test has.
    ((questions, output),) = collect_tests(tmp_path, "-k", "not usual")
    assert sum("_case" in name for name in questions) == 20 and output


@pytest.mark.parametrize(
    ("words", "of"), [(["--whole"], ""), (["-k", "case"], ""), ([], "::test_case")]
)
def test_requested_tests_have_all_their_rows(words: list[str], of: str, tmp_path: Path) -> None:
    ((names, output),) = collect_tests(tmp_path, *words, of=of)
    assert sum("_case" in name for name in names) == 60 and output == ""
    assert names[-4:] == [*"abcd"]


def test_some_files_run_whole_and_each_does_eventually(tmp_path: Path) -> None:
    commits = [*map(str, range(20)), "7"]
    counts = Counter[str]()
    collections = collect_tests(tmp_path, of=None, commits=commits)
    for collected_names, _ in collections:
        names = [name for name in collected_names if any(side in name for side in SIDES)]
        whole = [name.removeprefix("test_more_of_") for name in names if "more_of" in name]
        assert len(whole) == 2 and len(names) == 4
        assert {name.partition("[")[0] for name in names if "more" not in name} == {
            f"test_{side}" for side in whole
        }
        counts.update(names)
    assert len(counts) == 3 * len(SIDES)
    assert collections[7] == collections[20]
    left_path = f"{tmp_path / 'test_left.py'}"
    for collected_names, _ in collect_tests(tmp_path, left_path, of=None, commits=commits):
        assert "test_more_of_left" in collected_names  # named on the command line
    ((collected_names, _),) = collect_tests(tmp_path, "--whole", of=None)
    assert sum(side in name for name in collected_names for side in SIDES) == 3 * len(SIDES)


def test_a_tenth_of_the_long_tests_is_drawn_and_each_is_eventually(tmp_path: Path) -> None:
    def long_tests(
        *words: str, of: str | None = None, commits: Sequence[str] = ("7",)
    ) -> list[list[str]]:
        collections = collect_tests(tmp_path, *words, of=of, commits=commits)
        return [
            [name for name in names if name.startswith("test_long")] for names, _ in collections
        ]

    assert long_tests() == [[]]
    assert [len(names) for names in (*long_tests("--whole"), *long_tests(of=""))] == [20, 20]
    names_by_commit = long_tests("--tenth", commits=[*map(str, range(60))])
    assert {len(names) for names in names_by_commit} == {2}
    assert len({name for names in names_by_commit for name in names}) == 20
    assert long_tests("--tenth") == [names_by_commit[7]]


def test_all_rows_of_one_test_run_and_each_that_fails_is_named() -> None:
    lines = []

    @each_row("name, number", [("a", 1), ("b", 2), pytest.param("c", 3, id="third"), ("d", 4)])
    def test(number: int, name: str, lang: str) -> None:
        lines.append(name + lang)
        assert number != 2, "two"
        if name == "c":
            raise KeyError(name)

    assert list(inspect.signature(test).parameters) == ["lang"]
    with pytest.raises(AssertionError) as error_info:
        test(lang="en")
    assert lines == ["aen", "ben", "cen", "den"]
    first, second = str(error_info.value).split("\n\n")
    assert first.startswith("('b', 2): AssertionError: two")
    assert second == "third: KeyError: 'c'"
    with pytest.raises(AssertionError, match="no rows"):
        each_row("name", [])
