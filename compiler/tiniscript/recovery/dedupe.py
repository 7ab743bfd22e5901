"""Reports once what would be reported at several places of a text. Knows no row."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.base.source import Edit, Source, Span, apply_edits
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic, Repair
from tiniscript.recovery.consequences import without_consequences
from tiniscript.syntax.lexer import QUOTES

MAX_EXAMPLE_CALLS = 6  # calls that an example has
# Messages given once for the same values, some or all of them: with the lines of the others, and
# their repairs, or without.
_GAPS_WITH_LINES: dict[Code, tuple[str, ...] | None] = {
    codes.EMPTY_BRACKETS: ("word",),
    **dict.fromkeys((codes.BAD_NAME, codes.NAME_WITH_SPACE), ("found", "right")),
    **dict.fromkeys((codes.RESERVED, codes.SAME_AGAIN)),
}
# Codes about one word; only its first place is reported.
_UNKNOWN_WORD_CODES = (codes.UNKNOWN_WORD, codes.UNTAUGHT)
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
        diagnostic.values.get("found")
        for diagnostic in diagnostics
        if diagnostic.values.get("near") or diagnostic.values.get("first")
    }
    quote_indexes = {
        k for k, diagnostic in enumerate(diagnostics) if _removes_quotes(diagnostic, source)
    }
    diagnostics = _merge_quotes([diagnostics[k] for k in sorted(quote_indexes)], source) + [
        diagnostic for k, diagnostic in enumerate(diagnostics) if k not in quote_indexes
    ]
    diagnostics_by_key: dict[object, list[Diagnostic]] = {}
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
            gap_names = _MERGED_CODES[code]
            key = tuple(
                values.get(gap_name, "").upper()
                for gap_name in (values if gap_names is None else gap_names)
            )
        diagnostics_by_key.setdefault((code, key), []).append(diagnostic)
    return codes.in_order(
        [_merge_diagnostics(group, source) for group in diagnostics_by_key.values()]
    )


def _removes_quotes(diagnostic: Diagnostic, source: Source) -> bool:
    """Return whether a repair only removes quotation marks."""
    edits = diagnostic.repair.edits if diagnostic.repair else ()
    return bool(edits) and all(
        not edit.text.strip() and {*source[edit.span].strip()} <= {*QUOTES} for edit in edits
    )


def _merge_quotes(diagnostics: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return one diagnostic for all quotation marks of a line."""
    groups_by_line: dict[int, list[Diagnostic]] = {}
    for diagnostic in diagnostics:
        groups_by_line.setdefault(source.position(diagnostic.span.start)[0], []).append(diagnostic)
    merged_diagnostics = []
    for line_number, group in groups_by_line.items():
        repairs = [diagnostic.repair for diagnostic in group if diagnostic.repair]
        edits = sorted(edit for repair in repairs for edit in repair.edits)
        if len(group) > 1 and any(diagnostic.code is codes.QUOTE for diagnostic in group):
            line_span = source.line_span(line_number)
            shifted_edits = [
                Edit(Span(a - line_span.start, b - line_span.start), new_text)
                for (a, b), new_text in edits
            ]
            fix = apply_edits(source[line_span], shifted_edits).strip("\r\n \t")
            repair = Repair(tuple(edits), all(repair.is_sure for repair in repairs))
            span = Span(edits[0].span.start, edits[-1].span.end)
            group = [Diagnostic(codes.QUOTE, span, {"fix": fix}, span, repair)]
        merged_diagnostics += group
    return merged_diagnostics


def _merge_diagnostics(group: Sequence[Diagnostic], source: Source) -> Diagnostic:
    first_diagnostic = group[0]
    if len(group) == 1 or first_diagnostic.code not in (*_GAPS_WITH_LINES, codes.MISSING_OPEN):
        return first_diagnostic
    if first_diagnostic.code is codes.MISSING_OPEN:
        words = ", ".join(dict.fromkeys(diagnostic.values["word"] for diagnostic in group))
        calls = (
            diagnostic.values.get("fix") or diagnostic.values["example"]
            for diagnostic in group[:MAX_EXAMPLE_CALLS]
        )
        values = {**first_diagnostic.values, "words": words, "fix": "", "example": "; ".join(calls)}
        return first_diagnostic._replace(values=values, place=None, repair=None)
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
    repair = first_diagnostic.repair and Repair(
        edits, all(diagnostic.repair and diagnostic.repair.is_sure for diagnostic in group)
    )
    return first_diagnostic._replace(values={**first_diagnostic.values, **gaps}, repair=repair)
