"""`python -m tools.bench` prints the figures of the page, in its order, and no others.

The page is the form: a benchmark names the rows that it fills in, and no table prints another one.
"""

from __future__ import annotations

import subprocess
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from tools import uno
from tools.bench import __main__ as bench
from tools.bench import link, page

PAGE = """`python -m tools.bench.link` measures it, and `python -m tools.bench.ways`;
again `python -m tools.bench.link`, (`python -m
tools.bench.ways 20 --uno`), and `python -m tests.link.test_typed_stops 1000000`.
"""


@pytest.fixture
def commands_run(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The commands that would be run; `ways` fails."""
    rows: list[list[str]] = []

    def run(command: list[str], **_: Any) -> subprocess.CompletedProcess[str]:
        rows.append(command[2:])
        return subprocess.CompletedProcess(command, int("tools.bench.ways" in command))

    monkeypatch.setattr(subprocess, "run", run)
    return rows


def test_the_commands_named_on_the_page_are_run(
    commands_run: list[list[str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.setattr(bench, "PAGE", tmp_path / "figures.md")
    bench.PAGE.write_text(PAGE, encoding="utf-8")
    ways = [["tools.bench.ways"], ["tools.bench.ways", "20", "--uno"]]
    assert bench.main([]) == 1
    assert commands_run == [["tools.bench.link"], *ways]
    assert "not done: ways, ways 20 --uno" in capsys.readouterr().err
    commands_run.clear()
    assert bench.main(["link"]) == 0
    assert commands_run == [["tools.bench.link"]]
    with pytest.raises(SystemExit):
        bench.main(["sizes"])


def test_everything_named_on_the_page_exists() -> None:
    names = [name for name, *_ in bench.commands()]
    assert {"compiler", "machine", "link", "studio"} <= {*names}
    for name in names:
        assert find_spec(f"tools.bench.{name}"), name


NO_TABLE = ("code_size",)  # the figure is in a sentence, not a table
FILLED_TABLES = [
    name for name in dict.fromkeys(n for n, *_ in bench.commands()) if name not in NO_TABLE
]


@pytest.mark.parametrize("name", FILLED_TABLES)
def test_a_benchmark_fills_in_the_rows_of_its_tables(name: str) -> None:
    """The rows are in order; the text after a table was measured once."""
    module = import_module(f"tools.bench.{name}")
    table_rows = module.page_rows() if name == "firmware_size" else module.ROWS
    rows = [*(table_rows.values() if isinstance(table_rows, dict) else table_rows)]
    rows += module.OTHER_BOARDS.values() if name == "link" else ()
    tables = page.tables(name)
    shown_texts = [page.cells(row)[0] for table in tables for row in table.rows]
    assert shown_texts[: len(rows)] == rows
    assert len(shown_texts) == len(rows) or name == "machine"


def test_the_last_row_of_an_unos_history_is_its_current_size() -> None:
    """Both are on the page, and only one is printed by a benchmark."""
    ((_, flash, holds, *_),) = (
        page.cells(row)
        for table in page.tables("firmware_size")
        for row in table.rows
        if page.cells(row)[0] == "`tinibot`, Uno"
    )
    history = page.PAGE.read_text(encoding="utf-8").partition("\n| added | bytes | firmware |")[2]
    *_, last_row = history.partition("\n\n")[0].split("\n")
    _, _, firmware, bytes_left = page.cells(last_row)
    assert firmware == flash
    assert int(bytes_left) == int(holds.replace(",", "")) - int(flash.replace(",", ""))


def test_no_other_row_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    name = "text"
    row, other_row = (page.cells(row) for row in page.tables(name)[0].rows)
    page.show(name, [other_row, ["`SI|F(2,80)`", "1.00 ms", "2.00 ms"]])
    head, rule, first, second, _ = capsys.readouterr().out.split("\n", 4)
    assert (head, rule) == page.tables(name)[0][:2]
    assert (first, page.cells(second)) == (r"| `SI\|F(2,80)` | 1.00 ms | 2.00 ms |", other_row)
    with pytest.raises(LookupError, match="no row a robot"):
        page.show(name, [["a robot", "1 ms", "2 ms"]])
    with pytest.raises(ValueError, match="other columns"):
        page.show(name, [row[:2]])
    assert capsys.readouterr().out == ""


def test_the_firmware_is_measured_at_each_baud(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def measure(_: Path, baud: int) -> float:
        if baud == 9600 and breaks:
            raise RuntimeError("it did not move")
        return baud / 100

    breaks = False
    monkeypatch.setattr(link, "build", lambda baud, folder: folder / str(baud))
    monkeypatch.setattr(uno, "missing", lambda: "")
    for limit, code in ((2000.0, 0), (100.0, 1)):
        baud = link.on_each_baud(measure, lambda its, _: max(its.values()) <= limit)  # noqa: B023
        assert baud == code
    breaks = True
    assert link.on_each_baud(measure, lambda *_: True) == 2
    assert "it did not move" in capsys.readouterr().err
    monkeypatch.setattr(uno, "missing", lambda: "no simavr")
    assert link.on_each_baud(measure, lambda *_: True) == 2
