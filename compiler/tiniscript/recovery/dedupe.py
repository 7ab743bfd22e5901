"""Says once what would be said of several places of a text. Knows no row."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.base.source import Edit, Source, Span, apply_edits
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic, Repair
from tiniscript.recovery.consequences import without_consequences
from tiniscript.syntax.lexer import QUOTES

MOST_EXAMPLE_CALLS = 6  # calls that an example has
# What is said once for the same values, these or all of them: with the lines of the others, and
# their repairs, or without.
_GAPS_WITH_LINES: dict[Code, tuple[str, ...] | None] = {
    codes.EMPTY_BRACKETS: ("word",),
    **dict.fromkeys((codes.BAD_NAME, codes.NAME_WITH_SPACE), ("found", "right")),
    **dict.fromkeys((codes.RESERVED, codes.SAME_AGAIN)),
}
_UNKNOWN_WORD_CODES = (codes.UNKNOWN_WORD, codes.UNTAUGHT)  # one word: of each its first place
_MERGED_CODES = _GAPS_WITH_LINES | {
    **dict.fromkeys((codes.BRACES, codes.CASES), ()),
    **dict.fromkeys(
        (codes.DOTS, codes.UNTAUGHT, codes.CALLS_ITSELF, codes.UNKNOWN_NAME, codes.SWITCH_WHAT)
    ),
}


def dedupe(diagnostics: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return diagnostics without those that follow from others, or say the same as one before."""
    diagnostics = without_consequences(diagnostics, source)
    words_meant = {
        it.values.get("found")
        for it in diagnostics
        if it.values.get("near") or it.values.get("first")
    }
    quoted = {k for k, diagnostic in enumerate(diagnostics) if _unquotes(diagnostic, source)}
    diagnostics = _unquoted([diagnostics[k] for k in sorted(quoted)], source) + [
        diagnostic for k, diagnostic in enumerate(diagnostics) if k not in quoted
    ]
    groups: dict[object, list[Diagnostic]] = {}
    for diagnostic in diagnostics:
        code, values = diagnostic.code, diagnostic.values
        key: object = diagnostic.span
        is_bare_word = source[diagnostic.span].upper() == values.get("word")
        if (
            code is codes.MISSING_OPEN
            and is_bare_word
            and (values.get("fix") or values.get("example"))
        ):
            key = ""  # a word that has values
        elif code in _UNKNOWN_WORD_CODES and not (diagnostic.repair or values.get("near")):
            code, key = codes.UNKNOWN_WORD, (values.get("found") or values["name"]).upper()
        elif code in _MERGED_CODES and not (
            code is codes.UNKNOWN_NAME and values.get("found") in words_meant
        ):
            names = _MERGED_CODES[code]
            key = tuple(
                values.get(name, "").upper() for name in (values if names is None else names)
            )
        groups.setdefault((code, key), []).append(diagnostic)
    return codes.in_order([_merge_diagnostics(group, source) for group in groups.values()])


def _unquotes(diagnostic: Diagnostic, source: Source) -> bool:
    """Whether a repair takes quotation marks out, and does nothing else."""
    edits = diagnostic.repair.edits if diagnostic.repair else ()
    return bool(edits) and all(
        not edit.text.strip() and {*source[edit.span].strip()} <= {*QUOTES} for edit in edits
    )


def _unquoted(diagnostics: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return one diagnostic for all quotation marks of a line."""
    rows: dict[int, list[Diagnostic]] = {}
    for diagnostic in diagnostics:
        rows.setdefault(source.position(diagnostic.span.start)[0], []).append(diagnostic)
    result = []
    for row, group in rows.items():
        repairs = [diagnostic.repair for diagnostic in group if diagnostic.repair]
        edits = sorted(edit for repair in repairs for edit in repair.edits)
        if len(group) > 1 and any(diagnostic.code is codes.QUOTE for diagnostic in group):
            line = source.line_span(row)
            shifted_edits = [Edit(Span(a - line.start, b - line.start), it) for (a, b), it in edits]
            fix = apply_edits(source[line], shifted_edits).strip("\r\n \t")
            repair = Repair(tuple(edits), all(repair.is_sure for repair in repairs))
            span = Span(edits[0].span.start, edits[-1].span.end)
            group = [Diagnostic(codes.QUOTE, span, {"fix": fix}, span, repair)]
        result += group
    return result


def _merge_diagnostics(group: Sequence[Diagnostic], source: Source) -> Diagnostic:
    first = group[0]
    if len(group) == 1 or first.code not in (*_GAPS_WITH_LINES, codes.MISSING_OPEN):
        return first
    if first.code is codes.MISSING_OPEN:
        words = ", ".join(dict.fromkeys(diagnostic.values["word"] for diagnostic in group))
        calls = (
            diagnostic.values.get("fix") or diagnostic.values["example"]
            for diagnostic in group[:MOST_EXAMPLE_CALLS]
        )
        values = {**first.values, "words": words, "fix": "", "example": "; ".join(calls)}
        return first._replace(values=values, place=None, repair=None)
    first_line, *other_lines = (
        str(source.position(diagnostic.span.start)[0]) for diagnostic in group
    )
    other_lines = [line for line in dict.fromkeys(other_lines) if line != first_line]
    gaps = {
        "line": "".join(other_lines[:1]),
        "lines": ", ".join(other_lines) if len(other_lines) > 1 else "",
        "times": "" if other_lines else str(len(group)),
    }
    edits = tuple(
        edit for diagnostic in group if diagnostic.repair for edit in diagnostic.repair.edits
    )
    repair = first.repair and Repair(edits, all(it.repair and it.repair.is_sure for it in group))
    return first._replace(values={**first.values, **gaps}, repair=repair)
