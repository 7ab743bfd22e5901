"""Where the thing to try of a diagnostic stands: the changes of the text that it asks for.

Knows for each code which of its values is written there. What is only an example (`F(2, 80)` for F
alone), or names two ways, is no change. Does not know whether a repair is meant: `fixing` does.
"""

from __future__ import annotations

from tiniscript.base.source import Edit
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic

_WRITTEN = ("fix", "right", "near")  # the first of them that a diagnostic has
_GAPS: dict[Code, tuple[str, ...]] = {
    **dict.fromkeys((codes.UNKNOWN_WORD, codes.UNKNOWN_NAME, codes.WANTS_CONDITION,
                     codes.MIXED_COMPARE, codes.NAMED_ARGUMENT, codes.NAME_WITH_SPACE,
                     codes.WORDS_BEHIND, codes.SEVERAL_ORDERS, codes.REPEATED), _WRITTEN),
    **dict.fromkeys((codes.MISSING_OPEN, codes.OUT_OF_RANGE, codes.UNIT_PAIR, codes.OTHER_LANGUAGE,
                     codes.QUESTION_BEHIND, codes.NOT_CALLABLE), ("fix",)),
    codes.EMPTY_BRACKETS: ("word",),
}  # fmt: skip
_ELSEWHERE = (codes.QUESTION_BEHIND, codes.NOT_CALLABLE)  # without a place they show a way


def edits_of(diagnostic: Diagnostic) -> list[Edit] | None:
    """Return the changes that the thing to try asks for; None where it is no change of the text."""
    if diagnostic.repair is not None:
        return [*diagnostic.repair.edits] or None
    values, place = diagnostic.values, diagnostic.place
    new = next((values[gap] for gap in _GAPS.get(diagnostic.code, ()) if gap in values), "")
    if not new or (place is None and diagnostic.code in _ELSEWHERE):
        return None
    return [Edit(place or diagnostic.span, new)]
