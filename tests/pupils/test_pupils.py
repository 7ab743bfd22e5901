"""What pupils get wrong: each program of the corpus gets its messages, and repairs that are right.

python -m pytest tests/pupils --accept    writes what is said now; read the difference like code
"""

from __future__ import annotations

import re

import pytest

from tests.pupils.corpus import Entry, check, entries, found_in, write
from tests.support.rows import each_row
from tiniscript.base.source import Edit, Source, applied
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import edits_of, fixed, offer

ENTRIES = entries()
# Repairs that write a number in another way: a unit, a letter for a digit, `X++`, `50.`, and how
# often `I = 1 TO 4` and `LOOP(I = 0; I < 4; I++)` go round.
OTHER_NUMBERS = (
    codes.UNIT,
    codes.BAD_NUMBER,
    codes.OTHER_ASSIGNMENT,
    codes.LINE_NUMBER,
    codes.SETUP_UNKNOWN,  # `S1|` is SI
    codes.SETUP_NEEDS_BAR,  # and so is `S1;`
    codes.LOOP_COUNTS,
    codes.NEEDLESS_FRAME,  # with its `return 0`
    codes.LISTS,  # `V[0]` is V_1
    codes.PASTED,  # `[20:14] Luis:`
    codes.NO_BRACKETS_HERE,  # `TASK(1)`
)
# A digit for a sign on its key, or turned round; a power; a point between thousands; a sound; a
# number that counts lines.
SHIFTED = re.compile(r"[=!\"$%/]|\d\d, \d{3}$|^F8\d$|\^2|\.000$|^4WARD|^W8|^\d+\. [A-Z]")
CONVERTED = re.compile(r"(?i)[0-9] *(min|ms|mili|hora|hour)|delay|ton[eo]")


def mistakes(found: list[Diagnostic]) -> int:
    return sum(each.is_mistake for each in found)


def numbers(text: str) -> list[str]:
    without_notes = re.sub(r"\b[A-G][45]\b", "", text)  # the 4 of C4 is none
    return sorted(re.findall("[0-9]+", without_notes))


def loses_a_number(text: str, edits: list[Edit]) -> bool:
    """Whether a change drops one of the program's numbers."""
    left = numbers(applied(text, edits))
    for number in numbers(text):
        if number not in left:
            return True
        left.remove(number)
    return False


def test_there_are_enough() -> None:
    assert len(ENTRIES) >= 1000
    assert len({each.program for each in ENTRIES}) == len(ENTRIES)


def test_the_corpus_is_as_it_was(request: pytest.FixtureRequest) -> None:
    found = [found_in(each) for each in ENTRIES]
    if request.config.getoption("--accept"):
        write(found)
        return
    changed = [(old, new) for old, new in zip(ENTRIES, found, strict=True) if old != new]
    assert not changed, f"{len(changed)} of {len(found)}, the first: {changed[0]}"


@each_row("entry", ENTRIES)
def test_each_repair_helps_and_keeps_the_numbers(entry: Entry) -> None:
    found, source = check(entry.program), Source(entry.program)
    for diagnostic in found:
        edits = edits_of(diagnostic)
        if not edits or not diagnostic.is_mistake:
            continue
        after = check(applied(entry.program, edits))
        assert mistakes(after) <= mistakes(found)
        if mistakes(after) == mistakes(found):  # it has uncovered another one
            assert diagnostic not in after
        fix = diagnostic.values.get("fix", "")
        is_counted = fix.startswith(("LOOP(", "W(")) and diagnostic.code is codes.OTHER_LANGUAGE
        is_counted = is_counted or SHIFTED.search(source[diagnostic.span]) is not None
        is_counted = is_counted or CONVERTED.search(entry.program) is not None
        is_always = fix in ("TRUE", "WHILE(TRUE)")  # `WHILE(1)`
        is_always |= fix == "TASK"  # `TAREA 1`
        is_always |= "most" in diagnostic.values  # F(1, 800)
        stem = diagnostic.values.get("found", "").rstrip("0123456789")  # of `STOP2`
        is_always |= diagnostic.code is codes.UNKNOWN_WORD and diagnostic.values["near"] == stem
        if diagnostic.code not in OTHER_NUMBERS and not (is_counted or is_always):
            assert not loses_a_number(entry.program, edits), fix


# Of these the thing to try is one text: what it says is written when somebody presses a button.
WRITTEN = {
    codes.OUT_OF_RANGE: ("fix", "most"),
    codes.LONG_TIME: ("fix", "way"),
    codes.USED_BEFORE_SET: ("line", "before", "zero"),
    **dict.fromkeys((codes.SWAPPED, codes.ZERO_BEFORE, codes.TURNED_ROUND, codes.EXACT,
                     codes.FROZEN_UNTIL, codes.LATE_CHECK, codes.UNUSED_READING), ("fix",)),
}  # fmt: skip


@each_row("entry", ENTRIES)
def test_what_a_message_says_to_write_is_offered(entry: Entry) -> None:
    """Also a warning's, which is gone then; `tsc check --fix` makes none of a warning."""
    found, text = check(entry.program), entry.program
    for which, diagnostic in enumerate(found):
        edits = offer(text, found, which, check)
        names_one = any(diagnostic.values.get(gap) for gap in WRITTEN.get(diagnostic.code, ()))
        assert edits or not names_one, diagnostic
        if edits and not diagnostic.is_mistake:
            after = check(applied(text, edits))
            assert mistakes(after) == 0 and diagnostic not in after
            assert diagnostic.repair is None


@each_row("entry", ENTRIES)
def test_what_is_repaired_is_repaired_once(entry: Entry) -> None:
    if entry.mended is not None:
        assert fixed(entry.mended, check).text == entry.mended
        assert mistakes(check(entry.mended)) <= mistakes(check(entry.program))
