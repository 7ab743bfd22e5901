"""Says once what would be said of several places of a text. Knows no row."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.base.source import Edit, Source, Span, applied
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic, Repair
from tiniscript.recovery.consequences import without_consequences
from tiniscript.syntax.lexer import QUOTES

MANY = 6  # calls that an example has
# What is said once for the same values, these or all of them: with the lines of the others, and
# their repairs, or without.
_WITH_LINES: dict[Code, tuple[str, ...] | None] = {
    codes.EMPTY_BRACKETS: ("word",),
    **dict.fromkeys((codes.BAD_NAME, codes.NAME_WITH_SPACE), ("found", "right")),
    **dict.fromkeys((codes.RESERVED, codes.SAME_AGAIN)),
}
_UNKNOWN = (codes.UNKNOWN_WORD, codes.UNTAUGHT)  # one word: of each its first place
_ONCE = _WITH_LINES | {
    **dict.fromkeys((codes.BRACES, codes.CASES), ()),
    **dict.fromkeys((codes.DOTS, codes.UNTAUGHT, codes.CALLS_ITSELF, codes.UNKNOWN_NAME)),
}


def dedupe(found: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return diagnostics without those that follow from others, or say the same as one before."""
    found = without_consequences(found, source)
    meant = {
        it.values.get("found") for it in found if it.values.get("near") or it.values.get("first")
    }
    quoted = {k for k, each in enumerate(found) if _unquotes(each, source)}
    found = _unquoted([found[k] for k in sorted(quoted)], source) + [
        each for k, each in enumerate(found) if k not in quoted
    ]
    groups: dict[object, list[Diagnostic]] = {}
    for each in found:
        code, values = each.code, each.values
        key: object = each.span
        is_alone = source[each.span].upper() == values.get("word")
        if code is codes.MISSING_OPEN and is_alone and (values.get("fix") or values.get("example")):
            key = ""  # a word that has values
        elif code in _UNKNOWN and not (each.repair or values.get("near")):
            code, key = codes.UNKNOWN_WORD, (values.get("found") or values["name"]).upper()
        elif code in _ONCE and not (code is codes.UNKNOWN_NAME and values.get("found") in meant):
            names = _ONCE[code]
            key = tuple(
                values.get(name, "").upper() for name in (values if names is None else names)
            )
        groups.setdefault((code, key), []).append(each)
    return codes.in_order([_together(same, source) for same in groups.values()])


def _unquotes(found: Diagnostic, source: Source) -> bool:
    """Whether a repair takes quotation marks out, and does nothing else."""
    edits = found.repair.edits if found.repair else ()
    return bool(edits) and all(
        not edit.text.strip() and {*source[edit.span].strip()} <= {*QUOTES} for edit in edits
    )


def _unquoted(found: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return one diagnostic for all quotation marks of a line."""
    rows: dict[int, list[Diagnostic]] = {}
    for each in found:
        rows.setdefault(source.position(each.span.start)[0], []).append(each)
    told = []
    for row, same in rows.items():
        repairs = [each.repair for each in same if each.repair]
        edits = sorted(edit for each in repairs for edit in each.edits)
        if len(same) > 1 and any(each.code is codes.QUOTE for each in same):
            line = source.line_span(row)
            shift = [Edit(Span(a - line.start, b - line.start), it) for (a, b), it in edits]
            fix = applied(source[line], shift).strip("\r\n \t")
            repair = Repair(tuple(edits), all(each.is_sure for each in repairs))
            span = Span(edits[0].span.start, edits[-1].span.end)
            same = [Diagnostic(codes.QUOTE, span, {"fix": fix}, span, repair)]
        told += same
    return told


def _together(same: Sequence[Diagnostic], source: Source) -> Diagnostic:
    first = same[0]
    if len(same) == 1 or first.code not in (*_WITH_LINES, codes.MISSING_OPEN):
        return first
    if first.code is codes.MISSING_OPEN:
        words = ", ".join(dict.fromkeys(each.values["word"] for each in same))
        calls = (each.values.get("fix") or each.values["example"] for each in same[:MANY])
        values = {**first.values, "words": words, "fix": "", "example": "; ".join(calls)}
        return first._replace(values=values, place=None, repair=None)
    here, *lines = (str(source.position(each.span.start)[0]) for each in same)
    lines = [line for line in dict.fromkeys(lines) if line != here]
    gaps = {"line": "".join(lines[:1]), "lines": ", ".join(lines) if len(lines) > 1 else "",
            "times": "" if lines else str(len(same))}  # fmt: skip
    edits = tuple(edit for each in same if each.repair for edit in each.repair.edits)
    repair = first.repair and Repair(edits, all(it.repair and it.repair.is_sure for it in same))
    return first._replace(values={**first.values, **gaps}, repair=repair)
