"""Offers of messages are right: every edit, and every line that they show, compiles.

The law is stated here independently of the code that enforces it: inserted text contains no mistake
except those that another message reports.
"""

from __future__ import annotations

from itertools import accumulate

from tests.pupils.corpus import Entry, check
from tests.support.rows import each_row
from tiniscript.base.source import Edit, Span, apply_edits, edits_overlap
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import edits_of

SAID = ("fix", "right", "near")  # values of a message that show the changed program
OF_BLOCKS = {code.number for code in (codes.NEVER_ENDS, codes.NOT_OPEN, codes.WRONG_END)}


def spans_in_changed_text(edits: list[Edit]) -> list[Span]:
    """Return the spans of the edits' texts in the changed program."""
    ordered_edits = sorted(edits)
    grown = [len(edit.text) - (edit.span.end - edit.span.start) for edit in ordered_edits]
    starts = [edit.span.start + shift for edit, shift in
              zip(ordered_edits, accumulate(grown, initial=0), strict=False)]  # fmt: skip
    return [
        Span(start, start + len(edit.text))
        for start, edit in zip(starts, ordered_edits, strict=True)
    ]


def ways(diagnostic: Diagnostic, text: str) -> list[list[Edit]]:
    """Return the edits that a message offers, or the possible readings of the line that it
    shows."""
    if edits := edits_of(diagnostic):
        return [edits]
    fix = diagnostic.values.get("fix", "")
    start, end = diagnostic.place or diagnostic.span
    row = Span(text.rfind("\n", 0, start) + 1, (text + "\n").find("\n", end))
    spans = (Span(start, end), row, Span(0, len(text)))
    return [[Edit(span, fix)] for span in spans] if fix else []


def find_wrong_codes(
    diagnostic: Diagnostic,
    text: str,
    edits: list[Edit],
    other_codes: set[str],
    other_words: set[str],
) -> list[str]:
    """Return the codes of mistakes in the part of the changed program that a message shows."""
    changed_text = apply_edits(text, edits)
    own_edits = sorted(edits_of(diagnostic) or edits)
    spans = [
        span
        for edit, span in zip(sorted(edits), spans_in_changed_text(edits), strict=True)
        if edit in own_edits
    ]
    value = next((diagnostic.values[gap] for gap in SAID if diagnostic.values.get(gap)), "")
    position = changed_text.find(value, max(0, spans[0].start - len(value))) if value else -1
    if 0 <= position < spans[-1].end:
        spans.append(Span(position, position + len(value)))
    return [
        diagnostic.code.number for diagnostic in check(changed_text)
        if diagnostic.is_mistake
        and any(start <= diagnostic.span.start < end for start, end in spans)
        and diagnostic.code.number not in other_codes
        and not is_in_words(changed_text.upper(), diagnostic.span.start, other_words)
    ]  # fmt: skip


def is_in_words(changed_text: str, place: int, words: set[str]) -> bool:
    """Return whether a place is in one of the words that other messages point at."""
    return any(
        0 <= changed_text.find(word, max(0, place - len(word) + 1)) <= place for word in words
    )


def codes_with_wrong_offers(text: str) -> list[str]:
    """Return the codes of a program's messages with wrong offers."""
    diagnostics = [diagnostic for diagnostic in check(text) if diagnostic.is_mistake]
    together: list[Edit] = []
    for diagnostic in diagnostics:
        edits = edits_of(diagnostic) or []
        together += edits if not edits_overlap(edits, together) else []
    wrong_codes = []
    for diagnostic in diagnostics:
        other_diagnostics = [
            other_diagnostic
            for other_diagnostic in diagnostics
            if other_diagnostic is not diagnostic
        ]
        other_words = {
            text[slice(*other_diagnostic.span)].upper() for other_diagnostic in other_diagnostics
        } - {""}
        other_codes = {other_diagnostic.code.number for other_diagnostic in other_diagnostics}
        other_codes |= OF_BLOCKS if other_diagnostics or not edits_of(diagnostic) else set()
        tried_edits = ways(diagnostic, text)
        if set(edits_of(diagnostic) or ()) <= set(together) and edits_of(diagnostic):
            tried_edits.append(together)
        if tried_edits and all(
            find_wrong_codes(diagnostic, text, edits, other_codes, other_words)
            for edits in tried_edits
        ):
            wrong_codes.append(diagnostic.code.number)
    return wrong_codes


def test_repairs_offered_for_the_corpus_compile(
    programs: tuple[Entry, ...],
) -> None:
    texts = [entry.program for entry in programs]
    offers = sum(bool(ways(diagnostic, text)) for text in texts[-60:] for diagnostic in check(text))
    assert offers > 50
    wrong_codes_by_text = {
        text: codes for text in texts if (codes := codes_with_wrong_offers(text))
    }
    assert not wrong_codes_by_text, (
        f"{len(wrong_codes_by_text)} of {len(texts)}, the first: "
        f"{next(iter(wrong_codes_by_text.items()))}"
    )


@each_row("text", ["SI|WAIT UNTIL BUTTON", "SI|W UNTIL BUTTON", "BREIK", "EXIT", "F(FOREVR, 60)"])
def test_wrong_repairs_are_not_offered(text: str) -> None:
    for diagnostic in check(text):
        assert edits_of(diagnostic) is None
        assert not diagnostic.values.get("fix")


def test_a_similar_word_is_still_suggested() -> None:
    (diagnostic,) = check("BREIK")
    assert diagnostic.values["meant"] == "BREAK" and not diagnostic.values["near"]
