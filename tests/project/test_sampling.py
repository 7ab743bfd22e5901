"""The sample of rows that a commit runs: fair, drawn again by its commit; `--whole` runs all."""

from __future__ import annotations

import inspect
from collections import Counter
from collections.abc import Callable, Sequence
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
Found = list[tuple[str, dict[str, object]]]


class Plugin:
    """What `tests/conftest.py` does, and the rows that are left for each of these commits."""

    def __init__(self, commits: Sequence[str]) -> None:
        self.commits = commits
        self.found: list[tuple[Found, str]] = []

    def pytest_addoption(self, parser: pytest.Parser) -> None:
        sampling.add_options(parser)

    def pytest_configure(self, config: pytest.Config) -> None:
        config.addinivalue_line("markers", "sampled: rows")

    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        for config.option.sample in self.commits:
            left = list(items)
            sampling.leave_out(config, left)
            self.found.append(([_row(item) for item in left], sampling.said(config)))


def _row(item: pytest.Item) -> tuple[str, dict[str, object]]:
    assert isinstance(item, pytest.Function)
    return item.originalname, dict(item.callspec.params) if hasattr(item, "callspec") else {}


@pytest.fixture
def collected(tmp_path: Path) -> Callable[..., list[tuple[Found, str]]]:
    (tmp_path / "test_rows.py").write_text(ROWS, encoding="utf-8")
    (tmp_path / "pytest.ini").write_text("[pytest]", encoding="utf-8")

    def run(*words: str, of: str = "", commits: Sequence[str] = ("7",)) -> list[tuple[Found, str]]:
        plugin = Plugin(commits)
        options = ("-q", "--collect-only", "--import-mode=importlib", "-p", "no:cacheprovider",
                   "-p", "no:xdist")  # fmt: skip
        code = pytest.main([*options, *words, f"{tmp_path / 'test_rows.py'}{of}"], [plugin])
        assert code == pytest.ExitCode.OK
        return plugin.found

    return run


def test_each_value_is_in_each_sample_and_each_row_in_one(
    collected: Callable[..., list[tuple[Found, str]]],
) -> None:
    seen: Counter[tuple[object, object]] = Counter()
    together: Counter[tuple[str, object]] = Counter()
    commits = [*map(str, range(15)), "7"]
    drawn = dict(enumerate(collected(commits=commits)))
    for commit, (found, said) in drawn.items():
        assert f"--sample {commits[commit]} " in said
        cases = [row for name, row in found if name == "test_case"]
        assert [row["case"] for row in cases] == list(range(20))
        assert set(Counter(row["chip"] for row in cases).values()) == {6, 7}
        boards = [(name, row.get("board")) for name, row in found if "board" in name]
        assert len(boards) == 2
        together.update(boards)
        kits = [row["kit"] for name, row in found if "kit" in name]
        assert len(kits) == 6 and len(set(kits)) == 1
        together.update(("kit", kit) for kit in kits[:1])
        assert Counter(
            name for name, _ in found if name in ("test_case", "test_pin", "test_usual")
        ) == {
            "test_case": 20,
            "test_pin": 2,
            "test_usual": 1,
        }
        seen.update((row["case"], row["chip"]) for row in cases if commit < 15)
    assert len(seen) > 55
    assert len(together) == 3 + 4 and min(together.values()) >= 2
    assert drawn[7] == drawn[15]
    ((asked, said),) = collected("-k", "not usual")  # which asks for none
    assert len([name for name, _ in asked if name == "test_case"]) == 20 and said


@pytest.mark.parametrize(
    ("words", "of"), [(["--whole"], ""), (["-k", "case"], ""), ([], "::test_case")]
)
def test_what_is_asked_for_has_all_its_rows(
    words: list[str], of: str, collected: Callable[..., list[tuple[Found, str]]]
) -> None:
    ((found, said),) = collected(*words, of=of)
    assert len([name for name, _ in found if name == "test_case"]) == 60 and said == ""


def test_all_rows_of_one_test_run_and_each_that_fails_is_named() -> None:
    seen = []

    @each_row("name, number", [("a", 1), ("b", 2), pytest.param("c", 3, id="third"), ("d", 4)])
    def test(number: int, name: str, lang: str) -> None:
        seen.append(name + lang)
        assert number != 2, "two"
        if name == "c":
            raise KeyError(name)

    assert list(inspect.signature(test).parameters) == ["lang"]
    with pytest.raises(AssertionError) as why:
        test(lang="en")
    assert seen == ["aen", "ben", "cen", "den"]
    first, second = str(why.value).split("\n\n")
    assert first.startswith("('b', 2): AssertionError: two")
    assert second == "third: KeyError: 'c'"
    with pytest.raises(AssertionError, match="no rows"):
        each_row("name", [])
