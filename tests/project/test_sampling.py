"""The sample of rows that a commit runs: fair, drawn again by its commit; `--whole` runs all."""

from __future__ import annotations

import inspect
from collections import Counter
from collections.abc import Callable
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
"""
Found = list[tuple[str, dict[str, object]]]


class Plugin:
    """What `tests/conftest.py` does, and the rows that are left."""

    def __init__(self) -> None:
        self.found: Found = []
        self.said = ""

    def pytest_addoption(self, parser: pytest.Parser) -> None:
        sampling.add_options(parser)

    def pytest_configure(self, config: pytest.Config) -> None:
        config.addinivalue_line("markers", "sampled: rows")

    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        sampling.leave_out(config, items)
        self.said = sampling.said(config)
        for item in items:
            assert isinstance(item, pytest.Function)
            params = item.callspec.params if hasattr(item, "callspec") else {}
            self.found.append((item.originalname, dict(params)))


@pytest.fixture
def collected(tmp_path: Path) -> Callable[..., tuple[Found, str]]:
    (tmp_path / "test_rows.py").write_text(ROWS, encoding="utf-8")
    (tmp_path / "pytest.ini").write_text("[pytest]", encoding="utf-8")

    def run(*words: str, of: str = "") -> tuple[Found, str]:
        plugin = Plugin()
        options = (
            "-q",
            "--collect-only",
            "--import-mode=importlib",
            "-p",
            "no:cacheprovider",
            "-p",
            "no:xdist",
        )
        code = pytest.main([*options, *words, f"{tmp_path / 'test_rows.py'}{of}"], [plugin])
        assert code == pytest.ExitCode.OK
        return plugin.found, plugin.said

    return run


def test_each_value_is_in_each_sample_and_each_row_in_one(
    collected: Callable[..., tuple[Found, str]],
) -> None:
    seen: Counter[tuple[object, object]] = Counter()
    together: Counter[tuple[str, object]] = Counter()
    for commit in range(15):
        found, said = collected("--sample", f"{commit}")
        assert f"--sample {commit} " in said
        cases = [row for name, row in found if name == "test_case"]
        assert [row["case"] for row in cases] == list(range(20))
        assert set(Counter(row["chip"] for row in cases).values()) == {6, 7}
        boards = [(name, row.get("board")) for name, row in found if "board" in name]
        assert len(boards) == 2
        together.update(boards)
        assert Counter(name for name, _ in found if "board" not in name) == {
            "test_case": 20,
            "test_pin": 2,
            "test_usual": 1,
        }
        seen.update((row["case"], row["chip"]) for row in cases)
    assert len(seen) > 55
    assert len(together) == 3 and min(together.values()) >= 5
    assert collected("--sample", "7") == collected("--sample", "7")
    asked, said = collected("--sample", "7", "-k", "not usual")  # which asks for none
    assert len([name for name, _ in asked if name == "test_case"]) == 20 and said


@pytest.mark.parametrize(
    ("words", "of"), [(["--whole"], ""), (["-k", "case"], ""), ([], "::test_case")]
)
def test_what_is_asked_for_has_all_its_rows(
    words: list[str], of: str, collected: Callable[..., tuple[Found, str]]
) -> None:
    found, said = collected(*words, of=of)
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
