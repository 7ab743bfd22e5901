"""Mistakes of pupils: each program of the corpus gets its messages, and correct repairs.

python -m pytest tests/pupils --accept    writes what is said now; read the difference like code
python -m pytest tests/pupils --whole     takes all programs, and not the few of `cover.txt`
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.pupils import cover
from tests.pupils.corpus import (
    OTHER_NUMBERS,
    Entry,
    check,
    current_entry,
    entries,
    mistake_count,
    write,
)
from tests.pupils.cover import LIST, add, choose_cover, forks, head, why_stale
from tests.support.rows import go_through
from tiniscript.base.source import Edit, Source, apply_edits
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import edits_of, edits_offered, repair_program

# A digit for a sign on its key, or turned round; a power; a point between thousands; a sound; a
# number that counts lines.
SHIFTED_TEXT = re.compile(
    r"[=!\"$%/]|\d\d, \d{3}$|^F8\d$|\^2|\*\* ?2|\.000$|^4WARD|^W8|^\d+[.)] [A-Za-z]"
)
CONVERTED_UNIT = re.compile(r"(?i)[0-9] *(min|ms|mili|hora|hour)|delay|ton[eo]")


def numbers(text: str) -> list[str]:
    without_notes = re.sub(r"\b[A-G][45]\b", "", text)  # the 4 of C4 is not a number
    return sorted(re.findall("[0-9]+", without_notes))


def loses_a_number(text: str, edits: list[Edit]) -> bool:
    """Return whether an edit drops one of the program's numbers."""
    numbers_left = numbers(apply_edits(text, edits))
    for number in numbers(text):
        if number not in numbers_left:
            return True
        numbers_left.remove(number)
    return False


def test_the_corpus_has_enough_programs(programs: tuple[Entry, ...]) -> None:
    assert len(entries()) >= 2000 and len(programs) >= 200
    assert len({entry.program for entry in entries()}) == len(entries())


def test_the_programs_of_a_commit_are_chosen_of_this_corpus_and_code() -> None:
    first, *rows = LIST.read_text(encoding="utf-8").splitlines()
    now = head(len(rows), 0, [entry.program for entry in entries()])
    assert not why_stale(first, now), f"{why_stale(first, now)}: python -m tests.pupils.cover"


def test_programs_are_rechosen_when_the_corpus_has_changed() -> None:
    head_before = head(1, 1, ["S", "F"])
    assert why_stale(head_before, head(2, 2, ["F", "S"])) == ""
    assert why_stale(head_before, head(1, 1, ["S", "B"])) == "programs have come or gone"
    count = forks(["if a and b:\n    [c for c in d if c]\n"])
    assert count == 3
    small_head, large_head = (
        head_before.replace(" forks", f"{extra} forks") for extra in ("", "0")
    )
    assert (
        why_stale(head_before, small_head) == ""
        and why_stale(head_before, large_head) == "the code has other branches"
    )


def test_a_new_program_is_tested_until_the_next_choice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written_path = tmp_path / "cover.txt"
    monkeypatch.setattr(cover, "LIST", written_path)
    written_path.write_text(head(0, 5, ["S", "F"]) + "\n")
    new_text = "B\nS"
    add([new_text], ["S", "F", new_text])
    row = f"{cover.name_of(new_text)} B"
    assert written_path.read_text().splitlines() == [head(1, 5, ["S", "F", new_text]), row]
    add(["L"], ["S", "L"])
    assert not why_stale(written_path.read_text(), head(1, 5, ["S", "F", new_text])), (
        "others have gone, too"
    )


def test_the_chosen_programs_reach_the_same_code_as_all() -> None:
    steps = ([1], [1, 2], [2], [3, 1], [1, 3])
    sets = [frozenset(("", k, k) for k in step) for step in steps]
    assert choose_cover(sets) == [1, 3]
    assert choose_cover(sets, covered_before=[4]) == [1, 4], "what was taken before stays"


def test_the_corpus_is_unchanged(
    request: pytest.FixtureRequest, programs: tuple[Entry, ...]
) -> None:
    entries = [current_entry(program) for program in programs]
    if request.config.getoption("--accept"):
        write(entries)
        pairs = zip(programs, entries, strict=True)
        new_programs = [
            now.program for old_entry, now in pairs if now.messages and not old_entry.messages
        ]
        add(new_programs, [entry.program for entry in programs])
        return
    changed_entries = [
        (old_program, new_programs)
        for old_program, new_programs in zip(programs, entries, strict=True)
        if old_program != new_programs
    ]
    assert not changed_entries, (
        f"{len(changed_entries)} of {len(entries)}, the first: {changed_entries[0]}"
    )


