"""Makes the certain repairs of a program, and checks that offers are right.

An offer is always right: the text with it has no mistake that begins in the new part; otherwise the
mistake is reported without the offer (`drop_wrong_offers`). A repair is sure where the message
leaves no choice: it drops or invents no number, it does not guess a name, and with it the program
has fewer mistakes. All others are left to the reader.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence, Set
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span, apply_edits, edits_overlap
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic

# The gap of a message that is to be written. A suggestion that is only an example (`F(2, 80)` for F
# alone), or names two ways, is not an edit.
_SHOWN_GAPS = ("fix", "right", "near")  # the first of them that a diagnostic has
_GAPS_BY_CODE: dict[Code, tuple[str, ...]] = {
    **dict.fromkeys((codes.UNKNOWN_WORD, codes.UNKNOWN_NAME, codes.WANTS_CONDITION,
                     codes.MIXED_COMPARE, codes.NAMED_ARGUMENT, codes.NAME_WITH_SPACE,
                     codes.WORDS_AFTER, codes.SEVERAL_INSTRUCTIONS, codes.REPEATED), _SHOWN_GAPS),
    **dict.fromkeys((codes.MISSING_OPEN, codes.UNIT_PAIR, codes.OTHER_LANGUAGE,
                     codes.QUESTION_AFTER, codes.NOT_CALLABLE, codes.SWAPPED, codes.ZERO_BEFORE,
                     codes.LATE_CHECK, codes.FROZEN_UNTIL, codes.FROZEN_WHILE, codes.TURNED_ROUND,
                     codes.EXACT, codes.UNUSED_READING,
                     codes.NAME_TAKEN), ("fix",)),
    codes.EMPTY_BRACKETS: ("word",), codes.OUT_OF_RANGE: ("fix", "most"),
    codes.LONG_TIME: ("fix", "way"),
}  # fmt: skip
# Codes that show a whole line if they have no place.
_CODES_WITH_PLACE = (codes.QUESTION_AFTER, codes.NOT_CALLABLE)


def edits_of(diagnostic: Diagnostic) -> list[Edit] | None:
    """Return the changes that the thing to try asks for; None if it is no change of the text."""
    if diagnostic.repair is not None:
        return [*diagnostic.repair.edits] or None
    values, place = diagnostic.values, diagnostic.place
    new_text = next(
        (values[gap] for gap in _GAPS_BY_CODE.get(diagnostic.code, ()) if gap in values), ""
    )
    if not new_text or (place is None and diagnostic.code in _CODES_WITH_PLACE):
        return None
    return [Edit(place or diagnostic.span, new_text)]


MAX_CHECKS = 400  # most checks of one program; a long one gets fewer
CHECKED_CHARACTERS = 600_000
MAX_OFFERS = 20  # repairs of one text that are tried


class RepairedProgram(NamedTuple):
    """`text` is the program with its sure repairs, `diagnostics_left` its remaining diagnostics."""

    text: str
    repair_count: int
    diagnostics_left: list[Diagnostic]


Check = Callable[[str], list[Diagnostic]]


def repair_program(text: str, check: Check) -> RepairedProgram:
    """Return a program with its sure repairs. `check` finds the diagnostics of a text.

    A long program takes long to check and has many mistakes, so it is checked fewer times.
    """
    checks_left = min(MAX_CHECKS, 20 + CHECKED_CHARACTERS // (len(text) + 1)) - 1
    diagnostics = check(text)
    count = 0
    steps = _repair_steps(diagnostics)
    while checks_left > 0 and (repairs := next(steps, None)):
        edits = [_tidy(edit, text) for repair in repairs for edit in repair]
        changed_text = apply_edits(text, edits)
        diagnostics_after = check(changed_text)
        checks_left -= 1
        if is_better(diagnostics_after, diagnostics, edits):
            text, diagnostics, count, steps = (
                changed_text,
                diagnostics_after,
                count + len(repairs),
                _repair_steps(diagnostics_after),
            )
    return RepairedProgram(text, count, diagnostics)


def _tidy(edit: Edit, text: str) -> Edit:
    """Return an edit that leaves no blank line, and no blanks before an instruction or at an end.

    Removing text also removes the blanks around it, or its whole line.
    """
    start, end = edit.span
    if edit.text or start == end:
        return edit
    line_start = text.rfind("\n", 0, start) + 1
    line_end = text.find("\n", end)
    line_end = len(text) if line_end < 0 else line_end
    text_before, text_after = text[line_start:start], text[end:line_end]
    if not (text_before + text_after).strip():
        is_whole_text = line_end == len(text) and not line_start
        return Edit(
            Span(line_start, line_end if is_whole_text else min(line_end + 1, len(text))), ""
        )
    if not text_before.strip() or text_before[-1] in "|; ":
        end += len(text_after) - len(text_after.lstrip(" \t"))
    return Edit(Span(start, end), "")


def _repair_steps(diagnostics: list[Diagnostic]) -> Iterator[list[tuple[Edit, ...]]]:
    """Yield the certain repairs that do not overlap, and then each one alone."""
    sure_repairs = [
        diagnostic.repair.edits
        for diagnostic in diagnostics[: codes.MAX_DIAGNOSTICS]
        if diagnostic.repair and diagnostic.repair.is_sure
    ]
    separate_repairs: list[tuple[Edit, ...]] = []
    for edits in sure_repairs:
        if not any(edits_overlap(edits, other) for other in separate_repairs):
            separate_repairs.append(edits)
    if len(separate_repairs) > 1:
        yield separate_repairs
    yield from ([edits] for edits in sure_repairs)


def edits_offered(
    text: str, diagnostics: Sequence[Diagnostic], index: int, check: Check
) -> list[Edit]:
    """Return the edits that a reader may choose for one of a text's diagnostics, if any.

    The edits leave fewer mistakes; for a warning, the warning disappears and there are no more
    mistakes than before. They may be a guess, and change the program's behaviour: a person reviews
    them.
    """
    source, diagnostic = Source(text), diagnostics[index]
    edits = edits_of(diagnostic) or []
    lines = (source.line_text(source.position(edit.span.start)[0]) for edit in edits)
    # No edit has been made yet, so no copy is needed.
    if not edits or any("~" in line for line in lines):
        return []
    diagnostics_after = check(apply_edits(text, edits))
    if diagnostic.is_mistake:
        return edits if is_better(diagnostics_after, diagnostics, edits) else []
    return edits if _removes_warning(diagnostics_after, diagnostic.code, diagnostics) else []


def _removes_warning(
    diagnostics_after: Sequence[Diagnostic], code: Code, diagnostics: Sequence[Diagnostic]
) -> bool:
    """Return whether a repair removes one warning of this kind without adding a mistake."""
    count_before, count_after = (
        sum(diagnostic.code is code for diagnostic in each_list)
        for each_list in (diagnostics, diagnostics_after)
    )
    return count_after < count_before and _count_mistakes(diagnostics_after) <= _count_mistakes(
        diagnostics
    )


def drop_wrong_offers(
    diagnostics: Sequence[Diagnostic], text: str, check: Check
) -> list[Diagnostic]:
    """Return diagnostics without offers that are themselves wrong.

    An offer may be right only together with others, such as the header of a block and its end, and
    another mistake in it may be reported as well. In a long text, the last diagnostics are not
    checked.
    """
    checks_left = min(MAX_CHECKS, CHECKED_CHARACTERS // (len(text) + 1))
    kept_diagnostics = list(diagnostics)
    for _ in _SHOWN_GAPS:
        offers = [
            edits_of(diagnostic) or [] if diagnostic.is_mistake else []
            for diagnostic in kept_diagnostics
        ]
        joined_edits: list[Edit] = []
        for edits in offers:
            joined_edits += edits if not edits_overlap(edits, joined_edits) else []
        joined_text = _EditedText(text, joined_edits, check)
        joined_set = set(joined_edits)
        suspects = [
            k for k, edits in enumerate(offers)
            if kept_diagnostics[k].is_mistake and (edits or kept_diagnostics[k].values.get("fix"))
            and not (edits and set(edits) <= joined_set
                     and joined_text.is_right(kept_diagnostics[k], edits))
        ]  # fmt: skip
        # Results for offers without edits, so that each is checked once.
        is_right_of_offer: dict[tuple[Code, str], bool] = {}
        for k in suspects[:checks_left]:
            diagnostic = kept_diagnostics[k]
            codes_and_words = _covered_by_offer(kept_diagnostics, offers, k, text)
            offer_key = diagnostic.code, diagnostic.values.get("fix", "")
            if offers[k] or offer_key not in is_right_of_offer:
                is_right_of_offer[offer_key] = any(
                    _EditedText(text, edits, check).is_right(diagnostic, edits, codes_and_words)
                    for edits in ([offers[k]] if offers[k] else _shown_edits(diagnostic, text))
                )
            if not is_right_of_offer[offer_key]:
                kept_diagnostics[k] = _without_offer(diagnostic)
        checks_left -= len(suspects)
        if not suspects:
            break
    return kept_diagnostics


def _covered_by_offer(
    diagnostics: Sequence[Diagnostic], offers: Sequence[list[Edit]], k: int, text: str
) -> set[str]:
    """Return codes and words of mistakes that may be in the offer of diagnostic `k`."""
    codes_and_words = (
        set() if offers[k] else {codes.NEVER_ENDS.number}
    )  # a header is shown without its end
    if diagnostics[k].code is codes.RESERVED:  # `S = S + 1`, with any name
        codes_and_words.add(codes.USED_BEFORE_SET.number)
    for diagnostic, edits in zip(diagnostics, offers, strict=True):
        if diagnostic is not diagnostics[k]:
            codes_and_words |= {text[slice(*diagnostic.span)].upper()} - {""}
            if edits_overlap(edits, offers[k]):
                # their ends are in one place
                codes_and_words |= {
                    diagnostic.code.number,
                    codes.WRONG_END.number,
                    codes.NOT_OPEN.number,
                }
            elif (
                diagnostic.is_mistake
                and not edits
                and diagnostic.span.start < diagnostics[k].span.start
            ):
                codes_and_words.add(codes.NOT_OPEN.number)  # the block's header may be unreadable
    return codes_and_words


def _shown_edits(diagnostic: Diagnostic, text: str) -> Iterator[list[Edit]]:
    """Yield the possible edits of a message that shows an example but names no edits.

    In its place, in place of its line, or of all.
    """
    fix, span = diagnostic.values["fix"], diagnostic.place or diagnostic.span
    yield [Edit(span, fix)]
    line_start = text.rfind("\n", 0, span.start) + 1
    line_end = text.find("\n", span.end)
    yield [Edit(Span(line_start, line_end if line_end >= 0 else len(text)), fix)]
    yield [Edit(Span(0, len(text)), fix)]


class _EditedText:
    """A text with changes, and the mistakes that it has then."""

    def __init__(self, text: str, edits: Sequence[Edit], check: Check) -> None:
        self.edits = sorted(edits)
        self.text = apply_edits(text, edits)
        self.mistakes = [diagnostic for diagnostic in check(self.text) if diagnostic.is_mistake]

    def is_right(
        self,
        diagnostic: Diagnostic,
        own_edits: Sequence[Edit],
        codes_and_words: Set[str] = frozenset(),
    ) -> bool:
        """Return whether no mistake begins in the offer, except those of `codes_and_words`."""
        shift, spans = 0, []
        for edit in self.edits:
            start = edit.span.start + shift
            spans += [Span(start, start + len(edit.text))] if edit in own_edits else []
            shift += len(edit.text) - (edit.span.end - edit.span.start)
        shown_text = next(filter(None, map(diagnostic.values.get, _SHOWN_GAPS)), "")
        shown_start = self.text.find(shown_text, max(0, spans[0].start - len(shown_text)))
        if shown_start in range(spans[-1].end):
            spans.append(Span(shown_start, shown_start + len(shown_text)))
        return all(
            mistake.code.number in codes_and_words
            or self._is_in_words(codes_and_words, mistake.span.start)
            for mistake in self.mistakes
            if any(start <= mistake.span.start < end for start, end in spans)
        )

    def _is_in_words(self, words: Set[str], offset: int) -> bool:
        """Return whether an offset of the changed text is in one of these words of the original."""
        text = self.text.upper()
        return any(0 <= text.find(word, max(0, offset - len(word) + 1)) <= offset for word in words)


def _without_offer(diagnostic: Diagnostic) -> Diagnostic:
    """Return a diagnostic without the changes that it asks for, and without the words for them."""
    gaps = ("fix", "right") if diagnostic.repair else _GAPS_BY_CODE.get(diagnostic.code, ("fix",))
    shown_gap = next((gap for gap in gaps if diagnostic.values.get(gap)), "")
    emptied_gaps = [shown_gap, "whole", "lines", "times"]
    # The line of its header.
    emptied_gaps += ["line"] if diagnostic.code is not codes.WRONG_END else []
    emptied_gaps += ["right"] if diagnostic.code is codes.BRACES else []
    values = {gap: "" if gap in emptied_gaps else value for gap, value in diagnostic.values.items()}
    if shown_gap == "near":
        values["meant"] = diagnostic.values["near"]  # the question may lead to another word
    return diagnostic._replace(values=values, repair=None)


def is_better(
    diagnostics_after: Sequence[Diagnostic],
    diagnostics: Sequence[Diagnostic],
    edits: Sequence[Edit],
) -> bool:
    """Return whether a repair leaves fewer mistakes.

    Or as many, where it has uncovered one elsewhere: how a block ends is not looked at before its
    header is right, and of several signs that are missing on a line the first one is reported.
    """
    if _count_mistakes(diagnostics_after) != _count_mistakes(diagnostics):
        return _count_mistakes(diagnostics_after) < _count_mistakes(diagnostics)
    shift = 0
    for span, new_text in sorted(edits):
        start = span.start + shift
        end = start + len(new_text)
        shift += len(new_text) - (span.end - span.start)
        if any(
            diagnostic.is_mistake and start <= diagnostic.span.start < end
            for diagnostic in diagnostics_after
        ):
            return False
    return True


def _count_mistakes(diagnostics: Sequence[Diagnostic]) -> int:
    return sum(diagnostic.is_mistake for diagnostic in diagnostics)
