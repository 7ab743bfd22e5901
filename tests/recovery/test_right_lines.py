"""A correct line is never reported because another line is wrong.

python -m tests.recovery.test_right_lines 10000    so many right programs with a wrong line
"""

from __future__ import annotations

import random
import re
import sys
from functools import cache

import pytest

from tests.pupils.corpus import check, entries
from tests.support.damaged_programs import programs
from tests.support.rows import each_row
from tiniscript.base.source import Source
from tiniscript.base.words import WORDS

SEEDS_IN_CI = 150
# Right, and not as the documents write it.
ODD_LINES = (
    "L(90°, 50)",
    "L(90º, 50)\nR( 90 ° , 50 )",
    "M(\u221250, 50)",
    "f(20cm,60) until(distance<9)",
    "SI|A = .5; W(A)",
    "DEF PASO;F(1, 80);END_DEF;PASO;PASO",
)
_START = re.compile(r"(?i)\b(?:S[IB]\s*\||PING)")


@cache
def right_lines() -> list[str]:
    candidates = [
        *programs(),
        *(entry.program for entry in entries() if not entry.messages),
        *ODD_LINES,
    ]
    return sorted(line for line in candidates if _starts_at_once(line) and not _mistakes(line))


@cache
def wrong_lines() -> list[str]:
    """Return lines of pupils that are wrong on their own and do not belong to a block."""
    lines = ["F(2;80)"]
    for entry in entries():
        line = entry.program
        if re.search(r"[\n|{}]|//|~", line) or "(" not in line or not _mistakes(line):
            continue
        texts = [
            line,
            *(value for diagnostic in check(line) for value in diagnostic.values.values()),
        ]
        if not {*re.findall(r"\w+", " ".join(texts).upper())} & _BLOCK_WORDS:
            lines.append(line)
    return sorted(lines)


_BLOCK_WORDS = {word for word, row in WORDS.items() if row.role.belongs_to_blocks} | {"SI", "SB"}


@pytest.mark.sampled("seed", keep=SEEDS_IN_CI // 3)
@pytest.mark.parametrize("seed", range(SEEDS_IN_CI))
def test_only_the_wrong_line_is_reported(seed: int) -> None:
    """After, before and between right ones, which are no longer looked at for warnings."""
    rng = random.Random(seed)
    program, line = rng.choice(right_lines()), rng.choice(wrong_lines())
    rows = program.split("\n")
    k = rng.choice([k for k in range(1, len(rows) + 1) if _is_closed("\n".join(rows[:k]))])
    check_reported_alone(rows[:k], line, rows[k:])


@each_row("odd", ODD_LINES)
def test_unusual_but_right_lines_are_right_beside_a_wrong_one(odd: str) -> None:
    for line in (
        "F(2;80)",
        "F(2, 8=9",
        "F(2, 80*",
        "R(90, 60",
        "mueve adelante",
        "F(2, 80) 5 veces",
        "F(2)",
        "X := 5",
        "F(1, 80) LOP",
    ):
        check_reported_alone([odd], line, [])
        check_reported_alone([odd], line, [odd.removeprefix("SI|")] if "DEF" not in odd else [])


@each_row("block", ["LOOP(3)⏎{}⏎END_LOOP", "DEF A1⏎{}⏎END_DEF⏎A1", "IF(DISTANCE < 9)⏎{}⏎ENDIF"])
def test_a_word_after_an_instruction_begins_no_block(block: str) -> None:
    """If the next line is not indented more than the wrong line, the block around both
    continues.
    """
    for line in ("F(1, 80) LOP", "F(1, 80) loop", "S repite"):
        head, tail = block.replace("⏎", "\n").split("{}")
        check_reported_alone([f"{head}  F(1, 80)"], line, tail.strip().split("\n"))


def check_reported_alone(lines_before: list[str], line: str, lines_after: list[str]) -> None:
    rows = "\n".join([*lines_before, line, *lines_after]).split("\n")
    wrong_row = "\n".join(lines_before).count("\n") + 1
    source = Source("\n".join(rows))
    diagnostics = [diagnostic for diagnostic in check(source.text) if diagnostic.is_mistake]
    assert diagnostics, source.text
    for diagnostic in diagnostics:
        row = source.position(diagnostic.span.start)[0] - 1
        is_end = row == len(rows) or not rows[row].strip()  # the text ends early
        assert row == wrong_row or is_end, f"{source.text}\n{diagnostic}"


def _is_closed(text: str) -> bool:
    bare = re.sub("//[^\n]*", "", text)
    return bare.count("(") == bare.count(")")


def _mistakes(text: str) -> bool:
    return any(diagnostic.is_mistake for diagnostic in check(text))


def _starts_at_once(text: str) -> bool:
    """Return whether text below the first line is not before `SI|`."""
    return "~" not in text and not _START.search(text.partition("\n")[2]) and "PING" not in text


if __name__ == "__main__":
    for seed in range(int(sys.argv[1])):
        test_only_the_wrong_line_is_reported(seed)