def test_each_repair_helps_and_keeps_the_numbers(programs: tuple[Entry, ...]) -> None:
    go_through(check_repairs_keep_numbers, programs)


def check_repairs_keep_numbers(entry: Entry) -> None:
    diagnostics, source = check(entry.program), Source(entry.program)
    for diagnostic in diagnostics:
        edits, repair = edits_of(diagnostic), diagnostic.repair
        if not edits or not diagnostic.is_mistake:
            continue
        diagnostics_after = check(apply_edits(entry.program, edits))
        if mistake_count(diagnostics_after) > mistake_count(diagnostics):
            # A repair that reveals several other mistakes has no button.
            assert not edits_offered(
                entry.program, diagnostics, diagnostics.index(diagnostic), check
            )
        assert mistake_count(diagnostics_after) <= mistake_count(diagnostics) or not (
            repair and repair.is_sure
        )
        if mistake_count(diagnostics_after) == mistake_count(
            diagnostics
        ):  # the repair revealed another mistake
            assert diagnostic not in diagnostics_after
        fix = diagnostic.values.get("fix", "")
        is_counted = re.match(r"LOOP\(|W\(|\w+ = \d+;LOOP\(", fix) is not None
        is_counted &= diagnostic.code is codes.OTHER_LANGUAGE
        shifted_spans = [diagnostic.span, *(edit.span for edit in edits)]
        is_counted = is_counted or any(SHIFTED_TEXT.search(source[span]) for span in shifted_spans)
        is_counted = is_counted or CONVERTED_UNIT.search(entry.program) is not None
        is_always = fix in ("TRUE", "WHILE(TRUE)")  # `WHILE(1)`
        is_always |= fix == "TASK"  # `TAREA 1`
        is_always |= "most" in diagnostic.values  # F(1, 800)
        stem = diagnostic.values.get("found", "").rstrip("0123456789")  # the word of `STOP2`
        is_always |= diagnostic.code is codes.UNKNOWN_WORD and diagnostic.values["near"] == stem
        if diagnostic.code not in OTHER_NUMBERS and not (is_counted or is_always):
            assert not loses_a_number(entry.program, edits), fix


# These suggestions are text only; the repair is computed when someone presses the button.
TEXT_ONLY_GAPS = {
    codes.OUT_OF_RANGE: ("fix", "most"),
    codes.LONG_TIME: ("fix", "way"),
    codes.USED_BEFORE_SET: ("line", "before", "zero"),
    **dict.fromkeys((codes.SWAPPED, codes.ZERO_BEFORE, codes.TURNED_ROUND, codes.EXACT,
                     codes.FROZEN_UNTIL, codes.LATE_CHECK, codes.UNUSED_READING), ("fix",)),
}  # fmt: skip


def test_suggested_texts_are_offered_as_repairs(programs: tuple[Entry, ...]) -> None:
    """This includes a warning, which then disappears; `tsc check --fix` applies no repair of a
    warning."""
    go_through(check_offer, programs)


def check_offer(entry: Entry) -> None:
    diagnostics, text = check(entry.program), entry.program
    for index, diagnostic in enumerate(diagnostics):
        edits = edits_offered(text, diagnostics, index, check)
        names_one = any(
            diagnostic.values.get(gap) for gap in TEXT_ONLY_GAPS.get(diagnostic.code, ())
        )
        assert edits or not names_one, diagnostic
        if edits and not diagnostic.is_mistake:
            diagnostics_after = check(apply_edits(text, edits))
            assert (
                mistake_count(diagnostics_after) <= mistake_count(diagnostics)
                and diagnostic not in diagnostics_after
            )
            assert diagnostic.repair is None


def test_repairs_are_idempotent(programs: tuple[Entry, ...]) -> None:
    go_through(check_repaired, programs)


def check_repaired(entry: Entry) -> None:
    if entry.mended is not None:
        assert repair_program(entry.mended, check).text == entry.mended
        assert mistake_count(check(entry.mended)) <= mistake_count(check(entry.program))
