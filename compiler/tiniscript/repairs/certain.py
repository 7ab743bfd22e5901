"""Which repairs leave no choice: a slip whose sign could stand elsewhere is left to its author.

Knows the diagnostic, the changes that it asks for, and the text around them.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.repairs.accounting import makes_up_names
from tiniscript.source import Edit, Source, Span

# `8O`, `1OO` and `O.5`: in any other place a letter may be one too many.
_LETTER_FOR_ZERO = re.compile(r"[1-9][Oo]{1,2}|[Oo]\.[0-9]+")
_MARKS = "¡¿→•·►▶"  # that stand before a sentence or in a list, and for no other sign
_LETTERS = re.compile(r"[A-Za-z]")
# A call without calculations: of `5 / 3 - 3)` a bracket may be missing.
_PLAIN_CALL = re.compile(r"\s*[A-Za-z_]\w*\s*\([^()+*/%<>=-]*\)+\s*")
_UNIT_BEHIND = re.compile(r"(?i)[ \t]*s[ \t]+[0-9]")
_PERCENT = re.compile(r"[0-9.]+ ?% *,")
_AROUND = 80  # characters of an instruction that are looked at


def is_certain(diagnostic: Diagnostic, edits: Sequence[Edit], source: Source) -> bool:
    """Whether nothing else than this repair can be meant, as far as the signs around it tell."""
    text, span = source.text, diagnostic.span
    if diagnostic.code is codes.BAD_NUMBER:
        return _is_number(source[span])
    if diagnostic.code is codes.UNIT and _is_first_percent(text, span):
        return False
    if diagnostic.code is codes.OTHER_LANGUAGE and diagnostic.values.get("right") == "TIME":
        return False  # TIEMPO is rather a variable whose value is not set
    if diagnostic.code is codes.ODD_CHARACTER:
        after = text[span.end : span.end + 1]
        is_mark = set(source[span]) <= set(_MARKS)
        return is_mark or not (after.isalnum() or after in ("_", "."))  # `:PEED`, `0.?1`
    if diagnostic.values.get("pause"):
        return False  # `SB|F(1, 80);SB|B(1, 80)`: a wait may be meant
    if diagnostic.values.get("both"):
        return False  # `F(2, 80) + BEEP(2, 440)`: at once, or one after the other
    if diagnostic.code is codes.MISSING_SEPARATOR and diagnostic.values.get("fix"):
        return False  # `STOP 2` may have a number too many
    if diagnostic.code is codes.MISSING_OPEN and _UNIT_BEHIND.match(
        text, max((edit.span.end for edit in edits), default=span.end)
    ):
        return False  # `W 2 s 80`: its S is a unit
    if diagnostic.code is codes.EXTRA_CLOSE:
        return _PLAIN_CALL.fullmatch(_before(text, span.end)) is not None
    if diagnostic.code is codes.MISSING_CLOSE and not diagnostic.values.get("fix"):
        return not _is_grouped(_before(text, span.end))
    return not any(makes_up_names(source[edit.span], edit.text) for edit in edits)


def _is_number(written: str) -> bool:
    if _LETTERS.search(written):
        return _LETTER_FOR_ZERO.fullmatch(written) is not None
    return written[-1:].isnumeric()  # `15.` may be 1.5, and `10"` has a slip in it


def _is_first_percent(text: str, span: Span) -> bool:
    """Whether the `%` of `F 80 %, 2` is at `span`, whose call says which value is meant."""
    is_parted = _PERCENT.match(text, span.start) is not None
    return is_parted and "(" not in _before(text, span.start)


def _before(text: str, end: int) -> str:
    """Return what stands of an instruction before `end`."""
    part = text[max(0, end - _AROUND) : end]
    return re.split(r"[;\r\n|{}]", part)[-1]


def _is_grouped(part: str) -> bool:
    """Whether the bracket that is open last begins a part of a calculation."""
    opened = part.rfind("(")
    is_calculated = re.search(r"[-+*/%]", part[opened + 1 :]) is not None
    return is_calculated and not part[:opened].rstrip()[-1:].isalnum()
