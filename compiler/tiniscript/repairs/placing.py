"""Where the thing to try of a diagnostic stands: the changes of the text that it asks for.

Knows for each code what its repair replaces. What is only an example (`F(2, 80)` for F alone), or
names two ways, is no change. Does not know whether a repair is meant: `fixing` decides that.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.source import Edit, Source, Span

Edits = list[Edit] | None

_NEAR = 80  # characters before a value in which its word is looked for
_CALL = re.compile(r"[A-Za-z_]\w*\s*\([^()\r\n]*$")  # up to a value in brackets
_TO_ITS_END = re.compile(r"[^;\r\n{}]*")


def edits_of(diagnostic: Diagnostic, source: Source) -> Edits:
    """Return the changes that the thing to try asks for; None where it is no change of the text."""
    if diagnostic.repair is not None:
        return [*diagnostic.repair.edits] or None
    place = _PLACES.get(diagnostic.code)
    return None if place is None else place(diagnostic, source)


def _span(diagnostic: Diagnostic, source: Source) -> Edits:
    """The span becomes what is right."""
    values = diagnostic.values
    new = values.get("right") or values.get("near") or ""
    new = values.get("fix", new)
    if new.isalpha() and diagnostic.code is codes.OTHER_SIGN:  # `A&&B`
        before, after = (
            source.text[: diagnostic.span.start][-1:],
            source.text[diagnostic.span.end :][:1],
        )
        new = " " * (before.isalnum() or before == "_") + new + " " * after.isalnum()
    return [Edit(diagnostic.place or diagnostic.span, new)] if new else None


def _own(diagnostic: Diagnostic, source: Source) -> Edits:
    """The call that a value or a pair of brackets belongs to becomes what is right."""
    fix, text = diagnostic.values.get("fix", ""), source.text
    if not fix:
        return None
    if diagnostic.place is not None:
        return [Edit(diagnostic.place, fix)]
    start, end = diagnostic.span
    if "UNTIL" not in fix:
        end = _end_of_call(text, start) or end
    return [Edit(Span(start, end), fix)]


def _around(diagnostic: Diagnostic, source: Source) -> Edits:
    """The whole call around a value becomes what is right: `F(-2, 80)`."""
    fix = diagnostic.values.get("fix", "")
    begin = max(0, diagnostic.span.start - _NEAR)
    call = _CALL.search(source.text[begin : diagnostic.span.start])
    end = _end_of_call(source.text, begin + call.start()) if call else None
    return [Edit(Span(begin + call.start(), end), fix)] if fix and call and end else None


def _word(diagnostic: Diagnostic, source: Source) -> Edits:
    return [Edit(diagnostic.span, diagnostic.values["word"])]


def _other_word(diagnostic: Diagnostic, source: Source) -> Edits:
    """A word of another language, and its values where the repair has some."""
    fix = diagnostic.values.get("fix", "")
    if not fix:
        return None  # its values are not known
    if diagnostic.place is not None or "(" not in fix:
        return _span(diagnostic, source)
    return _own(diagnostic, source)


def _assigned(diagnostic: Diagnostic, source: Source) -> Edits:
    fix = diagnostic.values.get("fix", "")
    return [Edit(diagnostic.place, fix)] if fix and diagnostic.place else None


def _end_of_call(text: str, start: int) -> int | None:
    """Return where the call at `start` ends; None where it has no brackets."""
    begin = _TO_ITS_END.match(text, start)
    opened = text.find("(", start, begin.end() if begin else start)
    if opened < 0 or not text[start:opened].strip().isidentifier():
        return None
    depth = 0
    for k in range(opened, len(text)):
        depth += (text[k] == "(") - (text[k] == ")")
        if not depth:
            return k + 1
        if text[k] in ";\r\n":
            break
    return None


_PLACES: dict[Code, Callable[[Diagnostic, Source], Edits]] = {
    codes.DECIMAL_COMMA: _own,
    codes.MISSING_OPEN: _own,
    codes.ARGUMENT_COUNT: _own,
    codes.EMPTY_BRACKETS: _word,
    codes.OUT_OF_RANGE: _around,
    codes.UNIT_PAIR: _around,
    codes.OTHER_LANGUAGE: _other_word,
    codes.UNKNOWN_WORD: _span,
    codes.UNKNOWN_NAME: _span,
    codes.WANTS_CONDITION: _span,
    codes.MIXED_COMPARE: _span,
    codes.NAMED_ARGUMENT: _span,
    codes.NAME_WITH_SPACE: _span,
    codes.WORDS_BEHIND: _span,
    codes.SEVERAL_ORDERS: _span,
    codes.REPEATED: _span,
    codes.QUESTION_BEHIND: _assigned,
    codes.NOT_CALLABLE: lambda found, source: (
        _span(found, source) if "times" in found.values else None
    ),
}
