"""A decision of a class's computer is on its disk before anyone hears of it."""

from __future__ import annotations

import json
import os
from itertools import count
from pathlib import Path
from random import Random

import pytest

from tests.support.journal_disk import before_each_write, full_disk
from tests.together.world import FIRST_PROGRAM
from tiniscript.together import journal as journals
from tiniscript.together.form import Change, Replace, Unwrap
from tiniscript.together.journal import OLD_ENDING, Journal
from tiniscript.together.layout import parse_tree, text_of
from tiniscript.together.ordering import SharedProgram
from tiniscript.together.tree import START


def begin_journal(path: Path) -> tuple[Journal, SharedProgram]:
    ids = count(1)
    journal = Journal(path)
    return journal, journal.begin(parse_tree(FIRST_PROGRAM, lambda: f"i.{next(ids)}"), "e1")


def change_program(program: SharedProgram, value: int, page: str = "a") -> bool:
    """Change the program, or be refused where the value is 0."""
    uid = f"{page}:{program.last_count_by_page.get(page, 0) + 1}"
    operation = Replace("i.8", (("text", f"W({value})"),)) if value else Unwrap("i.99")
    return program.submit([Change(uid, (operation,))])


def are_same(a: SharedProgram, b: SharedProgram) -> bool:
    return (a.number, a.last_count_by_page, a.refusals_by_page, a.tree.checksum()) == (
        b.number, b.last_count_by_page, b.refusals_by_page, b.tree.checksum()
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(20))
def test_a_program_is_restored_from_a_truncated_journal(tmp_path: Path, seed: int) -> None:
    """All announced changes are there; a row that a crash has cut off was never announced."""
    path, rng = tmp_path / "journal", Random(seed)
    journal, program = begin_journal(path)
    sizes = [path.stat().st_size]
    states = [(program.number, dict(program.last_count_by_page))]
    for k in range(12):
        change_program(program, rng.choice((0, 1000 + k)), rng.choice("ab"))
        sizes.append(path.stat().st_size)
        states.append((program.number, dict(program.last_count_by_page)))
    journal.close()
    journal_size = rng.randint(sizes[0], sizes[-1])
    os.truncate(path, journal_size)
    resumed_program = Journal(path).resume("e2")
    assert resumed_program is not None
    state_index = max(k for k, size in enumerate(sizes) if size <= journal_size)
    assert (resumed_program.number, resumed_program.last_count_by_page) == states[state_index]
    assert resumed_program.epoch == "e2"
    change_program(resumed_program, 2000)
    whole_program = Journal(path).resume("e3")
    assert whole_program is not None
    assert are_same(whole_program, resumed_program)


def test_the_row_is_written_before_the_answer(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    _, program = begin_journal(path)
    for value in (5, 0, 6):
        change_program(program, value)
        resumed_program = Journal(path).resume("e2")
        assert resumed_program is not None
        assert are_same(resumed_program, program)


@pytest.mark.parametrize("says_so", ["write", "in part", "fsync"])
def test_with_a_full_disk_the_lesson_continues_and_the_journal_catches_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, says_so: str
) -> None:
    """A system reports it at a write, by the number of written bytes, or at the sync."""
    path = tmp_path / "journal"
    journal, program = begin_journal(path)
    write = os.write

    def write_half(file: int, data: bytes) -> int:
        return write(file, data[: len(data) // 2])

    with monkeypatch.context() as disk:
        if says_so == "in part":
            disk.setattr(os, "write", write_half)
        else:
            disk.setattr(os, says_so, full_disk)
        assert change_program(program, 7)
        assert journal.is_incomplete
    assert change_program(program, 8)
    assert not journal.is_incomplete
    resumed_program = Journal(path).resume("e2")
    assert resumed_program is not None
    assert (resumed_program.number, text_of(resumed_program.tree)) == (2, text_of(program.tree))


@pytest.mark.parametrize("seed", range(10))
def test_a_crash_on_a_bad_disk_loses_no_readable_data(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    path, rng, is_full, kept_number = tmp_path / "journal", Random(seed), False, 0
    journal, program = begin_journal(path)
    monkeypatch.setattr(journals, "MAX_BYTES", 2000)

    def check_kept_changes() -> None:
        reopened = Journal(path)
        resumed_program = reopened.resume("e2")
        reopened.close()
        assert resumed_program is not None and resumed_program.number >= kept_number

    def before_write() -> None:
        check_kept_changes()
        if is_full:
            full_disk()

    before_each_write(monkeypatch, before_write)
    for value in range(1, 40):
        is_full = rng.random() < (0.8 if is_full else 0.2)
        assert change_program(program, value)
        kept_number = kept_number if journal.is_incomplete else program.number
        check_kept_changes()
        if rng.random() < 0.2:  # it crashes, and resumes with the stored data
            journal.close()
            journal = Journal(path)
            if rng.random() < 0.5 and path.with_name(path.name + OLD_ENDING).exists():
                path.write_bytes(rng.randbytes(rng.randrange(3000)))  # it is damaged
                kept_number = 0
            resumed_program = journal.resume(f"e{value}")
            assert resumed_program is not None
            program = resumed_program
            kept_number = max(kept_number, program.number)
    is_full = False
    assert change_program(program, 99) and not journal.is_incomplete
    final = Journal(path).resume("e3")
    assert final is not None and are_same(final, program)


@pytest.mark.parametrize("seed", range(5))
def test_a_program_goes_on_as_before_a_crash_whenever_its_journal_began_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """Each page hears the same of its changes, taken or refused."""
    rng, path = Random(seed), tmp_path / "journal"
    monkeypatch.setattr(journals, "MAX_BYTES", 3000)
    journal, program = begin_journal(path)
    for k in range(60):
        change_program(program, rng.choice((0, 1000 + k)), rng.choice("abc"))
        assert path.stat().st_size < 6000
        reopened = Journal(path)
        resumed_program = reopened.resume(f"e{k}")
        assert resumed_program is not None and are_same(resumed_program, program)
        if rng.random() < 0.1:  # it crashes
            journal.close()
            journal, program = reopened, resumed_program
        else:
            reopened.close()
    assert path.with_name(path.name + OLD_ENDING).exists()


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{}\n",
        b"[]\n",
        b"no\n",
        b"[" * 100_000 + b"\n",
        b'{"n":1,"epoch":"e","counts":{}}\n',
        b'{"n":1,"epoch":"e","counts":{},"refused":1}\n',
    ],
)
def test_an_invalid_journal_is_ignored(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "journal"
    path.write_bytes(data)
    assert Journal(path).resume("e2") is None


def test_a_forgotten_journal_is_deleted(tmp_path: Path) -> None:
    path = tmp_path / "folder" / "journal"
    journal, program = begin_journal(path)
    change_program(program, 3)
    journal.forget()
    assert not list(path.parent.iterdir())
    assert Journal(path).resume("e2") is None
    assert START in program.tree  # the holder continues with it


def test_recent_history_is_in_memory_and_the_rest_in_the_journal(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    _, program = begin_journal(path)
    program._most_kept = 20
    for value in range(1, 100):
        assert change_program(program, value)
        assert len(program.taken_changes) <= 20
    assert program.taken_changes[-1].number == 99
    rows = [json.loads(row) for row in path.read_text().splitlines()]
    assert [row["n"] for row in rows if "uid" in row] == list(range(1, 100))
    late_news = program.news("z", 3, "e1")  # a page absent for longer gets the whole program
    assert late_news["whole"] == program.tree.snapshot() and "changes" not in late_news
    assert len(program.news("z", 95, "e1")["changes"]) == 4
