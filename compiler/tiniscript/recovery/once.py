"""Says once what would be said of several places of a text. Knows no row."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic, Repair

MANY = 6  # calls that an example has
# One message has the lines of the others, and their repairs.
_OF_WORDS = (codes.BAD_NAME, codes.EMPTY_BRACKETS, codes.NAME_WITH_SPACE)  # in any instruction
_WITH_LINES = (codes.RESERVED, codes.SAME_AGAIN, *_OF_WORDS)
_DROPPED = (codes.BRACES, codes.DOTS, codes.UNTAUGHT, codes.CALLS_ITSELF, codes.UNKNOWN_NAME,
            codes.CASES)  # fmt: skip
_OF_CASES = (codes.BRACES, codes.BREAK_OUTSIDE)  # which go with them


def said_once(found: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return diagnostics without those that say the same as one before."""
    if any(each.code is codes.CASES for each in found):
        found = [each for each in found if each.code not in _OF_CASES]
    groups: dict[tuple[Code, tuple[tuple[str, str], ...]], list[Diagnostic]] = {}
    bare = [each for each in found if each.code is codes.MISSING_OPEN and _is_bare(each, source)]
    meant = {
        it.values.get("found") for it in found if it.values.get("near") or it.values.get("first")
    }
    for each in found:
        is_meant = each.code is codes.UNKNOWN_NAME and each.values.get("found") in meant
        is_one = each.code in (*_WITH_LINES, *_DROPPED) and not is_meant
        is_any = each.code in (codes.BRACES, codes.CASES)
        kind = () if is_any else tuple(sorted(each.values.items()))
        if each.code in _OF_WORDS:
            its = ("word",) if each.code is codes.EMPTY_BRACKETS else ("found", "right")
            kind = tuple((name, each.values.get(name, "").upper()) for name in its)
        key = (each.code, kind if is_one else (("at", str(each.span)),))
        groups.setdefault(key, []).append(each)
    kept = [
        _with_lines(same, source) if same[0].code in _WITH_LINES else same[0]
        for same in groups.values()
    ]
    if len(bare) > 1:
        kept = [each for each in kept if each not in bare[1:]]
        kept[kept.index(bare[0])] = _with_calls(bare)
    return codes.in_order(kept)


def _is_bare(found: Diagnostic, source: Source) -> bool:
    """Whether a word stands alone that has values."""
    is_word = source[found.span].upper() == found.values["word"]
    return is_word and bool(found.values.get("fix") or found.values.get("example"))


def _with_calls(bare: Sequence[Diagnostic]) -> Diagnostic:
    first = bare[0]
    words = ", ".join(dict.fromkeys(each.values["word"] for each in bare))
    calls = (each.values.get("fix") or each.values["example"] for each in bare[:MANY])
    values = {**first.values, "words": words, "fix": "", "example": "; ".join(calls)}
    return first._replace(values=values, place=None, repair=None)


def _with_lines(same: Sequence[Diagnostic], source: Source) -> Diagnostic:
    first, *others = same
    if not others:
        return first
    here, *lines = (str(source.position(each.span.start)[0]) for each in same)
    lines = [each for each in dict.fromkeys(lines) if each != here]
    gaps = {"line": "".join(lines[:1]), "lines": ", ".join(lines) if len(lines) > 1 else "",
            "times": "" if lines else str(len(same))}  # fmt: skip
    edits = tuple(edit for each in same if each.repair for edit in each.repair.edits)
    repair = first.repair and Repair(edits, all(it.repair and it.repair.is_sure for it in same))
    return first._replace(values={**first.values, **gaps}, repair=repair)
