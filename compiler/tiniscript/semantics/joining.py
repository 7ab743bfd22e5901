"""Joins diagnostics of one misunderstanding: what one repair mends needs no other.

Knows where the things to try stand, and writes each of them in the words of the language. Finds no
mistakes.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.kit import Kit
from tiniscript.source import Source
from tiniscript.syntax.lexer import Token
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import WORDS

# What is mended within a larger repair: a word, a number or a sign.
_SMALL = (codes.OTHER_LANGUAGE, codes.UNIT, codes.OTHER_SIGN, codes.BAD_NUMBER)
# Whose fix is a note, or the name of a new variable.
_OWN_WORDS = (codes.PROSE, codes.WORDS_BEHIND, codes.MISSING_EQUALS)
ENOUGH = 100  # diagnostics that are joined


def joined(
    found: Sequence[Diagnostic], source: Source, tokens: Sequence[Token], kit: Kit
) -> list[Diagnostic]:
    """Return diagnostics without those that the thing to try of another one mends."""
    known = Vocabulary(tokens, kit)
    kept: list[Diagnostic] = []
    mended: set[int] = set()
    for diagnostic in found[:ENOUGH]:
        fix = diagnostic.values.get("fix", "")
        right = diagnostic.values.get("right", "").upper()
        if (
            diagnostic.code is codes.BAD_NAME and right in WORDS and _has_accent(source, diagnostic)
        ):  # `Sí|`
            diagnostic = diagnostic._replace(values={**diagnostic.values, "word": right})
        if fix:
            place = diagnostic.place or diagnostic.span
            for k, other in enumerate(found[:ENOUGH]):
                small = other.place or other.span
                if other is diagnostic or other.code not in _SMALL:
                    continue
                if place.start <= small.start and small.end <= place.end and small != place:
                    written = source[small]
                    right = other.values.get("fix") or other.values.get("right", "")
                    if written.upper() in fix.upper() and right:
                        fix = _replaced(fix, written, right)
                    mended.add(k)
            if diagnostic.code not in _OWN_WORDS:
                fix = known.translated(fix)
            diagnostic = diagnostic._replace(values={**diagnostic.values, "fix": fix})
        kept.append(diagnostic)
    return [each for k, each in enumerate(kept) if k not in mended] + list(found[ENOUGH:])


def _has_accent(source: Source, diagnostic: Diagnostic) -> bool:
    """Whether a name has its length without what makes it bad: `_F` has not."""
    return len(source[diagnostic.span]) == len(diagnostic.values["right"])


def _replaced(text: str, old: str, new: str) -> str:
    """Return `text` with the first `old` replaced, in any case, if it is no part of more."""
    start = text.upper().index(old.upper())
    end = start + len(old)
    is_part = text[end : end + 1].isalnum() and text[end - 1 : end] in (".", "_", *"0123456789")
    return text if is_part else text[:start] + new + text[end:]  # `0.` within `0.5`
