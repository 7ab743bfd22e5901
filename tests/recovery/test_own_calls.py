"""A DEF with values is read, and told of, alike for each count of values.

The brackets of its header and of its call may be missing, with or without commas, and what is said
of a word of the program's own ends with no gap.
"""

from __future__ import annotations

import re
from itertools import product

import pytest

from tests.pupils.corpus import check
from tests.support.rows import each_row
from tiniscript.base.languages import languages
from tiniscript.base.limits import PARAMETERS
from tiniscript.base.source import Source
from tiniscript.diagnostics.fixing import fixed
from tiniscript.diagnostics.rendering import message

NAMES, NUMBERS = ("SIZE", "V", "ZOOM", "N2"), ("30", "2.5", "7", "0")
COUNTS = range(1, PARAMETERS + 1)
JOINTS = (", ", " ", " ,")
PROGRAM = "DEF SIDE{head}\nSHOW({body})\nEND_DEF\nW(1)\nSIDE{call}"


def program(head: str, call: str, count: int) -> str:
    return PROGRAM.format(head=head, call=call, body=" + ".join(NAMES[:count]))


@each_row("count, joint, other", product(COUNTS, JOINTS, JOINTS))
def test_brackets_may_be_missing_around_any_count(count: int, joint: str, other: str) -> None:
    names, numbers = NAMES[:count], NUMBERS[:count]
    right = {"head": f"({', '.join(names)})", "call": f"({', '.join(numbers)})"}
    bare = {"head": f" {joint.join(names)}", "call": f" {other.join(numbers)}"}
    for lacks in ({"head"}, {"call"}, {"head", "call"}):
        wrong = program(count=count, **{**right, **{it: bare[it] for it in lacks}})
        assert fixed(wrong, check).text == program(count=count, **right), wrong


SLIPS = (
    "{w}(,{a})",
    "{w}({a},)",
    "{w}[{a}]",
    "{w}{{{a}}}",
    "{w}({a}))",
    "{w}(,,{a})",
    "Y = {w}({a})",
)


@pytest.mark.parametrize("language", languages())
def test_no_sentence_on_a_def_ends_with_a_gap_or_takes_another_word(language: str) -> None:
    for count, slip in product(COUNTS, SLIPS):
        names, numbers = (", ".join(its[:count]) for its in (NAMES, NUMBERS))
        header = slip.format(w="", a=names) if slip[0] == "{" else ""
        for text in (
            program(f"({names})", f"({numbers})\n{slip.format(w='SIDE', a=numbers)}", count),
            *([program(header, f"({numbers})", count)] if header else []),
        ):
            for diagnostic in check(text):
                said = message(diagnostic, Source(text, ""), language)
                assert not re.search(r":\s*(?:DEF)?\s*$", said.message), said
                assert not re.match(r"Y\b", said.message), said
